/* SPDX-License-Identifier: Apache-2.0 */
/*
 * length_eta.h - the time left, by the way that is cut
 *
 * The path is divided into parts that are cut and parts that are positioned.
 * What was cut is taken to have passed at the same pace as what is to come.
 * Each condition has its own pace, and so has each depth, so this is wrong by a
 * factor of two and more: tests/experiments/times compares it.
 *
 * Threads: one object belongs to one thread.
 */
#ifndef TRIED_LENGTH_ETA_H
#define TRIED_LENGTH_ETA_H

#include "interp/program.h"

#include <stddef.h>

/* From here on the path is cut, or positioned; before it so much was cut. */
struct length_part {
	double s_mm, cut_mm;
	bool cut;
};

/* Fields are private; all 0 at first. */
struct length_eta {
	struct length_part *part;
	size_t nparts;
	double cut_mm;			/* of the whole path */
};

/**
 * length_eta_measure() - divide @p into its parts. Return: 0; or -ENOMEM, and
 * then it has none.
 */
int length_eta_measure(struct length_eta *l, const struct interp_program *p);

/**
 * length_eta_s() - the estimate in s, if @far_mm of the path took @job_s.
 *
 * Return: -1 if there is none, because nothing has been cut yet.
 */
double length_eta_s(const struct length_eta *l, double far_mm, double job_s);

/** length_eta_fini() - free everything. */
void length_eta_fini(struct length_eta *l);

#endif /* TRIED_LENGTH_ETA_H */
