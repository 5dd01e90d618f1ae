/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face.c - the outline of the part on one plane
 *
 * Pieces are laid on a stack.  Each new one is joined to the top; if nothing
 * is left of the top then, it is taken off again and the one below is joined
 * instead, so that neighbours of a vanished piece meet.
 */
#include "wire/face.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define RIGHT_ANGLE	(M_PI / 2)
#define ANGLE_SLACK	1e-6		/* the rounding of a right angle */
#define TANGENT		0.02		/* turns of neighbours written rounded */
#define CLOSED_PULSES	3.0		/* an end written to a pulse */
#define LEAD_PIECES	3u		/* in front of and behind a closed part */

/* A piece that is joined on its first side only. */
struct open {
	struct curve whole;		/* before any cut */
	struct vec from, to;
	bool fitted;			/* a fillet: its ends are its own */
	double sigma;			/* moved to the left by this */
	uint32_t owner, pieces;		/* f->n when it was laid down */
};

struct maker {
	struct face *f;
	const struct face_from *from;
	struct face_fault *fault;
	struct open *stack;
	uint32_t depth;
};

void face_free(struct face *f)
{
	free(f->piece);
	*f = (struct face) { .n = 0 };
}

static double sigma_of(const struct face_from *from, uint32_t i)
{
	return from->plane ? from->m[i].slope * from->height_mm : 0;
}

static struct face_piece *add(struct face *f)
{
	if (f->n == f->room) {
		const uint32_t room = f->room ? f->room * 2 : 64;
		struct face_piece *p = realloc(f->piece, room * sizeof(*p));

		if (!p)
			return NULL;
		f->piece = p;
		f->room = room;
	}
	f->piece[f->n] = (struct face_piece) { .fill = false };
	return &f->piece[f->n++];
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
	dot.theta = atan2(way.y, way.x) - RIGHT_ANGLE;
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
		    !curve_parallel(n, sigma_of(from, j), &side[k]) ||
		    !curve_parallel(&side[k], r, &beside[k]))
			return false;
	}
	if (!curve_meet(&beside[0], &beside[1], c->centre, &centre))
		return false;
	*ret = curve_arc(foot_on(&side[0], centre), foot_on(&side[1], centre),
			 centre, c->sweep < 0);
	return fabs(ret->sweep - c->sweep) < 0.2;
}

/* Motion @i, moved.  Return: false if nothing is left of it. */
static bool move(struct maker *k, uint32_t i, struct open *ret)
{
	const struct contour_motion *m = &k->from->m[i];
	const struct curve c = contour_on(m, k->from->plane);
	bool inside_out;

	*ret = (struct open) { .owner = i, .sigma = sigma_of(k->from, i) };
	inside_out = !curve_parallel(&c, ret->sigma, &ret->whole);
	if (c.arc && ret->sigma != 0 &&
	    (inside_out || m->corner == INTERP_CORNER_CONSTANT))
		ret->fitted = fit(k->from, i, &ret->whole);
	if (inside_out && ret->fitted && m->corner != INTERP_CORNER_CONSTANT &&
	    !k->f->nconstant++)
		k->f->first_constant = i;
	ret->from = ret->whole.from;
	ret->to = ret->whole.to;
	return !inside_out || ret->fitted;
}

/* -- Two neighbours ------------------------------------------------------- */

struct join {
	struct vec end, start;
	uint32_t nfill;			/* curves from end to start */
	struct curve fill[2];
};

static double reach_of(double a, double b, double turn)
{
	return sqrt(a * a + b * b - 2 * a * b * cos(turn)) / fabs(sin(turn));
}

/* Round the corner at the radius of the one, then straight to the other. */
static void go_round(const struct open *a, const struct open *b, struct vec v,
		     struct join *j)
{
	const struct vec way = curve_way(&b->whole, false);
	const struct vec at = vec_add(v, a->sigma,
				      (struct vec) { -way.y, way.x });

	j->end = a->whole.to;
	j->start = b->whole.from;
	j->nfill = 0;
	if (curve_distance(j->end, at) > 1e-6)
		j->fill[j->nfill++] = curve_arc(j->end, at, v, a->sigma > 0);
	if (curve_distance(at, j->start) > 1e-6)
		j->fill[j->nfill++] = curve_line(at, j->start);
}

static bool join_corner(const struct maker *k, const struct open *a,
			const struct open *b, struct join *j)
{
	const struct contour_motion *m = &k->from->m[a->owner];
	const struct curve p = contour_on(m, k->from->plane);
	const struct curve q = contour_on(&k->from->m[b->owner],
					  k->from->plane);
	const double turn = curve_turn(&p, &q);
	const double most = fmax(fabs(a->sigma), fabs(b->sigma));
	const double reach = reach_of(a->sigma, b->sigma, turn);
	const bool same = fabs(a->sigma - b->sigma) < 1e-9;
	const bool outer = turn * (a->sigma + b->sigma) < 0;
	const bool edge = same ? !outer || m->corner == INTERP_CORNER_SHARP ||
			  fabs(turn) <= RIGHT_ANGLE + ANGLE_SLACK :
			  reach <= 3 * most;

	if (edge && curve_meet(&a->whole, &b->whole, p.to, &j->end) &&
	    (!outer || curve_distance(j->end, p.to) < 1.5 * reach)) {
		j->start = j->end;
		return true;
	}
	if (!outer && same)
		return false;
	go_round(a, b, p.to, j);
	return true;
}

