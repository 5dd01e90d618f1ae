/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour.c - between a reader and the builder: wire offset, taper, corners
 */
#include "wire/contour.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define DEGREE		(3.14159265358979323846 / 180)
#define SAME_MM		1e-9		/* two places that are one */

void contour_init(struct contour *k, const struct interp_wire *w,
		  const struct interp_machine *m, struct interp_build *b)
{
	*k = (struct contour) { .held = false };
	guides_init(&k->guides, w, m, b);
	memcpy(k->here_mm, interp_build_here(b), sizeof(k->here_mm));
	guides_planes(&k->guides, k->here_mm, k->at);
	if (!guides_on(&k->guides))
		return;
	k->here_mm[INTERP_X] = k->at[0].x;
	k->here_mm[INTERP_Y] = k->at[0].y;
	k->here_mm[INTERP_U] = k->at[1].x;
	k->here_mm[INTERP_V] = k->at[1].y;
}

/* A leaning wire's section by the plane is an ellipse: the face is touched
 * at offset / cos(angle). */
void contour_side(struct contour *k, double offset_mm, double slope)
{
	k->d[0] = offset_mm * sqrt(1 + slope * slope);
	k->d[1] = k->d[0] + slope * k->guides.height_mm;
}

double contour_tangent(const struct contour *k, double deg)
{
	if (!(fabs(deg) <= k->guides.wire->angle_max_deg))
		return NAN;
	return tan(deg * DEGREE);
}

/* -- Refusals ------------------------------------------------------------- */

static const char *plane_name(int p)
{
	return p ? " on the second plane" : "";
}

static int refuse_radius(const struct contour_motion *m, int p,
			 struct interp_diag *diag)
{
	diag->line = m->word.line;
	return interp_diag_say(diag, "an inside radius of %.4f mm under an "
			       "offset of %.4f mm%s; a radius of the offset "
			       "or more, or a smaller offset", m->c[p].r,
			       fabs(m->d[p]), plane_name(p));
}

static int refuse_gouge(const struct contour_motion *m, int p,
			struct interp_diag *diag)
{
	diag->line = m->word.line;
	return interp_diag_say(diag, "nothing is left of a motion of %.4f mm "
			       "under an offset of %.4f mm%s; inner corners "
			       "with room for the wire, or a smaller offset",
			       curve_length(&m->c[p]), fabs(m->d[p]),
			       plane_name(p));
}

static int refuse_lead(const struct contour_motion *m, double by_mm,
		       struct interp_diag *diag)
{
	const bool arc = m->c[0].arc;

	diag->line = m->word.line;
	if (arc)
		snprintf(diag->found, sizeof(diag->found),
			 "an arc where the offset or taper changes");
	else
		snprintf(diag->found, sizeof(diag->found),
			 "a lead of %.4f mm for a change of offset of %.4f mm",
			 curve_length(&m->c[0]), by_mm);
	snprintf(diag->wanted, sizeof(diag->wanted),
		 "G0 or G1 %s", arc ? "behind G40 ... G42 and G50 ... G52" :
		 "longer than the offset, square to the contour if it can be");
	return -EINVAL;
}

static int refuse_todo(const struct contour_motion *m, struct interp_diag *diag)
{
	diag->line = m->word.line;
	return interp_diag_say(diag, "more than %d actions behind a motion; "
			       "fewer of them, or no offset", CONTOUR_TODO_MAX);
}

/* -- Out ------------------------------------------------------------------- */

/* Share @t0 to @t1 of a motion along @c. */
static int cut_part(struct contour *k, const struct curve c[2],
		    const double t[2], const struct interp_build_word *w,
		    struct interp_diag *diag)
{
	const struct curve part[2] = { curve_part(&c[0], t[0], t[1]),
				       curve_part(&c[1], t[0], t[1]) };
	double end_mm[INTERP_NAXES];
	int r;

	for (int i = 0; i < INTERP_NAXES; i++)
		end_mm[i] = t[1] >= 1 ? k->m.end_mm[i] : k->m.from_mm[i] +
			    t[1] * (k->m.end_mm[i] - k->m.from_mm[i]);
	r = guides_cut(&k->guides, part, end_mm, w, diag);
	if (r == -EINVAL)
		diag->line = w->line;
	return r;
}

