/* SPDX-License-Identifier: Apache-2.0 */
/*
 * jump.c - what the nodes of a program cost its jumps
 *
 *	jump		the tables, as Markdown
 *	jump profile	one jump of each kind: seconds, mm, mm/s
 *
 * NC text, compiled, and the machine's own cycle in virtual time.  The gap is
 * ideal: it always sparks, and the feed limit is the rate of erosion.
 */
#include "cycle.h"
#include "interp/nc.h"
#include "make_program.h"

#include <math.h>
#include <stdarg.h>

#define TURN	(2 * M_PI)

/* Given with the experiment: what the published times follow from. */
#define HEIGHT_MM	3.0
#define V_MAX_MM_S	80.0
#define A_MAX_MM_S2	1000.0
#define J_MAX_MM_S3	20000.0
#define EVERY_S		0.543		/* td: discharge between two jumps */
#define HOLE_MM		10.0
#define HOLE_MIN	53.3		/* te: discharge in all */
#define BLISK_MM	105.0
#define BLISK_MIN	63.1
#define PERIOD_NS	1000000

struct path {
	double length_mm, turn;		/* radian, over its whole length */
	double discharge_min;
	int lines;
	bool stop_at_nodes;
	int decimals;			/* as it is written; 0: four */
	double deg_mm;			/* C beside it */
};

struct text {
	char *at;
	size_t n, room;
};

static void put(struct text *t, const char *format, ...)
{
	va_list ap;

	if (t->room - t->n < 128) {
		t->room = 2 * t->room + 4096;
		t->at = realloc(t->at, t->room);
		if (!t->at)
			abort();
	}
	va_start(ap, format);
	t->n += (size_t)vsnprintf(t->at + t->n, t->room - t->n, format, ap);
	va_end(ap);
}

/* Chords of an arc, all of one length and one turn; straight if it has none. */
static struct text write_path(const struct path *p)
{
	const double chord = p->length_mm / p->lines;
	const double turn = p->lines > 1 ? p->turn / (p->lines - 1) : 0;
	struct text t = { 0 };
	const int d = p->decimals ? p->decimals : 4;
	double x = 0, y = 0;

	put(&t, "G21 G90 G17 F4000\n");
	for (int i = 0; i < p->lines; i++) {
		x += chord * cos(i * turn);
		y += chord * sin(i * turn);
		put(&t, "G1 X%.*f Y%.*f", d, x, d, y);
		if (p->deg_mm > 0)
			put(&t, " C%.*f", d, chord * (i + 1) * p->deg_mm);
		put(&t, "\n");
	}
	put(&t, "M2\n");
	return t;
}

static struct interp_program compile(const struct path *path)
{
	const struct interp_build_options bo = { .machine = &machine };
	const struct interp_nc_options no = { .machine = &machine };
	const struct interp_build_about about = { .name = "jump" };
	struct text t = write_path(path);
	struct interp_build *b;
	struct interp_nc_result done;
	struct interp_diag diag = { .found = "" };
	struct interp_program p;
	void *block;
	size_t n;

	machine_set();
	b = interp_build_create(&bo);
	must(interp_nc_compile(&(struct interp_text) {
		.at = t.at, .bytes = t.n }, &no, b, &done, &diag), &diag);
	free(t.at);
	block = interp_build_take(b, &about, &n);
	if (!block)
		abort();
	interp_build_destroy(b);
	if (interp_program_map(&p, block, n) < 0)
		abort();
	return p;
}

