/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_orbit.c - promises of the orbits as paths, and of their ways out
 */
#include "nc_read.h"

#include "cycle.h"
#include "interp/orbit.h"
#include "path/place.h"

#define PULSE	0.001

/* -- Walking -------------------------------------------------------------- */

struct walked {
	int32_t (*at)[INTERP_NAXES];
	uint8_t *rapid;
	size_t n;
};

static void walk(const struct interp_program *p, struct walked *w)
{
	struct interp_cursor c;
	size_t room = 0;
	enum interp_step s;

	*w = (struct walked) { 0 };
	assert_int_equal(interp_cursor_init(&c, p), 0);
	do {
		if (w->n == room) {
			room = room ? 2 * room : 65536;
			w->at = realloc(w->at, room * sizeof(*w->at));
			w->rapid = realloc(w->rapid, room);
		}
		memcpy(w->at[w->n], c.pos, sizeof(c.pos));
		w->rapid[w->n++] = c.seg.flags & INTERP_SEG_RAPID;
		interp_cursor_aim(&c, 1e6);
		s = interp_cursor_step(&c);
		if (s == INTERP_AT_ACTION) {
			interp_cursor_pass(&c);
			s = INTERP_MOVED;
			w->n--;
		}
	} while (s == INTERP_MOVED);
	assert_int_equal(s, INTERP_AT_END);
	/* And all the way back. */
	for (size_t i = w->n - 1; i-- > 0; ) {
		interp_cursor_aim(&c, -1e6);
		assert_int_equal(interp_cursor_step(&c), INTERP_MOVED);
		assert_memory_equal(c.pos, w->at[i], sizeof(c.pos));
	}
}

static void unwalk(struct walked *w)
{
	free(w->at);
	free(w->rapid);
}

/* Radius and height over the bottom of a point, mm; the axis of G17. */
static double radius(const int32_t *p)
{
	return hypot(p[0], p[1]) * PULSE;
}

/* -- Shapes --------------------------------------------------------------- */

struct shape {
	const char *text;		/* from Z1, or the plane's */
	double bottom_mm;
	/* Distance of a cut point from the shape; below 0: not on its turns. */
	double (*off)(const int32_t *p);
	double allowed_mm;
};

#define R_MM	0.3

static double off_circle(const int32_t *p)
{
	return fabs(radius(p) - R_MM);
}

static double off_square(const int32_t *p)
{
	return fabs(fmax(abs(p[0]), abs(p[1])) * PULSE - R_MM);
}

/* About the circle the quarter turns on; a wall above it. */
static double off_sphere(const int32_t *p)
{
	const double h = p[2] * PULSE + 0.5, b = 0.2;

	if (h >= b)
		return fabs(radius(p) - R_MM);
	return fabs(hypot(radius(p) - (R_MM - b), b - h) - b);
}

static double off_ball(const int32_t *p)
{
	const double h = p[2] * PULSE + 0.5;

	if (h >= R_MM)
		return fabs(radius(p) - R_MM);
	return fabs(hypot(radius(p), R_MM - h) - R_MM);
}

static double off_cone(const int32_t *p)
{
	const double a = 10 * M_PI / 180;

	return fabs(radius(p) - R_MM - (p[2] * PULSE + 0.5) * tan(a)) * cos(a);
}

static double off_tip(const int32_t *p)
{
	return fabs(radius(p) - R_MM * (1 - p[2] * PULSE) / 1.5);
}

/* r = q (turn + n): the arm that is nearest; the last turns are a circle. */
static double off_spiral(const int32_t *p)
{
	const double turn = atan2(p[1], p[0]) / (2 * M_PI);
	const double q = 0.05, n = radius(p) / q - turn;

	/* Inside, an arm runs outward more than round. */
	if (radius(p) < q)
		return 0;
	return fmin(fabs(n - round(n)) * q, off_circle(p));
}

static double off_rays(const int32_t *p)
{
	double best = 1;

	for (int i = 0; i < 3; i++) {
		const double a = (30 + 120 * i) * M_PI / 180;
		const double across = p[1] * cos(a) - p[0] * sin(a);
		const double along = p[0] * cos(a) + p[1] * sin(a);

		if (along >= -1)
			best = fmin(best, fabs(across) * PULSE);
	}
	return best;
}

