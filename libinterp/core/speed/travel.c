/* SPDX-License-Identifier: Apache-2.0 */
/* travel.c - more than any positioning has */
#include "interp/axis.h"

#include <math.h>

void interp_machine_travel(const struct interp_machine *m, double *ret_a_mm_s2,
			   double *ret_j_mm_s3)
{
	double a = 0, j = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!(m->present >> i & 1))
			continue;
		a = hypot(a, m->axis[i].a_max_mm_s2);
		j = hypot(j, m->axis[i].j_max_mm_s3);
	}
	*ret_a_mm_s2 = a;
	*ret_j_mm_s3 = j;
}
