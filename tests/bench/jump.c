/* SPDX-License-Identifier: Apache-2.0 */
/*
 * jump.c - nanoseconds per cycle on dense code: gap servo, look ahead, jumps
 *
 *	jump SEGMENTS
 *	jump SEGMENTS worst
 *
 * A path of lines that turn a little, 10 um long; a gap that always sparks, and
 * the jumps of the built-in machine, deep inside the program.
 *
 * `worst` times each of 10^8 cycles, three times over: the same inputs, so the
 * same cycles.  Of each the least is kept.  What else the host did while it ran
 * hits another cycle in the next pass and is gone; what the cycle itself needs
 * stays.  Some minutes, 200 MB.
 */
#include "bench.h"

#include "config.h"
#include "cycle.h"
#include "interp/build.h"

#include <math.h>
#include <string.h>

#define CYCLES		400000
#define WORST_CYCLES	100000000
#define WORST_PASSES	3
#define LINE_MM		0.01
#define RADIUS_MM	30.0
#define PERIOD_S	1e-3

static struct machine_config machine;
static const struct io_inputs sparking = { .gap_valid = true, .gap_v = 50 };

/* A circle of lines, round and round. */
static struct interp_program build(uint32_t n)
{
	const struct interp_build_options o = {
		.machine = &machine.axes, .start_mm = { RADIUS_MM },
	};
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 50 };
	struct interp_build *b = interp_build_create(&o);
	struct interp_diag d;

	bench_must(b != NULL);
	for (uint32_t i = 1; i <= n; i++) {
		const double at = i * LINE_MM / RADIUS_MM;
		const double end[INTERP_NAXES] = { RADIUS_MM * cos(at),
						   RADIUS_MM * sin(at) };

		bench_must(interp_build_line(b, end, &w, &d) == 0);
	}
	return bench_program(b);
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
	bench_must(interp_cursor_init(&at, p) == 0);
	bench_must(interp_cursor_seek(&at, p->head->nsegs * 9 / 10, 0) == 0);
	bench_must(cycle_load_at(c, &at, 0) == ANSWER_DONE);
	cycle_command(c, &start);
}

static void say_means(const struct interp_program *p)
{
	double mean[BENCH_RUNS], worst[BENCH_RUNS];

	for (int i = 0; i < BENCH_RUNS; i++) {
		struct io_outputs out;
		double from_s, begun_s;
		struct cycle c;

		begin(&c, p);
		begun_s = from_s = bench_now_s();
		worst[i] = 0;
		for (int n = 0; n < CYCLES; n++) {
			double now_s;

			cycle_step(&c, &sparking, &out);
			if (n % 16)
				continue;
			now_s = bench_now_s();
			worst[i] = fmax(worst[i], (now_s - from_s) / 16);
			from_s = now_s;
		}
		mean[i] = (bench_now_s() - begun_s) / CYCLES;
		bench_must(c.fault.first == FAULT_NONE && c.totals.jumps > 100);
	}
	bench_say("mean_ns", bench_median(mean, BENCH_RUNS) * 1e9);
	bench_say("worst_ns", bench_median(worst, BENCH_RUNS) * 1e9);
}

/* -- Every cycle ---------------------------------------------------------- */

static uint64_t now_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (uint64_t)t.tv_sec * 1000000000 + (uint64_t)t.tv_nsec;
}

/* What two looks at the clock are apart of themselves. */
static uint64_t clock_ns(void)
{
	uint64_t least = UINT64_MAX;

	for (int i = 0; i < 1000000; i++) {
		const uint64_t from = now_ns(), took = now_ns() - from;

		least = took < least ? took : least;
	}
	return least;
}

static void time_each(const struct interp_program *p, uint16_t *least)
{
	struct io_outputs out;
	struct cycle c;
	uint64_t from;

	begin(&c, p);
	from = now_ns();
	for (uint32_t n = 0; n < WORST_CYCLES; n++) {
		uint64_t at, took;

		cycle_step(&c, &sparking, &out);
		at = now_ns();
		took = at - from;
		if (took < least[n])
			least[n] = (uint16_t)took;
		from = at;
	}
	bench_must(c.fault.first == FAULT_NONE && c.totals.jumps > 100);
}

static void say_worst(const struct interp_program *p)
{
	const uint64_t clock = clock_ns();
	uint16_t *least = malloc(WORST_CYCLES * sizeof(*least));
	uint32_t worst = 0, over = 0;

	bench_must(least != NULL);
	memset(least, 0xff, WORST_CYCLES * sizeof(*least));
	for (int i = 0; i < WORST_PASSES; i++)
		time_each(p, least);
	for (uint32_t n = 0; n < WORST_CYCLES; n++) {
		worst = least[n] > worst ? least[n] : worst;
		over += least[n] > clock + 1000;
	}
	bench_say("worst_cycle_ns", (double)worst - (double)clock);
	bench_say("over_1_us", over);
	free(least);
}

int main(int argc, char **argv)
{
	const bool worst = argc == 3 && strcmp(argv[2], "worst") == 0;
	struct interp_program p;

	if (argc != 2 && !worst)
		return 64;
	config_defaults(&machine);
	machine.gap.servo_v = 40;
	p = build((uint32_t)strtoul(argv[1], NULL, 0));
	if (worst)
		say_worst(&p);
	else
		say_means(&p);
	return 0;
}
