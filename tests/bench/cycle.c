/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle.c - cycles per second: read, step, write, as edmsim does it
 *
 *	cycle dry JOB.ngc	on no machine, at the programmed feed
 *	cycle gap JOB.ngc	on the simulated machine
 *	cycle sim		the simulated machine alone
 */
#include "bench.h"

#include "config.h"
#include "cycle.h"
#include "interp/nc.h"

#include <string.h>

static struct machine_config machine;

static struct interp_program compile(const char *path)
{
	struct interp_build_options bo = { .machine = &machine.axes };
	const struct interp_nc_options no = { .machine = &machine.axes };
	const struct interp_build_about about = { .name = path };
	struct interp_nc_result done;
	struct interp_program p;
	struct interp_diag diag;
	struct interp_build *b = interp_build_create(&bo);
	static char text[1 << 24];
	FILE *f = fopen(path, "rb");
	size_t n;
	void *block;

	if (!f)
		exit(66);
	n = fread(text, 1, sizeof(text), f);
	fclose(f);
	if (interp_nc_compile(&(struct interp_text) { .at = text, .bytes = n },
			      &no, b, &done, &diag)) {
		fprintf(stderr, "%s:%u:%u: %s\n", path, diag.line, diag.column,
			diag.found);
		exit(65);
	}
	block = interp_build_take(b, &about, &n);
	interp_build_destroy(b);
	if (!block || interp_program_map(&p, block, n))
		exit(70);
	return p;
}

static void begin(struct cycle *c, const struct interp_program *p, bool dry)
{
	const struct cycle_command start = { .verb = CYCLE_START };
	struct cycle_config cc;

	config_cycle(&machine, &cc);
	cc.dry_run = dry;
	cycle_init(c, &cc);
	cycle_load(c, p);
	cycle_command(c, &start);
}

/* The whole job, again and again, for at least a quarter of a second. */
static double cycles_s(const struct interp_program *p, bool dry)
{
	const double from_s = bench_now_s();
	double took_s;
	uint64_t cycles = 0;

	do {
		struct io_machine m;
		struct io_outputs out;
		struct io_inputs in;
		struct cycle c;

		begin(&c, p, dry);
		if (dry ? io_null_open(&m, NULL, NULL) :
			  io_sim_open_seed(&m, &machine, 1))
			exit(71);
		m.write(m.self, &c.out);
		while (state_duty[c.state].running ||
		       c.state == STATE_HOLD) {
			m.read(m.self, &in);
			cycle_step(&c, &in, &out);
			m.write(m.self, &out);
			cycles++;
		}
		m.close(m.self);
		if (c.outcome == OUTCOME_FAULT)
			exit(1);
		took_s = bench_now_s() - from_s;
	} while (took_s < 0.25);
	return (double)cycles / took_s;
}

/* Around the best gap, as the servo keeps it. */
static double sims_s(void)
{
	const double from_s = bench_now_s();
	struct io_outputs out = { .power = true };
	struct io_machine m;
	struct io_inputs in;
	double took_s;
	uint64_t n = 0;

	if (io_sim_open_seed(&m, &machine, 1))
		exit(71);
	do {
		for (int i = 0; i < 10000; i++, n++) {
			out.place_mm += in.gap_v > 20 ? 1e-5 : -1e-5;
			m.write(m.self, &out);
			m.read(m.self, &in);
		}
		took_s = bench_now_s() - from_s;
	} while (took_s < 0.25);
	m.close(m.self);
	return (double)n / took_s;
}

int main(int argc, char **argv)
{
	const bool sim = argc == 2 && strcmp(argv[1], "sim") == 0;
	struct interp_program p = { 0 };
	double v[BENCH_RUNS];

	if (argc != 3 && !sim)
		return 64;
	config_defaults(&machine);
	if (!sim)
		p = compile(argv[2]);
	for (int i = 0; i < BENCH_RUNS; i++)
		v[i] = sim ? sims_s() :
			     cycles_s(&p, strcmp(argv[1], "dry") == 0);
	bench_say(argv[1], bench_median(v, BENCH_RUNS));
	return 0;
}
