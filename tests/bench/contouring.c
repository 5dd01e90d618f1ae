/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contouring.c - nanoseconds that maps and [contour] add to a cycle
 *
 * A dry walk round a circle, as lines of 10 um and as arcs, with neither, with
 * each, and with both.
 */
#include "bench.h"

#include "config.h"
#include "cycle.h"
#include "interp/build.h"

#include <math.h>
#include <string.h>

#define CYCLES		200000
#define LINE_MM		0.01
#define RADIUS_MM	30.0
#define TURNS		22

static struct machine_config machine;

static void turn(struct interp_build *b, bool arcs)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 20 };
	const struct interp_build_arc a = { .axis_a = INTERP_X,
					    .axis_b = INTERP_Y,
					    .sweep = M_PI };
	const int n = arcs ? 2 : (int)(2 * M_PI * RADIUS_MM / LINE_MM);
	struct interp_diag d;

	for (int i = 1; i <= n; i++) {
		const double at = i * 2 * M_PI / n;
		const double end[INTERP_NAXES] = { RADIUS_MM * cos(at),
						   RADIUS_MM * sin(at) };

		bench_must((arcs ? interp_build_arc(b, end, &a, &w, &d) :
				   interp_build_line(b, end, &w, &d)) == 0);
	}
}

static struct interp_program build(bool arcs)
{
	const struct interp_build_options o = {
		.machine = &machine.axes, .start_mm = { RADIUS_MM },
	};
	struct interp_build *b = interp_build_create(&o);

	bench_must(b != NULL);
	for (int i = 0; i < TURNS; i++)
		turn(b, arcs);
	return bench_program(b);
}

/* Three pitches, six straightnesses, three angles, three growths. */
static void maps(struct interp_errormap *m)
{
	for (int r = 0; r < 9; r++) {
		m->row[r].along = (uint8_t)(r / 3);
		m->row[r].across = (uint8_t)(r % 3);
		m->row[r].n = 41;
		for (int i = 0; i < 41; i++) {
			m->row[r].at_mm[i] = -200 + 10 * i;
			m->row[r].error_mm[i] = 0.004 * sin(i + r);
		}
	}
	m->nrows = 9;
	for (int i = 0; i < 3; i++) {
		m->lean[i] = (struct interp_errormap_lean) {
			(uint8_t)i, (uint8_t)((i + 1) % 3), 40e-6 };
		m->growth[i] = (struct interp_errormap_growth) {
			11.5e-6, 0, 3 };
	}
	m->nleans = 3;
	bench_must(interp_errormap_check(m) == 0);
}

static double run(const struct interp_program *p, const char *method)
{
	const struct cycle_command start = { .verb = CYCLE_START };
	struct io_inputs in = { .gap_valid = false };
	static struct cycle c;
	struct cycle_config k;
	struct io_outputs out;
	double from_s;

	snprintf(machine.contour.method, sizeof(machine.contour.method), "%s",
		 method);
	config_cycle(&machine, &k);
	k.dry_run = true;
	k.start[0] = (int32_t)(RADIUS_MM / machine.axes.axis[0].pulse_mm);
	cycle_init(&c, &k);
	bench_must(cycle_load(&c, p) == ANSWER_DONE);
	cycle_command(&c, &start);
	from_s = bench_now_s();
	for (int n = 0; n < CYCLES; n++) {
		cycle_step(&c, &in, &out);
		memcpy(in.actual, out.target, sizeof(in.actual));
	}
	bench_must(c.loaded && c.fault.first == FAULT_NONE);
	return (bench_now_s() - from_s) / CYCLES * 1e9;
}

static void say(const char *what, const struct interp_program *p,
		const char *method)
{
	double ns[BENCH_RUNS];

	for (int i = 0; i < BENCH_RUNS; i++)
		ns[i] = run(p, method);
	bench_say(what, bench_median(ns, BENCH_RUNS));
}

static void bench(const char *shape, bool arcs)
{
	static const struct interp_errormap none;
	const struct interp_program p = build(arcs);
	char what[64];

	for (int m = 0; m < 2; m++) {
		static const char *const methods[] = {
			"none", "feedforward", "feedforward+cross-coupled",
		};

		machine.geometry = none;
		if (m)
			maps(&machine.geometry);
		for (int i = 0; i < 3; i++) {
			snprintf(what, sizeof(what), "%s_%s%s_ns", shape,
				 methods[i], m ? "_maps" : "");
			say(what, &p, methods[i]);
		}
	}
}

int main(void)
{
	config_defaults(&machine);
	machine.backend = BACKEND_CAN402;
	machine.period_us = 1000;
	machine.axes.present = 7;
	for (int i = 0; i < 3; i++)
		machine.loop[i].gain_1_s = 30 - 4 * i;
	machine.contour.cross_1_s = 50;
	bench("lines", false);
	bench("arcs", true);
	return 0;
}
