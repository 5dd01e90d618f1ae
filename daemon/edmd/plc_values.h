/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_values.h - the words for states and faults, behind plc_dbc()
 */
#ifndef EDMD_PLC_VALUES_H
#define EDMD_PLC_VALUES_H

#include <stdint.h>
#include <stdio.h>

/** loop_plc_values() - value tables of the status frame of @node. Any thread. */
void loop_plc_values(FILE *f, uint8_t node);

#endif /* EDMD_PLC_VALUES_H */
