/* SPDX-License-Identifier: Apache-2.0 */
/* probe.c - find the work by contact; end segments where the machine says */
#include "path/probe.h"
#include "path/laws.h"
#include "path/pace.h"
#include "path/place.h"
#include "path/probe_rest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Stop so far before the end of a segment that its last point is reached and
 * the next segment is not begun. */
#define SHY_MM		(2 * MOVER_ONTO_MM)

/* -- Sensing --------------------------------------------------------------- */

void probe_sense(struct cycle *c, const struct io_inputs *in)
{
	c->probe.contact = c->sensed.contact || in->contact;
}

/* -- Places ---------------------------------------------------------------- */

/* The segment that it is on or, at the stop before it, is about to enter. */
static uint32_t index_of(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;

	return at->seg.flags & INTERP_SEG_SENSED &&
	       at->s_mm < at->seg.length_mm - MOVER_ONTO_MM ? at->index :
							    at->index + 1;
}

static const struct interp_seg *segment(const struct cycle *c)
{
	return &c->cursor.p.segs[index_of(c)];
}

bool probe_is_start(const struct cycle *c, const struct interp_cursor *at)
{
	for (int i = 0; i < INTERP_NAXES; i++)
		if (c->out.target[i] !=
		    at->pos[i] + at->p.head->probed.shift[i])
			return false;
	return true;
}

void probe_load(struct cycle *c)
{
	const struct interp_probed *was = &c->cursor.p.head->probed;
	struct probe *t = &c->probe;

	*t = (struct probe) {
		.phase = PROBE_SETTLE, .once = was->once, .twice = was->twice,
	};
	memcpy(t->shift, was->shift, sizeof(t->shift));
	memcpy(t->found, was->found, sizeof(t->found));
	place_target(c, c->cursor.pos);
}

/* Along which axis the segment goes, and in which direction; 0 if along
 * none. */
static int axis_of(const struct cycle *c, int *ret_sign)
{
	const struct interp_program_head *h = c->cursor.p.head;
	const int64_t *from = c->cursor.p.nodes +
			      (uint64_t)index_of(c) * h->naxes;

	*ret_sign = 0;
	for (uint32_t j = 0; j < h->naxes; j++) {
		if (from[j] == from[j + h->naxes])
			continue;
		*ret_sign = from[j] < from[j + h->naxes] ? 1 : -1;
		return h->column[j];
	}
	return 0;
}

/* Where the segment begins, in pulses of its axis. */
static double from_pulses(const struct cycle *c, int axis)
{
	const struct interp_program_head *h = c->cursor.p.head;
	const int64_t *from = c->cursor.p.nodes +
			      (uint64_t)index_of(c) * h->naxes;

	for (uint32_t j = 0; j < h->naxes; j++)
		if (h->column[j] == axis)
			return (double)from[j] / INTERP_SUB;
	return 0;
}

/* To the end of the segment, or of the travel. */
static double left_mm(const struct cycle *c)
{
	const struct interp_seg *s = segment(c);
	int sign;
	const int axis = axis_of(c, &sign);
	const double last = sign > 0 ? c->config.travel_max[axis] :
				       c->config.travel_min[axis];
	const double pulses = last - c->probe.shift[axis] -
			      from_pulses(c, axis);
	const double travel = sign * pulses *
			      c->cursor.p.head->pulse_mm[axis];

	return s->s_mm + fmin(s->length_mm, travel) - SHY_MM - place_mm(c);
}

/* -- The end --------------------------------------------------------------- */

static void remember(struct cycle *c, int axis, int32_t pos)
{
	struct probe *t = &c->probe;

	t->found[1][axis] = t->found[0][axis];
	t->found[0][axis] = pos;
	t->twice |= t->once & 1u << axis;
	t->once |= 1u << axis;
}

