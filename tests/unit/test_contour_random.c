/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_contour_random.c - the wire keeps its distance from random contours
 *
 * Seeds are printed.  The place where the axis of the wire crosses a plane is
 * computed back from the guides by similar triangles.
 */
#include "wire_help.h"
#include "seed.h"

#include "interp/cursor.h"

#include <math.h>
#include <float.h>


static struct nc_read ready(const struct interp_wire *w)
{
	struct nc_read n = nc_ready();

	n.o.wire = w;
	n.o.offset_mm[2] = 0.2;
	return n;
}

/* -- Sharp corners -------------------------------------------------------- */

struct polygon {
	double x[12], y[12];
	int n;
};

static double gap_to(const struct polygon *p, double x, double y)
{
	double best = DBL_MAX;

	for (int i = 0; i < p->n; i++) {
		const int j = (i + 1) % p->n;
		const double dx = p->x[j] - p->x[i], dy = p->y[j] - p->y[i];
		double t = ((x - p->x[i]) * dx + (y - p->y[i]) * dy) /
			   (dx * dx + dy * dy);

		t = t < 0 ? 0 : t > 1 ? 1 : t;
		best = fmin(best, hypot(x - p->x[i] - t * dx,
					y - p->y[i] - t * dy));
	}
	return best;
}

/* A star round the origin, counter-clockwise, begun in mid-side. */
static struct polygon random_polygon(uint64_t *seed, char *text, size_t room,
				     bool left)
{
	struct polygon p = { .n = 3 + (int)(nc_random(seed) % 10) };
	int at;

	for (int i = 0; i < p.n; i++) {
		const double a = 2 * acos(-1) * i / p.n;
		const double r = 2 + nc_random(seed) % 4000 * 0.001;

		p.x[i] = round(r * cos(a) * 1000) / 1000;
		p.y[i] = round(r * sin(a) * 1000) / 1000;
	}
	const double mx = (p.x[0] + p.x[1]) / 2, my = (p.y[0] + p.y[1]) / 2;
	const double k = left ? 0.2 : 3;

	at = snprintf(text, room, "F5 G0 X%.4f Y%.4f\n%s D2\nG1 X%.4f Y%.4f\n",
		      k * mx, k * my, left ? "G41" : "G42", mx, my);
	for (int i = 1; i <= p.n; i++)
		at += snprintf(text + at, room - (size_t)at,
			       "X%.3f Y%.3f\n", p.x[i % p.n], p.y[i % p.n]);
	snprintf(text + at, room - (size_t)at,
		 "X%.4f Y%.4f\nG40 X%.4f Y%.4f\n", mx, my, k * mx, k * my);
	return p;
}

/* Between the leads the wire's axis is 0.2 from the contour and no nearer. */
static bool keeps_clear(const struct nc_read *r, const struct polygon *p)
{
	const uint32_t first = 4, last = 3 + (uint32_t)p->n + 1;
	struct interp_cursor c;
	bool clear = true;

	assert_int_equal(interp_cursor_init(&c, &r->p), 0);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		const double gap = gap_to(p, c.pos[INTERP_X] * 0.001,
					  c.pos[INTERP_Y] * 0.001);

		if (c.seg.line < first || c.seg.line > last)
			continue;
		clear = clear && gap > 0.2 - 0.001 && gap < 0.2 * 1.4143;
	}
	return clear;
}

#define POLYGONS	SEED_ROUNDS(1000)

static void the_wire_keeps_clear_of_random_contours(void **st)
{
	uint64_t seed = 11;
	int taken = 0;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < POLYGONS; i++) {
		char text[1024];
		const struct polygon p = random_polygon(&seed, text,
							sizeof(text), i % 2);
		struct nc_read r = ready(&no_guides);

		nc_read_bytes(&r, text, strlen(text));
		if (r.rc == 0) {
			taken++;
			if (!keeps_clear(&r, &p))
				fail_msg("too near: %s", text);
		} else {
			assert_int_equal(r.rc, -EINVAL);
			assert_non_null(
				strstr(r.diag.found, "nothing is left"));
			assert_in_range(r.diag.line, 4, 4 + p.n);
		}
		nc_done(&r);
	}
	print_message("    %d of %d taken\n", taken, POLYGONS);
	assert_in_range(taken, POLYGONS * 9 / 10, POLYGONS);
}

/* -- Rounded corners ------------------------------------------------------ */

struct corner {
	double from[2], to[2], centre[2];	/* of the fillet */
	double theta, turn;
};

struct outline {
	struct corner k[8];
	int n;
	double r, start[2];
};

static double random_in(uint64_t *seed, double lo, double hi)
{
	return lo + (hi - lo) * (nc_random(seed) % 1000000) * 1e-6;
}

/* The fillet of radius r at @c between @p and @q; false if there is no room. */
static bool corner_of(struct corner *k, const double p[2], const double c[2],
		      const double q[2], double r)
{
	const double lv = hypot(c[0] - p[0], c[1] - p[1]);
	const double lw = hypot(q[0] - c[0], q[1] - c[1]);
	const double v[2] = { (c[0] - p[0]) / lv, (c[1] - p[1]) / lv };
	const double w[2] = { (q[0] - c[0]) / lw, (q[1] - c[1]) / lw };
	const double t = r * fabs(tan(atan2(v[0] * w[1] - v[1] * w[0],
					    v[0] * w[0] + v[1] * w[1]) / 2));
	double s;

	k->turn = atan2(v[0] * w[1] - v[1] * w[0], v[0] * w[0] + v[1] * w[1]);
	s = k->turn > 0 ? r : -r;
	for (int i = 0; i < 2; i++) {
		k->from[i] = c[i] - v[i] * t;
		k->to[i] = c[i] + w[i] * t;
	}
	k->centre[0] = k->from[0] - s * v[1];
	k->centre[1] = k->from[1] + s * v[0];
	k->theta = atan2(k->from[1] - k->centre[1], k->from[0] - k->centre[0]);
	return t < 0.4 * fmin(lv, lw) && fabs(k->turn) > 0.05;
}

