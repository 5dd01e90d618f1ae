/* SPDX-License-Identifier: Apache-2.0 */
/*
 * caps.h - tops of a speed that the jerk rounds off
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_CAPS_H
#define SPEED_CAPS_H

#include "speed/profile.h"

/**
 * caps_round() - lower the speeds of @p so that no axis needs more than its
 * jerk to let go of its acceleration.
 *
 * Return: 0, -ENOMEM.
 */
int caps_round(struct profile *p, const struct interp_axes *x);

/** caps_interval_s() - the time from place @i to the next one. */
double caps_interval_s(const struct profile *p, size_t i);

#endif /* SPEED_CAPS_H */
