/* SPDX-License-Identifier: Apache-2.0 */
/*
 * check.h - a whole way proved, or its first contact
 *
 * Units: mm and degrees.
 */
#ifndef PLAN_CHECK_H
#define PLAN_CHECK_H

#include "job.h"

struct check_result {
	bool ok;
	bool given_up;			/* on block; memory or patience ended */
	bool lift;			/* in a lift beside the path */
	bool inside;			/* the way begins inside: no distance */
	char say[80];			/* then, which inside which */
	uint32_t block;			/* of the first contact */
	double t;			/* 0..1 on it */
	double q[INTERP_NAXES];		/* the axes there */
	struct near_pair pair;
	double wanted_mm;		/* there */
	double least_mm;		/* seen at any pose looked at */
	uint32_t least_block;
	double most_added_mm;		/* to the clearance, for what strays */
	uint64_t queries;
};

/**
 * check_way() - prove all of @w, or find the first contact.
 *
 * Return: 0, or -ENOMEM, or -EINTR.
 */
int check_way(const struct job *j, const struct route *w,
	      const struct clearance *c, struct check_result *ret);

/** check_clearance() - the clearance of a way that ends where @w does. */
int check_clearance(const struct job *j, const double end[INTERP_NAXES],
		    struct clearance *ret);

/**
 * check_block() - is the straight block from @from to @to proved to keep @c?
 *
 * It adds to @c what pulses may stray and the chord error of the meshes.
 * @pair is as in near_distance(); if the answer is no, the pair that is too
 * near.
 */
bool check_block(const struct job *j, const double from[INTERP_NAXES],
		 const double to[INTERP_NAXES], const struct clearance *c,
		 struct near_pair *pair);

/** check_say_left() - how much of the clearance is left at the first
 *  contact. */
void check_say_left(const struct check_result *r, FILE *f);

/** check_program() - --check. Return: 0 proved, 1 not; else sysexits. */
int check_program(struct job *j);

#endif /* PLAN_CHECK_H */
