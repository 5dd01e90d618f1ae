/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contouring.c - feedforward and cross-coupling, as places
 */
#include "axes/contouring.h"
#include "path/laws.h"

#include <math.h>

#define TAKEN_UP	(1.0 / 16)	/* a period */
#define SEGMENTS_MAX	64		/* segments, looked at for one point */

/* -- Set values ------------------------------------------------------------ */

/* For each axis: [0] is the period before, [1] the present one. */
struct row_ahead {
	double mm[INTERP_NAXES][CONTOURING_AHEAD + 2];
};

/* The segment that contains @s_mm, searched from segment @i on; an action has
 * no point. */
static uint32_t seg_near(const struct interp_program *p, uint32_t i,
			 double s_mm)
{
	const uint32_t last = p->head->nsegs - 1;
	int n = SEGMENTS_MAX;

	while (n-- > 0 && i > 0 && (s_mm < p->segs[i].s_mm || i == last))
		i--;
	while (n-- > 0 && i < last &&
	       s_mm > p->segs[i].s_mm + p->segs[i].length_mm)
		i++;
	while (n-- > 0 && i < last && p->segs[i].kind >= INTERP_BEGIN)
		i++;
	while (n-- > 0 && i > 0 && p->segs[i].kind >= INTERP_BEGIN)
		i--;
	return i;
}

static bool point_set(struct cycle *c, struct row_ahead *r, int k,
		      double s_mm)
{
	const struct interp_program *p = &c->cursor.p;
	const uint32_t i = seg_near(p, c->cursor.index, s_mm);
	struct interp_contour_point at;

	if (!interp_program_at(p, i, s_mm - p->segs[i].s_mm,
			       &c->contouring.curve, &at))
		return false;
	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const uint8_t axis = p->head->column[j];

		r->mm[axis][k] = at.mm[j] + c->probe.shift[axis] *
					    c->config.contouring.pulse_mm[axis];
	}
	return true;
}

/* Axes that the program does not move stay where they are. */
static void stand_all(const struct cycle *c, struct row_ahead *r)
{
	for (int i = 0; i < INTERP_NAXES; i++)
		for (int k = 0; k < CONTOURING_AHEAD + 2; k++)
			r->mm[i][k] = c->out.target[i] *
				      c->config.contouring.pulse_mm[i];
}

/*
 * It is assumed that the speed along the path goes on changing as it does now,
 * but that it does not change its sign: a motion that comes to a stop stays
 * there.
 */
static bool look_ahead(struct cycle *c, double way_mm,
		       struct row_ahead *r)
{
	const struct contouring *w = &c->contouring;
	const double more_mm = way_mm - w->way_mm;
	const int toward = way_mm < 0 ? -1 : 1;
	double s_mm = interp_cursor_place_mm(&c->cursor), go_mm = way_mm;

	stand_all(c, r);
	if (!point_set(c, r, 0, s_mm - way_mm) || !point_set(c, r, 1, s_mm))
		return false;
	for (int k = 2; k < c->config.contouring.ahead + 2; k++) {
		go_mm = way_mm == 0 ? 0 :
			toward * fmax(toward * (go_mm + more_mm), 0);
		s_mm += go_mm;
		if (!point_set(c, r, k, s_mm))
			return false;
	}
	return true;
}

/* -- Cross-coupling -------------------------------------------------------- */

static bool is_coupled(const struct contouring_config *k, int axis)
{
	return k->axes >> axis & 1 &&
	       !interp_axis_is_rotary((enum interp_axis)axis);
}

/* Put the linear axes with a loop in a row. Return: how many there are. */
static int pick(const struct contouring_config *k,
		const double mm[INTERP_NAXES], double *ret)
{
	int n = 0;

	for (int i = 0; i < INTERP_NAXES; i++)
		if (is_coupled(k, i))
			ret[n++] = mm[i];
	return n;
}

static void measured(const struct cycle *c, const struct io_inputs *in,
		     double ret[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++)
		ret[i] = comp_place(&c->comp.axis[i], in->actual[i]) *
			 c->config.contouring.pulse_mm[i];
}

static void couple(struct cycle *c, const struct io_inputs *in,
		   const struct row_ahead *set, double v[INTERP_NAXES])
{
	const struct contouring_config *k = &c->config.contouring;
	struct contouring *w = &c->contouring;
	double now[INTERP_NAXES], is[INTERP_NAXES], mm[INTERP_NAXES];
	struct interp_contour_error e;
	int n = 0;

	for (int i = 0; i < INTERP_NAXES; i++)
		now[i] = set->mm[i][1];
	pick(k, now, mm);
	interp_row_take(&w->row, mm);
	measured(c, in, is);
	pick(k, is, mm);
	interp_row_error(&w->row, &w->foot, mm, &e);
	for (int i = 0; i < INTERP_NAXES; i++)
		if (is_coupled(k, i))
			v[i] += w->coupled * k->gains.cross_1_s *
				e.vector_mm[n++];
}

/* -- As places ------------------------------------------------------------- */

/* The drive's own feedforward sees the changes of the addition as a speed. */
static double as_place(const struct cycle *c, int axis, double v_mm_s)
{
	const struct interp_axis_loop *l = &c->config.contouring.loop[axis];
	const double own = fmax(l->feedforward, 0) /
			   (l->gain_1_s * law_period_s(c));

	return (v_mm_s / l->gain_1_s + own * c->contouring.added_mm[axis]) /
	       (1 + own);
}