/* The rest of the segment goes into the shift. */
static void finish(struct cycle *c)
{
	struct probe *t = &c->probe;
	int32_t was[INTERP_NAXES];
	int sign;
	const int axis = axis_of(c, &sign);

	memcpy(was, c->cursor.pos, sizeof(was));
	mover_set(&c->mover, 0);
	if (segment(c)->flags & INTERP_SEG_PROBE && !c->config.dry_run)
		remember(c, axis, was[axis] + t->shift[axis]);
	if (interp_cursor_seek_end(&c->cursor, index_of(c)) < 0) {
		fault_latch(&c->fault, FAULT_PROGRAM);
		return;
	}
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int64_t shift = (int64_t)t->shift[i] + was[i] -
				      c->cursor.pos[i];

		if (llabs(shift) > INTERP_PULSES_MAX) {
			fault_latch(&c->fault, FAULT_PROGRAM);
			return;
		}
		t->shift[i] = (int32_t)shift;
	}
	c->far_mm = c->back_mm = place_mm(c);
	c->out.path++;
	t->phase = PROBE_DONE;
}

/* -- The rest of the program ---------------------------------------------- */

static void begin_look(struct cycle *c)
{
	mover_set(&c->mover, 0);
	c->probe.rest = index_of(c) + 1;
	c->probe.phase = PROBE_LOOK;
}

/* The axes stand, and go on only if the rest of the program fits. */
static double look(struct cycle *c)
{
	int sign;

	if (!probe_rest_look(c, axis_of(c, &sign), index_of(c)))
		return 0;
	if (c->probe.beyond)
		fault_latch(&c->fault, FAULT_SOFT_LIMIT);
	else
		finish(c);
	return 0;
}

/* -- To a place known beforehand ------------------------------------------- */

/* The distance to it, in mm; below 0 if it lies behind. */
static double way_mm(const struct cycle *c)
{
	const struct probe *t = &c->probe;
	int sign;
	const int axis = axis_of(c, &sign);
	const int64_t at = (int64_t)c->cursor.pos[axis] + t->shift[axis];
	int64_t to;

	if (segment(c)->flags & INTERP_SEG_LIMIT)
		to = sign > 0 ? c->config.travel_max[axis] - 1 :
				c->config.travel_min[axis] + 1;
	else if (t->twice & 1u << axis)
		to = ((int64_t)t->found[0][axis] + t->found[1][axis]) / 2;
	else
		return NAN;
	return (double)(sign * (to - at)) * c->cursor.p.head->pulse_mm[axis];
}

static void begin_going(struct cycle *c)
{
	const double way = way_mm(c);

	if (!(way <= left_mm(c))) {
		fault_latch(&c->fault, FAULT_PROGRAM);
		return;
	}
	c->probe.phase = PROBE_GO;
	c->probe.to_mm = place_mm(c) + fmax(way, 0);
}

static bool is_there(const struct cycle *c)
{
	return c->mover.v_mm_s == 0 &&
	       fabs(c->probe.to_mm - place_mm(c)) < 2 * MOVER_ONTO_MM;
}

static struct mover_limits limits(const struct cycle *c, double v_max_mm_s)
{
	struct mover_limits l = law_travel_limits(c, v_max_mm_s);

	law_soften(&l, segment(c));
	return l;
}

static double go_to(struct cycle *c, double v_max_mm_s)
{
	const struct mover_limits l = limits(c, v_max_mm_s);

	return mover_step(&c->mover, &l, c->probe.to_mm - place_mm(c));
}

static double go(struct cycle *c)
{
	const double by = fmin(c->override, 1);
	const struct mover_limits l = limits(c, 1);

	if (is_there(c)) {
		begin_look(c);
		return 0;
	}
	if (c->probe.contact && c->probe.open_seen) {
		fault_latch(&c->fault, FAULT_CONTACT);
		return mover_stop(&c->mover, &l);
	}
	c->probe.open_seen = c->probe.open_seen || !c->probe.contact;
	return by > 0 ? go_to(c, by * law_seg_speed(segment(c))) :
			mover_stop(&c->mover, &l);
}

/* -- Feeling --------------------------------------------------------------- */

