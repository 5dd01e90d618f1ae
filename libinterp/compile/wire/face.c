/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face.c - the outline of the part on one plane
 */
#include "wire/face_move.h"

#include "interp/angle.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define TANGENT		0.02		/* neighbours whose turn is rounding */
#define CLOSED_PULSES	3.0		/* an end written to a pulse */
#define LEAD_PIECES	3u		/* before and behind a closed part */

void face_free(struct face *f)
{
	free(f->piece);
	*f = (struct face) { .n = 0 };
}

static double shift_of(const struct face_from *from, uint32_t i)
{
	return from->plane ? from->m[i].slope * from->height_mm : 0;
}

/* -- A motion on this plane ----------------------------------------------- */

static bool stands(const struct curve *c)
{
	return !c->arc && curve_distance(c->from, c->to) < 1e-9;
}

/* A contour that stands is an arc of radius 0 that turns as the other does. */
static struct curve contour_on(const struct contour_motion *m, int plane)
{
	const struct curve *c = &m->c[plane], *other = &m->c[!plane];
	struct curve dot = { .arc = true, .from = c->from, .to = c->from,
			     .centre = c->from };
	struct vec way;

	if (!stands(c) || stands(other))
		return *c;
	if (other->arc) {
		dot.theta = other->theta;
		dot.sweep = other->sweep;
		return dot;
	}
	way = curve_way(other, false);
	dot.theta = atan2(way.y, way.x) - ANGLE_RIGHT;
	return dot;
}

/*
 * A wire that leans square to the face cuts the plane in an ellipse and keeps
 * off by its offset / cos.  @lean is how far the top is to the left of the
 * bottom, for the height.
 */
static double wire_at(double offset_mm, double lean)
{
	return fabs(offset_mm) * sqrt(1 + lean * lean);
}

static double wire_of(const struct face_from *from, uint32_t i)
{
	const struct contour_motion *m = &from->m[i];
	const struct curve c = contour_on(m, from->plane);
	double most = m->slope;

	if (from->height_mm == 0)
		return fabs(m->offset_mm);
	for (int k = 0; k <= 4; k++) {
		const struct curve part = curve_part(&c, 0, k / 4.0);
		const struct vec way = curve_way(k ? &part : &c, k > 0);
		const struct vec p = curve_at(&m->c[0], k / 4.0);
		const struct vec q = curve_at(&m->c[1], k / 4.0);
		const double lean = m->slope +
				    ((q.y - p.y) * way.x - (q.x - p.x) * way.y)
				    / from->height_mm;

		if (fabs(lean) > fabs(most))
			most = lean;
	}
	return wire_at(m->offset_mm, most);
}

/* -- Fillets of constant radius ------------------------------------------- */

/* The foot of @at on @c or its prolongation. */
static struct vec foot_on(const struct curve *c, struct vec at)
{
	const double far = curve_distance(c->centre, at);

	if (!c->arc)
		return vec_add(c->from, curve_share(c, at), (struct vec) {
			       c->to.x - c->from.x, c->to.y - c->from.y });
	return vec_add(c->centre, c->r / far, (struct vec) {
		       at.x - c->centre.x, at.y - c->centre.y });
}

/* The fillet of motion @i's radius between its moved neighbours. */
static bool fit(const struct face_from *from, uint32_t i, struct curve *ret)
{
	const struct curve *c = &from->m[i].c[from->plane];
	const double r = c->sweep > 0 ? c->r : -c->r;
	struct curve side[2], beside[2];
	struct vec centre;

	if (i == from->first || i + 1 == from->first + from->n)
		return false;
	for (uint32_t k = 0; k < 2; k++) {
		const uint32_t j = k ? i + 1 : i - 1;
		const struct curve *n = &from->m[j].c[from->plane];

		if (stands(n) || fabs(k ? curve_turn(c, n) :
				      curve_turn(n, c)) > TANGENT ||
		    !curve_parallel(n, shift_of(from, j), &side[k]) ||
		    !curve_parallel(&side[k], r, &beside[k]))
			return false;
	}
	if (!curve_meet(&beside[0], &beside[1], c->centre, &centre))
		return false;
	*ret = curve_arc(foot_on(&side[0], centre), foot_on(&side[1], centre),
			 centre, c->sweep);
	return fabs(ret->sweep - c->sweep) < 0.2;
}