static const struct shape shapes[] = {
	{ "G130 Z-.5 R.3 Q.1 P2",	-0.5, off_circle, 0.00071 },
	{ "G130 Z-.5 R.3 P3",		-0.5, off_circle, 0.00071 },
	{ "G131 Z-.5 R.3 Q.07",		-0.5, off_square, 0.00001 },
	{ "G131 Z-.5 R.3 P2",		-0.5, off_square, 0.00001 },
	{ "G132 Z-.5 R.3 B.2 Q.02",	-0.5, off_sphere, 0.0012 },
	{ "G132 Z-.5 R.3 Q.02",		-0.5, off_ball, 0.0012 },
	{ "G133 Z-.5 R.3 A10 Q.05",	-0.5, off_cone, 0.0012 },
	{ "G133 Z-.5 R.3 Q.05",		-0.5, off_tip, 0.0012 },
	{ "G134 Z-.5 R.3 A30 L3",	-0.5, off_rays, 0.00071 },
	{ "G134 Z-.5 R.3 A30 L3 Q.2",	-0.5, off_rays, 0.00071 },
	{ "G135 Z-.5 R.3 Q.05 P2",	-0.5, off_spiral, 0.0012 },
};

static struct nc_read read_shape(const char *text)
{
	char all[256];

	snprintf(all, sizeof(all), "G0 Z1\n%s F5\n", text);
	return nc_read_text(all);
}

/* The leads lie on the line from the centre that the turns begin on. */
static bool on_lead(const int32_t *p)
{
	return p[1] == 0 && p[0] >= 0;
}

static void each_shape_is_kept_within_a_pulse_or_so(void **st)
{
	(void)st;
	for (size_t i = 0; i < sizeof(shapes) / sizeof(shapes[0]); i++) {
		const struct shape *s = &shapes[i];
		struct nc_read n = read_shape(s->text);
		double worst = 0;
		struct walked w;

		walk(&n.p, &w);
		for (size_t k = 0; k < w.n; k++) {
			if (!w.rapid[k] && !on_lead(w.at[k]))
				worst = fmax(worst, s->off(w.at[k]));
		}
		if (worst > s->allowed_mm)
			fail_msg("%s: off by %.5f mm", s->text, worst);
		unwalk(&w);
		nc_done(&n);
	}
}

static void each_goes_all_round_reaches_the_bottom_and_closes(void **st)
{
	(void)st;
	for (size_t i = 0; i < sizeof(shapes) / sizeof(shapes[0]); i++) {
		const struct shape *s = &shapes[i];
		struct nc_read n = read_shape(s->text);
		int32_t low = 0, wide = 0;
		const int32_t *end;
		struct walked w;

		walk(&n.p, &w);
		for (size_t k = 0; k < w.n; k++) {
			low = w.at[k][2] < low ? w.at[k][2] : low;
			if (-w.at[k][0] > wide)
				wide = -w.at[k][0];
		}
		end = w.at[w.n - 1];
		assert_int_equal(low, lround(s->bottom_mm / PULSE));
		assert_true(wide >= (s->off == off_rays ? 259 : 295));
		assert_int_equal(end[0], 0);
		assert_int_equal(end[1], 0);
		assert_int_equal(end[2], 1000);
		assert_int_equal(nc_end_sub(&n, nc_count(&n) - 1, INTERP_X), 0);
		assert_int_equal(nc_end_sub(&n, nc_count(&n) - 1, INTERP_Y), 0);
		unwalk(&w);
		nc_done(&n);
	}
}

static void a_step_is_kept_or_made_smaller_to_be_equal(void **st)
{
	struct nc_read n = nc_read_text("G130 Z-1 R.2 Q.3 P2 F5\n");

	(void)st;
	/* Lead, four turns of 0.25, two flat ones, home, out. */
	assert_int_equal(nc_count(&n), 1 + 4 + 2 + 2);
	for (uint32_t i = 1; i <= 4; i++) {
		assert_int_equal(nc_seg(&n, i)->kind, INTERP_ARC);
		assert_xyz(&n, i, 0.2, 0, -0.25 * i);
	}
	nc_done(&n);
}

static void the_radius_is_undersize_less_gap_and_allowance(void **st)
{
	struct nc_read r = nc_read_text("G130 Z-1 R.2 P2 F5\n");
	struct nc_read i = nc_read_text("G130 Z-1 I.25 J.03 K.02 P2 F5\n");
	struct nc_read d = nc_read_text("D7=.25\n"
					"G130 Z-1 D7 J.03 K.02 P2 F5\n");

	(void)st;
	assert_same_path(&r, &i, 0);
	assert_same_path(&r, &d, 0);
	nc_done(&r);
	nc_done(&i);
	nc_done(&d);
}