void probe_begin(struct cycle *c)
{
	struct probe *t = &c->probe;

	mover_set(&c->mover, 0);
	t->phase = PROBE_SETTLE;
	t->settled = 0;
	t->open_seen = false;
}

static double feed_mm_s(const struct cycle *c)
{
	return fmin(c->config.probe.feed_mm_s, law_seg_speed(segment(c)));
}

static double forward(struct cycle *c, double v_mm_s)
{
	const double left = left_mm(c);

	if (left > 0)
		return fmin(pace_go(c, v_mm_s, place_mm(c) + left), left);
	fault_latch(&c->fault, FAULT_NO_CONTACT);
	return 0;
}

static void begin_back(struct cycle *c)
{
	/* It may have braked farther than that beyond the contact. */
	c->probe.to_mm = fmax(segment(c)->s_mm,
			      c->probe.met_mm - c->config.probe.back_mm);
	c->probe.phase = PROBE_BACK;
}

/* A contact that is there before the motion begins was not found by this
 * motion, so it does not count.  But a hold may have ended in contact, farther
 * on. */
static double settle(struct cycle *c)
{
	const struct interp_seg *s = segment(c);

	mover_set(&c->mover, 0);
	if (c->probe.settled++ < c->config.probe.settle.cycles)
		return 0;
	if (!(s->flags & INTERP_SEG_PROBE)) {
		begin_going(c);
		return 0;
	}
	if (!c->probe.contact) {
		c->probe.phase = PROBE_FAST;
		return 0;
	}
	c->probe.met_mm = place_mm(c);
	if (place_mm(c) - s->s_mm < s->length_mm / s->ticks)
		fault_latch(&c->fault, FAULT_CONTACT);
	else
		begin_back(c);
	return 0;
}

static double stop(struct cycle *c)
{
	const double left = left_mm(c);

	if (left > 0 && c->mover.v_mm_s > pace_dv_mm_s(c))
		return fmin(pace_go(c, 0, place_mm(c) + left), left);
	mover_set(&c->mover, 0);
	begin_back(c);
	if (c->config.probe.back_mm <= 0)
		begin_look(c);
	return 0;
}

static double fast(struct cycle *c)
{
	if (!c->probe.contact)
		return forward(c, feed_mm_s(c));
	c->probe.met_mm = place_mm(c);
	c->probe.phase = PROBE_STOP;
	return stop(c);
}

/* If the contact does not open on the way back, it is not the work. */
static double back(struct cycle *c)
{
	if (!is_there(c))
		return go_to(c, feed_mm_s(c));
	if (c->probe.contact)
		fault_latch(&c->fault, FAULT_CONTACT);
	else
		c->probe.phase = PROBE_FINE;
	return 0;
}

/*
 * So slow that it stands within the cycle of the contact.  Farther than the
 * first contact by all of back_mm: that was not the work.
 */
static double fine(struct cycle *c)
{
	const double v = fmin(c->config.probe.fine_mm_s, pace_dv_mm_s(c));

	if (c->probe.contact) {
		begin_look(c);
		return 0;
	}
	if (place_mm(c) > c->probe.met_mm + c->config.probe.back_mm)
		c->probe.phase = PROBE_FAST;
	return forward(c, fmin(v, feed_mm_s(c)));
}

static double none(struct cycle *c)
{
	return law_go_at(c, 0);
}

double probe_distance(struct cycle *c)
{
	static double (*const laws[PROBE_NPHASES])(struct cycle *) = {
		[PROBE_SETTLE]	= settle,
		[PROBE_FAST]	= fast,
		[PROBE_STOP]	= stop,
		[PROBE_BACK]	= back,
		[PROBE_FINE]	= fine,
		[PROBE_GO]	= go,
		[PROBE_LOOK]	= look,
		[PROBE_DONE]	= none,
	};

	if (c->config.dry_run && c->probe.phase < PROBE_LOOK)
		begin_look(c);
	return laws[c->probe.phase](c);
}
