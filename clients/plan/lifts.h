/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lifts.h - lifts that leave the path (G141 ... G143), proved
 *
 * Units: mm and degrees.
 */
#ifndef PLAN_LIFTS_H
#define PLAN_LIFTS_H

#include "check.h"

/**
 * lifts_check() - prove that lifts from every place on @w keep @c to their
 * ends.
 *
 * Return: 0, and @ret says whether they do; -EINTR.
 */
int lifts_check(const struct job *j, const struct route *w,
		const struct clearance *c, struct check_result *ret);

#endif /* PLAN_LIFTS_H */