/* Z X Y of one plane are X Y Z of another. */
static void it_sinks_along_any_axis_in_either_sense(void **st)
{
	static const struct { const char *text; int axis[3], sense; } way[] = {
		{ "G18 G133 Y-1 R.2 A5 Q.1 F5\n", { 2, 0, 1 }, 1 },
		{ "G19 G133 X-1 R.2 A5 Q.1 F5\n", { 1, 2, 0 }, 1 },
		{ "G17 G133 Z1 R.2 A5 Q.1 F5\n", { 0, 1, 2 }, -1 },
		{ "G18 G133 Y1 R.2 A5 Q.1 F5\n", { 2, 0, 1 }, -1 },
	};
	struct nc_read a = nc_read_text("G133 Z-1 R.2 A5 Q.1 F5\n");

	(void)st;
	for (size_t k = 0; k < sizeof(way) / sizeof(way[0]); k++) {
		struct nc_read b = nc_read_text(way[k].text);

		assert_int_equal(nc_count(&a), nc_count(&b));
		for (uint32_t i = 0; i < nc_count(&a); i++) {
			for (int x = 0; x < 3; x++)
				assert_near(nc_end(&a, i, (enum interp_axis)x),
					    nc_end(&b, i, (enum interp_axis)
						   way[k].axis[x]) *
					    (x == 2 ? way[k].sense : 1));
		}
		nc_done(&b);
	}
	nc_done(&a);
}

static void c_turns_as_it_sinks_and_back_as_it_leaves(void **st)
{
	struct nc_read n = nc_read_text("G141\nG130 Z-2 C45. R.2 P2 F5\n");
	const uint32_t last = nc_count(&n) - 1;

	(void)st;
	assert_near(nc_end(&n, 0, INTERP_C), 45);
	assert_near(nc_end(&n, 0, INTERP_X), 0);
	for (uint32_t i = 1; i < last; i++)
		assert_near(nc_end(&n, i, INTERP_C), 45);
	assert_near(nc_end(&n, last, INTERP_C), 0);
	/* Its way out turns back too. */
	assert_int_equal(n.p.escapes[nc_seg(&n, 3)->escape].out,
			 1u << INTERP_Z | 1u << INTERP_C);
	nc_done(&n);
}

/* The straight way up is the way it sank, so its axes allow the same; a segment
 * keeps a percent for rounding. */
static void c_keeps_its_limits_on_the_way_out(void **st)
{
	struct nc_read n = nc_read_text("G141\nG130 Z-2 C45. R.2 P2 F5\n");
	const struct interp_seg *sunk = nc_seg(&n, 0);
	const struct interp_escape *up = &n.p.escapes[sunk->escape];

	(void)st;
	assert_int_equal(up->out, 1u << INTERP_Z | 1u << INTERP_C);
	assert_true(up->v_max_mm_s <= 1.02 * (double)sunk->feed_max_mm_s);
	assert_true(up->a_max_mm_s2 <= 1.02 * (double)sunk->a_mm_s2);
	assert_true(up->j_max_mm_s3 <= 1.02 * (double)sunk->j_mm_s3);
	nc_done(&n);
}

/* -- Ways out ------------------------------------------------------------- */

/*
 * A workpiece of columns, each cut down to the lowest place the electrode had
 * over it; uncut everywhere at first, up to any height.
 */
#define SIDE	121
#define HALF	(SIDE / 2)

struct block {
	int32_t floor[SIDE * SIDE];	/* pulses */
	int whole[4900], nwhole;	/* columns under the electrode */
	int less[4900], nless;		/* a pulse of its outline left out */
};

/* Pulses of 0.01 mm here; an orbit of 10 of them. */
static bool in_disc(int x, int y, int less)
{
	return x * x + y * y <= (14 - less) * (14 - less);
}

/* Nowhere thinner than the orbit is wide. */
static bool in_angle(int x, int y, int less)
{
	const bool in = abs(x) <= 32 - less && abs(y) <= 32 - less;

	return in && (x <= -10 - less || y <= -10 - less);
}

