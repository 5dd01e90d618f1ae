/* SPDX-License-Identifier: Apache-2.0 */
/*
 * prove.h - that a block keeps a clearance, or where it does not
 *
 * Conservative advancement: at each pose the proof finds a time in which no
 * point can come too near, and goes on behind that time, until the end of the
 * block.  Nothing is sampled.
 *
 * Units: mm; time 0..1 of the block.  Any thread.
 * Source: B. Mirtich, Impulse-based dynamic simulation of rigid body systems,
 * 1996; the directed bound per pair of boxes is this project's (docs/plan.md).
 */
#ifndef PLAN_PROVE_H
#define PLAN_PROVE_H

#include "motion.h"

/* A pose that is nearer than the clearance plus this is refused.  So steps do
 * not become arbitrarily short. */
#define PROVE_EPS_MM	0.002

/*
 * The distance to be kept.  Within zone_mm of the end pose, the clearance falls
 * linearly to end_mm.  How far a pose is from the end pose is the longest way
 * of any point of the electrode between the two.
 */
struct clearance {
	double mm;
	double zone_mm;			/* 0: it does not fall */
	double end_mm;			/* at the end pose itself */
	double corner[8][3];		/* of a box round the electrode */
	double end[8][3];		/* the same at the end pose, in the
					 * part's frame */
};

struct proof {
	double least_mm;		/* the least distance that was seen */
	double t;			/* where it was seen */
	struct near_pair pair;		/* the pair there; zeros at first */
	bool given_up;			/* memory ran out, or it took too many
					 * steps; nothing was too near */
	uint64_t queries;		/* the number of poses that were looked
					 * at is added to this */
};

/** clearance_init() - the same clearance everywhere; clearance_end() lets it
 *  fall towards the end pose. */
void clearance_init(struct clearance *c, double mm);
void clearance_end(struct clearance *c, const struct mesh *tool,
		   const struct pose *end, double zone_mm, double end_mm);

/** clearance_at() - the distance to be kept at @pose. */
double clearance_at(const struct clearance *c, const struct pose *pose);

/**
 * prove_block() - prove that no point in it comes nearer than @c.
 *
 * Return: is it proved?  If not, @p has the first time at which the distance is
 * less than the clearance + PROVE_EPS_MM, to one step of the proof.
 */
bool prove_block(const struct bodies *bodies, const struct block *b,
		 const struct clearance *c, struct proof *p);

/**
 * prove_refuted() - do a few poses show that it does not keep @c?
 *
 * Quick, and no proof of the contrary.
 */
bool prove_refuted(const struct bodies *bodies, const struct block *b,
		   const struct clearance *c, struct proof *p);

/* How exact prove_least() is.  The finer value costs several times as much,
 * where the electrode passes along a wall at nearly the same distance. */
#define PROVE_FINE_MM	0.002
#define PROVE_COARSE_MM	0.02

/**
 * prove_least() - find the largest clearance that can be proved, to @within_mm
 * and up to 100 mm.
 *
 * Return: that clearance; less than 0 if the electrode touches the part.  @p
 * tells where the block is nearest.
 */
double prove_least(const struct bodies *bodies, const struct block *b,
		   double within_mm, struct proof *p);

#endif /* PLAN_PROVE_H */
