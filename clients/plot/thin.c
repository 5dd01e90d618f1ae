/* SPDX-License-Identifier: Apache-2.0 */
/* thin.c - strips of time, points of the path, marks, and a zoom */
#include "thin.h"

#include <math.h>
#include <string.h>

#define ZOOM_JUMPS	3ul
#define ZOOM_S		3.0		/* of a retract, where nothing jumps */

/* This is called twenty times for each row; fmin() and fmax() would be calls of
 * libm. */
static inline void range_add(struct thin_range *r, double v)
{
	if (r->n++ == 0)
		r->min = r->max = v;
	else if (v < r->min)
		r->min = v;
	else if (v > r->max)
		r->max = v;
	r->sum += v;
}

void thin_range_join(struct thin_range *a, const struct thin_range *b)
{
	if (b->n == 0)
		return;
	a->min = a->n ? fmin(a->min, b->min) : b->min;
	a->max = a->n ? fmax(a->max, b->max) : b->max;
	a->sum += b->sum;
	a->n += b->n;
}

static int state_of(const char *(*name)(int state), const char *wanted)
{
	for (int i = 0; i < PLOT_NSTATES && name(i); i++)
		if (strcmp(name(i), wanted) == 0)
			return i;
	return -1;
}

void thin_init(struct thin *t, const char *(*name)(int state))
{
	memset(t, 0, sizeof(*t));
	t->is = (struct thin_states) {
		.approach = state_of(name, "approach"),
		.erode = state_of(name, "erode"),
		.retract = state_of(name, "retract"),
		.jump = state_of(name, "jump"),
	};
	t->state = -1;
	t->jumps.every = t->retracts.every = 1;
	t->try_at = 1;
}

static void strip_join(struct thin_strip *a, const struct thin_strip *b)
{
	thin_range_join(&a->place, &b->place);
	thin_range_join(&a->gap, &b->gap);
	thin_range_join(&a->feed, &b->feed);
	for (int i = 0; i < PLOT_NAXES; i++)
		thin_range_join(&a->axis[i], &b->axis[i]);
	a->far_mm = b->far_mm;
	for (int i = 0; i < PLOT_NSTATES; i++)
		a->share[i] += b->share[i];
}

static void strips_join(struct thin *t)
{
	for (size_t i = 0; i < THIN_STRIPS / 2; i++) {
		struct thin_strip s = t->strip[2 * i];

		strip_join(&s, &t->strip[2 * i + 1]);
		t->strip[i] = s;
	}
	memset(&t->strip[THIN_STRIPS / 2], 0, sizeof(t->strip) / 2);
	t->nstrips = THIN_STRIPS / 2;
	t->width_s *= 2;
}

/* The strip to which a row belongs.  The first two rows show how wide a strip
 * is. */
static struct thin_strip *strip_of(struct thin *t, double t_s)
{
	const double after_s = t_s - t->time.min;
	size_t i;

	if (t->width_s == 0 && after_s > 0)
		t->width_s = 2 * after_s;
	while (t->width_s > 0 && after_s / t->width_s >= THIN_STRIPS)
		strips_join(t);
	i = t->width_s > 0 ? (size_t)(after_s / t->width_s) : 0;
	/* Strips that were skipped get what was known before them. */
	for (; t->nstrips <= i; t->nstrips++)
		t->strip[t->nstrips].far_mm = t->place.max;
	return &t->strip[i];
}

static bool is_power(const struct thin *t, int state)
{
	return state == t->is.approach || state == t->is.erode;
}

/*
 * Voltage and feed are shown only for the cut.  Jumps are a hundred times as
 * fast and have no power, and would hide what the servo does.  For a run that
 * cuts nothing, everything is shown.
 */
static void begin_cut(struct thin *t, const struct plot_row *r)
{
	t->cuts = true;
	t->cut_min = r->s_mm;
	for (size_t i = 0; i < t->nstrips; i++)
		t->strip[i].gap = t->strip[i].feed = (struct thin_range) { 0 };
}

static void take_strip(struct thin *t, const struct plot_row *r)
{
	struct thin_strip *s = strip_of(t, r->t_s);
	const bool erodes = r->state == t->is.erode;

	range_add(&s->place, r->s_mm);
	if (!isnan(r->gap_v) &&
	    (!t->cuts || erodes || r->state == t->is.retract))
		range_add(&s->gap, r->gap_v);
	if (!t->cuts || erodes)
		range_add(&s->feed, r->feed_mm_s);
	for (int i = 0; i < PLOT_NAXES; i++)
		range_add(&s->axis[i], r->axis_mm[i]);
	s->far_mm = r->s_mm > t->place.max ? r->s_mm : t->place.max;
	s->share[r->state]++;
}

static void take_event(struct thin_events *e, const struct plot_row *r)
{
	if (e->seen++ % e->every)
		return;
	if (e->n == THIN_EVENTS) {
		for (size_t i = 0; i < THIN_EVENTS / 2; i++)
			e->at[i] = e->at[2 * i];
		e->n = THIN_EVENTS / 2;
		e->every *= 2;
	}
	e->at[e->n] = (struct thin_event) { r->t_s, r->s_mm, { 0 } };
	memcpy(e->at[e->n++].axis_mm, r->axis_mm, sizeof(r->axis_mm));
}

