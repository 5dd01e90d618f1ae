/* SPDX-License-Identifier: Apache-2.0 */
/*
 * count.c - work of known size between two marks of callgrind, which counts
 * the instructions; tests/bench/count runs it
 *
 * It prints a line for each piece of work: its name and its units.  The counts
 * do not depend on how busy the machine is.
 */
#include "bench.h"

#include "config.h"
#include "cycle.h"
#include "interp/cursor.h"
#include "interp/nc.h"

#include <math.h>
#include <string.h>
#include <valgrind/callgrind.h>

#define POINTS		20000
#define LINES		5000
#define CYCLES		5000
#define RUN		64		/* points at once, as the cycle takes */

static struct machine_config machine;

static void begin(void)
{
	CALLGRIND_ZERO_STATS;
}

/* What was done since begin(). */
static void end(const char *name, uint64_t units)
{
	CALLGRIND_DUMP_STATS_AT(name);
	printf("%s %llu\n", name, (unsigned long long)units);
}

/* -- Lattice points ------------------------------------------------------- */

static const struct bench_path paths[] = {
	{ "simultaneous, 2 axes", INTERP_SIMULTANEOUS, 0, 2 },
	{ "simultaneous, 8 axes", INTERP_SIMULTANEOUS, 0, 8 },
	{ "simultaneous, arc", INTERP_SIMULTANEOUS, 0, 0 },
	{ "point-by-point, 2 axes", INTERP_POINT_BY_POINT, 0, 2 },
	{ "point-by-point, arc", INTERP_POINT_BY_POINT, 0, 0 },
	{ "main-direction, 2 axes", INTERP_MAIN_DIRECTION, 0, 2 },
	{ "main-direction, tree of 8", INTERP_MAIN_DIRECTION, INTERP_TREE, 8 },
	{ "min-switch, 2 axes", INTERP_MIN_SWITCH, 0, 2 },
	{ "min-switch, arc", INTERP_MIN_SWITCH, 0, 0 },
	{ "min-switch, tree of 8", INTERP_MIN_SWITCH, INTERP_TREE, 8 },
	{ "min-switch, star of 8", INTERP_MIN_SWITCH, INTERP_STAR, 8 },
	{ "point-by-point, XYUV", INTERP_POINT_BY_POINT, 0, BENCH_PAIR },
};

/* The first points of a run on the way; the rest is not walked. */
static void walk(struct interp_cursor *c, double ds_mm, uint64_t points)
{
	uint16_t pulses[RUN];

	interp_cursor_aim(c, ds_mm);
	for (uint64_t n = 0; n < points; ) {
		const uint64_t left = points - n;
		const uint32_t some = interp_cursor_run(c, pulses,
				left < RUN ? (uint32_t)left : RUN);

		n += some;
		if (some == 0 && interp_cursor_step(c) == INTERP_MOVED)
			n++;
		else
			bench_must(some > 0);
	}
}

static void count_path(const struct bench_path *p)
{
	const struct interp_program prog = bench_path(&machine.axes, p);
	struct interp_cursor c;
	char name[80];

	interp_cursor_init(&c, &prog);
	begin();
	walk(&c, 1e9, POINTS);
	snprintf(name, sizeof(name), "a point forward: %s", p->name);
	end(name, POINTS);
	begin();
	walk(&c, -1e9, POINTS - 1000);
	snprintf(name, sizeof(name), "a point back: %s", p->name);
	end(name, POINTS - 1000);
	begin();
	bench_must(interp_cursor_seek(&c, 1, prog.segs[1].ticks / 4 * 3) == 0);
	snprintf(name, sizeof(name), "a place sought: %s", p->name);
	end(name, 1);
}

/* -- Lines ---------------------------------------------------------------- */

static const char *const texts[] = {
	"a line compiled: X Y Z", "a line compiled: arcs",
	"a line compiled: X Y Z C", "a line compiled: X Y, tiny",
	"a line compiled: any way, Z softer",
	"a line compiled: arcs of many sizes",
};

