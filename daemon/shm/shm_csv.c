/* SPDX-License-Identifier: Apache-2.0 */
/* shm_csv.c - the trace of a machine as CSV */
#include "shm_csv.h"

void shm_csv_head(FILE *f)
{
	fputs("t_s,line,s_mm,feed_mm_s,gap_v,state,X,Y,Z,A,B,C,U,V,"
	      "X_actual,Y_actual,Z_actual,A_actual,B_actual,C_actual,"
	      "U_actual,V_actual\n", f);
}

static void places(FILE *f, const int32_t *pulses, const double *pulse_mm)
{
	for (int i = 0; i < SHM_NAXES; i++)
		fprintf(f, ",%.10g", pulses[i] * pulse_mm[i]);
}

void shm_csv_row(FILE *f, const struct shm_trace *t, double t_s,
		   const double pulse_mm[SHM_NAXES])
{
	fprintf(f, "%.6f,%u,%.6f,%.6f,%.2f,%s", t_s, t->line, t->place_mm,
		t->feed_mm_s, t->gap_v, shm_state_name(t->state));
	places(f, t->pos, pulse_mm);
	places(f, t->actual, pulse_mm);
	fputc('\n', f);
}
