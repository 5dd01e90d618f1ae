/* SPDX-License-Identifier: Apache-2.0 */
/*
 * encoder.h - where an axis of pulses truly is, and the pulses it has lost
 *
 * A stepper motor does not say that it has stalled.  An encoder on the axis
 * shows it: the measured place and the pulses that were put out then differ by
 * more than following_max.  The axis is in trouble until an operator resets it.
 * The axis is where the encoder says, and goes on from there.  Its place is
 * lost if the encoder itself has missed counts.
 *
 * Units: pulses, if nothing else is said; a count is a quarter period of the
 * encoder.  Threads: encoder_init() is startup only; all others are RT-safe.
 */
#ifndef IO_ENCODER_H
#define IO_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

struct encoder_config {
	int64_t counts, pulses;		/* this many counts are this many
					 * pulses; counts < 0: the encoder
					 * counts the other way */
	int32_t following_max;		/* 0: not supervised */
	double lag_cycles;		/* the axis may lag by what it moves in
					 * this many cycles */
};

struct encoder {
	struct encoder_config c;
	int64_t count, zero;		/* counts: now, and at pulse 0 */
	int32_t at;			/* measured place */
	int32_t put;			/* all pulses put out, a cycle ago */
	double lag;			/* how far the axis may lag now */
	bool stands;			/* zero is known */
	bool ill;			/* counts were missed */
	bool too_far;			/* it was too far off; until a reset */
};

/** encoder_init() - start with a place that is not known yet. */
void encoder_init(struct encoder *e, const struct encoder_config *c);

/**
 * encoder_look() - once a cycle: compare the place with the pulses.
 *
 * @count: as read; @ok: no count was missed; @put: all pulses put out by now;
 * @follows: the axis has power, and must be where they lead.
 * The first call sets where the axis is.
 */
void encoder_look(struct encoder *e, int64_t count, bool ok, int32_t put,
		  bool follows);

/** encoder_shift() - from now on the place has a number greater by @by. */
void encoder_shift(struct encoder *e, int32_t by);

/**
 * encoder_reset() - an operator's reset.
 * Return: true if the place of the axis is lost with it.
 */
bool encoder_reset(struct encoder *e);

#endif /* IO_ENCODER_H */