#define ANY_WAY		4
#define MANY_SIZES	5

/* The smaller one is, the softer: whether to stand is asked at each. */
static void write_sizes(FILE *f)
{
	double x = 0;

	for (int i = 1; i <= LINES; i++) {
		double d = 0.5 + round(8000 * fabs(sin(i * 1.7))) / 1000;

		d = x > 0 ? -d : d;
		x += d;
		fprintf(f, "G%d X%.4f I%.4f J0\n", 2 + i % 2, x, d / 2);
	}
}

static void write_text(FILE *f, int kind)
{
	fputs("G21 G90 F600\n", f);
	if (kind == MANY_SIZES) {
		write_sizes(f);
		return;
	}
	for (int i = 1; i <= LINES; i++) {
		const double a = i * 0.02, x = 20 * cos(a), y = 20 * sin(a);

		if (kind == 0)
			fprintf(f, "G1 X%.3f Y%.3f Z%.3f\n", x, y, -i * 1e-3);
		else if (kind == 1)
			fprintf(f, "G3 X%.3f I%.3f J0\n", i & 1 ? 0.4 : 0.0,
				i & 1 ? 0.2 : -0.2);
		else if (kind == 2)
			fprintf(f, "G1 X%.3f Y%.3f Z%.3f C%.3f\n", x, y,
				-i * 1e-3, i * 0.03);
		else if (kind == ANY_WAY)
			fprintf(f, "G1 X%.3f Y%.3f Z%.3f\n", 90 * sin(i * 1.7),
				90 * sin(i * 2.9), 90 * sin(i * 4.3));
		else
			fprintf(f, "G1 X%.4f Y%.4f\n", 20 * cos(a / 40),
				20 * sin(a / 40));
	}
}

/* As edmd-jobs makes a program of a text. */
static struct interp_program compile(const char *text, size_t size)
{
	struct interp_build_options bo = {
		.machine = &machine.axes,
	};
	const struct interp_nc_options no = { .machine = &machine.axes };
	struct interp_build *b = interp_build_create(&bo);
	struct interp_nc_result done;
	struct interp_diag diag = { 0 };

	bench_must(b != NULL);
	if (interp_nc_compile(&(struct interp_text) {
			.at = text, .bytes = size }, &no, b, &done, &diag)) {
		fprintf(stderr, "count: %u:%u: %s\n", diag.line, diag.column,
			diag.found);
		exit(70);
	}
	return bench_program(b);
}

/* Where axes differ, lines of some directions may be faster than others. */
static void count_compile(int kind)
{
	struct interp_axis_limits *z = &machine.axes.axis[INTERP_Z];
	const struct interp_axis_limits as_others = *z, softer = {
		z->pulse_mm, z->travel_min_mm, z->travel_max_mm,
		z->v_max_mm_s / 4, z->a_max_mm_s2 / 4, z->j_max_mm_s3 / 4
	};
	char *text = NULL;
	size_t size;
	FILE *f = open_memstream(&text, &size);

	bench_must(f != NULL);
	write_text(f, kind);
	bench_must(fclose(f) == 0);
	if (kind == ANY_WAY)
		*z = softer;
	begin();
	compile(text, size);
	end(texts[kind], LINES);
	*z = as_others;
	free(text);
}

/* -- Cycles --------------------------------------------------------------- */

static void steps(struct cycle *c, struct io_machine *m, uint64_t n)
{
	struct io_outputs out;
	struct io_inputs in;

	for (uint64_t i = 0; i < n; i++) {
		m->read(m->self, &in);
		cycle_step(c, &in, &out);
		m->write(m->self, &out);
		bench_must(state_duty[c->state].running);
	}
}