static void path_halve(struct thin *t)
{
	for (size_t i = 0; i < THIN_PATH / 2; i++)
		t->path[i] = t->path[2 * i];
	t->npath = THIN_PATH / 2;
	t->least_mm = t->least_mm > 0 ? 2 * t->least_mm :
		      (t->place.max - t->place.min) / THIN_PATH;
}

/*
 * The path is drawn where new ground is gained.  So each place is drawn once,
 * however often jumps and retracts pass it.
 */
static void take_path(struct thin *t, const struct plot_row *r)
{
	struct thin_point *p;

	if (t->npath && (r->s_mm <= t->place.max ||
			 r->s_mm - t->kept_mm < t->least_mm))
		return;
	if (t->npath == THIN_PATH)
		path_halve(t);
	p = &t->path[t->npath++];
	memcpy(p->axis_mm, r->axis_mm, sizeof(p->axis_mm));
	p->cut = r->cut;
	t->kept_mm = r->s_mm;
}

static void zoom_begin(struct thin *t, const struct plot_row *r, bool jump)
{
	t->trying = (struct thin_zoom) { .from_s = r->t_s, .jumps = jump };
	t->trying.retract = !jump;
	t->trying.n = 1;
	t->try_at = t->jumps.seen + 1 + t->jumps.seen / 2;
}

/* A later zoom shows more of the job; a zoom with a retract shows more of the
 * gap. */
static void zoom_end(struct thin *t)
{
	t->trying.whole = true;
	if (t->zoom.n == 0 || t->trying.retract >= t->zoom.retract)
		t->zoom = t->trying;
	t->trying.n = 0;
}

static void zoom_halve(struct thin_zoom *z)
{
	for (size_t i = 0; i < THIN_ZOOM / 2; i++) {
		struct thin_detail d = z->at[2 * i];

		thin_range_join(&d.place, &z->at[2 * i + 1].place);
		if (z->at[2 * i + 1].place.n)
			d.state = z->at[2 * i + 1].state;
		z->at[i] = d;
	}
	memset(&z->at[THIN_ZOOM / 2], 0, sizeof(z->at) / 2);
	z->n = THIN_ZOOM / 2;
	z->width_s *= 2;
}

static void zoom_add(struct thin_zoom *z, const struct plot_row *r)
{
	const double after_s = r->t_s - z->from_s;
	size_t i;

	if (z->width_s == 0 && after_s > 0)
		z->width_s = 2 * after_s;
	while (z->width_s > 0 && after_s / z->width_s >= THIN_ZOOM)
		zoom_halve(z);
	i = z->width_s > 0 ? (size_t)(after_s / z->width_s) : 0;
	range_add(&z->at[i].place, r->s_mm);
	z->at[i].state = r->state;
	z->n = i + 1 > z->n ? i + 1 : z->n;
}

static void take_zoom(struct thin *t, const struct plot_row *r, bool jump,
		      bool retract)
{
	struct thin_zoom *z = &t->trying;

	if (z->n && ((jump && z->jumps == ZOOM_JUMPS) ||
		     (z->jumps == 0 && r->t_s - z->from_s > ZOOM_S)))
		zoom_end(t);
	else if (z->n && jump && z->jumps)
		z->jumps++;
	if (z->n)
		z->retract |= retract;
	else if ((jump && t->jumps.seen >= t->try_at) ||
		 (retract && t->jumps.seen == 0 && t->zoom.n == 0))
		zoom_begin(t, r, jump);
	if (z->n)
		zoom_add(z, r);
}

void thin_end(struct thin *t)
{
	if (t->zoom.n == 0 && t->trying.n > 0)
		t->zoom = t->trying;
}

/* Called before the row counts: t->place, t->time and t->state are those of the
 * previous rows. */
static void take(struct thin *t, const struct plot_row *r)
{
	const bool jump = r->state == t->is.jump && r->state != t->state;
	const bool retract = r->state == t->is.retract && r->state != t->state;

	if (jump)
		take_event(&t->jumps, r);
	if (retract)
		take_event(&t->retracts, r);
	if (is_power(t, r->state)) {
		if (!t->cuts)
			begin_cut(t, r);
		t->cut_min = r->s_mm < t->cut_min ? r->s_mm : t->cut_min;
	}
	take_strip(t, r);
	take_path(t, r);
	take_zoom(t, r, jump, retract);
}

void thin_add(struct thin *t, const struct plot_row *r)
{
	if (r->state < 0 || r->state >= PLOT_NSTATES)
		return;
	if (t->rows++ == 0) {
		range_add(&t->time, r->t_s);
		range_add(&t->place, r->s_mm);
	}
	take(t, r);
	range_add(&t->time, r->t_s);
	range_add(&t->place, r->s_mm);
	for (int i = 0; i < PLOT_NAXES; i++)
		range_add(&t->axis[i], r->axis_mm[i]);
	t->in_state[r->state]++;
	t->state = r->state;
}
