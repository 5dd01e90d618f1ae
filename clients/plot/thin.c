/* SPDX-License-Identifier: Apache-2.0 */
/* thin.c - the second reading of a trace: strips of time, points of the path */
#include "thin.h"
#include "survey.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The walk of the second reading. */
struct walk {
	double far_mm;			/* farthest place so far */
	double kept_mm;			/* place of the last point kept */
	bool cut;
	bool begun;
};

static void add(struct thin_bin *b, double v)
{
	if (b->n++ == 0)
		b->min = b->max = v;
	b->min = fmin(b->min, v);
	b->max = fmax(b->max, v);
	b->sum += v;
}

/* Strip of @t_s among @n from @from to @to; the end belongs to the last. */
static size_t strip(double t_s, double from, double to, size_t n)
{
	double u = to > from ? (t_s - from) / (to - from) : 0;
	double i = floor(u * (double)n);

	if (!(i > 0))
		return 0;
	return i < (double)n ? (size_t)i : n - 1;
}

static bool is_cut(enum csv_state s)
{
	return s == CSV_APPROACH || s == CSV_ERODE;
}

/*
 * Voltage and feed are shown of the cut alone: jumps are a hundred times as
 * fast and without power, and would hide what the servo does.  A trace with
 * no cut in it shows everything.
 */
static void take_strips(struct thin *t, const struct csv_row *r)
{
	const struct thin_survey *s = &t->survey;
	size_t i = strip(r->t_s, s->t_min, s->t_max, t->nbins);

	add(&t->place[i], r->s_mm);
	if (!isnan(r->gap_v) && (!s->cuts || r->state == CSV_ERODE ||
				 r->state == CSV_RETRACT))
		add(&t->gap[i], r->gap_v);
	if (!s->cuts || r->state == CSV_ERODE)
		add(&t->feed[i], r->feed_mm_s);
	t->share[strip(r->t_s, s->t_min, s->t_max, THIN_COLUMNS)][r->state]++;
}

static void keep(struct thin *t, struct walk *w, const struct csv_row *r)
{
	struct thin_point *p = &t->path[t->npath];

	if (t->npath == sizeof(t->path) / sizeof(t->path[0]))
		return;
	memcpy(p->axis_mm, r->axis_mm, sizeof(p->axis_mm));
	p->cut = w->cut;
	t->npath++;
	w->kept_mm = r->s_mm;
	w->begun = true;
}

/*
 * The path is drawn where new ground is gained, so each place of it is drawn
 * once however often jumps and retracts pass.
 */
static void take_path(struct thin *t, struct walk *w, const struct csv_row *r)
{
	const struct thin_survey *s = &t->survey;
	double least_mm = (s->s_max - s->s_min) / THIN_PATH;
	bool fresh = r->s_mm > w->far_mm;
	bool cut = is_cut(r->state);

	if (fresh)
		w->far_mm = r->s_mm;
	if (!w->begun || (fresh && r->s_mm - w->kept_mm >= least_mm)) {
		w->cut = cut;
		keep(t, w, r);
	}
}

static void take_zoom(struct thin *t, const struct csv_row *r)
{
	const struct thin_survey *s = &t->survey;
	size_t i;

	if (r->t_s < s->zoom_from_s || r->t_s > s->zoom_to_s || !t->nzoom)
		return;
	i = strip(r->t_s, s->zoom_from_s, s->zoom_to_s, t->nzoom);
	add(&t->zoom[i].place, r->s_mm);
	t->zoom[i].state = r->state;
}

/* As many strips as there are rows for, so that none stays empty by chance. */
static size_t strips_for(const struct thin_survey *s, double span_s, size_t max)
{
	double all_s = s->t_max - s->t_min;
	double rows = all_s > 0 ? (double)s->rows * span_s / all_s : 1;

	if (rows / 2 > (double)max)
		return max;
	return rows > 2 ? (size_t)(rows / 2) : 1;
}

static int fill(struct thin *t, struct csv *c)
{
	struct walk w = { .far_mm = -INFINITY };
	struct csv_row r;
	size_t done = 0;
	int err;

	while ((err = csv_next(c, &r)) > 0) {
		size_t i = strip(r.t_s, t->survey.t_min, t->survey.t_max,
				 t->nbins);

		take_strips(t, &r);
		take_path(t, &w, &r);
		take_zoom(t, &r);
		/* Strips passed over hold what was known before them. */
		for (; done < i; done++)
			t->far_mm[done + 1] = t->far_mm[done];
		t->far_mm[i] = w.far_mm;
	}
	return err;
}

static int thin_read(struct thin *t, struct csv *c)
{
	struct thin_survey *s = &t->survey;
	int err = survey_read(s, c);

	if (err < 0)
		return err;
	t->nbins = strips_for(s, s->t_max - s->t_min, THIN_BINS);
	if (s->zoom_to_s > s->zoom_from_s)
		t->nzoom = strips_for(s, s->zoom_to_s - s->zoom_from_s,
				      THIN_ZOOM);
	csv_rewind(c);
	return fill(t, c);
}

int thin_create(struct thin **ret, struct csv *c)
{
	struct thin *t = calloc(1, sizeof(*t));
	int err = t ? thin_read(t, c) : -ENOMEM;

	if (err == 0) {
		*ret = t;
		return 0;
	}
	thin_destroy(t);
	if (err != -EINVAL)
		fprintf(stderr, "%s: error: %s: %s\n", c->program, c->path,
			err == -ENODATA ?
			"no row behind the heading; some are wanted" :
			strerror(-err));
	return err;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* All but one mean in a hundred on either side, and as much again. */
void thin_span_of(struct thin_span *ret, const struct thin_bin *bin, size_t n)
{
	double mean[THIN_BINS];
	size_t m = 0;

	*ret = (struct thin_span) { 0 };
	for (size_t i = 0; i < n; i++) {
		if (bin[i].n == 0)
			continue;
		ret->min = m ? fmin(ret->min, bin[i].min) : bin[i].min;
		ret->max = m ? fmax(ret->max, bin[i].max) : bin[i].max;
		mean[m++] = bin[i].sum / (double)bin[i].n;
	}
	if (m == 0)
		return;
	qsort(mean, m, sizeof(mean[0]), by_value);
	ret->low = fmax(ret->min, fmin(0, 2 * mean[m / 100]));
	ret->high = fmin(ret->max, fmax(0, 2 * mean[m - 1 - m / 100]));
}

void thin_destroy(struct thin *t)
{
	if (!t)
		return;
	free(t->survey.jumps.at);
	free(t->survey.retracts.at);
	free(t);
}