static void count_cycles(const struct interp_program *p, bool dry)
{
	const struct cycle_command start = { .verb = CYCLE_START };
	static struct cycle_config cc;
	static struct cycle c;
	struct io_machine m;

	config_cycle(&machine, &cc);
	cc.dry_run = dry;
	cycle_init(&c, &cc);
	cycle_load(&c, p);
	cycle_command(&c, &start);
	bench_must(!(dry ? io_null_open(&m, NULL, NULL) :
			   io_sim_open_seed(&m, &machine, 1)));
	m.write(m.self, &c.out);
	/* Past the approach, so that it sparks. */
	steps(&c, &m, 200);
	begin();
	steps(&c, &m, dry ? 1000 : CYCLES);
	end(dry ? "a cycle of a dry run" : "a cycle in the simulated gap",
	    dry ? 1000 : CYCLES);
	m.close(m.self);
}

/* -- The cycle that looks for cut ground ----------------------------------- */

#define CURVES		100

/* Curves of the highest degree in all axes, which hardly leave the place: C
 * turns to and fro.  Then C turns away. */
static void write_curves(FILE *f)
{
	fputs("G21 G90 F6000\nM3\nG0 Z0.1\nG1 Z0\n", f);
	for (int i = 0; i < CURVES; i++) {
		for (int k = 0; k < 10; k++) {
			const double at = (i % 2 ? 9 - k : k) / 9.0;

			fprintf(f, "%sK0 X%.6f Y%.6f Z%.6f U%.6f V%.6f A%.6f "
				"B%.6f C%.6f\n", k ? "" : "G6.2 P10 ",
				0.002 * at, 0.001 * at * at, 0.0015 * at,
				0.002 * at * at, 0.001 * at, 0.001 * at,
				0.002 * at, 3 * at);
		}
		fputs("K1\nK1\nK1\nK1\nK1\nK1\nK1\nK1\nK1\nK1\n", f);
	}
	fputs("G0 C-60\nM2\n", f);
}

static void step_at(struct cycle *c, double gap_v)
{
	const struct io_inputs in = { .gap_valid = true, .gap_v = gap_v };
	struct io_outputs out;

	cycle_step(c, &in, &out);
}

/* Of all cycles until it is known what the short is, the first: it also looks
 * for the segments that count. */
static void count_ground(void)
{
	const struct cycle_command start = { .verb = CYCLE_START };
	struct interp_program p;
	static struct cycle_config cc;
	static struct cycle c;
	char *text = NULL;
	size_t size;
	FILE *f = open_memstream(&text, &size);

	bench_must(f != NULL);
	write_curves(f);
	bench_must(fclose(f) == 0);
	p = compile(text, size);
	free(text);
	config_cycle(&machine, &cc);
	cycle_init(&c, &cc);
	cycle_load(&c, &p);
	cycle_command(&c, &start);
	for (int i = 0; i < 1000000 && (c.state != STATE_TRAVEL ||
					c.out.target[INTERP_C] > -1000); i++)
		step_at(&c, state_duty[c.state].power ?
			    (cc.gap.servo_v + cc.gap.open_v) / 2 : 100);
	bench_must(c.state == STATE_TRAVEL);
	begin();
	step_at(&c, 0);
	end("a cycle that asks what was cut, beside 512 curves", 1);
}

int main(void)
{
	static const char cut[] = "G21 G90 F60\nM3\nG1 X1 Y-2 Z-4\nM2\n";
	struct interp_program p;

	config_defaults(&machine);
	for (int i = 0; i < INTERP_NAXES; i++)
		machine.axes.axis[i] = (struct interp_axis_limits) {
			0.001, -200, 200, 80, 1000, 20000
		};
	machine.axes.present = 0xff;
	for (size_t i = 0; i < sizeof(paths) / sizeof(*paths); i++)
		count_path(&paths[i]);
	/* The first text in a process also reads the dialects. */
	p = compile(cut, strlen(cut));
	for (int i = 0; i < (int)(sizeof(texts) / sizeof(*texts)); i++)
		count_compile(i);
	count_cycles(&p, true);
	count_cycles(&p, false);
	count_ground();
	return 0;
}
