/* SPDX-License-Identifier: Apache-2.0 */
/* set_twin.c - put the errors of a run of the model where their feet were */
#include "tried/set_twin.h"

void interp_twin_correct(const struct interp_twin_set *set,
			 const struct interp_twin_run *run, double gain,
			 int naxes)
{
	size_t j = 0;

	if (run->n == 0)
		return;
	for (size_t i = 0; i < set->n; i++) {
		const double u = set->u[i];
		double part = 0;

		while (j + 2 < run->n && run->u[j + 1] <= u)
			j++;
		if (run->n > 1 && u > run->u[j])
			part = run->u[j + 1] > u ?
			       (u - run->u[j]) / (run->u[j + 1] - run->u[j]) :
			       1;
		for (int a = 0; a < naxes; a++) {
			const double *e = run->error_mm[j];
			const double next = part > 0 ?
					    run->error_mm[j + 1][a] : 0;

			set->offset_mm[i][a] += gain * ((1 - part) * e[a] +
							part * next);
		}
	}
}
