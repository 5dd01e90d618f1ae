/* SPDX-License-Identifier: Apache-2.0 */
/* kalman.c - predicts by the model, corrects by the encoder */
#include "interp/kalman.h"

#include <errno.h>
#include <string.h>

#define N	INTERP_AXIS_NSTATES

int interp_kalman_init(struct interp_kalman *k,
		       const struct interp_axis_loop *loop, double period_s,
		       const struct interp_kalman_noise *noise,
		       double place_mm)
{
	if (!(noise->drive_mm_s > 0 && noise->sensor_mm > 0))
		return -EINVAL;
	*k = (struct interp_kalman) {
		.q_mm2_s2 = noise->drive_mm_s * noise->drive_mm_s,
		.r_mm2 = noise->sensor_mm * noise->sensor_mm,
	};
	return interp_axis_model_init(&k->model, loop, period_s, place_mm);
}

void interp_kalman_correct(struct interp_kalman *k, double measured_mm)
{
	const double missed = measured_mm - k->model.x[0];
	const double s = k->p[0][0] + k->r_mm2;
	double gain[N], row[N];

	memcpy(row, k->p[0], sizeof(row));
	for (int i = 0; i < N; i++) {
		gain[i] = k->p[i][0] / s;
		k->model.x[i] += gain[i] * missed;
	}
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			k->p[i][j] -= gain[i] * row[j];
}

void interp_kalman_predict(struct interp_kalman *k, double u_mm_s)
{
	const struct interp_axis_model *m = &k->model;
	double fp[N][N] = { 0 };

	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			for (int n = 0; n < N; n++)
				fp[i][j] += m->phi[i][n] * k->p[n][j];
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++) {
			double sum = k->q_mm2_s2 *
				     (m->gamma_new[i] * m->gamma_new[j] +
				      m->gamma_old[i] * m->gamma_old[j]);

			for (int n = 0; n < N; n++)
				sum += fp[i][n] * m->phi[j][n];
			k->p[i][j] = sum;
		}
	interp_axis_model_step(&k->model, u_mm_s);
}
