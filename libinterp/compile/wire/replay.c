/* SPDX-License-Identifier: Apache-2.0 */
/*
 * replay.c - a contour kept, to be cut several times
 */
#include "wire/replay.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CLOSED_PULSES	3.0

void contour_record(struct contour *k, const double here_mm[2])
{
	k->recording = true;
	k->here_mm[INTERP_X] = here_mm[0];
	k->here_mm[INTERP_Y] = here_mm[1];
	if (!guides_on(&k->guides))
		return;
	k->here_mm[INTERP_U] = here_mm[0];
	k->here_mm[INTERP_V] = here_mm[1];
}

void contour_recorded(struct contour *k, struct contour_tape *ret)
{
	*ret = (struct contour_tape) { k->m, k->n, k->n ? k->n - 1 : 0 };
	k->recording = false;
	k->m = NULL;
	k->room = k->n = k->ntodo = 0;
	k->last_offset_mm = k->last_slope = 0;
}

bool contour_tape_is_whole(const struct contour_tape *t, double pulse_mm)
{
	if (t->n < 3 || !t->m[0].lead || !t->m[t->n - 1].lead)
		return false;
	for (uint32_t i = 1; i + 1 < t->n; i++) {
		if (t->m[i].lead || t->m[i].offset_mm == 0)
			return false;
	}
	for (int p = 0; p < 2; p++) {
		if (curve_distance(t->m[1].c[p].from, t->m[t->n - 2].c[p].to) >
		    CLOSED_PULSES * pulse_mm)
			return false;
	}
	return true;
}

static double length_of(const struct contour_motion *m)
{
	return fmax(curve_length(&m->c[0]), curve_length(&m->c[1]));
}

double contour_tape_length(const struct contour_tape *t, uint32_t first,
			   uint32_t end)
{
	double sum = 0;

	for (uint32_t i = first; i < end; i++)
		sum += length_of(&t->m[i]);
	return sum;
}

/* Share @t0 to @t1 of a motion. */
static struct contour_motion part_of(const struct contour_motion *m, double t0,
				     double t1)
{
	struct contour_motion part = *m;

	for (int p = 0; p < 2; p++)
		part.c[p] = curve_part(&m->c[p], t0, t1);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double way = m->end_mm[i] - m->from_mm[i];

		part.from_mm[i] = m->from_mm[i] + t0 * way;
		part.end_mm[i] = m->from_mm[i] + t1 * way;
	}
	return part;
}

int contour_tape_split(struct contour_tape *t, double tab_mm)
{
	uint32_t i = t->n - 2;
	struct contour_motion *m;
	double left = tab_mm, at;

	if (!(contour_tape_length(t, 1, t->n - 1) > tab_mm))
		return -ERANGE;
	while (left > length_of(&t->m[i]))
		left -= length_of(&t->m[i--]);
	m = realloc(t->m, (t->n + 1) * sizeof(*m));
	if (!m)
		return -ENOMEM;
	t->m = m;
	at = 1 - left / length_of(&m[i]);
	memmove(&m[i + 1], &m[i], (t->n - i) * sizeof(*m));
	m[i] = part_of(&m[i], 0, at);
	m[i + 1] = part_of(&m[i + 1], at, 1);
	t->n++;
	t->tab = i + 1;
	return 0;
}

static struct contour_motion reversed(const struct contour_motion *m)
{
	struct contour_motion back = *m;

	for (int p = 0; p < 2; p++)
		back.c[p] = curve_reversed(&m->c[p]);
	memcpy(back.from_mm, m->end_mm, sizeof(back.from_mm));
	memcpy(back.end_mm, m->from_mm, sizeof(back.end_mm));
	back.offset_mm = -m->offset_mm;
	back.slope = -m->slope;
	return back;
}

static void set_word(struct contour_motion *m, const struct contour_pass *p)
{
	const uint32_t line = m->word.line;
	const bool rapid = m->word.rapid;

	m->word = *p->word;
	m->word.line = line;
	m->word.rapid = rapid;
}

/* A lead has the offset behind it: one that leads out has none. */
static void set_offset(struct contour_motion *m, const struct contour_tape *t,
		       uint32_t i, const struct contour_pass *p)
{
	const double side = t->m[1].offset_mm > 0 ? 1 : -1;
	const bool out = p->back ? i == 0 : i == t->n - 1;

	m->offset_mm = out ? 0 : (p->back ? -side : side) * p->offset_mm;
	if (out)
		m->slope = 0;
}

int contour_play(struct contour *k, const struct contour_tape *t,
		 const uint32_t range[2], const struct contour_pass *p,
		 struct interp_diag *diag)
{
	for (uint32_t j = range[0]; j < range[1]; j++) {
		const uint32_t i = p->back ? range[1] - 1 - (j - range[0]) : j;
		struct contour_motion m = p->back ? reversed(&t->m[i]) :
						    t->m[i];
		int err;

		set_word(&m, p);
		set_offset(&m, t, i, p);
		m.todo = k->ntodo;
		m.ntodo = 0;
		err = contour_keep(k, &m, diag);
		if (err)
			return err;
	}
	return 0;
}

int contour_play_step(struct contour *k, const struct contour_pass *p,
		      struct interp_diag *diag)
{
	struct contour_motion m = k->m[k->n - 1];

	set_word(&m, p);
	return contour_keep_step(k, &m, diag);
}