/* Does corner control ask for care in front of @next? */
static bool is_corner(const struct contour *k, const struct contour_motion *next)
{
	const double least = k->guides.wire->corner_angle_deg * DEGREE;
	const int p = k->m.point[0] || (next && next->point[0]);

	return next && least < 180 * DEGREE && !k->m.word.rapid &&
	       !next->word.rapid &&
	       fabs(contour_turn(&k->m, next, p)) >= least - 1e-9;
}

/* The motion held, its last part slower if a corner follows. */
static int cut_held(struct contour *k, const struct curve c[2],
		    bool corner, struct interp_diag *diag)
{
	const struct interp_wire *w = k->guides.wire;
	const double len = fmax(curve_length(&c[0]), curve_length(&c[1]));
	const double before = fmin(w->corner_before_mm, len);
	const double at = len > 0 ? 1 - before / len : 0;
	const double full[2] = { 0, corner && before > 0 ? at : 1 };
	const double slow[2] = { at, 1 };
	struct interp_build_word word = k->m.word;
	int r = 0;

	if (full[1] > 0)
		r = cut_part(k, c, full, &word, diag);
	if (r < 0 || full[1] == 1)
		return r;
	word.feed_mm_s *= w->corner_feed_percent / 100;
	return cut_part(k, c, slow, &word, diag);
}

static int do_todo(struct contour *k, struct interp_diag *diag)
{
	for (uint32_t i = 0; i < k->ntodo; i++) {
		const struct contour_action *a = &k->todo[i];
		const int r = interp_build_action(k->guides.build, a->kind,
						  a->arg, &a->word, diag);

		if (r == -EINVAL)
			diag->line = a->word.line;
		if (r < 0)
			return r;
	}
	k->ntodo = 0;
	return 0;
}

/* Wait on the corner, then what the program asked for there. */
static int do_corner(struct contour *k, bool corner, struct interp_diag *diag)
{
	const double s = k->guides.wire->corner_dwell_s;
	int r = 0;

	if (corner && s > 0)
		r = interp_build_action(k->guides.build, INTERP_DWELL,
					(uint32_t)(s * 1000 + 0.5),
					&k->m.word, diag);
	return r < 0 ? r : do_todo(k, diag);
}

static int cut_fill(struct contour *k, const struct contour_join j[2],
		    struct interp_diag *diag)
{
	const double whole[2] = { 0, 1 };
	struct curve c[2];

	if (!j[0].filled && !j[1].filled)
		return 0;
	for (int p = 0; p < 2; p++)
		c[p] = j[p].filled ? j[p].fill :
				     curve_line(j[p].end, j[p].start);
	return cut_part(k, c, whole, &k->m.word, diag);
}

/* End the motion held in front of @next, NULL if nothing follows. */
static int release(struct contour *k, const struct contour_motion *next,
		   struct interp_diag *diag)
{
	const bool corner = is_corner(k, next);
	struct contour_join j[2];
	struct curve c[2];
	int r;

	for (int p = 0; p < 2; p++) {
		if (!contour_join(&k->m, next, p, k->guides.pulse_mm, &j[p]))
			return refuse_gouge(&k->m, p, diag);
		c[p] = k->m.parallel[p];
		if (k->m.ramp[p] || k->m.point[p])
			c[p] = curve_line(k->at[p], j[p].end);
		else if (!curve_trim(&c[p], k->at[p], j[p].end))
			return refuse_gouge(&k->m, p, diag);
	}
	r = cut_held(k, c, corner, diag);
	if (!r)
		r = do_corner(k, corner, diag);
	if (!r)
		r = cut_fill(k, j, diag);
	for (int p = 0; p < 2; p++)
		k->at[p] = j[p].start;
	k->held = false;
	return r;
}

int contour_flush(struct contour *k, struct interp_diag *diag)
{
	const int r = k->held ? release(k, NULL, diag) : 0;

	return r ? r : interp_build_flush(k->guides.build, diag);
}

