/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axis_track.h - random paths, and every axis's speed, acceleration and jerk
 * along them, by differences from cycle to cycle
 *
 * A node steps, by the corner that it is passed as: what spans one is not
 * looked at.
 */
#ifndef AXIS_TRACK_H
#define AXIS_TRACK_H

#include "arc_turn.h"
#include "cycle_help.h"
#include "seed.h"

#include "interp/at.h"
#include "interp/limits.h"

#define SEGS	12

/* So many cycles between two looks. */
static int track_stride = 1;

/* Places of a curve are so far off: from cycle to cycle this hides its jerk. */
#define CURVE_OFF_MM	(0.02 * PULSE_MM)

static struct interp_machine axes_machine;

/* Axes as unequal as they come; C is slow to set off. */
static inline void set_machine(uint64_t *s)
{
	axes_machine = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		axes_machine.axis[i] = (struct interp_axis_limits) {
			0.001, -1000, 1000, uniform(s, 20, 90),
			pow(10, uniform(s, 2, 3.5)), pow(10, uniform(s, 3.5, 5))
		};
}

static inline void random_line(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = rnd(s) % 3 == 0,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	for (int i = 0; i < INTERP_NAXES; i++)
		if (rnd(s) % 3 == 0)
			end[i] += uniform(s, -6, 6);
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

/* As little of X as there is, on which C turns far: by more than the rounding
 * of a line counts for. */
static inline void random_tiny(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 60 };
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] += pow(10, uniform(s, -4, -1));
	end[INTERP_C] += (rnd(s) % 2 ? 1 : -1) * uniform(s, 0.05, 20);
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

/* Past a pole of C, close to it: C turns ever faster, and slower again. */
static inline void random_pole(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 60 };
	const double d = pow(10, uniform(s, -3, 0)), step = uniform(s, 2, 9);
	const double *here = interp_build_here(b);
	const double x = here[INTERP_X], c = here[INTERP_C];
	double end[INTERP_NAXES];
	struct interp_diag diag;

	memcpy(end, here, sizeof(end));
	for (double deg = 70; deg > -70; deg -= step) {
		end[INTERP_X] = x + d * (tan(70 * M_PI / 180) -
					 tan(deg * M_PI / 180));
		end[INTERP_C] = c + 70 - deg;
		assert_int_equal(interp_build_line(b, end, &w, &diag),
				 0);
	}
}

static inline void random_arc(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 60 };
	const double *here = interp_build_here(b);
	const double r = pow(10, uniform(s, -0.5, 1)), t = uniform(s, 0, 6.28);
	struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = here[0] + r * cos(t),
		.centre_b_mm = here[1] + r * sin(t),
	};
	const bool clockwise = rnd(s) % 2;
	const double to = uniform(s, 0, 6.28);
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, here, sizeof(end));
	end[0] = a.centre_a_mm + r * cos(to);
	end[1] = a.centre_b_mm + r * sin(to);
	end[INTERP_C] += rnd(s) % 2 ? uniform(s, -9, 9) : 0;
	arc_turn(&a, b, end, clockwise);
	assert_int_equal(interp_build_arc(b, end, &a, &w, &d), 0);
}

/* A NURBS of X, Y, Z and C: from here, gently.  Of degree 2 its bend makes a
 * step at each knot. */
static inline void random_nurbs(struct interp_build *b, uint64_t *s,
				uint32_t degree)
{
	enum { N = 5, COLUMNS = 4 };
	static const uint8_t axis[COLUMNS] = { INTERP_X, INTERP_Y, INTERP_Z,
					       INTERP_C };
	static const double knots[][N + 4] = {
		[2] = { 0, 0, 0, 0.3, 0.7, 1, 1, 1 },
		[3] = { 0, 0, 0, 0, 0.5, 1, 1, 1, 1 },
	};
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 60 };
	const double *here = interp_build_here(b);
	double points[N * (COLUMNS + 1)];
	struct interp_build_curve c = { .nurbs = {
		.degree = degree, .npoints = N, .naxes = COLUMNS, .counted = 3,
		.knots = knots[degree],
		.points = points,
	} };
	struct interp_diag d;

	memcpy(c.axis, axis, sizeof(axis));
	for (int k = 0; k < N; k++) {
		for (int j = 0; j < COLUMNS; j++)
			points[k * (COLUMNS + 1) + j] = here[axis[j]] +
				(k > 0 ? uniform(s, -4, 4) : 0);
		points[k * (COLUMNS + 1) + COLUMNS] = 1;
	}
	if (interp_build_curve(b, &c, &w, &d) != 0)
		fail_msg("%s; %s", d.found, d.wanted);
}