static void block_init(struct block *k, bool (*inside)(int x, int y, int less))
{
	*k = (struct block) { .nwhole = 0 };
	for (int i = 0; i < SIDE * SIDE; i++)
		k->floor[i] = INT32_MAX;
	for (int y = -34; y <= 34; y++) {
		for (int x = -34; x <= 34; x++) {
			if (inside(x, y, 0))
				k->whole[k->nwhole++] = y * SIDE + x;
			if (inside(x, y, 1))
				k->less[k->nless++] = y * SIDE + x;
		}
	}
}

static int32_t *under(struct block *k, const int32_t *p)
{
	return &k->floor[(HALF + p[1]) * SIDE + HALF + p[0]];
}

static void block_cut(struct block *k, const int32_t *p)
{
	int32_t *floor = under(k, p);

	for (int i = 0; i < k->nwhole; i++) {
		int32_t *f = &floor[k->whole[i]];

		*f = p[2] < *f ? p[2] : *f;
	}
}

/* But for a pulse of its outline: the lattice, and the gate. */
static bool block_meets(struct block *k, const int32_t *p)
{
	const int32_t *floor = under(k, p);

	for (int i = 0; i < k->nless; i++) {
		if (floor[k->less[i]] > p[2])
			return true;
	}
	return false;
}

struct flight {
	struct block *k;
	const char *text;
};

static void look_at(void *arg, const struct cycle *c)
{
	const struct flight *f = arg;

	if (block_meets(f->k, place_pos(c)))
		fail_msg("%s, line %u: the way out meets the workpiece at "
			 "%d %d %d, from %d %d %d", f->text,
			 c->cursor.seg.line, place_pos(c)[0],
			 place_pos(c)[1], place_pos(c)[2], c->cursor.pos[0],
			 c->cursor.pos[1], c->cursor.pos[2]);
}

/* Out by the escape; was there one? */
static bool fly(const struct cycle *from)
{
	struct cycle c = *from;

	if (!escape_begin(&c))
		return false;
	while (escape_by(&c, -0.05))
		;
	assert_true(c.escape.pos[2] > c.cursor.pos[2]);
	return true;
}

struct tried {
	uint32_t points, free;
};

static struct tried try_all(const char *text,
			    bool (*inside)(int x, int y, int less))
{
	struct block *k = malloc(sizeof(*k));
	struct flight f = { k, text };
	struct cycle c = {
		.config = { .points_max = 100000, .period_ns = 1000000000 },
		.on_point = look_at, .on_point_arg = &f,
	};
	struct nc_read n = nc_ready();
	struct tried t = { 0 };
	enum interp_step s;

	block_init(k, inside);
	for (int i = 0; i < INTERP_NAXES; i++) {
		n.machine.axis[i].pulse_mm = 0.01;
		c.config.travel_min[i] = -20000;
		c.config.travel_max[i] = 20000;
	}
	nc_read(&n, text);
	assert_int_equal(interp_cursor_init(&c.cursor, &n.p), 0);
	do {
		block_cut(k, c.cursor.pos);
		if (c.cursor.seg.kind < INTERP_BEGIN &&
		    !(c.cursor.seg.flags & INTERP_SEG_RAPID)) {
			t.points++;
			t.free += fly(&c);
		}
		interp_cursor_aim(&c.cursor, 1e6);
		s = interp_cursor_step(&c.cursor);
	} while (s == INTERP_MOVED);
	assert_int_equal(s, INTERP_AT_END);
	nc_done(&n);
	free(k);
	return t;
}

