/* SPDX-License-Identifier: Apache-2.0 */
/* feedforward.c - the methods of compensation by name, and the feedforward */
#include "interp/feedforward.h"

#include <errno.h>
#include <math.h>
#include <string.h>

static const char *const names[] = {
	"feedforward", "cross-coupled", "predictive", "zpetc",
};

#define NMETHODS	((int)(sizeof(names) / sizeof(names[0])))

const char *interp_compensate_name(int bit)
{
	return bit >= 0 && bit < NMETHODS ? names[bit] : NULL;
}

static int method_find(const char *word, size_t n)
{
	for (int i = 0; i < NMETHODS; i++)
		if (strlen(names[i]) == n && strncmp(names[i], word, n) == 0)
			return 1 << i;
	return -EINVAL;
}

int interp_compensate_parse(const char *text)
{
	int methods = 0;

	if (strcmp(text, "none") == 0)
		return 0;
	for (;;) {
		const size_t n = strcspn(text, "+");
		const int bit = method_find(text, n);

		if (bit < 0)
			return bit;
		methods |= bit;
		if (!text[n])
			return methods;
		text += n + 1;
	}
}

/*
 * Speed and acceleration of the cubic through four targets, a part @f of a
 * period after the second one.
 */
double interp_compensate_feedforward(const struct interp_compensate_gains *g,
				     const struct interp_axis_loop *l,
				     double period_s, const double *set)
{
	const double t = period_s;
	const double ahead = g->lead_periods + l->delay_s / t;
	const double *s = set + (int)floor(ahead), f = ahead - floor(ahead);
	const double d1 = s[1] - s[0], d2 = s[1] - 2 * s[0] + s[-1];
	const double d3 = s[2] - 3 * s[1] + 3 * s[0] - s[-1];
	const double v = d1 + d2 * (f - 0.5) + d3 * (f * f / 2 - 1.0 / 6);
	const double a = d2 + d3 * f;
	const double lags_s = 2 * l->damping / (2 * M_PI * l->velocity_hz);

	return (g->velocity * v +
		g->acceleration * g->velocity * lags_s * a / t) / t;
}