/* A damaged program may lead to a value that is no number: it counts as 0. */
static double within(double x, double low, double high)
{
	return isnan(x) ? fmin(fmax(0, low), high) : fmin(fmax(x, low), high);
}

/* The target stays inside the travel too, because a drive may watch its travel
 * itself. */
static int32_t inside(const struct cycle *c, int axis, double pulses)
{
	const double low = (double)c->config.travel_min[axis] -
			   c->out.target[axis];
	const double high = (double)c->config.travel_max[axis] -
			    c->out.target[axis];

	return (int32_t)llround(within(pulses, fmin(low, 0), fmax(high, 0)));
}

/* In a period an addition changes by no more than the distance at v_max. */
static void put(struct cycle *c, int axis, double mm)
{
	const struct contouring_config *k = &c->config.contouring;
	struct contouring *w = &c->contouring;
	const double most = k->most_mm[axis], was = w->added_mm[axis];
	const double leap = most * k->loop[axis].gain_1_s * law_period_s(c);

	w->added_mm[axis] = within(within(mm, -most, most), was - leap,
				   was + leap);
	w->added[axis] = inside(c, axis, w->added_mm[axis] / k->pulse_mm[axis]);
}

static void add(struct cycle *c, const double v[INTERP_NAXES])
{
	for (uint32_t m = c->config.contouring.axes; m; m &= m - 1) {
		const int i = __builtin_ctz(m);

		put(c, i, as_place(c, i, v[i]));
	}
}

/* -- One period ------------------------------------------------------------ */

static bool applies(const struct cycle *c)
{
	return c->loaded && (c->state == STATE_TRAVEL ||
			     c->state == STATE_HOLD) &&
	       c->out.enable && (!c->axes.off || c->axes.steers) &&
	       !resync_is_off(c) &&
	       !escape_is_out(&c->escape);
}

bool contouring_rests(const struct contouring *w)
{
	int32_t any = 0;

	for (int i = 0; i < INTERP_NAXES && w->on; i++)
		any |= w->added[i];
	return any == 0;
}

static void leave(struct contouring *w)
{
	if (!w->on)
		return;
	w->on = false;
	w->eases = false;
	for (int i = 0; i < INTERP_NAXES; i++) {
		w->added_mm[i] = 0;
		w->added[i] = 0;
	}
}

/* The axes move at full speed, and the points of their path are not known
 * here. */
static void ease_off(struct cycle *c)
{
	struct contouring *w = &c->contouring;

	for (uint32_t m = c->config.contouring.axes; m; m &= m - 1) {
		const int i = __builtin_ctz(m);

		put(c, i, w->added_mm[i] * (1 - TAKEN_UP));
	}
	w->eases = !contouring_rests(w);
	if (!w->eases)
		leave(w);
}

/* Begin here; gradually, if the axes are moving. */
static void begin(struct cycle *c, bool stood)
{
	struct contouring *w = &c->contouring;
	double now[INTERP_NAXES], mm[INTERP_NAXES];
	int n;

	leave(w);
	w->on = true;
	w->path = c->out.path;
	w->curve.open = false;
	w->place_mm = interp_cursor_place_mm(&c->cursor);
	w->way_mm = c->feed_mm_s * law_period_s(c);
	w->share = stood ? 1 : 0;
	w->coupled = 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		now[i] = c->out.target[i] * c->config.contouring.pulse_mm[i];
	n = pick(&c->config.contouring, now, mm);
	interp_row_begin(&w->row, n, mm);
	interp_row_foot(&w->row, &w->foot);
}

static void lead(struct cycle *c, const struct row_ahead *set,
		 double v[INTERP_NAXES])
{
	const struct contouring_config *k = &c->config.contouring;

	for (uint32_t m = k->axes; m; m &= m - 1) {
		const int i = __builtin_ctz(m);

		v[i] = c->contouring.share *
		       interp_compensate_feedforward(&k->gains, &k->loop[i],
						     law_period_s(c),
						     &set->mm[i][1]);
	}
}

static void go_on(struct cycle *c, const struct io_inputs *in)
{
	struct contouring *w = &c->contouring;
	const double place_mm = interp_cursor_place_mm(&c->cursor);
	const double way_mm = place_mm - w->place_mm;
	const double toward = way_mm == 0 ? -TAKEN_UP : TAKEN_UP;
	double v[INTERP_NAXES] = { 0 };
	struct row_ahead set;

	w->share = fmin(w->share + TAKEN_UP, 1);
	w->coupled = c->fault.latched & axes_faults() ? 0 :
		     fmin(fmax(w->coupled + toward, 0), 1);
	if (w->eases || !look_ahead(c, way_mm, &set)) {
		ease_off(c);
		return;
	}
	if (c->config.contouring.methods & INTERP_COMPENSATE_FEEDFORWARD)
		lead(c, &set, v);
	if (c->config.contouring.methods & INTERP_COMPENSATE_CROSS)
		couple(c, in, &set, v);
	add(c, v);
	w->place_mm = place_mm;
	w->way_mm = way_mm;
}

void contouring_step(struct cycle *c, const struct io_inputs *in)
{
	struct contouring *w = &c->contouring;
	const bool stood = w->stood;

	if (c->config.contouring.methods == 0)
		return;
	w->stood = c->feed_mm_s == 0;
	if (!applies(c))
		leave(w);
	else if (!w->on || w->path != c->out.path)
		begin(c, stood);
	else
		go_on(c, in);
}