enum face_fate face_piece_moved(const struct face_from *from, uint32_t i,
				struct curve *ret)
{
	const struct contour_motion *m = &from->m[i];
	const struct curve c = contour_on(m, from->plane);
	const double by = shift_of(from, i);
	const bool gone = !curve_parallel(&c, by, ret);

	if (c.arc && by != 0 &&
	    (gone || m->corner == INTERP_CORNER_CONSTANT) && fit(from, i, ret))
		return FACE_FITTED;
	return gone ? FACE_GONE : FACE_MOVED;
}

/* -- Pieces --------------------------------------------------------------- */

/* A fillet that keeps its radius leans to where its centre moves. */
static double wire_of_fitted(const struct face_from *from, uint32_t owner,
			     const struct curve *c)
{
	const struct vec at = from->m[owner].c[0].centre;

	return wire_at(from->m[owner].offset_mm,
		       curve_distance(c->centre, at) / from->height_mm);
}

struct face_piece *face_add(struct face *f, const struct face_from *from,
			    uint32_t owner, const struct curve *c, bool fitted)
{
	const struct contour_motion *m = &from->m[owner];
	const bool told = fitted && m->corner != INTERP_CORNER_CONSTANT;
	struct face_piece *p;

	if (f->n == f->room &&
	    grow_array(&f->piece, &f->room, sizeof(*f->piece)))
		return NULL;
	p = &f->piece[f->n++];
	*p = (struct face_piece) {
		.c = *c, .owner = owner, .shift_mm = shift_of(from, owner),
		.wire_mm = fitted ? wire_of_fitted(from, owner, c) :
				    wire_of(from, owner),
	};
	if (told && !f->nconstant++)
		f->first_constant = owner;
	return p;
}

static int take_all(struct face *f, const struct face_from *from)
{
	for (uint32_t i = from->first; i < from->first + from->n; i++) {
		const struct curve c = contour_on(&from->m[i], from->plane);

		if (!face_add(f, from, i, &c, false))
			return -ENOMEM;
	}
	return 0;
}

/* -- Where it closes ------------------------------------------------------ */

/* The outline behind @a pieces that lead in, before @b that lead out. */
struct ring {
	const struct face *f;
	uint32_t a, b;
	double pulse_mm;
};

static const struct curve *piece_of(const struct ring *r, uint32_t i)
{
	return &r->f->piece[i].c;
}

static bool is_one(const struct ring *r, struct vec p, struct vec q)
{
	return curve_distance(p, q) <= CLOSED_PULSES * r->pulse_mm;
}

static uint32_t ring_last(const struct ring *r)
{
	return r->f->n - 1 - r->b;
}

static bool ring_closes(const struct ring *r)
{
	const uint32_t last = ring_last(r);

	return (r->a < last || piece_of(r, last)->arc) &&
	       is_one(r, piece_of(r, r->a)->from, piece_of(r, last)->to);
}

static double length_of(const struct ring *r, uint32_t i, uint32_t end)
{
	double sum = 0;

	for (; i < end; i++)
		sum += curve_length(piece_of(r, i));
	return sum;
}

/* The direction to the place @mm along the outline from the start of piece @i,
 * or @back from its end. */
static double direction(const struct ring *r, uint32_t i, bool back, double mm)
{
	const struct vec from = back ? piece_of(r, i)->to :
				       piece_of(r, i)->from;
	double share;
	struct vec to;

	while (mm > curve_length(piece_of(r, i)) &&
	       (back ? i > 0 : i + 1 < r->f->n)) {
		mm -= curve_length(piece_of(r, i));
		i += back ? -1u : 1u;
	}
	share = curve_min(mm / curve_length(piece_of(r, i)), 1);
	to = curve_at(piece_of(r, i), back ? 1 - share : share);
	return atan2(to.y - from.y, to.x - from.x);
}

/* From direction @from to @to, the way round that @side tells (+1: left). */
static double turn_to(double from, double to, int side)
{
	const double turn = fmod(side * (to - from), 4 * ANGLE_RIGHT);

	return turn < 0 ? turn + 4 * ANGLE_RIGHT : turn;
}

