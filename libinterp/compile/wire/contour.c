/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour.c - between a reader and the builder: what is collected
 */
#include "wire/contour.h"
#include "wire/to_build.h"

#include "interp/angle.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where the axes stand, in the places of the program. */
static void begin_here(struct contour *k)
{
	guides_here(&k->guides, k->here_mm);
	guides_planes(&k->guides, k->here_mm, k->at);
	if (!guides_on(&k->guides))
		return;
	k->here_mm[INTERP_X] = k->at[0].x;
	k->here_mm[INTERP_Y] = k->at[0].y;
	k->here_mm[INTERP_U] = k->at[1].x;
	k->here_mm[INTERP_V] = k->at[1].y;
}

void contour_init(struct contour *k, const struct interp_wire *w,
		  const struct interp_machine *m, struct interp_build *b)
{
	*k = (struct contour) { .n = 0 };
	k->corner = (enum interp_taper_corner)w->corner;
	guides_init(&k->guides, w, m, b);
	k->plain = !guides_on(&k->guides) && !(w->corner_angle_deg < 180);
	begin_here(k);
}

int contour_turn(struct contour *k, double deg, bool mirrored,
		 struct interp_diag *diag)
{
	int err;

	if (deg == k->guides.turn.deg && mirrored == k->guides.turn.mirrored)
		return 0;
	err = contour_flush(k, diag);
	if (err)
		return err;
	k->guides.turn = interp_turn_of(deg, mirrored);
	begin_here(k);
	return 0;
}

void contour_free(struct contour *k)
{
	free(k->m);
	free(k->todo);
	k->m = NULL;
	k->todo = NULL;
}

void contour_side(struct contour *k, double offset_mm, double slope)
{
	k->offset_mm = offset_mm;
	k->slope = slope;
}

double contour_tangent(const struct contour *k, double deg)
{
	if (!(fabs(deg) <= k->guides.wire->angle_max_deg))
		return NAN;
	return tan(deg * ANGLE_DEGREE);
}

int contour_set_taper(const struct contour *k, double deg, double *ret,
		      struct interp_diag *diag)
{
	*ret = contour_tangent(k, deg);
	diag->line = diag->column = 0;
	if (deg != 0 && !guides_on(&k->guides))
		return interp_diag_say(diag, "a taper on a machine without "
				       "wire guides; wire.guides absolute or "
				       "relative in the machine file");
	if (isnan(*ret))
		return interp_diag_say(diag, "a taper that leans too far; up "
				       "to wire.angle_max_deg");
	return 0;
}

/* -- Collected ------------------------------------------------------------ */

static bool is_on(double offset_mm, double slope)
{
	return offset_mm != 0 || slope != 0;
}

/* All bits but that of the sign: 0 if @v is 0. */
static inline uint64_t bits(double v)
{
	uint64_t b;

	memcpy(&b, &v, sizeof(b));
	return b << 1;
}

/* Nothing in force, nothing held: no business of this stage. */
static inline bool is_idle(const struct contour *k)
{
	return k->plain && !k->n && !k->recording &&
	       !(bits(k->end.mm) | bits(k->offset_mm) | bits(k->slope) |
		 bits(k->last_offset_mm) | bits(k->last_slope));
}

static int refuse_record(const struct contour *k, struct interp_diag *diag)
{
	diag->line = k->n ? k->m[k->n - 1].word.line : 0;
	return interp_diag_say(diag, "a contour of G151 has motions, offset "
			       "and taper alone; put other words in front of "
			       "or behind it");
}

/* Does the last motion wait for the next one, to round their corner? */
static bool has_corner(const struct contour *k)
{
	return k->n && k->m[k->n - 1].end.mm != 0;
}

int contour_flush(struct contour *k, struct interp_diag *diag)
{
	const int err = k->recording ? refuse_record(k, diag) :
			has_corner(k) ? contour_refuse_corner(k, diag) :
					contour_release(k, NULL, diag);

	return err ? err : interp_build_flush(k->guides.build, diag);
}

