/* SPDX-License-Identifier: Apache-2.0 */
/*
 * check.h - prove a whole way free of contact, or find its first contact
 *
 * Units: mm and degrees.
 */
#ifndef PLAN_CHECK_H
#define PLAN_CHECK_H

#include "job.h"

struct check_result {
	bool ok;
	bool given_up;			/* on block: memory ran out, or it took
					 * too many steps */
	bool lift;			/* the contact is in a lift beside the
					 * path */
	bool inside;			/* one body is inside the other at the
					 * start: there is no distance */
	char say[80];			/* then: which one is inside which */
	uint32_t block;			/* of the first contact */
	double t;			/* where on it, 0 to 1 */
	double q[INTERP_NAXES];		/* the axes there */
	struct near_pair pair;
	double wanted_mm;		/* the clearance wanted there */
	double least_mm;		/* the least distance that was seen */
	uint32_t least_block;
	double most_added_mm;		/* the most that was added to the
					 * clearance, because pulses stray */
	uint64_t queries;
};

/**
 * check_way() - prove all of @w, or find the first contact.
 *
 * Return: 0, or -ENOMEM, or -EINTR.
 */
int check_way(const struct job *j, const struct route *w,
	      const struct clearance *c, struct check_result *ret);

/** check_clearance() - fill in the clearance for a way that ends where @w
 *  ends. */
int check_clearance(const struct job *j, const double end[INTERP_NAXES],
		    struct clearance *ret);

/**
 * check_block() - is the straight block from @from to @to proved to keep @c?
 *
 * To @c it adds how far pulses may stray, and the chord error of the meshes.
 * @pair is as in near_distance(); if the answer is no, it is the pair that is
 * too near.
 */
bool check_block(const struct job *j, const double from[INTERP_NAXES],
		 const double to[INTERP_NAXES], const struct clearance *c,
		 struct near_pair *pair);

/** check_say_left() - print how much of the clearance is left at the first
 *  contact. */
void check_say_left(const struct check_result *r, FILE *f);

/** check_program() - do what --check asks. Return: 0: it is proved; 1: it is
 *  not; else a sysexits code. */
int check_program(struct job *j);

#endif /* PLAN_CHECK_H */
