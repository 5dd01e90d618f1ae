/* SPDX-License-Identifier: Apache-2.0 */
/*
 * jump.c - nanoseconds per cycle on dense code: gap servo, look ahead, jumps
 *
 *	jump SEGMENTS
 *
 * A path of lines that turn a little, 10 um long; a gap that always sparks, and
 * the jumps of the built-in machine, deep inside the program.
 */
#include "bench.h"

#include "config.h"
#include "cycle.h"
#include "interp/build.h"

#include <math.h>

#define CYCLES		400000
#define LINE_MM		0.01
#define RADIUS_MM	30.0
#define PERIOD_S	1e-3

static struct machine_config machine;

static void must(bool good)
{
	if (!good)
		exit(70);
}

/* A circle of lines, round and round. */
static struct interp_program build(uint32_t n)
{
	const struct interp_build_options o = {
		.machine = &machine.axes, .start_mm = { RADIUS_MM },
	};
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 50 };
	const struct interp_build_about about = { .lines = 1 };
	struct interp_build *b = interp_build_create(&o);
	struct interp_program p;
	struct interp_diag d;
	void *block;
	size_t bytes;

	must(b != NULL);
	for (uint32_t i = 1; i <= n; i++) {
		const double at = i * LINE_MM / RADIUS_MM;
		const double end[INTERP_NAXES] = { RADIUS_MM * cos(at),
						   RADIUS_MM * sin(at) };

		must(interp_build_line(b, end, &w, &d) == 0);
	}
	bytes = interp_build_bytes(b);
	block = malloc(bytes);
	must(block != NULL);
	interp_build_write(b, &about, block);
	interp_build_destroy(b);
	must(interp_program_map(&p, block, bytes) == 0);
	return p;
}

static void begin(struct cycle *c, const struct interp_program *p)
{
	const struct cycle_command start = { .verb = CYCLE_START };
	struct interp_cursor at;
	struct cycle_config k;

	config_cycle(&machine, &k);
	k.gap.feed_max_mm_s = 1e-4;
	k.gap.approach_mm_s = 1e-4;
	k.jump.short_of_mm = 0;
	k.hold_at_end = true;
	cycle_init(c, &k);
	must(interp_cursor_init(&at, p) == 0);
	must(interp_cursor_seek(&at, p->head->nsegs * 9 / 10, 0) == 0);
	must(cycle_load_at(c, &at, 0) == ANSWER_DONE);
	cycle_command(c, &start);
}

int main(int argc, char **argv)
{
	const struct io_inputs in = { .gap_valid = true, .gap_v = 50 };
	struct interp_program p;
	double mean[BENCH_RUNS], worst[BENCH_RUNS];

	if (argc != 2)
		return 64;
	config_defaults(&machine);
	machine.gap.servo_v = 40;
	p = build((uint32_t)strtoul(argv[1], NULL, 0));
	for (int i = 0; i < BENCH_RUNS; i++) {
		struct io_outputs out;
		double from_s, begun_s;
		struct cycle c;

		begin(&c, &p);
		begun_s = from_s = bench_now_s();
		worst[i] = 0;
		for (int n = 0; n < CYCLES; n++) {
			double now_s;

			cycle_step(&c, &in, &out);
			if (n % 16)
				continue;
			now_s = bench_now_s();
			worst[i] = fmax(worst[i], (now_s - from_s) / 16);
			from_s = now_s;
		}
		mean[i] = (bench_now_s() - begun_s) / CYCLES;
		must(c.fault == FAULT_NONE && c.totals.jumps > 100);
	}
	bench_say("mean_ns", bench_median(mean, BENCH_RUNS) * 1e9);
	bench_say("worst_ns", bench_median(worst, BENCH_RUNS) * 1e9);
	return 0;
}
