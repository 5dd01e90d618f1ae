/* SPDX-License-Identifier: Apache-2.0 */
/*
 * speeds.c - the table of speeds of a job, as places a millisecond apart
 *
 *	speeds MACHINE.ini JOB.ngc
 *
 * Prints the time of the processor for the shapes and for the speeds, and then
 * the place along the path at each millisecond.  Dwells are left out.
 */
#include "compiling.h"
#include "grow.h"

#include "speed/caps.h"
#include "speed/sections.h"

#include "interp/nc.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define TICK_S	1e-3

static double now_s(void)
{
	return (double)clock() / CLOCKS_PER_SEC;
}

struct sums {
	double shape_s, speed_s, time_s, late_s;
	size_t places, sections;
	struct profile_asked most;
};

/* By time, the speed goes from the one to the other as a parabola does that has
 * the mean slope; so the place is a cubic. */
static void print_places(const struct profile *p, struct sums *k)
{
	double from = -k->late_s;

	for (size_t i = 0; i + 1 < p->n; i++) {
		const double t = caps_interval_s(p, i);
		const double mm = p->s_mm[i + 1] - p->s_mm[i];
		const double a = p->v_mm_s[i], b = p->v_mm_s[i + 1];

		for (; from < t; from += TICK_S) {
			const double u = t > 0 ? from / t : 0;
			const double h = u * u * (3 - 2 * u) * mm +
				(u * (1 - u) * (1 - u) * a -
				 u * u * (1 - u) * b) * t;

			printf("%.9f\n", p->s_mm[i] + h);
		}
		from -= t;
	}
	k->late_s = -from;
}

static int of_way(const struct interp_limits *l, const struct interp_program *p,
		  uint32_t from, uint32_t to, struct sums *k)
{
	const struct interp_axes axes = sections_axes(l, p);
	const double begin = now_s();
	struct sections s;
	struct profile speeds;
	double middle;
	int err = sections_make(&s, l, p, from, to);

	if (err < 0 || s.n == 0)
		return err;
	middle = now_s();
	err = profile_solve(&speeds, &axes, s.at, s.n, s.corner_mm_s);
	k->shape_s += middle - begin;
	k->speed_s += now_s() - middle;
	k->sections += s.n;
	if (err < 0)
		return err;
	k->time_s += profile_s(&speeds);
	k->places += speeds.n;
	for (size_t i = 0; i < speeds.n; i++) {
		const struct profile_asked a = profile_asked(&speeds, &axes, i);

		k->most.v = fmax(k->most.v, a.v);
		k->most.a = fmax(k->most.a, a.a);
		k->most.j = fmax(k->most.j, a.j);
	}
	print_places(&speeds, k);
	profile_free(&speeds);
	sections_free(&s);
	return 0;
}

static int of_program(const struct interp_limits *l,
		      const struct interp_program *p)
{
	struct sums k = { 0 };
	uint32_t from = 0;
	int err = 0;

	for (uint32_t i = 0; err == 0 && i < p->head->nsegs; i++) {
		if (p->segs[i].kind < INTERP_BEGIN)
			continue;
		err = of_way(l, p, from, i, &k);
		from = i + 1;
	}
	fprintf(stderr, "{\"time_s\": %.6f, \"shape_s\": %.4f, \"speed_s\": "
		"%.4f, \"places\": %zu, \"sections\": %zu, \"v\": %.4f, "
		"\"a\": %.4f, \"j\": %.4f}\n", k.time_s, k.shape_s, k.speed_s,
		k.places, k.sections, k.most.v, k.most.a, k.most.j);
	return err;
}

int main(int argc, char **argv)
{
	static struct machine_config c;
	const struct interp_build_about about = { .name = "speeds" };
	const struct config_tech none = { 0 };
	struct config_compiling of;
	struct interp_program p;
	struct interp_nc_result done;
	struct interp_diag diag;
	struct interp_text text = { 0 };
	struct interp_limits l;
	struct interp_build *b;
	char *at = NULL;
	size_t n = 0, bytes;
	void *block;
	FILE *f;

	if (argc != 3 || !(f = fopen(argv[2], "rb")) ||
	    grow_read(f, 1u << 30, &at, &n) < 0)
		return 64;
	if (config_read(&c, argv[1], &diag) < 0)
		return 78;
	config_compiling(&c, &none, &of);
	text.at = at;
	text.bytes = n;
	b = interp_build_create(&of.build);
	if (interp_nc_compile(&text, &of.text.nc, b, &done, &diag) < 0) {
		fprintf(stderr, "%u: %s\n", diag.line, diag.found);
		return 65;
	}
	block = interp_build_take(b, &about, &bytes);
	if (!block || interp_program_map(&p, block, bytes) < 0)
		return 70;
	l = (struct interp_limits) {
		.machine = &c.axes, .corner_mm = of.build.corner_mm > 0 ?
			of.build.corner_mm : INTERP_CORNER_MM,
		.tolerance_mm = of.build.tolerance_mm,
		.rotary_radius_mm = INTERP_ROTARY_MM,
	};
	return of_program(&l, &p) < 0 ? 71 : 0;
}