static struct cycle_config config_of(const struct path *p)
{
	const double rate = p->length_mm / (p->discharge_min * 60);
	struct cycle_config k = {
		.period_ns = PERIOD_NS,
		.gap = {
			.servo_v = 40, .short_v = 15, .open_v = 70,
			.gain_mm_s_v = 1, .feed_max_mm_s = rate,
			.approach_mm_s = rate, .retract_mm_s = 5,
			.retract_limit_mm = 1, .retract_wait.cycles = 1000,
		},
		.jump = {
			.height_mm = HEIGHT_MM,
			.every.cycles = (uint64_t)(EVERY_S * 1e9 / PERIOD_NS),
			.v_max_mm_s = V_MAX_MM_S, .a_max_mm_s2 = A_MAX_MM_S2,
			.j_max_mm_s3 = J_MAX_MM_S3,
		},
		.travel_a_mm_s2 = A_MAX_MM_S2, .travel_j_mm_s3 = J_MAX_MM_S3,
		.stop_at_nodes = p->stop_at_nodes, .points_max = 4096,
	};

	for (int i = 0; i < INTERP_NAXES; i++) {
		k.travel_min[i] = -1000000;
		k.travel_max[i] = 1000000;
	}
	return k;
}

/* Called after each cycle; false: enough. */
typedef bool (*watch_fn)(const struct cycle *c, void *arg);

static struct cycle erode(const struct path *p, watch_fn watch, void *arg)
{
	const struct io_inputs in = { .gap_valid = true, .gap_v = 50 };
	const struct cycle_command start = { .verb = CYCLE_START };
	const struct interp_program program = compile(p);
	const struct cycle_config k = config_of(p);
	struct io_outputs out;
	struct cycle c;

	cycle_init(&c, &k);
	cycle_load(&c, &program);
	cycle_command(&c, &start);
	do
		cycle_step(&c, &in, &out);
	while (state_duty[c.state].running && (!watch || watch(&c, arg)));
	if (c.fault.first != FAULT_NONE ||
	    (!watch && c.outcome != OUTCOME_DONE)) {
		fprintf(stderr, "experiment: fault %s\n",
			fault_name(c.fault.first));
		exit(1);
	}
	free((void *)(uintptr_t)program.head);
	return c;
}

/* -- Tables --------------------------------------------------------------- */

static double minutes(uint64_t cycles)
{
	return (double)cycles * PERIOD_NS / 60e9;
}

static double row(const char *what, const struct path *p, double measured)
{
	const struct cycle c = erode(p, NULL, NULL);
	const double min = minutes(c.totals.cycles);

	printf("| %s | %d | %s | %u | %.3f | %.2f | %.2f |", what, p->lines,
	       p->stop_at_nodes ? "stop" : "pass", c.totals.jumps,
	       (double)c.totals.jump_cycles * PERIOD_NS * 1e-9 /
		       c.totals.jumps,
	       minutes(c.totals.erode_cycles), min);
	if (measured > 0)
		printf(" %g | %+.2f %% |\n", measured,
		       100 * (min / measured - 1));
	else
		printf(" | |\n");
	fflush(stdout);
	return min;
}

static void head(void)
{
	printf("| path | lines | nodes | jumps | s each | discharge, min | "
	       "min | paper, min | off by |\n"
	       "|---|---|---|---|---|---|---|---|---|\n");
}

static const struct path hole = {
	.length_mm = HOLE_MM, .discharge_min = HOLE_MIN, .lines = 1,
};
static const struct path blisk = {
	.length_mm = BLISK_MM, .turn = TURN / 4, .discharge_min = BLISK_MIN,
	.lines = 63,
};

static struct path with(struct path p, int lines, bool stop)
{
	p.lines = lines;
	p.stop_at_nodes = stop;
	return p;
}

static void hole_table(void)
{
	struct path p = with(hole, 1, true);
	double one;

	printf("\n## A hole of 10 mm\n\n");
	head();
	row("hole", &p, 84);
	p = with(hole, 100, true);
	row("hole", &p, 330);
	p = with(hole, 1, false);
	one = row("hole", &p, 0);
	for (int lines = 100; lines <= 10000; lines *= 10) {
		p = with(hole, lines, false);
		printf("%s", row("hole", &p, 0) <= 1.005 * one ? "" :
		       "\nMore than 1.005 of one line.\n");
	}
}

