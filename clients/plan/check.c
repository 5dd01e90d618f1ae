/* SPDX-License-Identifier: Apache-2.0 */
/*
 * check.c - a whole way proved, or its first contact
 *
 * A dense program has thousands of blocks that are shorter than the room round
 * the electrode.  Over several of them no point moves farther than the sum of
 * their ways, so one distance proves many blocks.  Only a block that is longer
 * than the room that is left gets a proof of its own.
 */
#include "check.h"

#include "lifts.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <sysexits.h>

/* In the end zone the clearance falls to the distance at the end pose, less
 * this. */
#define END_LESS_MM	0.005

struct checking {
	const struct job *j;
	const struct route *w;
	const struct clearance *c;
	struct check_result *ret;
	struct near_pair pair;		/* nearest at the node last looked at */
	double room_mm;			/* round it, over what is to be kept */
};

static struct clearance more(const struct clearance *c, double mm)
{
	struct clearance ret = *c;

	ret.mm += mm;
	ret.end_mm += mm;
	return ret;
}

static void contact(struct checking *k, uint32_t i, const struct block *b,
		    const struct proof *p, const struct clearance *c)
{
	struct check_result *r = k->ret;
	struct pose pose;

	r->ok = false;
	r->given_up = p->given_up;
	r->block = i;
	r->t = p->t;
	r->pair = p->pair;
	block_at(b, p->t, r->q);
	block_pose(b, p->t, &pose, NULL);
	r->wanted_mm = clearance_at(c, &pose);
}

static void see(struct checking *k, uint32_t i, double mm)
{
	if (mm < k->ret->least_mm) {
		k->ret->least_mm = mm;
		k->ret->least_block = i;
	}
}

/* The room round node @i, if block @i is to begin there. */
static void look(struct checking *k, uint32_t i, const struct block *b,
		 const struct clearance *c)
{
	struct pose pose;
	double mm;

	block_pose(b, 0, &pose, NULL);
	mm = near_distance(&k->j->bodies, &pose, &k->pair);
	k->ret->queries++;
	see(k, i, mm);
	/* The room is the same on all sides. */
	k->room_mm = mm - c->mm - PROVE_EPS_MM;
}

static bool prove_next(struct checking *k, uint32_t i, const struct block *b,
			const struct clearance *c)
{
	struct proof p = { .least_mm = DBL_MAX, .pair = k->pair };
	const bool ok = prove_block(&k->j->bodies, b, c, &p);
	struct pose end;

	k->ret->queries += p.queries;
	k->room_mm = 0;
	if (!ok) {
		see(k, i, p.pair.mm);
		contact(k, i, b, &p, c);
		return false;
	}
	/* A proof does not say how near the block came.  Often that is its
	 * end. */
	block_pose(b, 1, &end, NULL);
	k->pair = p.pair;
	if (near_less(&k->j->bodies, &end, k->ret->least_mm, &k->pair))
		see(k, i, k->pair.mm);
	k->ret->queries++;
	return true;
}

static bool check_next(struct checking *k, uint32_t i)
{
	struct clearance c;
	struct block b;
	double strays;

	job_block(k->j, k->w, i, &b);
	strays = job_strays_mm(k->w, i, &b);
	k->ret->most_added_mm = fmax(k->ret->most_added_mm, strays);
	/* What strays differs a little from block to block. */
	if (b.way_mm + strays <= k->room_mm) {
		k->room_mm -= b.way_mm;
		return true;
	}
	c = more(k->c, strays + k->j->chord_mm);
	look(k, i, &b, &c);
	if (b.way_mm <= k->room_mm) {
		k->room_mm -= b.way_mm;
		return true;
	}
	return prove_next(k, i, &b, &c);
}

bool check_block(const struct job *j, const double from[INTERP_NAXES],
		 const double to[INTERP_NAXES], const struct clearance *c,
		 struct near_pair *pair)
{
	struct proof p = { .pair = *pair };
	double lattice[INTERP_NAXES];
	struct clearance with;
	struct block b;
	bool ok;

	block_init(&b, &j->motion, from, to);
	route_lattice(&j->config, lattice);
	with = more(c, motion_strays_mm(&b, lattice) + j->chord_mm);
	ok = !prove_refuted(&j->bodies, &b, &with, &p) &&
	     prove_block(&j->bodies, &b, &with, &p);
	*pair = p.pair;
	return ok;
}

/* Does the way begin inside? */
static int check_start(struct checking *k)
{
	struct pose pose;
	int err;

	motion_pose(&k->j->motion, k->w->node[0].q, &pose);
	if (near_below(&k->j->bodies, &pose, 1e-9, &k->pair))
		return 0;		/* it touches, and will be found */
	err = job_inside(k->j, &pose, k->ret->say, sizeof(k->ret->say));
	if (err < 0)
		return -ENOMEM;
	k->ret->inside = err > 0;
	return 0;
}

int check_way(const struct job *j, const struct route *w,
	      const struct clearance *c, struct check_result *ret)
{
	struct checking k = { .j = j, .w = w, .c = c, .ret = ret };
	int err;

	*ret = (struct check_result) { .ok = true, .least_mm = DBL_MAX };
	err = check_start(&k);
	if (err || ret->inside) {
		ret->ok = false;
		memcpy(ret->q, w->node[0].q, sizeof(ret->q));
		return err;
	}
	for (uint32_t i = 0; i + 1 < w->n && ret->ok; i++) {
		char text[100];

		if (bar_interrupted()) {
			bar_end(j);
			return -EINTR;
		}
		check_next(&k, i);
		if (i % 16)
			continue;
		snprintf(text, sizeof(text), "proof: block %u of %u, %.3f mm",
			 i + 1, w->n - 1, ret->least_mm);
		bar_show(j, (double)i / w->n, text);
	}
	err = ret->ok ? lifts_check(j, w, c, ret) : 0;
	bar_end(j);
	return err;
}

int check_clearance(const struct job *j, const double end[INTERP_NAXES],
		    struct clearance *ret)
{
	struct near_pair pair = { 0 };
	struct pose pose;
	double mm;

	clearance_init(ret, j->clear_mm);
	if (!(j->o->end_zone_mm > 0))
		return 0;
	motion_pose(&j->motion, end, &pose);
	mm = near_distance(&j->bodies, &pose, &pair) - j->chord_mm -
	     END_LESS_MM;
	if (mm < ret->mm)
		clearance_end(ret, &j->tool, &pose, j->o->end_zone_mm,
			      fmax(mm, 0));
	return 0;
}

void check_say_left(const struct check_result *r, FILE *f)
{
	if (!(r->pair.mm > 0))
		fputs("they touch", f);
	else if (r->pair.mm > r->wanted_mm - 1e-4)
		/* The first such pose is as good as at the limit. */
		fprintf(f, "they come nearer than the %.4f mm to be kept",
			r->wanted_mm);
	else
		fprintf(f, "%.4f mm are left of %.4f", r->pair.mm,
			r->wanted_mm);
	if (r->lift)
		fputs(" in a lift beside the path", f);
}
