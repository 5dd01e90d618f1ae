/* SPDX-License-Identifier: Apache-2.0 */
/*
 * prove.h - that a block keeps a clearance, or where it does not
 *
 * Conservative advancement: from each pose the proof goes on for the time in
 * which no point can come too near, until the end of the block.  Nothing is
 * sampled.
 *
 * Units: mm; time 0..1 of the block.  Any thread.
 * Source: B. Mirtich, Impulse-based dynamic simulation of rigid body systems,
 * 1996; the directed bound per pair of boxes is this project's (docs/plan.md).
 */
#ifndef PLAN_PROVE_H
#define PLAN_PROVE_H

#include "motion.h"

/* A pose that is nearer than the clearance plus this is refused.  So no step
 * can become arbitrarily short. */
#define PROVE_EPS_MM	0.002

/*
 * What is to be kept.  Within zone_mm of the end pose, counted by the farthest
 * way of any point of the electrode, the clearance falls linearly to end_mm.
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
	double t;			/* where */
	struct near_pair pair;		/* of it; begin with a zeroed one */
	bool given_up;			/* memory or patience ended; nothing is
					 * too near */
	uint64_t queries;		/* poses looked at; added to */
};

/** clearance_init() - of one value; clearance_end() lets it fall. */
void clearance_init(struct clearance *c, double mm);
void clearance_end(struct clearance *c, const struct mesh *tool,
		   const struct pose *end, double zone_mm, double end_mm);

/** clearance_at() - what is to be kept at @pose. */
double clearance_at(const struct clearance *c, const struct pose *pose);

/**
 * prove_block() - that no point of it comes nearer than @c.
 *
 * Return: whether.  If not, @p has the first time, within a step of the proof,
 * at which the distance is less than the clearance + PROVE_EPS_MM.
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

/* How sharp prove_least() is to be.  The finer one costs several times as
 * much, where the electrode passes a wall at nearly the same distance all
 * along. */
#define PROVE_FINE_MM	0.002
#define PROVE_COARSE_MM	0.02

/**
 * prove_least() - the largest clearance that can be proved, within @within_mm,
 * up to 100 mm.
 *
 * Return: it, proved; less than 0 if the electrode touches.  @p tells where the
 * block is nearest.
 */
double prove_least(const struct bodies *bodies, const struct block *b,
		   double within_mm, struct proof *p);

#endif /* PLAN_PROVE_H */
