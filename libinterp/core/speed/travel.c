/* SPDX-License-Identifier: Apache-2.0 */
/* travel.c - what any positioning has at most */
#include "interp/axis.h"
#include "interp/smaller.h"

#include <math.h>

void interp_machine_travel(const struct interp_machine *m, double *ret_a_mm_s2,
			   double *ret_j_mm_s3)
{
	double a[2] = { INFINITY, INFINITY };	/* linear, rotary */
	double j[2] = { INFINITY, INFINITY };

	for (int i = 0; i < INTERP_NAXES; i++) {
		const int rotary = interp_axis_is_rotary((enum interp_axis)i);

		if (!(m->present >> i & 1))
			continue;
		a[rotary] = smaller(a[rotary], m->axis[i].a_max_mm_s2);
		j[rotary] = smaller(j[rotary], m->axis[i].j_max_mm_s3);
	}
	*ret_a_mm_s2 = isfinite(a[0]) ? a[0] : a[1];
	*ret_j_mm_s3 = isfinite(j[0]) ? j[0] : j[1];
}