/* Each with the least share of its cut that has a way out. */
static const struct { const char *text; double share; } outs[] = {
	{ "G0 Z1\nG0 Z.1\nG141\nG130 Z-.4 R.1 Q.1 P2 F5\n", 0.7 },
	{ "G0 Z1\nG0 Z.1\nG141\nG130 Z-.4 R.1 P3 F5\n", 0.6 },
	{ "G0 Z1\nG0 Z.1\nG143\nG130 Z-.4 R.1 P3 F5\n", 0.6 },
	{ "G0 Z1\nG0 Z.1\nG142\nG130 Z-.4 R.1 P3 F5\n", 0.1 },
	{ "G0 Z1\nG0 Z.1\nG141\nG131 Z-.4 R.1 Q.1 P2 F5\n", 0.7 },
	{ "G0 Z1\nG0 Z.1\nG143\nG131 Z-.4 R.1 Q.1 P2 F5\n", 0.7 },
	{ "G0 Z1\nG0 Z.1\nG143\nG131 Z-.4 R.1 P3 F5\n", 0.6 },
	{ "G0 Z1\nG0 Z.1\nG141\nG132 Z-.4 R.1 Q.05 P2 F5\n", 0.6 },
	{ "G0 Z1\nG0 Z.1\nG141\nG132 Z-.4 R.1 B.05 Q.05 P3 F5\n", 0.7 },
	{ "G0 Z1\nG0 Z.1\nG141\nG133 Z-.4 R.05 A5 Q.05 P3 F5\n", 0.7 },
	{ "G0 Z1\nG0 Z.1\nG141\nG133 Z-.4 R.1 Q.05 P3 F5\n", 0.1 },
	{ "G0 Z1\nG0 Z.3\nG141\nG133 Z0 R.1 Q.1 P3 F5\n", 0.3 },
	{ "G0 Z1\nG0 Z.1\nG141\nG134 Z-.4 R.1 A20 L5 Q.2 F5\n", 1 },
	{ "G0 Z1\nG0 Z.1\nG141\nG135 Z-.4 R.1 Q.02 P2 F5\n", 0.9 },
	{ "G0 Z1\nG0 Z.1\nG140\nG130 Z-.4 R.1 Q.1 P2 F5\n", 0 },
};

static void no_way_out_meets_what_is_not_cut(void **st)
{
	(void)st;
	for (size_t i = 0; i < sizeof(outs) / sizeof(outs[0]); i++) {
		const struct tried a = try_all(outs[i].text, in_disc);
		const struct tried b = try_all(outs[i].text, in_angle);

		assert_int_equal(a.free, b.free);
		if (a.free < outs[i].share * a.points ||
		    (outs[i].share == 0 && a.free > 0))
			fail_msg("%s: a way out at %u of %u points",
				 outs[i].text, a.free, a.points);
	}
}

static void a_time_goes_round_the_whole_cycle(void **st)
{
	struct nc_read n = nc_read_text("G86 Z-2 P3 S90 F5\n"
					"G130 Z-1 R.2 S60.5\n");
	const struct interp_seg *s = n.p.segs;

	(void)st;
	assert_int_equal(s[1].kind, INTERP_TIMED);
	assert_int_equal(s[1].arg, 5);
	assert_int_equal(s[3].kind, INTERP_DWELL);
	assert_int_equal(s[3].arg, 3000);
	assert_int_equal(s[5].kind, INTERP_TIMED_END);
	assert_int_equal(s[5].arg, 90000);
	assert_int_equal(s[6].kind, INTERP_TIMED);
	assert_int_equal(s[s[6].arg].kind, INTERP_TIMED_END);
	assert_int_equal(s[s[6].arg].arg, 60500);
	nc_done(&n);
}

/* -- Refusals ------------------------------------------------------------- */