/* Does what is in front of the ring come from the wire's side, what is behind
 * it go there, and the one cross the other? */
static bool is_led_from(const struct ring *r, int side)
{
	const uint32_t last = ring_last(r);
	const double in = r->a ? length_of(r, 0, r->a) : INFINITY;
	const double out = r->b ? length_of(r, last + 1, r->f->n) : INFINITY;
	const double ring = length_of(r, r->a, last + 1);
	const double mm = curve_min(curve_min(in, out), ring / 4) / 2;
	const double begin = direction(r, r->a, false, mm);
	const double slack = r->pulse_mm / mm;
	const double room = turn_to(begin, direction(r, last, true, mm),
				    side) - slack;
	const double from = r->a ? turn_to(begin, direction(
				   r, r->a - 1, true, mm), side) : room;
	const double to = r->b ? turn_to(begin, direction(
				 r, last + 1, false, mm), side) : slack;

	return from >= slack && from <= room && to >= slack && to <= room &&
	       to <= from + slack;
}

/*
 * Leads that touch the ring at one place.  What they are is no surface of the
 * part, even if the one begins where the other ends: such an outline would
 * cross itself.  A single circle may also be a part of an open contour, if
 * lines go on from it.
 */
static bool ring_is_led(const struct ring *r, int side)
{
	const uint32_t a = r->a, last = ring_last(r);
	const struct vec at = piece_of(r, a)->from;

	if (!(a + r->b) ||
	    (a && is_one(r, piece_of(r, 0)->from, at)) ||
	    (r->b && is_one(r, piece_of(r, r->f->n - 1)->to, at)) ||
	    (a == last && ((a && !piece_of(r, a - 1)->arc) ||
			   (r->b && !piece_of(r, last + 1)->arc))))
		return false;
	return (side >= 0 && is_led_from(r, 1)) ||
	       (side <= 0 && is_led_from(r, -1));
}

/* All of it, or all but a lead of any kind. */
static bool ring_is_most(const struct ring *r)
{
	return !(r->a + r->b) || (r->f->n >= 4 && r->a < ring_last(r));
}

static bool find_ring(struct ring *r, int side, bool led)
{
	for (uint32_t sum = 0; sum <= 2 * LEAD_PIECES; sum++) {
		for (r->a = 0; r->a <= sum && r->a <= LEAD_PIECES; r->a++) {
			r->b = sum - r->a;
			if (r->b <= LEAD_PIECES && sum < r->f->n &&
			    ring_closes(r) &&
			    (led ? ring_is_led(r, side) : ring_is_most(r)))
				return true;
		}
	}
	return false;
}

/*
 * A part's outline ends where it begins.  What is programmed in front of that
 * place (an arc that leads in) and behind it (one that leads out, or a little
 * more of the first motion) is no surface of the part.
 */
static void find_closure(struct face *f, const struct face_from *from)
{
	const double offset = from->m[from->first].offset_mm;
	const int side = (offset > 0) - (offset < 0);
	struct ring r = { .f = f, .pulse_mm = from->pulse_mm };

	f->closed = find_ring(&r, side, true) || find_ring(&r, side, false);
	for (uint32_t i = 0; f->closed && i < f->n; i++)
		f->piece[i].lead = i < r.a || i > ring_last(&r);
}

static bool is_moved(const struct face_from *from)
{
	for (uint32_t i = 0; i < from->n; i++) {
		if (shift_of(from, from->first + i) != 0)
			return true;
	}
	return false;
}

int face_make(struct face *f, const struct face_from *from,
	      struct face_fault *fault)
{
	struct face still = { .n = 0 };
	bool closed = false;
	double way = 0;
	int err = take_all(f, from);

	if (!err && is_moved(from)) {
		still = *f;
		*f = (struct face) { .n = 0 };
		find_closure(&still, from);
		closed = still.closed;
		err = face_move(f, from, &still, fault);
		face_free(&still);
	}
	for (uint32_t i = 0; !err && i < f->n; i++) {
		f->piece[i].way_mm = way;
		way += curve_length(&f->piece[i].c);
	}
	if (!err)
		find_closure(f, from);
	f->written_closed = closed || f->closed;
	return err;
}
