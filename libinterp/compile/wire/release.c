/* SPDX-License-Identifier: Apache-2.0 */
/*
 * release.c - what is collected, through faces and tracks, to the guides
 *
 * Motions are taken lead by lead: a lead in, the motions behind it and the
 * lead out make one outline on each plane.  The tracks of both planes are
 * walked motion by motion; where one plane has nothing for a motion, because
 * there was no room for it, that end of the wire stands.
 */
#include "wire/contour.h"
#include "wire/track.h"

#include "interp/angle.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* -- One motion, or a part of it ------------------------------------------ */

struct step {
	struct contour *k;
	const struct contour_motion *m;
	const struct curve *c;		/* on both planes */
	double t[2];			/* its share of the motion */
	struct interp_diag *diag;
};

/* Share @t0 to @t1 of it. */
static int cut_part(const struct step *s, double t0, double t1,
		    const struct interp_build_word *w)
{
	const struct curve part[2] = { curve_part(&s->c[0], t0, t1),
				       curve_part(&s->c[1], t0, t1) };
	const double t = s->t[0] + t1 * (s->t[1] - s->t[0]);
	double end_mm[INTERP_NAXES];
	int err;

	for (int i = 0; i < INTERP_NAXES; i++)
		end_mm[i] = t >= 1 ? s->m->end_mm[i] : s->m->from_mm[i] +
			    t * (s->m->end_mm[i] - s->m->from_mm[i]);
	err = guides_cut(&s->k->guides, part, end_mm, w, s->diag);
	if (err == -EINVAL)
		s->diag->line = w->line;
	return err;
}

static double length_of(const struct curve c[2])
{
	return fmax(curve_length(&c[0]), curve_length(&c[1]));
}

/* The motion, its last part slower if a corner follows. */
static int cut_motion(const struct step *s, bool corner)
{
	const struct interp_wire *w = s->k->guides.wire;
	const double len = length_of(s->c);
	const double before = corner ? fmin(w->corner_before_mm, len) : 0;
	const double at = len > 0 ? 1 - before / len : 0;
	struct interp_build_word slow = s->m->word;
	int err = 0;

	if (!(before > 0))
		return cut_part(s, 0, 1, &s->m->word);
	if (at > 0)
		err = cut_part(s, 0, at, &s->m->word);
	slow.feed_mm_s *= w->corner_feed_percent / 100;
	return err < 0 ? err : cut_part(s, at, 1, &slow);
}

/* The motion as its @n curves, one behind the other. */
static int cut_curves(const struct step *s, struct curve c[][2],
		      uint32_t n, bool corner)
{
	double all = 0, done = 0;
	int err = 0;

	for (uint32_t i = 0; i < n; i++)
		all += length_of(c[i]);
	for (uint32_t i = 0; !err && i < n; i++) {
		struct step part = *s;

		part.c = c[i];
		part.t[0] = all > 0 ? done / all : 1;
		done += length_of(c[i]);
		part.t[1] = i + 1 < n && all > 0 ? done / all : 1;
		err = cut_motion(&part, corner && i + 1 == n);
	}
	return err;
}

/* Does corner control ask for care in front of @b? */
static bool is_corner(const struct contour *k, const struct contour_motion *a,
		      const struct contour_motion *b)
{
	const double least = k->guides.wire->corner_angle_deg * ANGLE_DEGREE;
	int p;

	if (!b || least >= 180 * ANGLE_DEGREE || a->word.rapid || b->word.rapid)
		return false;
	p = curve_length(&a->c[0]) < 1e-9 || curve_length(&b->c[0]) < 1e-9;
	if (curve_length(&a->c[p]) < 1e-9 || curve_length(&b->c[p]) < 1e-9)
		return false;
	return fabs(curve_turn(&a->c[p], &b->c[p])) >= least - 1e-9;
}

static int do_todo(const struct step *s)
{
	for (uint32_t i = 0; i < s->m->ntodo; i++) {
		const struct contour_action *a = &s->k->todo[s->m->todo + i];
		const int err = interp_build_action(s->k->guides.build, a->kind,
						  a->arg, &a->word, s->diag);

		if (err == -EINVAL)
			s->diag->line = a->word.line;
		if (err < 0)
			return err;
	}
	return 0;
}

/* Wait on the corner, then what the program asked for there. */
static int do_corner(const struct step *s, bool corner)
{
	const double wait_s = s->k->guides.wire->corner_dwell_s;
	int err = 0;

	if (corner && wait_s > 0)
		err = interp_build_action(s->k->guides.build, INTERP_DWELL,
					(uint32_t)(wait_s * 1000 + 0.5),
					&s->m->word, s->diag);
	return err < 0 ? err : do_todo(s);
}