/* -- In -------------------------------------------------------------------- */

/* Nothing in force, nothing held: no business of this stage. */
static bool is_idle(const struct contour *k)
{
	return !k->held && !guides_on(&k->guides) && k->d[0] == 0 &&
	       k->d_end[0] == 0 &&
	       !(k->guides.wire->corner_angle_deg < 180);
}

static void stand(struct contour *k, const double end_mm[INTERP_NAXES])
{
	memcpy(k->here_mm, end_mm, sizeof(k->here_mm));
	if (guides_on(&k->guides) || k->d[0] != 0 || k->d_end[0] != 0)
		return;
	k->at[0] = k->at[1] = (struct vec) { end_mm[INTERP_X],
					     end_mm[INTERP_Y] };
}

/* Distances, ramps and parallels of a new motion. */
static int prepare(const struct contour *k, struct contour_motion *m,
		   struct interp_diag *diag)
{
	const double by = fabs(k->d[0] - k->d_end[0]);
	int bad;

	for (int p = 0; p < 2; p++) {
		m->d[p] = k->d[p];
		m->ramp[p] = k->d[p] != k->d_end[p];
		m->point[p] = !m->c[p].arc && curve_length(&m->c[p]) < SAME_MM;
	}
	if ((m->ramp[0] && m->c[0].arc) || (m->ramp[1] && m->c[1].arc) ||
	    (m->ramp[0] && curve_length(&m->c[0]) <= by))
		return refuse_lead(m, by, diag);
	bad = contour_parallels(m);
	return bad < 0 ? 0 : refuse_radius(m, bad, diag);
}

static int take(struct contour *k, struct contour_motion *m,
		struct interp_diag *diag)
{
	int r = prepare(k, m, diag);

	if (!r && k->held)
		r = release(k, m, diag);
	if (r)
		return r;
	/* The very first: square to the contour, where there is no lead. */
	k->m = *m;
	k->held = true;
	memcpy(k->d_end, k->d, sizeof(k->d_end));
	memcpy(k->here_mm, m->end_mm, sizeof(k->here_mm));
	return 0;
}

static struct vec place(const double at_mm[INTERP_NAXES], bool top)
{
	return (struct vec) { at_mm[top ? INTERP_U : INTERP_X],
			      at_mm[top ? INTERP_V : INTERP_Y] };
}

static void motion_init(const struct contour *k, struct contour_motion *m,
			const double end_mm[INTERP_NAXES],
			const struct interp_build_word *w)
{
	*m = (struct contour_motion) { .word = *w };
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
		if (fabs(end_mm[i] - k->here_mm[i]) > SAME_MM)
			return true;
	}
	return false;
}

static int refuse_alone(const struct interp_build_word *w,
			struct interp_diag *diag)
{
	diag->line = w->line;
	return interp_diag_say(diag, "another axis alone under an offset or a "
			       "taper; G40 and G50 before it");
}

/* A line on which neither contour moves: only other axes do, or none. */
static int stay(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_word *w, struct interp_diag *diag)
{
	double to_mm[INTERP_NAXES];
	int r;

	if (!moves(k, end_mm))
		return 0;
	if (k->d_end[0] != 0 || k->d_end[1] != 0)
		return refuse_alone(w, diag);
	r = contour_flush(k, diag);
	if (r)
		return r;
	memcpy(to_mm, end_mm, sizeof(to_mm));
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (i <= INTERP_Y || (i >= INTERP_U && guides_on(&k->guides)))
			to_mm[i] = interp_build_here(k->guides.build)[i];
	}
	memcpy(k->here_mm, end_mm, sizeof(k->here_mm));
	r = interp_build_line(k->guides.build, to_mm, w, diag);
	if (r == -EINVAL)
		diag->line = w->line;
	return r;
}