static void stand(struct contour *k, const double end_mm[INTERP_NAXES])
{
	memcpy(k->here_mm, end_mm, sizeof(k->here_mm));
	k->at[0] = k->at[1] = (struct vec) { end_mm[INTERP_X],
					     end_mm[INTERP_Y] };
}

bool contour_leads(const struct contour *k)
{
	const double was = k->last_offset_mm, is = k->offset_mm;

	if (was != 0 || is != 0)
		return (was != 0) != (is != 0);
	return (k->last_slope != 0) != (k->slope != 0);
}

/* Does the wire change from one side of the contour to the other? */
static bool crosses(const struct contour *k)
{
	return k->last_offset_mm * k->offset_mm < 0;
}

static int check_lead(const struct contour *k, const struct contour_motion *m,
		      struct interp_diag *diag)
{
	const double by = fabs(k->offset_mm - k->last_offset_mm);

	return m->lead && curve_length(&m->c[0]) <= by ?
	       contour_refuse_lead(m, by, diag) : 0;
}

int contour_keep(struct contour *k, const struct contour_motion *m,
		 struct interp_diag *diag)
{
	if (k->n == CONTOUR_MOTIONS_MAX)
		return contour_refuse_length(&m->word, diag);
	if (k->n == k->room && grow_array(&k->m, &k->room, sizeof(*k->m)))
		return -ENOMEM;
	k->m[k->n++] = *m;
	return 0;
}

int contour_keep_step(struct contour *k, const struct contour_motion *m,
		      struct interp_diag *diag)
{
	struct contour_motion step = *m;

	for (int p = 0; p < 2; p++)
		step.c[p] = curve_line(m->c[p].to, m->c[p].to);
	memcpy(step.from_mm, m->end_mm, sizeof(step.from_mm));
	step.lead = step.step = true;
	step.todo = k->ntodo;
	step.ntodo = 0;
	return contour_keep(k, &step, diag);
}

/* On the spot where the last motion ended: the next one holds its own side from
 * its start. */
static int cross_over(struct contour *k, const struct contour_motion *next,
		      struct interp_diag *diag)
{
	struct contour_motion m = *next;

	for (int p = 0; p < 2; p++)
		m.c[p].to = m.c[p].from;
	memcpy(m.end_mm, m.from_mm, sizeof(m.end_mm));
	return contour_keep_step(k, &m, diag);
}

static int take_one(struct contour *k, struct contour_motion *m,
		    struct interp_diag *diag)
{
	const bool corner = has_corner(k);
	int err;

	m->offset_mm = k->offset_mm;
	m->slope = k->slope;
	m->corner = k->corner;
	m->lead = contour_leads(k);
	for (int p = 0; !m->lead && p < 2; p++)
		m->c[p] = curve_evened(&m->c[p]);
	err = check_lead(k, m, diag);
	if (!err && corner)
		err = contour_cut_corner(k, m, diag);
	if (err == 1) {
		k->end.mm = 0;
		memcpy(k->here_mm, m->end_mm, sizeof(k->here_mm));
		return 0;
	}
	if (!err && crosses(k))
		err = cross_over(k, m, diag);
	if (!err && !is_on(k->last_offset_mm, k->last_slope) && !k->recording)
		err = contour_release(k, m, diag);
	m->todo = k->ntodo;
	if (!err)
		err = contour_keep(k, m, diag);
	k->last_offset_mm = k->offset_mm;
	k->last_slope = k->slope;
	/* It was held back for the corner alone. */
	if (!err && corner && k->plain && !k->recording && !has_corner(k) &&
	    !is_on(k->offset_mm, k->slope))
		err = contour_release(k, NULL, diag);
	k->end.mm = 0;
	memcpy(k->here_mm, m->end_mm, sizeof(k->here_mm));
	return err;
}

/*
 * On an arc that nearly comes back to its start, a rounding of its ends would
 * move the centre by far more, to have both ends on one circle: a keyhole of 5
 * mm with a neck of 0.3 mm by 17 roundings.  Its halves have a diameter
 * between their ends.
 */
