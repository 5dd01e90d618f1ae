/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ramp.h - estimates of how a move with a limit of jerk gets faster
 *
 * Private to libinterp/compile.  Accelerations are in mm/s2, jerks in mm/s3.
 */
#ifndef SPEED_RAMP_H
#define SPEED_RAMP_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/** ramp_slope_mm_s2() - what is left of acceleration @a in the mean of a
 *  ramp that gets faster by @v_mm_s. */
static inline double ramp_slope_mm_s2(double v_mm_s, double a, double j)
{
	return v_mm_s * j >= a * a ? v_mm_s / (v_mm_s / a + a / j) :
				     sqrt(v_mm_s * j) / 2;
}

/**
 * ramp_root3() - the cube root of @x >= 0, within 10^-5 of it.
 *
 * That is near enough for an estimate, and it costs a tenth of cbrt().  A third
 * of the bits of a float is within 4 %.
 */
static inline double ramp_root3(double x)
{
	const float near = (float)x;
	uint32_t bits;
	double y;
	float f;

	memcpy(&bits, &near, sizeof(bits));
	bits = bits / 3 + 709921077;
	memcpy(&f, &bits, sizeof(f));
	y = (double)f;
	y = (2 * y + x / (y * y)) / 3;
	return (2 * y + x / (y * y)) / 3;
}

/** ramp_rise_mm_s() - how much faster it gets on @mm, from a stand and back to
 *  one. */
static inline double ramp_rise_mm_s(double mm, double a, double j)
{
	return 16 * a * a * a < j * j * mm ? sqrt(a * mm) :
					     ramp_root3(j * mm * mm / 4);
}

#endif /* SPEED_RAMP_H */
