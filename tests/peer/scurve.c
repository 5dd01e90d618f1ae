/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scurve.c - durations of S-curves, for a comparison with another planner
 *
 * Reads lines of eight words from stdin and prints a duration in s for each:
 *
 *	place|speed V_MAX A_UP A_DOWN J_MAX  V A  GOAL
 *
 * GOAL is mm to go, or mm/s to come to.
 */
#include "interp/scurve.h"

#include <stdio.h>
#include <string.h>

int main(void)
{
	struct interp_scurve_limits l;
	struct interp_scurve c;
	double v, a, goal;
	char what[8];

	while (scanf("%7s %lf %lf %lf %lf %lf %lf %lf", what, &l.v_max_mm_s,
		     &l.a_up_mm_s2, &l.a_down_mm_s2, &l.j_max_mm_s3, &v, &a,
		     &goal) == 8) {
		if (strcmp(what, "place") == 0)
			interp_scurve_to_place(&c, &l, v, a, goal);
		else
			interp_scurve_to_speed(&c, &l, v, a, goal);
		printf("%.17g\n", c.end_s);
	}
	return 0;
}