static inline struct made random_path(uint64_t *s)
{
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};
	struct interp_build *b = interp_build_create(&o);

	for (int i = 0; i < SEGS; i++) {
		if (rnd(s) % 4 == 0)
			random_arc(b, s);
		else if (rnd(s) % 6 == 0)
			random_nurbs(b, s, 3);
		else if (rnd(s) % 8 == 0)
			random_tiny(b, s);
		else if (rnd(s) % 12 == 0)
			random_pole(b, s);
		else
			random_line(b, s);
		if (rnd(s) % 6 == 0)
			action(b, INTERP_DWELL, 1);
	}
	return finish(b);
}

/* Where the axes are in four cycles; on one segment, in one kind of move. */
struct track {
	double at[4][INTERP_NAXES];
	uint32_t index[4];
	enum cycle_state state[4];
	int n;
	struct interp_at_curve curve;
};

/* On two contours at once: each goes by its own share of the way. */
static inline void places_of_pair(const struct interp_cursor *at,
				  double ret[INTERP_NAXES])
{
	const struct interp_program *p = &at->p;
	const double part = at->s_mm / at->seg.length_mm;
	const uint32_t n = p->head->naxes;

	for (uint32_t j = 0; j < n; j++) {
		const int64_t *from = &p->nodes[at->index * n + j];

		ret[p->head->column[j]] =
			((double)from[0] + part * (double)(from[n] - from[0])) /
			INTERP_SUB * PULSE_MM;
	}
	for (int k = 0; k < 2; k++) {
		const struct interp_arc *a = &at->couple.side[k];
		const double turned = a->theta + part * a->sweep;
		const double r = a->r_mm + part * a->dr_mm;

		if (!(a->r_mm > 0) || a->sweep == 0)
			continue;
		ret[a->axis_a] = a->a_mm + r * cos(turned);
		ret[a->axis_b] = a->b_mm + r * sin(turned);
	}
}

/* Not by pulses: from where the cursor says it is. */
static inline void places_of(struct track *k, const struct rig *r,
			     double ret[INTERP_NAXES])
{
	const struct interp_cursor *at = &r->c.cursor;
	struct interp_contour_point point;

	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	if (at->seg.kind >= INTERP_BEGIN)
		return;
	if (at->seg.kind == INTERP_PAIR) {
		places_of_pair(at, ret);
		return;
	}
	assert_true(interp_program_at(&at->p, at->index, at->s_mm, &k->curve,
				      &point));
	for (uint32_t j = 0; j < at->p.head->naxes; j++)
		ret[at->p.head->column[j]] = point.mm[j];
}

static inline void note(struct track *k, const struct rig *r)
{
	for (int i = 0; i < 3; i++) {
		memcpy(k->at[i], k->at[i + 1], sizeof(k->at[i]));
		k->index[i] = k->index[i + 1];
		k->state[i] = k->state[i + 1];
	}
	places_of(k, r, k->at[3]);
	k->index[3] = r->c.cursor.index;
	k->state[3] = r->c.state;
	k->n++;
}

static inline bool is_whole(const struct track *k)
{
	for (int i = 0; i < 3; i++)
		if (k->index[i] != k->index[3] || k->state[i] != k->state[3])
			return false;
	return k->n >= 4 && (k->state[3] == STATE_TRAVEL ||
			     k->state[3] == STATE_JUMP ||
			     k->state[3] == STATE_HOLD);
}

/* Slower is never gone: a bend of a curve with less than a pulse's radius is
 * none that the axes see. */
static inline double slowest_mm_s(void)
{
	double j = INFINITY;

	for (int i = 0; i < INTERP_NAXES; i++)
		j = fmin(j, axes_machine.axis[i].j_max_mm_s3);
	return cbrt(j * PULSE_MM * PULSE_MM);
}

/* How far an axis turns by a mm of the line that it is on; 1 at least. */
static inline double rate_of(const struct rig *r, int axis)
{
	const struct interp_program *p = &r->c.cursor.p;
	const uint32_t i = r->c.cursor.index, n = p->head->naxes;
	double rate = 1;

	for (uint32_t j = 0; j < n && r->c.cursor.seg.kind == INTERP_LINE; j++)
		if (p->head->column[j] == axis)
			rate = fabs((double)(p->nodes[(i + 1) * n + j] -
					     p->nodes[i * n + j])) /
			       INTERP_SUB * PULSE_MM /
			       r->c.cursor.seg.length_mm;
	return fmax(rate, 1);
}

/* How often more than the limit an axis may do: its share of a line is not
 * known better than the ends of the line are, and not by more than 20 pulses
 * of it.  */
