/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flat.c - a program's path as points to draw
 */
#include "flat.h"

#include "interp/at.h"
#include "interp/program.h"
#include "interp/wire.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_MAX	512		/* most points of one curved segment */
#define EXTENT_SHARE	2000.0

struct walk {
	struct flat *flat;
	const struct interp_program *p;
	struct interp_at_curve curve;
	double last_mm[5];		/* X Y Z U V of the last point that was
					 * kept */
	bool any;
	bool measure;			/* only find the extent */
};

struct spot {
	double mm[5];
	double s_mm;
	uint32_t line;
	uint8_t kind;
	bool keep;			/* turns by more than this are a corner
					 * at any distance */
};

static int grow(struct flat *f)
{
	const struct {
		void *at;
		size_t bytes;
	} all[] = {
		{ &f->at_mm, 3 * sizeof(*f->at_mm) },
		{ &f->upper_mm, 2 * sizeof(*f->upper_mm) },
		{ &f->s_mm, sizeof(*f->s_mm) },
		{ &f->line, sizeof(*f->line) },
		{ &f->kind, sizeof(*f->kind) },
	};
	size_t room = 0;

	for (size_t i = 0; i < sizeof(all) / sizeof(*all); i++) {
		room = f->room;
		if (grow_array(all[i].at, &room, all[i].bytes))
			return -ENOMEM;
	}
	f->room = room;
	return 0;
}

static void widen(struct flat *f, const double mm[5], bool first)
{
	for (int i = 0; i < 3; i++) {
		f->min_mm[i] = first ? mm[i] : fmin(f->min_mm[i], mm[i]);
		f->max_mm[i] = first ? mm[i] : fmax(f->max_mm[i], mm[i]);
	}
}

static int keep(struct walk *w, const struct spot *at)
{
	struct flat *f = w->flat;

	if (f->n == f->room && grow(f) < 0)
		return -ENOMEM;
	if (f->n == 0)
		memcpy(f->origin_mm, at->mm, sizeof(f->origin_mm));
	for (int i = 0; i < 3; i++)
		f->at_mm[3 * f->n + (size_t)i] =
			(float)(at->mm[i] - f->origin_mm[i]);
	for (int i = 0; i < 2; i++)
		f->upper_mm[2 * f->n + (size_t)i] =
			(float)(at->mm[3 + i] + (f->rides ? at->mm[i] : 0));
	f->s_mm[f->n] = at->s_mm;
	f->line[f->n] = at->line;
	f->kind[f->n] = at->kind;
	f->n++;
	memcpy(w->last_mm, at->mm, sizeof(w->last_mm));
	return 0;
}

static double distance(const double a[5], const double b[5])
{
	double sum = 0;

	for (int i = 0; i < 5; i++)
		sum += (a[i] - b[i]) * (a[i] - b[i]);
	return sqrt(sum);
}

/* A point that is nearer to the last one than the tolerance is left out. */
static int offer(struct walk *w, const struct spot *at)
{
	if (w->measure) {
		widen(w->flat, at->mm, !w->any);
		w->any = true;
		return 0;
	}
	if (w->flat->n > 0 && !at->keep &&
	    distance(at->mm, w->last_mm) < w->flat->tolerance_mm)
		return 0;
	return keep(w, at);
}

static int slot_of(int axis)
{
	return axis <= INTERP_Z ? axis : axis == INTERP_U ? 3 :
	       axis == INTERP_V ? 4 : -1;
}

static void node_at(const struct walk *w, uint32_t i, double mm[5])
{
	const struct interp_program_head *h = w->p->head;

	memset(mm, 0, 5 * sizeof(*mm));
	for (int a = 0; a < INTERP_NAXES; a++)
		if (slot_of(a) >= 0)
			mm[slot_of(a)] = h->start_pulses[a] * h->pulse_mm[a];
	for (uint32_t j = 0; j < h->naxes; j++) {
		const int64_t sub = w->p->nodes[(size_t)i * h->naxes + j];
		const int slot = slot_of(h->column[j]);

		if (slot >= 0)
			mm[slot] = (double)sub / INTERP_SUB *
				   h->pulse_mm[h->column[j]];
	}
}

static uint8_t kind_of(const struct interp_seg *s)
{
	if (s->flags & INTERP_SEG_SENSED)
		return FLAT_PROBE;
	return s->flags & INTERP_SEG_RAPID ? FLAT_RAPID : FLAT_CUT;
}