static bool join(const struct maker *k, const struct open *a,
		 const struct open *b, struct join *j)
{
	const struct vec v = k->from->m[b->owner].c[k->from->plane].from;

	*j = (struct join) { .end = a->whole.to, .start = b->whole.from };
	if (a->fitted || b->fitted) {
		j->end = j->start = a->fitted ? a->to : b->from;
		return true;
	}
	if (curve_distance(j->end, j->start) < 1.5 * k->from->pulse_mm) {
		j->start = j->end;
		return true;
	}
	if (b->owner == a->owner + 1)
		return join_corner(k, a, b, j);
	if (!curve_meet(&a->whole, &b->whole, v, &j->end))
		return false;
	j->start = j->end;
	return true;
}

/* What is left of it between its two corners. */
static bool cut(const struct open *o, struct vec to, struct curve *ret)
{
	*ret = o->whole;
	if (o->whole.arc && (o->whole.r == 0 || o->fitted))
		return true;
	if (curve_distance(o->from, o->whole.from) < 1e-12 &&
	    curve_distance(to, o->whole.to) < 1e-12)
		return true;
	return curve_trim(ret, o->from, to);
}

/* -- The stack ------------------------------------------------------------ */

static int lay(struct maker *k, const struct open *o, const struct curve *c,
	       const struct join *j)
{
	const double wire = wire_of(k->from, o->owner);
	struct face_piece *p = add(k->f);

	if (!p)
		return -ENOMEM;
	*p = (struct face_piece) { .c = *c, .owner = o->owner,
				   .wire_mm = wire };
	if (o->fitted) {
		const struct vec at = k->from->m[o->owner].c[0].centre;

		p->wire_mm = wire_at(k->from->m[o->owner].offset_mm,
				     curve_distance(c->centre, at) /
				     k->from->height_mm);
	}
	for (uint32_t i = 0; j && i < j->nfill; i++) {
		p = add(k->f);
		if (!p)
			return -ENOMEM;
		*p = (struct face_piece) { .c = j->fill[i], .fill = true,
					   .owner = o->owner, .wire_mm = wire };
	}
	return 0;
}

static int fail(struct maker *k, uint32_t a, uint32_t b)
{
	*k->fault = (struct face_fault) { a, b };
	return -EINVAL;
}

static int push(struct maker *k, struct open *o)
{
	struct curve c;
	struct join j;
	int err;

	while (k->depth) {
		const struct open *top = &k->stack[k->depth - 1];

		if (!join(k, top, o, &j))
			return fail(k, top->owner, o->owner);
		if (cut(top, j.end, &c)) {
			err = lay(k, top, &c, &j);
			if (err)
				return err;
			o->from = j.start;
			break;
		}
		k->f->n = top->pieces;
		k->depth--;
		/* The piece laid when this one came is open again. */
		if (k->depth)
			k->f->n = k->stack[k->depth - 1].pieces;
	}
	o->pieces = k->f->n;
	k->stack[k->depth++] = *o;
	return 0;
}

static int finish(struct maker *k)
{
	struct open *top = &k->stack[k->depth - 1];
	struct curve c;

	if (!cut(top, top->to, &c))
		return fail(k, k->depth > 1 ? top[-1].owner : top->owner,
			    top->owner);
	return lay(k, top, &c, NULL);
}

static int move_all(struct maker *k)
{
	int err = 0;

	k->stack = malloc(k->from->n * sizeof(*k->stack));
	if (!k->stack)
		return -ENOMEM;
	for (uint32_t i = 0; !err && i < k->from->n; i++) {
		struct open o;

		if (move(k, k->from->first + i, &o))
			err = push(k, &o);
	}
	if (!err)
		err = k->depth ? finish(k) :
		     fail(k, k->from->first, k->from->first + k->from->n - 1);
	free(k->stack);
	return err;
}

static int take_all(struct maker *k)
{
	for (uint32_t i = 0; i < k->from->n; i++) {
		const struct open o = {
			.owner = k->from->first + i,
		};
		const struct curve c = contour_on(&k->from->m[o.owner],
						  k->from->plane);
		const int err = lay(k, &o, &c, NULL);

		if (err)
			return err;
	}
	return 0;
}

/* -- Where it closes ------------------------------------------------------ */

/*
 * A part's outline ends where it begins.  What is programmed in front of that
 * place (an arc that leads in) and behind it (one that leads out, or a little
 * more of the first motion) is no surface of the part.
 */
static void find_closure(struct face *f, double pulse_mm)
{
	const uint32_t most = f->n < 4 ? 0 : LEAD_PIECES;

	for (uint32_t sum = 0; sum <= 2 * most; sum++) {
		for (uint32_t a = 0; a <= sum && a <= most; a++) {
			const uint32_t b = sum - a;

			if (b > most || a + b + 2 > f->n ||
			    curve_distance(f->piece[a].c.from,
					 f->piece[f->n - 1 - b].c.to) >
			    CLOSED_PULSES * pulse_mm)
				continue;
			for (uint32_t i = 0; i < a; i++)
				f->piece[i].lead = true;
			for (uint32_t i = 0; i < b; i++)
				f->piece[f->n - 1 - i].lead = true;
			f->closed = true;
			return;
		}
	}
	f->closed = f->n == 1 && f->piece[0].c.arc &&
		    curve_distance(f->piece[0].c.from, f->piece[0].c.to) <
		    CLOSED_PULSES * pulse_mm;
}

int face_make(struct face *f, const struct face_from *from,
	      struct face_fault *fault)
{
	struct maker k = { .f = f, .from = from, .fault = fault };
	bool moved = false;
	double way = 0;
	int err;

	for (uint32_t i = 0; i < from->n; i++)
		moved = moved || sigma_of(from, from->first + i) != 0;
	err = moved ? move_all(&k) : take_all(&k);
	for (uint32_t i = 0; !err && i < f->n; i++) {
		f->piece[i].way_mm = way;
		way += curve_length(&f->piece[i].c);
	}
	if (!err)
		find_closure(f, from->pulse_mm);
	return err;
}