/* -- One outline ---------------------------------------------------------- */

/* Motions @first to @end - 1; some of these at either end may be leads. */
struct stretch {
	uint32_t first, end;		/* with the leads */
	bool in, out;			/* they are there */
	bool one;			/* no guides: the planes are the same */
	struct track t[2];
	uint32_t next[2];		/* of each track's curves */
};

static bool is_on(const struct contour_motion *m)
{
	return m->offset_mm != 0 || m->slope != 0;
}

static double height_of(const struct contour *k)
{
	return guides_on(&k->guides) ? k->guides.height_mm : 0;
}

/* Where the wire begins (or ends) along @m if nothing is beside it. */
static struct vec beside(const struct contour *k,
			 const struct contour_motion *m, int p, bool at_end)
{
	const struct curve *c = &m->c[curve_length(&m->c[p]) > 1e-9 ? p : !p];
	const struct vec way = curve_way(c, at_end);
	const double lean = m->slope * height_of(k);
	const double d = m->offset_mm * sqrt(1 + m->slope * m->slope) +
			 (p ? lean : 0);

	return vec_add(at_end ? m->c[p].to : m->c[p].from, d,
		       (struct vec) { -way.y, way.x });
}

/* Where a lead ends that nothing tells the end of but the motion behind it. */
static struct vec lead_end(const struct contour *k, uint32_t i,
			   const struct contour_motion *next, int p)
{
	const struct contour_motion *m = &k->m[i];
	const struct contour_motion *b = i + 1 < k->n ? &k->m[i + 1] : next;

	if (!is_on(m))
		return m->c[p].to;
	return b && !b->lead && is_on(b) ? beside(k, b, p, false) :
					   beside(k, m, p, true);
}

/*
 * Is the lead in, or out, programmed to come through the outline?  What it does
 * nearer to the outline than the offset tells; one that lies along the outline
 * does not come through it.  On the second plane the outline may have moved
 * beyond the far end of a lead that does not; so the programmed plane tells.
 */
static bool goes_through(const struct contour *k, const struct stretch *s,
			 bool out)
{
	const struct contour_motion *lead = &k->m[out ? s->end - 1 : s->first];
	const struct contour_motion *m = out ? lead - 1 : lead + 1;
	const struct curve *c = &m->c[0];
	const struct curve to = out ? curve_reversed(&lead->c[0]) : lead->c[0];
	const double share = fabs(m->offset_mm) / curve_length(&to);
	const struct vec near = curve_at(&to, 1 - share);
	const struct vec end = out ? c->to : c->from;
	struct vec way;

	if (curve_length(c) < CURVE_SAME_MM)
		return true;
	way = curve_way(c, out);
	return ((near.y - end.y) * way.x - (near.x - end.x) * way.y) *
	       m->offset_mm < 0;
}

/* Motion @i as a lead that goes to, or comes from, @far on plane @p. */
static struct track_lead lead_of(const struct contour *k, uint32_t i, int p,
				 struct vec far)
{
	const struct contour_motion *m = &k->m[i];

	return (struct track_lead) {
		.there = true, .owner = i, .c = m->c[p], .far = far,
		.round = m->c[0].arc || m->c[1].arc,
	};
}

static int make_track(struct contour *k, struct stretch *s, int p,
		      const struct contour_motion *next,
		      struct interp_diag *diag)
{
	const uint32_t a = s->first + s->in, b = s->end - s->out;
	const struct face_from from = {
		.m = k->m, .first = a, .n = b - a, .plane = p,
		.height_mm = height_of(k), .pulse_mm = k->guides.pulse_mm,
	};
	struct track_job job = {
		.side = (k->m[a].offset_mm > 0) - (k->m[a].offset_mm < 0),
		.pulse_mm = k->guides.pulse_mm,
		.skip = k->guides.wire->gouge == INTERP_GOUGE_SKIP,
	};
	struct face_fault bad;
	struct track_fault fault;
	struct face f = { .n = 0 };
	int err = face_make(&f, &from, &bad);

	if (err == -EINVAL)
		contour_refuse_faces(k, &bad, diag);
	job.face = &f;
	if (s->in) {
		job.lead[0] = lead_of(k, s->first, p, k->at[p]);
		job.lead[0].through = goes_through(k, s, false);
	}
	if (s->out) {
		job.lead[1] = lead_of(k, b, p, lead_end(k, b, next, p));
		job.lead[1].through = goes_through(k, s, true);
	}
	if (!err) {
		err = track_make(&s->t[p], &job, &fault);
		if (err == -EINVAL)
			contour_refuse_track(k, &fault, p, diag);
	}
	for (uint32_t i = 0; !err && i < s->t[p].nleft; i++)
		contour_note_left(k, &s->t[p].left[i], p);
	if (!err && f.nconstant)
		contour_note_constant(k, &f);
	face_free(&f);
	return err;
}

