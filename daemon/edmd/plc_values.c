/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_values.c - the words for states and faults, as a PLC tool reads them
 */
#include "plc_values.h"

#include "can_msg.h"
#include "cycle.h"

void loop_plc_values(FILE *f, uint8_t node)
{
	const int id = CAN_TPDO1 + node;

	fprintf(f, "VAL_ %d State", id);
	for (int s = STATE_IDLE; s < CYCLE_NSTATES; s++)
		fprintf(f, " %d \"%s\"", s, state_duty[s].name);
	fprintf(f, ";\nVAL_ %d Fault", id);
	for (int i = 0; i < CYCLE_NFAULTS; i++)
		fprintf(f, " %d \"%s\"", i,
			fault_name((uint32_t)i));
	fputs(";\n", f);
}