static void blisk_table(void)
{
	struct path p = with(blisk, 5, true);

	printf("\n## A channel of 105 mm that turns by 90 degrees\n\n");
	head();
	row("channel", &p, 106);
	p = with(blisk, 63, true);
	row("channel", &p, 139);
	for (int lines = 5; lines <= 6300; lines = lines == 5 ? 63 :
							 lines * 10) {
		p = with(blisk, lines, false);
		row("channel", &p, 0);
	}
	p = with(blisk, 63, false);
	p.turn = TURN;
	row("channel, 360 degrees", &p, 0);
	p.lines = 630;
	row("channel, 360 degrees", &p, 0);
}

/* -- Nodes ---------------------------------------------------------------- */

static void node_table(void)
{
	static const double degrees[] = { 0.5, 1, 2, 5, 10, 20, 45, 90, 135,
					  180 };
	struct path p = { .length_mm = HOLE_MM,
			  .discharge_min = 1,
			  .lines = 2 };

	printf("\n## Speed of a node\n\nBetween two lines of %g mm, the first "
	       "along X, with the axes' limits above; mm/s.\n\n"
	       "| turn, degrees | node | reached |\n|---|---|---|\n",
	       HOLE_MM / 2);
	for (size_t i = 0; i < COUNT(degrees); i++) {
		struct interp_program c;
		double v;

		p.turn = degrees[i] * TURN / 360;
		c = compile(&p);
		v = (double)c.segs[1].node_mm_s;
		printf("| %g | %.3g | %.3g |\n", degrees[i], v,
		       fmin(v, (double)c.segs[1].feed_max_mm_s));
		free((void *)(uintptr_t)c.head);
	}
}

/* -- As CAM systems write ------------------------------------------------- */

#define SPARSE_MM	1.0
#define C_DEG_MM	7.0

/* Positioned, all of it, and back. */
static void walk(const struct path *p, double ret_s[2])
{
	const struct io_inputs in = { .gap_valid = true, .gap_v = 50 };
	const struct cycle_command start = { .verb = CYCLE_START };
	const struct cycle_command back = { .verb = CYCLE_RETRACT,
					    .arg_mm = 1e9 };
	const struct interp_program program = compile(p);
	struct cycle_config k = config_of(p);
	struct io_outputs out;
	struct cycle c;

	k.dry_run = k.hold_at_end = true;
	k.gap.retract_mm_s = V_MAX_MM_S;
	cycle_init(&c, &k);
	cycle_load(&c, &program);
	cycle_command(&c, &start);
	for (int leg = 0; leg < 2; leg++) {
		const uint64_t from = c.count;

		if (leg == 1)
			cycle_command(&c, &back);
		do
			cycle_step(&c, &in, &out);
		while (state_duty[c.state].running || c.hold.moving);
		ret_s[leg] = (double)(c.count - from) * PERIOD_NS * 1e-9;
	}
	free((void *)(uintptr_t)program.head);
}

static void dense_row(struct path p, double mm, int decimals)
{
	static double sparse_s;		/* of the first row */
	double s[2];
	struct cycle c;

	p.lines = (int)lround(p.length_mm / mm);
	p.decimals = decimals;
	walk(&p, s);
	c = erode(&p, NULL, NULL);
	if (mm == SPARSE_MM)
		sparse_s = s[0];
	printf("| %s | %g | %d | %.3f | %.3f | %.3f | %.3f |\n",
	       p.deg_mm > 0 ? "X Y C" : "X Y", mm, decimals, s[0], s[1],
	       s[0] / sparse_s, (double)c.totals.jump_cycles * PERIOD_NS *
				1e-9 / c.totals.jumps);
	fflush(stdout);
}

