/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_learnt.h - what jobs took to cut, of what was forecast
 *
 * There is a row for each condition, material of the electrode, and material of
 * the work, as far as these are known.  Each job counts by its time, and half
 * as much after each later one.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_STORE_LEARNT_H
#define JOBS_STORE_LEARNT_H

struct store;

/* Which row; "": not known. */
struct store_learnt {
	const char *condition, *electrode, *work;
};

/** store_learnt_add() - a job passed @passed_s in what was forecast to take
 *  @expected_s. */
int store_learnt_add(struct store *s, const struct store_learnt *l,
		     double passed_s, double expected_s);

/** store_learnt_factor() - passed over expected; 0: there is no row. */
double store_learnt_factor(struct store *s, const struct store_learnt *l);

#endif /* JOBS_STORE_LEARNT_H */