/* The next curve of plane @p's track, if it is motion @owner's. */
static bool take_curve(struct stretch *s, int p, uint32_t owner, bool fill,
		       struct curve *ret)
{
	const struct track *t = &s->t[s->one ? 0 : p];
	const uint32_t i = s->next[p];

	if (i >= t->n || t->owner[i] != owner || t->fill[i] != fill)
		return false;
	*ret = t->c[i];
	s->next[p]++;
	return true;
}

/* What both planes have next; false if they have nothing. */
static bool take_curves(struct contour *k, struct stretch *s, uint32_t owner,
			bool fill, struct curve ret[2])
{
	bool any = false;

	for (int p = 0; p < 2; p++) {
		if (take_curve(s, p, owner, fill, &ret[p])) {
			any = true;
			k->at[p] = ret[p].to;
		} else {
			ret[p] = curve_line(k->at[p], k->at[p]);
		}
	}
	return any;
}

static int cut_owner(struct contour *k, struct stretch *s, uint32_t i,
		     const struct contour_motion *next,
		     struct interp_diag *diag)
{
	const struct contour_motion *b = i + 1 < k->n ? &k->m[i + 1] : next;
	const bool corner = is_corner(k, &k->m[i], b);
	struct curve c[LEAD_PARTS][2];
	const struct step step = { k, &k->m[i], c[0], { 0, 1 }, diag };
	uint32_t n = 0;
	int err;

	while (n < LEAD_PARTS && take_curves(k, s, i, false, c[n]))
		n++;
	err = cut_curves(&step, c, n, corner);
	if (!err)
		err = do_corner(&step, corner);
	while (!err && take_curves(k, s, i, true, c[0]))
		err = cut_part(&step, 0, 1, &step.m->word);
	return err;
}

static int cut_stretch(struct contour *k, struct stretch *s,
		       const struct contour_motion *next,
		       struct interp_diag *diag)
{
	int err = make_track(k, s, 0, next, diag);

	s->one = !guides_on(&k->guides);
	if (!err && !s->one)
		err = make_track(k, s, 1, next, diag);
	for (uint32_t i = s->first; !err && i < s->end; i++)
		err = cut_owner(k, s, i, next, diag);
	track_free(&s->t[0]);
	track_free(&s->t[1]);
	return err;
}

/* A lead with no contour behind it, or between two others. */
static int cut_lead(struct contour *k, uint32_t i,
		    const struct contour_motion *next,
		    struct interp_diag *diag)
{
	const bool out = !is_on(&k->m[i]);
	struct curve c[LEAD_PARTS][2];
	const struct step step = { k, &k->m[i], c[0], { 0, 1 }, diag };
	uint32_t n = 0;
	int err;

	for (int p = 0; p < 2; p++) {
		const struct vec end = lead_end(k, i, next, p);
		const struct vec at = out ? k->at[p] : end;
		const struct track_lead l = lead_of(k, i, p,
						    out ? end : k->at[p]);
		const struct vec was = out ? l.c.from : l.c.to;
		struct curve way[LEAD_PARTS];

		if (!lead_lay(&l, at, out, way))
			return contour_refuse_track(k, &(struct track_fault) {
				.kind = TRACK_ROUND, .a = i, .b = out ? i - 1 :
				i, .found_mm = l.c.r,
				.wanted_mm = curve_distance(was, at),
			}, p, diag);
		n = lead_size(&l);
		for (uint32_t j = 0; j < n; j++)
			c[j][p] = way[j];
		k->at[p] = end;
	}
	err = cut_curves(&step, c, n, false);
	return err ? err : do_corner(&step, false);
}

int contour_release(struct contour *k, const struct contour_motion *next,
		    struct interp_diag *diag)
{
	uint32_t i = 0;
	int err = 0;

	while (!err && i < k->n) {
		struct stretch s = { .first = i, .in = k->m[i].lead };
		uint32_t j = i + s.in;

		while (j < k->n && !k->m[j].lead)
			j++;
		if (k->m[i].step || j == i + s.in) {
			err = cut_lead(k, i++, next, diag);
			continue;
		}
		s.out = j < k->n && !k->m[j].step;
		s.end = j + s.out;
		err = cut_stretch(k, &s, next, diag);
		i = s.end;
	}
	k->n = k->ntodo = 0;
	return err;
}
