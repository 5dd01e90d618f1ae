/* SPDX-License-Identifier: Apache-2.0 */
/* survey.c - the first reading of a trace: extent, events, where to zoom */
#include "survey.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ZOOM_JUMPS	3
#define ZOOM_TRY	200		/* windows looked at for a retract */

static int add_event(struct thin_events *e, const struct csv_row *r)
{
	if (e->n == e->cap) {
		size_t cap = e->cap ? 2 * e->cap : 64;
		void *at = realloc(e->at, cap * sizeof(*e->at));

		if (!at)
			return -ENOMEM;
		e->at = at;
		e->cap = cap;
	}
	e->at[e->n] = (struct thin_event) { r->t_s, r->s_mm, { 0 } };
	memcpy(e->at[e->n].axis_mm, r->axis_mm, sizeof(r->axis_mm));
	e->n++;
	return 0;
}

static void extend(double *min, double *max, double v)
{
	*min = fmin(*min, v);
	*max = fmax(*max, v);
}

static void begin(struct thin_survey *s, const struct csv_row *r)
{
	s->t_min = s->t_max = r->t_s;
	s->s_min = s->s_max = r->s_mm;
	for (int i = 0; i < CSV_NAXES; i++)
		s->axis_min[i] = s->axis_max[i] = r->axis_mm[i];
}

static int take(struct thin_survey *s, const struct csv_row *r,
		enum csv_state before)
{
	if (s->rows++ == 0)
		begin(s, r);
	extend(&s->t_min, &s->t_max, r->t_s);
	extend(&s->s_min, &s->s_max, r->s_mm);
	for (int i = 0; i < CSV_NAXES; i++)
		extend(&s->axis_min[i], &s->axis_max[i], r->axis_mm[i]);
	s->in_state[r->state]++;
	s->gap |= !isnan(r->gap_v);
	if (r->state == CSV_APPROACH || r->state == CSV_ERODE) {
		s->cut_min = s->cuts ? fmin(s->cut_min, r->s_mm) : r->s_mm;
		s->cuts = true;
	}
	if (r->state == before)
		return 0;
	if (r->state == CSV_JUMP)
		return add_event(&s->jumps, r);
	if (r->state == CSV_RETRACT)
		return add_event(&s->retracts, r);
	return 0;
}

static bool has_retract(const struct thin_survey *s, double from_s,
			double to_s)
{
	for (size_t i = 0; i < s->retracts.n; i++)
		if (s->retracts.at[i].t_s > from_s &&
		    s->retracts.at[i].t_s < to_s)
			return true;
	return false;
}

/* Jumps k to k + 2, with a third of a jump's cycle on either side. */
static void window(struct thin_survey *s, size_t k)
{
	const struct thin_event *jump = s->jumps.at;
	size_t last = k + ZOOM_JUMPS - 1;
	double room = (jump[last].t_s - jump[k].t_s) / 6;

	s->zoom_from_s = fmax(s->t_min, jump[k].t_s - room);
	s->zoom_to_s = fmin(last + 1 < s->jumps.n ? jump[last + 1].t_s :
			    s->t_max, jump[last].t_s + 2.5 * room);
}

/* From the middle outward, the first three jumps with a retract among them. */
static void window_of_jumps(struct thin_survey *s)
{
	size_t last = s->jumps.n - ZOOM_JUMPS;

	for (size_t i = 0; i <= ZOOM_TRY; i++) {
		size_t off = (i + 1) / 2;
		size_t k = i % 2 ? last / 2 - off : last / 2 + off;

		if (k > last)
			continue;
		window(s, k);
		if (has_retract(s, s->zoom_from_s, s->zoom_to_s))
			return;
	}
	window(s, last / 2);
}

static void window_about(struct thin_survey *s, const struct thin_events *e)
{
	double t_s = e->at[e->n / 2].t_s;
	double room = fmin(3, (s->t_max - s->t_min) / 4);

	s->zoom_from_s = fmax(s->t_min, t_s - room);
	s->zoom_to_s = fmin(s->t_max, t_s + room);
}

static void choose_zoom(struct thin_survey *s)
{
	if (s->jumps.n >= ZOOM_JUMPS)
		window_of_jumps(s);
	else if (s->jumps.n)
		window_about(s, &s->jumps);
	else if (s->retracts.n)
		window_about(s, &s->retracts);
}

int survey_read(struct thin_survey *s, struct csv *c)
{
	enum csv_state before = CSV_NSTATES;
	struct csv_row r;
	int err;

	while ((err = csv_next(c, &r)) > 0) {
		err = take(s, &r, before);
		if (err < 0)
			return err;
		before = r.state;
	}
	if (err < 0)
		return err;
	if (s->rows == 0)
		return -ENODATA;
	choose_zoom(s);
	return 0;
}
