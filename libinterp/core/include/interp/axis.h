/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axis.h - the axes of a machine, their pulses and limits
 *
 * Eight axes in one fixed order: X Y Z linear, A B C rotary about them, U V
 * the upper guide of a wire machine.  A place on an axis is counted in pulses
 * (1 pulse = 1 BLU): linear axes usually 0.001 mm, rotary 0.001 degree.
 * Wherever a name says _mm, a rotary axis means degrees.
 *
 * Units: in every name.  Threads: any thread; nothing here has state.
 */
#ifndef INTERP_AXIS_H
#define INTERP_AXIS_H

#include <stdbool.h>
#include <stdint.h>

enum interp_axis {
	INTERP_X, INTERP_Y, INTERP_Z,
	INTERP_A, INTERP_B, INTERP_C,
	INTERP_U, INTERP_V,
	INTERP_NAXES
};

/* Letters in the order of enum interp_axis; a NUL ends them. */
#define INTERP_AXIS_LETTERS	"XYZABCUV"

/* Farthest place an axis may have; keeps every product inside int64_t. */
#define INTERP_PULSES_MAX	(1 << 30)

/* What one axis can do; an absent one has a pulse too. */
struct interp_axis_limits {
	double pulse_mm;		/* worth of one pulse, > 0 */
	double travel_min_mm;		/* soft limits, machine coordinates */
	double travel_max_mm;
	double v_max_mm_s;		/* > 0 */
	double a_max_mm_s2;		/* > 0 */
	double j_max_mm_s3;		/* > 0 */
};

#define INTERP_NC_NWORK		9		/* work offsets: G54 ...
						 * G59.3 */

struct interp_machine {
	struct interp_axis_limits axis[INTERP_NAXES];
	uint32_t present;		/* bit per axis: the machine has it */
};

static inline bool interp_axis_is_rotary(enum interp_axis a)
{
	return a >= INTERP_A && a <= INTERP_C;
}

/**
 * interp_machine_travel() - more than any positioning has: all axes together.
 * Each segment says what the axes allow that move on it.
 */
void interp_machine_travel(const struct interp_machine *m, double *ret_a_mm_s2,
			   double *ret_j_mm_s3);

#endif /* INTERP_AXIS_H */