static inline double rounding_of(const struct rig *r, int axis)
{
	const double mm = r->c.cursor.seg.length_mm;
	const double rate = rate_of(r, axis);
	const double off = PULSE_MM * (1 + fmin(rate, 20));

	if (r->c.cursor.seg.kind != INTERP_LINE)
		return 1;
	return rate * mm > off ? rate * mm / (rate * mm - off) : INFINITY;
}

/* A stop less than 1e-9 mm ahead is met: the last bit of time is cut, and the
 * axis moves by that. */
static inline void check_axes(const struct track *k, const struct rig *r)
{
	const double t = PERIOD_S * track_stride;
	const bool curve = r->c.cursor.seg.kind == INTERP_CURVE;
	const bool floored = curve && fabs(r->c.mover.v_mm_s) <
				      2 * slowest_mm_s();
	const double off = curve && track_stride > 1 ? CURVE_OFF_MM : 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &axes_machine.axis[i];
		const double v[3] = { (k->at[1][i] - k->at[0][i]) / t,
				      (k->at[2][i] - k->at[1][i]) / t,
				      (k->at[3][i] - k->at[2][i]) / t };
		const double a[2] = { (v[1] - v[0]) / t, (v[2] - v[1]) / t };
		const double jerk = (a[1] - a[0]) / t;
		const double onto = 4e-9 * rate_of(r, i);
		const double cut = cbrt(1.5 * onto * l->j_max_mm_s3 *
					l->j_max_mm_s3) + onto / t / t +
				   6e-9 / t / t;
		/* Between two places of a curve an axis is taken for as fast
		 * as a parabola's top. */
		const double more = rounding_of(r, i) *
				    (1 + (curve ? 1e-4 : 1e-6));
		const bool beyond =
			fabs(a[0]) > l->a_max_mm_s2 * more + cut +
				     4 * off / t / t ||
			fabs(jerk) > l->j_max_mm_s3 * more + 2 * cut / t +
				     8 * off / t / t / t;

		if (fabs(v[0]) > l->v_max_mm_s * more + 2 * off / t ||
		    (beyond && !floored))
			fail_msg("axis %c, %s, segment %u: %g of %g mm/s, %g "
				 "of %g mm/s2, %g of %g mm/s3",
				 INTERP_AXIS_LETTERS[i],
				 state_duty[r->c.state].name,
				 (unsigned)k->index[3], v[0], l->v_max_mm_s,
				 a[0], l->a_max_mm_s2, jerk, l->j_max_mm_s3);
	}
}

/* At any moment: held, gone on, told another speed; and taken back in one cycle
 * of @one_in in which it is held. */
static inline void disturb(struct rig *r, uint64_t *s, unsigned int one_in)
{
	if (r->c.state == STATE_HOLD && !r->c.hold.moving &&
	    mover_is_standing(&r->c.mover) && rnd(s) % 20 == 0)
		tell(r, CYCLE_START);
	else if (rnd(s) % 300 == 0)
		tell(r, CYCLE_HOLD);
	else if (rnd(s) % 200 == 0)
		tell_mm(r, CYCLE_OVERRIDE, uniform(s, 0.02, 1.5));
	else if (rnd(s) % one_in == 0 && r->c.state == STATE_HOLD)
		tell_mm(r, CYCLE_RETRACT, uniform(s, 0.001, 9));
}

/* A dry run with this travel, without limits of the places. */
static inline struct cycle_config dry(double a_mm_s2, double j_mm_s3)
{
	struct cycle_config k = usual_config();

	for (int i = 0; i < INTERP_NAXES; i++) {
		k.travel_min[i] = -1000000;
		k.travel_max[i] = 1000000;
	}
	k.travel_a_mm_s2 = a_mm_s2;
	k.travel_j_mm_s3 = j_mm_s3;
	k.dry_run = k.hold_at_end = true;
	k.gap.retract_mm_s = 1000;
	return k;
}

/* What a test keeps of the cycles behind it. */
struct ring;

/* To the end of the program, which is a hold. */
static inline void track_there(struct rig *r, struct ring *k,
			       void (*watch)(struct rig *r, struct ring *k),
			       int cycles)
{
	tell(r, CYCLE_START);
	for (int n = 0; n < cycles && r->c.state == STATE_TRAVEL; n++)
		watch(r, k);
	assert_int_equal(r->c.state, STATE_HOLD);
}

/* Back to its start. */
static inline void track_back(struct rig *r, struct ring *k,
			      void (*watch)(struct rig *r, struct ring *k),
			      int cycles)
{
	tell_mm(r, CYCLE_RETRACT, 1e9);
	for (int n = 0; n < cycles && r->c.hold.moving; n++)
		watch(r, k);
	assert_true(place(r) == 0);
}

#endif /* AXIS_TRACK_H */