static void dense_table(void)
{
	static const double mm[] = { 0.1, 0.02, 0.01, 0.005 };
	struct path p = { .length_mm = 30, .turn = 6, .discharge_min = 0.4 };

	printf("\n## Lines as CAM systems write them\n\nPrograms with three to "
	       "six decimals go along 30 mm of a circle of 5 mm, alone\nand "
	       "with C turning by %g degrees a mm, at 4000 mm/min; and back at "
	       "%g mm/s.\n\n| axes | mm a line | decimals | there, s | back, s "
	       "| there, of %g mm a line | s a jump |\n"
	       "|---|---|---|---|---|---|---|\n",
	       C_DEG_MM, V_MAX_MM_S, SPARSE_MM);
	for (int rotary = 0; rotary < 2; rotary++) {
		p.deg_mm = rotary ? C_DEG_MM : 0;
		dense_row(p, SPARSE_MM, 6);
		for (size_t i = 0; i < COUNT(mm); i++)
			for (int d = 6; d >= 3; d--)
				dense_row(p, mm[i], d);
	}
}

static void tables(void)
{
	printf("# Jumps over dense programs\n\nPrinted by `make experiments`; "
	       "docs/speed.md says how a jump is planned.\n\nLiang, Kang, "
	       "Xu and Zhao (2017) measured what the nodes of a program cost "
	       "a\ncontroller that stops at each of them in a jump: 84 min "
	       "with one line, 330 min\nwith a hundred; 106 min with 5 lines, "
	       "139 min with 63.  The paper does not tell the speed, the "
	       "acceleration, the time between jumps and\nthe time of "
	       "discharge. The values below were chosen so that they give its\n"
	       "times. Then our look-ahead has the same machine.\n\nA jump has "
	       "%g mm, %g mm/s, %g mm/s2 and %g mm/s3. It comes after every td "
	       "= %g\ns of discharge, and goes no higher than the beginning of "
	       "the path. The\ndischarge takes te = %g min over %g mm, and %g "
	       "min over %g mm. The gap is\nideal: it always sparks, at a "
	       "constant rate. The text is compiled, and the\ncycle runs in "
	       "virtual time with a period of %g us.  `[speed] nodes = stop` "
	       "is the paper's\ncontroller, `pass` is ours; corner_um is %g.\n",
	       HEIGHT_MM, V_MAX_MM_S, A_MAX_MM_S2, J_MAX_MM_S3, EVERY_S,
	       HOLE_MIN, HOLE_MM, BLISK_MIN, BLISK_MM,
	       PERIOD_NS * 1e-3, 5.0);
	hole_table();
	blisk_table();
	node_table();
	dense_table();
	printf("\n![speed in one jump](pictures/jump.svg)\n");
}

/* -- One jump ------------------------------------------------------------- */

struct profile {
	uint64_t cycles;
	double from_mm;
};

/* The first at its full height. */
static bool draw(const struct cycle *c, void *arg)
{
	struct profile *p = arg;

	if (c->state != STATE_JUMP || c->totals.jumps < 2)
		return c->totals.jumps < 2;
	if (p->cycles == 0)
		p->from_mm = c->lift.from_mm;
	printf("%.5f %.6f %.5f\n", (double)p->cycles++ * PERIOD_NS * 1e-9,
	       interp_cursor_place_mm(&c->cursor) - p->from_mm,
	       c->mover.v_mm_s);
	return true;
}

static void profiles(void)
{
	for (int i = 0; i < 3; i++) {
		struct path p = with(hole, i == 0 ? 1 : 100, i == 1);
		struct profile f = { 0 };

		/* Beginning deep, so that nodes lie on the whole way. */
		p.length_mm = 4 * HOLE_MM;
		p.lines *= i == 0 ? 1 : 4;
		p.discharge_min = 2 * EVERY_S / 60 * 8;
		erode(&p, draw, &f);
		printf("\n\n");
	}
}

int main(int argc, char **argv)
{
	if (argc > 1 && strcmp(argv[1], "profile") == 0)
		profiles();
	else
		tables();
	return 0;
}