static const struct nc_refusal refusals[] = {
	{ "G130 Z-1 R0 F5",	1, 10,	"radius 0", "a pulse" },
	{ "G130 Z-1 R-.2 F5",	1, 10,	"radius -0.2", "a pulse" },
	{ "G130 Z-1 I.1 J.2 F5", 1, 10,	"leaves a radius of -0.1", "a pulse" },
	{ "D1=.1\nG130 Z-1 D1 J.1 F5", 2, 10, "leaves a radius of 0", "pulse" },
	{ "G130 Z-1 D9 F5",	1, 10,	"register 9", "D1=0.25" },
	{ "G130 Z-1 F5",	1, 1,	"without a radius", "R, the radius" },
	{ "G130 Z-1 R.2 J.1 F5", 1, 14,	"R beside", "undersize" },
	{ "G130 Z-1 R.2 Q0 F5",	1, 14,	"a step of 0 mm", "a pulse" },
	{ "G130 R.2 Q.1 F5",	1, 10,	"no depth", "Z, the bottom" },
	{ "G132 Z-1 R.2 F5",	1, 1,	"G132 without a step", "Q0.02" },
	{ "G132 R.2 Q.1 F5",	1, 1,	"without a depth", "Z, the bottom" },
	{ "G132 Z-1 R.2 B.3 Q.1 F5", 1, 14, "radius 0.3", "up to the radius" },
	{ "G133 Z-1 R.1 A-45 Q.1 F5", 1, 14, "closes 0.1 mm", "smaller angle" },
	{ "G130 Z-1 R.1 A5 F5",	1, 14,	"A5 has no use", "G133 and G134" },
	{ "G130 Z-1 R.1 B5 F5",	1, 14,	"B5 has no use", "G132" },
	{ "G130 Z-1 R.1 L5 F5",	1, 14,	"L5 has no use", "L goes with" },
	{ "G135 Z-1 R.1 F5",	1, 1,	"G135 without a step", "Q" },
	{ "G134 Z-1 R.1 P0 F5",	1, 14,	"0 turns", "whole number" },
	{ "G130 Z-1 R.1 P1.5 F5", 1, 14, "1.5 turns", "whole number" },
	{ "G130 X-1 R.1 F5",	1, 6,	"X-1 of an orbit", "Z, along" },
	{ "G18 G130 Z-1 R.1 F5", 1, 10,	"Z-1 of an orbit", "Y, along" },
	{ "G130 Z-1 C9 Q.1 R.1 F5", 1, 10, "C in an orbit", "without Q" },
	{ "G130 Z-500 R.1 F5",	1, 6,	"Z -500.0000 is", "-200 to 200" },
	{ "G130 Z-1 R300 F5",	1, 1,	"X 300.0000 is", "-200 to 200" },
	{ "G130 Z-1 R.1",	1, 1,	"no feed given", "F word" },
	{ "G130 G1 Z-1 R.1 F5",	1, 1,	"G130 on a line with", "of its own" },
	{ "G141 G142",		1, 6,	"G142 on a line with G141", "modal" },
	{ "H1=.1\nG41 H1 G1 X5 F5\nG130 Z-1 R.1", 3, 1, "under its offset",
	  "G40" },
	{ "G86 F5",		1, 1,	"G86 without a depth", "G86 Z-5" },
	{ "G86 Z-1 S0 F5",	1, 9,	"a time of 0 s", "1000000" },
	{ "G86 Z-1 R1 F5",	1, 9,	"R1 has no use", "G2" },
	{ "G86 Z-1 A1 F5",	1, 9,	"A1 has no use", "G133" },
	{ "G86 Z-1 B5 F5",	1, 9,	"B5 has no use", "G132" },
	{ "G1 X1 Q2 F5",	1, 7,	"Q2 has no use", "G130" },
};

static void what_is_wrong_is_said_at_its_word(void **st)
{
	(void)st;
	for (size_t i = 0; i < sizeof(refusals) / sizeof(refusals[0]); i++)
		nc_check_refusal(&refusals[i]);
}

static void an_orbit_is_made_for_every_strategy(void **st)
{
	(void)st;
	for (int s = 0; s < INTERP_NSTRATEGIES; s++) {
		struct nc_read n = nc_ready();
		const struct interp_build_options o = {
			.machine = &n.machine, .tolerance_milli = 2000,
			.strategy = (enum interp_strategy)s,
		};
		const char *text = "G130 Z-.5 R.2 Q.1 P2 F5\n"
				   "G135 Z-.7 R.2 Q.05 P2\n";
		struct interp_build *b = interp_build_create(&o);

		n.o.machine = &n.machine;
		if (interp_nc_compile(&(struct interp_text) {
					.at = text, .bytes = strlen(text) },
				      &n.o, b, &n.result, &n.diag))
			fail_msg("%s: %s; %s",
				 interp_strategy_name((enum interp_strategy)s),
				 n.diag.found, n.diag.wanted);
		assert_true(fabs(interp_build_here(b)[INTERP_X]) < 1e-9);
		interp_build_destroy(b);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_shape_is_kept_within_a_pulse_or_so),
		cmocka_unit_test(each_goes_all_round_reaches_the_bottom_and_closes),
		cmocka_unit_test(a_step_is_kept_or_made_smaller_to_be_equal),
		cmocka_unit_test(the_radius_is_undersize_less_gap_and_allowance),
		cmocka_unit_test(it_sinks_along_any_axis_in_either_sense),
		cmocka_unit_test(c_turns_as_it_sinks_and_back_as_it_leaves),
		cmocka_unit_test(c_keeps_its_limits_on_the_way_out),
		cmocka_unit_test(no_way_out_meets_what_is_not_cut),
		cmocka_unit_test(a_time_goes_round_the_whole_cycle),
		cmocka_unit_test(what_is_wrong_is_said_at_its_word),
		cmocka_unit_test(an_orbit_is_made_for_every_strategy),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