static bool wants_halves(const struct contour *k, const struct curve *c)
{
	return fabs(c->sweep) > 2 * ANGLE_RIGHT &&
	       fabs(curve_uneven(c)) > k->guides.pulse_mm / 2;
}

static int take_halves(struct contour *k, const struct contour_motion *m,
		       struct interp_diag *diag)
{
	struct contour_motion half[2] = { *m, *m };
	double *mid = half[0].end_mm;
	int err;

	half[0].end.mm = 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		mid[i] = (m->from_mm[i] + m->end_mm[i]) / 2;
	for (int p = 0; p < 2; p++) {
		struct curve part[2];

		curve_halved(&m->c[p], part);
		half[0].c[p] = part[0];
		half[1].c[p] = part[1];
		if (p && !guides_on(&k->guides))
			continue;
		mid[p ? INTERP_U : INTERP_X] = part[0].to.x;
		mid[p ? INTERP_V : INTERP_Y] = part[0].to.y;
	}
	memcpy(half[1].from_mm, mid, sizeof(half[1].from_mm));
	err = take_one(k, &half[0], diag);
	return err ? err : take_one(k, &half[1], diag);
}

static int take(struct contour *k, struct contour_motion *m,
		struct interp_diag *diag)
{
	if (!contour_leads(k) && (wants_halves(k, &m->c[0]) ||
				  wants_halves(k, &m->c[1])))
		return take_halves(k, m, diag);
	return take_one(k, m, diag);
}

/* -- In -------------------------------------------------------------------- */

static struct vec place(const double at_mm[INTERP_NAXES], bool top)
{
	return (struct vec) { at_mm[top ? INTERP_U : INTERP_X],
			      at_mm[top ? INTERP_V : INTERP_Y] };
}

static void motion_init(const struct contour *k, struct contour_motion *m,
			const double end_mm[INTERP_NAXES],
			const struct interp_build_word *w)
{
	*m = (struct contour_motion) { .word = *w, .end = k->end };
	memcpy(m->from_mm, k->here_mm, sizeof(m->from_mm));
	memcpy(m->end_mm, end_mm, sizeof(m->end_mm));
	m->c[0] = curve_line(place(k->here_mm, false), place(end_mm, false));
	m->c[1] = guides_on(&k->guides) ?
		  curve_line(place(k->here_mm, true), place(end_mm, true)) :
		  m->c[0];
}

static bool moves(const struct contour *k, const double end_mm[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (fabs(end_mm[i] - k->here_mm[i]) > CURVE_SAME_MM)
			return true;
	}
	return false;
}

/* A line on which neither contour moves: only other axes do, or none. */
static int stay(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_word *w, struct interp_diag *diag)
{
	double to_mm[INTERP_NAXES], at_mm[INTERP_NAXES];
	int err;

	if (!moves(k, end_mm))
		return 0;
	if (is_on(k->last_offset_mm, k->last_slope))
		return contour_refuse_alone(w, diag);
	err = contour_flush(k, diag);
	if (err)
		return err;
	memcpy(to_mm, end_mm, sizeof(to_mm));
	guides_here(&k->guides, at_mm);
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (i <= INTERP_Y || (i >= INTERP_U && guides_on(&k->guides)))
			to_mm[i] = at_mm[i];
	}
	memcpy(k->here_mm, end_mm, sizeof(k->here_mm));
	err = guides_line(&k->guides, to_mm, w, diag);
	if (err == -EINVAL)
		diag->line = w->line;
	return err;
}

/*
 * A motion of no length has no direction, so no offset can be square to it.  As
 * a lead it is refused: the next motion would be the lead, and cut into the
 * part.
 */
static int take_or_stay(struct contour *k, struct contour_motion *m,
			struct interp_diag *diag)
{
	if (fmax(curve_length(&m->c[0]), curve_length(&m->c[1])) >=
	    CURVE_SAME_MM)
		return take(k, m, diag);
	if (k->end.mm != 0)
		return contour_refuse_still(m, diag);
	if (contour_leads(k) && k->offset_mm != 0 && !moves(k, m->end_mm))
		return contour_refuse_lead(m, fabs(k->offset_mm), diag);
	return stay(k, m->end_mm, &m->word, diag);
}