int contour_line(struct contour *k, const double end_mm[INTERP_NAXES],
		 const struct interp_build_word *w, struct interp_diag *diag)
{
	struct contour_motion m;
	int r;

	if (is_idle(k)) {
		r = interp_build_line(k->guides.build, end_mm, w, diag);
		if (r == -EINVAL)
			diag->line = w->line;
		stand(k, end_mm);
		return r;
	}
	motion_init(k, &m, end_mm, w);
	if (curve_length(&m.c[0]) < SAME_MM && curve_length(&m.c[1]) < SAME_MM)
		return stay(k, end_mm, w, diag);
	return take(k, &m, diag);
}

static int refuse_plane(const struct interp_build_word *w,
			struct interp_diag *diag)
{
	diag->line = w->line;
	return interp_diag_say(diag, "an arc outside the plane XY under an "
			       "offset, a taper or corner control; G17 arcs, "
			       "or G40 and G50");
}

/* Start and end at one distance from the centre, as the builder wants it. */
static int check_radius(const struct contour *k, const struct curve *c,
			struct interp_diag *diag)
{
	const double r1 = curve_distance(c->centre, c->to);

	if (fabs(r1 - c->r) <= fmax(2 * k->guides.pulse_mm,
				    fmin(0.001 * c->r,
					 5 * k->guides.pulse_mm)))
		return 0;
	return interp_diag_say(diag, "the arc starts %.4f mm from its centre "
			       "and ends %.4f mm from it; radii that agree "
			       "within 2 pulses, or 0.1 %% but 5 pulses", c->r,
			       r1);
}

/* The wire keeps its lean: the top goes round as the bottom does. */
static int take_arc(struct contour *k, struct contour_motion *m,
		    const struct interp_build_arc *arc,
		    struct interp_diag *diag)
{
	const struct vec centre = { arc->centre_a_mm, arc->centre_b_mm };
	const struct vec lean = { m->c[1].from.x - m->c[0].from.x,
				  m->c[1].from.y - m->c[0].from.y };

	m->c[0] = curve_arc(m->c[0].from, m->c[0].to, centre, arc->clockwise);
	m->c[1] = curve_arc(m->c[1].from, m->c[1].to, vec_add(centre, 1, lean),
			    arc->clockwise);
	if (check_radius(k, &m->c[0], diag) < 0) {
		diag->line = m->word.line;
		return -EINVAL;
	}
	return take(k, m, diag);
}

int contour_arc(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_arc *arc,
		const struct interp_build_word *w, struct interp_diag *diag)
{
	struct contour_motion m;
	int r;

	if (is_idle(k)) {
		r = interp_build_arc(k->guides.build, end_mm, arc, w, diag);
		if (r == -EINVAL)
			diag->line = w->line;
		stand(k, end_mm);
		return r;
	}
	if (arc->axis_a != INTERP_X || arc->turns)
		return refuse_plane(w, diag);
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
					   c[p].clockwise);
		if (c[p].arc && check_radius(k, &m.c[p], diag) < 0) {
			diag->line = w->line;
			return -EINVAL;
		}
	}
	return take(k, &m, diag);
}

int contour_nurbs(struct contour *k, const double end_mm[INTERP_NAXES],
		  const struct interp_build_curve *c,
		  const struct interp_build_word *w, struct interp_diag *diag)
{
	int r;

	if (!is_idle(k)) {
		diag->line = w->line;
		return interp_diag_say(diag, "a curve under an offset, a "
				       "taper, guides or corner control; G40 "
				       "and G50 before it, or the curve as G1 "
				       "lines");
	}
	r = interp_build_curve(k->guides.build, c, w, diag);
	if (r == -EINVAL && !diag->line)
		diag->line = w->line;
	stand(k, end_mm);
	return r;
}

int contour_action(struct contour *k, enum interp_kind kind, uint32_t arg,
		   const struct interp_build_word *w, struct interp_diag *diag)
{
	int r;

	if (k->held && kind != INTERP_END) {
		if (k->ntodo == CONTOUR_TODO_MAX)
			return refuse_todo(&k->m, diag);
		k->todo[k->ntodo++] = (struct contour_action) { kind, arg, *w };
		return 0;
	}
	r = contour_flush(k, diag);
	if (!r)
		r = interp_build_action(k->guides.build, kind, arg, w, diag);
	if (r == -EINVAL && !diag->line)
		diag->line = w->line;
	return r;
}