static int steps_of(const struct walk *w, const struct interp_seg *s)
{
	const double fine = w->measure ? s->length_mm / 16 :
			    w->flat->tolerance_mm * 4;
	double n;

	if (s->kind == INTERP_LINE)
		return 1;
	n = ceil(s->length_mm / fmax(fine, 1e-6));
	return n < 8 ? 8 : n > STEPS_MAX ? STEPS_MAX : (int)n;
}

static bool point_at(struct walk *w, uint32_t i, double t, struct spot *at)
{
	const struct interp_seg *s = &w->p->segs[i];
	struct interp_contour_point c;

	if (!interp_program_any_at(w->p, i, t * s->length_mm, &w->curve, &c))
		return false;
	node_at(w, i, at->mm);
	for (uint32_t j = 0; j < w->p->head->naxes; j++)
		if (slot_of(w->p->head->column[j]) >= 0)
			at->mm[slot_of(w->p->head->column[j])] = c.mm[j];
	return true;
}

static int walk_segment(struct walk *w, uint32_t i)
{
	const struct interp_seg *s = &w->p->segs[i];
	struct spot at = { .line = s->line, .kind = kind_of(s) };
	const uint8_t before = w->flat->n ? w->flat->kind[w->flat->n - 1] :
					    at.kind;
	const int steps = steps_of(w, s);
	int err = 0;

	/* The colour changes where the kind changes. */
	if (before != at.kind) {
		struct spot edge = at;

		node_at(w, i, edge.mm);
		edge.s_mm = s->s_mm;
		edge.kind = before;
		edge.keep = true;
		err = offer(w, &edge);
	}
	for (int k = 1; k < steps && err == 0; k++) {
		at.s_mm = s->s_mm + s->length_mm * k / steps;
		if (point_at(w, i, (double)k / steps, &at))
			err = offer(w, &at);
	}
	node_at(w, i + 1, at.mm);
	at.s_mm = s->s_mm + s->length_mm;
	at.keep = before != at.kind;
	return err ? err : offer(w, &at);
}

static int walk_all(struct walk *w)
{
	const uint32_t nsegs = w->p->head->nsegs;
	struct spot at = { .keep = true };
	int err;

	node_at(w, 0, at.mm);
	err = offer(w, &at);
	for (uint32_t i = 0; i < nsegs && err == 0; i++) {
		struct interp_seg seg = w->p->segs[i];

		if (!interp_program_seg_ok(w->p, i, &seg))
			return -EBADMSG;
		if (seg.kind < INTERP_BEGIN)
			err = walk_segment(w, i);
		if (w->flat->n > FLAT_POINTS_MAX)
			return -E2BIG;
	}
	if (err)
		return err;
	/* The end is drawn even if it is near to the last point. */
	node_at(w, nsegs, at.mm);
	at.s_mm = w->p->head->length_mm;
	at.line = nsegs ? w->p->segs[nsegs - 1].line : 0;
	at.kind = w->flat->n ? w->flat->kind[w->flat->n - 1] : FLAT_CUT;
	return offer(w, &at);
}

static void measure(struct flat *f, const struct interp_program *p)
{
	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		if (p->segs[i].kind >= INTERP_BEGIN)
			continue;
		if (p->segs[i].flags & INTERP_SEG_RAPID)
			f->rapid_mm += p->segs[i].length_mm;
		else
			f->cut_mm += p->segs[i].length_mm;
	}
	for (uint32_t j = 0; j < p->head->naxes; j++)
		f->has_upper = f->has_upper || p->head->column[j] == INTERP_U ||
			       p->head->column[j] == INTERP_V;
}

static double extent(const struct flat *f)
{
	double most = 0;

	for (int i = 0; i < 3; i++)
		most = fmax(most, f->max_mm[i] - f->min_mm[i]);
	return most > 0 ? most : 1;
}

int flat_make(struct flat *f, const struct interp_program *p, int guides,
	      double tolerance_mm)
{
	struct walk w = { .flat = f, .p = p, .measure = true };
	int err;

	*f = (struct flat) { .rides = guides == INTERP_GUIDES_RELATIVE };
	measure(f, p);
	err = walk_all(&w);
	if (err)
		return err;
	f->tolerance_mm = tolerance_mm > 0 ? tolerance_mm :
			  extent(f) / EXTENT_SHARE;
	do {
		w = (struct walk) { .flat = f, .p = p };
		f->n = 0;
		err = walk_all(&w);
		if (err == -E2BIG)
			f->tolerance_mm *= 2;
	} while (err == -E2BIG);
	return err;
}

void flat_fini(struct flat *f)
{
	free(f->at_mm);
	free(f->upper_mm);
	free(f->s_mm);
	free(f->line);
	free(f->kind);
	*f = (struct flat) { .n = 0 };
}
