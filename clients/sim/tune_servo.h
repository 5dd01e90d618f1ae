/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tune_servo.h - edmsim --tune: keys of [gap] and [jump] for one kind of work
 *
 * A trial runs the job for some seeds with one set of values. tune_servo.c
 * looks for the set with the best result and prints it.
 */
#ifndef SIM_TUNE_SERVO_H
#define SIM_TUNE_SERVO_H

#include "sim.h"
#include "trials.h"

#define TRIAL_SEEDS_MAX	16

/* What a trial runs; the job and the options are only read. */
struct trial {
	const struct sim_options *o;
	const struct sim_job *job;
	uint64_t seed;			/* the first; the others follow it */
	uint32_t seeds;
	double limit_s;			/* virtual, of each run */
};

/* Over all runs of it.  A run that ends in a fault stands for the rest of
 * its time and removes nothing. */
struct trial_sum {
	double minutes;			/* that were run */
	double removal_mm3_min;
	double shorts_min, retracts_min, arcs_min, burns_min;
	double wear_mm_mm3;		/* electrode lost per volume */
	uint32_t runs, faults;
};

/**
 * trial_run() - do the runs, on as many processors as there are.
 *
 * Return: 0; -EINTR if a signal ended one; an exit code of run_job().
 */
int trial_run(const struct trial *t, const struct machine_config *c,
	      struct trial_sum *ret);

#define TUNE_KEYS_MAX	8

/* A key that is tuned, over a range of ratios. */
struct tune_key {
	int row;			/* for config_key() */
	double min, max;
	double none_above;		/* written as 0 from here on; 0:
					 * never */
};

struct tune {
	const struct machine_config *was;
	struct machine_config now;	/* with the best values */
	struct tune_key key[TUNE_KEYS_MAX];
	uint32_t nkeys;
	struct trial train, test;
	struct trial_sum before, after;	/* on the seeds it was tuned on */
	struct trial_sum test_before, test_after;	/* on others */
	double score, test_score;	/* docs/gap-servo.md; as it was: 0 */
	uint32_t used, budget;
	struct trials trials;
	bool better, tested, interrupted;
	int e;				/* of a trial that could not be run */
};

/**
 * tune_servo() - the command. Return: an exit code whose reason was printed.
 */
int tune_servo(const struct sim_options *o, const struct machine_config *c,
	     const struct sim_job *job);

/** tune_score() - how much better @s is than @ref. */
double tune_score(const struct trial_sum *s, const struct trial_sum *ref);

/** tune_value() - the value of a key that is tuned. */
double tune_value(const struct tune_key *k, const struct machine_config *c);

/** tune_print() - lines for a machine file; tune_write() - JSON. */
void tune_print(const struct tune *t, FILE *f);
int tune_write(const struct tune *t, FILE *f);

#endif /* SIM_TUNE_SERVO_H */