static bool random_outline(struct outline *o, uint64_t *seed)
{
	double at[8][2];

	o->n = 3 + (int)(nc_random(seed) % 6);
	o->r = random_in(seed, 0.5, 1.5);
	for (int i = 0; i < o->n; i++) {
		const double a = 2 * M_PI * (i + random_in(seed, -.3, .3)) /
				 o->n;
		const double r = random_in(seed, 6, 12);

		at[i][0] = r * cos(a);
		at[i][1] = r * sin(a);
	}
	for (int i = 0; i < o->n; i++) {
		if (!corner_of(&o->k[i], at[(i + o->n - 1) % o->n], at[i],
			       at[(i + 1) % o->n], o->r))
			return false;
	}
	for (int i = 0; i < 2; i++)
		o->start[i] = (o->k[o->n - 1].to[i] + o->k[0].from[i]) / 2;
	return true;
}

/* As a drawing gives it: places to a micrometre.  Lines 4 to 4 + 2n cut. */
static void write_outline(const struct outline *o, const char *begin,
			  double lead, char *text, size_t room)
{
	size_t at = (size_t)snprintf(text, room, "F60 G0 X%.3f Y%.3f\n%s\n"
				     "G1 X%.3f Y%.3f\n", lead * o->start[0],
				     lead * o->start[1], begin, o->start[0],
				     o->start[1]);

	for (int i = 0; i < o->n; i++) {
		const struct corner *k = &o->k[i];

		at += (size_t)snprintf(text + at, room - at,
			"G1 X%.3f Y%.3f\nG%d X%.3f Y%.3f I%.3f J%.3f\n",
			k->from[0], k->from[1], k->turn > 0 ? 3 : 2, k->to[0],
			k->to[1], k->centre[0] - k->from[0],
			k->centre[1] - k->from[1]);
	}
	snprintf(text + at, room - at, "G1 X%.3f Y%.3f\nG40 G50 X%.3f Y%.3f\n",
		 o->start[0], o->start[1], lead * o->start[0],
		 lead * o->start[1]);
}

static double line_gap(const double a[2], const double b[2], double x, double y)
{
	const double dx = b[0] - a[0], dy = b[1] - a[1];
	double t = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy);

	t = t < 0 ? 0 : t > 1 ? 1 : t;
	return hypot(x - a[0] - t * dx, y - a[1] - t * dy);
}

static double outline_gap(const struct outline *o, double x, double y)
{
	double best = DBL_MAX;

	for (int i = 0; i < o->n; i++) {
		const struct corner *k = &o->k[i], *b = &o->k[(i + 1) % o->n];
		double a = atan2(y - k->centre[1], x - k->centre[0]) - k->theta;

		a -= 2 * M_PI * floor(a / (2 * M_PI) + 0.5);
		if (a * k->turn >= 0 && fabs(a) <= fabs(k->turn))
			best = fmin(best, fabs(hypot(x - k->centre[0],
						     y - k->centre[1]) - o->r));
		best = fmin(best, line_gap(k->to, b->from, x, y));
	}
	return best;
}

/* How far the wire is off @want mm beside the outline, on either plane. */
static double outline_error(const struct nc_read *r, const struct outline *o,
			    const double want[2])
{
	const double share[2] = { 0.2, 0.6 };
	struct interp_cursor c;
	double worst = 0;
	int n = 0;

	assert_int_equal(interp_cursor_init(&c, &r->p), 0);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		const uint32_t l = c.seg.line;

		if (l < 4 || l > 4 + 2 * (uint32_t)o->n || n++ % 23)
			continue;
		for (int i = 0; i < 2; i++) {
			const double k = share[i];
			const double x = c.pos[0] + k * (c.pos[6] - c.pos[0]);
			const double y = c.pos[1] + k * (c.pos[7] - c.pos[1]);

			worst = fmax(worst, fabs(outline_gap(o, x * 0.001,
						 y * 0.001) - want[i]));
		}
	}
	return worst;
}

static void rounded_contours_are_followed_on_both_planes(void **st)
{
	const double slope = tan(0.5 * M_PI / 180);
	const double d = 0.2 * sqrt(1 + slope * slope);
	uint64_t seed = 5;
	double worst = 0;
	int made = 0;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	while (made < 100) {
		/* Inside, the top leaning further in; outside, further out. */
		const bool in = made % 2;
		const double want[2] = { d, d + 40 * slope };
		struct outline o;
		struct nc_read r;
		char text[2048];

		if (!random_outline(&o, &seed) || (in && o.r < want[1] + 0.05))
			continue;
		write_outline(&o, in ? "G41 D2 G51 A0.5" : "G42 D2 G52 A0.5",
			      in ? 0.3 : 2, text, sizeof(text));
		made++;
		r = ready(&guides);
		nc_read(&r, text);
		worst = fmax(worst, outline_error(&r, &o, want));
		nc_done(&r);
	}
	print_message("    off by %.2f um at the worst\n", worst * 1000);
	assert_true(worst <= 0.003);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_wire_keeps_clear_of_random_contours),
		cmocka_unit_test(rounded_contours_are_followed_on_both_planes),
	};

	return cmocka_run_group_tests_name("interp/contour at random", tests,
					   NULL, NULL);
}