/* Most lines are none of these, and need no room for one. */
__attribute__((noinline))
static int collect_line(struct contour *k, const double end_mm[INTERP_NAXES],
			const struct interp_build_word *w,
			struct interp_diag *diag)
{
	struct contour_motion m;

	motion_init(k, &m, end_mm, w);
	return take_or_stay(k, &m, diag);
}

int contour_line(struct contour *k, const double end_mm[INTERP_NAXES],
		 const struct interp_build_word *w, struct interp_diag *diag)
{
	int err;

	if (!is_idle(k))
		return collect_line(k, end_mm, w, diag);
	stand(k, end_mm);
	err = guides_line(&k->guides, end_mm, w, diag);
	if (err == -EINVAL)
		diag->line = w->line;
	return err;
}

/* The wire keeps its lean: the top goes round as the bottom does. */
static int take_arc(struct contour *k, struct contour_motion *m,
		    const struct interp_build_arc *arc,
		    struct interp_diag *diag)
{
	const struct vec centre = { arc->centre_a_mm, arc->centre_b_mm };
	const struct vec lean = { m->c[1].from.x - m->c[0].from.x,
				  m->c[1].from.y - m->c[0].from.y };

	m->c[0] = curve_arc(m->c[0].from, m->c[0].to, centre, arc->sweep);
	m->c[1] = curve_arc(m->c[1].from, m->c[1].to, vec_add(centre, 1, lean),
			    arc->sweep);
	return take_or_stay(k, m, diag);
}

int contour_arc(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_arc *arc,
		const struct interp_build_word *w, struct interp_diag *diag)
{
	struct contour_motion m;
	int err;

	if (is_idle(k)) {
		err = guides_arc(&k->guides, end_mm, arc, w, diag);
		if (err == -EINVAL)
			diag->line = w->line;
		stand(k, end_mm);
		return err;
	}
	if (arc->axis_a != INTERP_X)
		return contour_refuse_plane(w, diag);
	motion_init(k, &m, end_mm, w);
	return take_arc(k, &m, arc, diag);
}

int contour_two(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_contour c[2],
		const struct interp_build_word *w, struct interp_diag *diag)
{
	struct contour_motion m;

	motion_init(k, &m, end_mm, w);
	for (int p = 0; p < 2; p++) {
		const struct vec centre = { c[p].centre_mm[0],
					    c[p].centre_mm[1] };

		if (c[p].arc)
			m.c[p] = curve_arc(m.c[p].from, m.c[p].to, centre,
					   c[p].sweep);
	}
	return take_or_stay(k, &m, diag);
}

int contour_nurbs(struct contour *k, const double end_mm[INTERP_NAXES],
		  const struct interp_build_curve *c,
		  const struct interp_build_word *w, struct interp_diag *diag)
{
	int err;

	if (!is_idle(k)) {
		err = contour_cut_nurbs(k, end_mm, c, w, diag);
		return err ? err : 1;
	}
	err = guides_curve(&k->guides, c, w, diag);
	if (err == -EINVAL && !diag->line)
		diag->line = w->line;
	stand(k, end_mm);
	return err;
}

static int put_off(struct contour *k, const struct contour_action *a)
{
	if (k->ntodo == k->todo_room &&
	    grow_array(&k->todo, &k->todo_room, sizeof(*k->todo)))
		return -ENOMEM;
	k->todo[k->ntodo++] = *a;
	k->m[k->n - 1].ntodo++;
	return 0;
}

int contour_action(struct contour *k, enum interp_kind kind, uint32_t arg,
		   const struct interp_build_word *w, struct interp_diag *diag)
{
	int err;

	if (k->recording)
		return refuse_record(k, diag);
	if (k->n && kind != INTERP_END)
		return put_off(k, &(struct contour_action) { kind, arg, *w });
	err = contour_flush(k, diag);
	if (!err)
		err = interp_build_action(k->guides.build, kind, arg, w, diag);
	if (err == -EINVAL && !diag->line)
		diag->line = w->line;
	return err;
}
