/* SPDX-License-Identifier: Apache-2.0 */
/*
 * encoder.h - where an axis of pulses truly is, and the pulses it has lost
 *
 * A motor on step and direction does not tell when it stalls.  An encoder on
 * the axis does: if its place and the pulses put out differ by more than
 * following_max, that is a trouble until an operator's reset.  The reset takes
 * the encoder's word: the pulses that moved nothing are put out once more,
 * slowly, after the next start.  If they are too many, or if the encoder itself
 * lost count, the place of the axis is lost.
 *
 * Units: pulses, if nothing else is said; a count is a quarter period of the
 * encoder.  Threads: RT-safe, but encoder_init(), startup only.
 */
#ifndef IO_ENCODER_H
#define IO_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

struct encoder_config {
	int64_t counts, pulses;		/* so many counts are so many pulses;
					 * counts < 0 turns it round */
	int32_t following_max;		/* 0: not supervised */
	double lag_cycles;		/* it may lag by its way in so many */
	int32_t resync_max;		/* so many lost ones are made good */
	double slew;			/* a cycle, to do that */
};

struct encoder {
	struct encoder_config c;
	int64_t count, zero;		/* counts: now, and at pulse 0 */
	int32_t at;			/* measured place */
	int32_t lost;			/* put out in vain, as far as known */
	int32_t extra;			/* put out once more for them, so far */
	int32_t put;			/* put out in all, a cycle ago */
	double owed;			/* of slew, less than one */
	double lag;			/* the axis may lag by, now */
	bool stands;			/* zero is set */
	bool ill;			/* counts were missed */
	bool too_far;			/* until a reset */
};

/** encoder_init() - it counts, and stands nowhere yet. */
void encoder_init(struct encoder *e, const struct encoder_config *c);

/**
 * encoder_look() - a cycle: @count as read, @put pulses put out by now.
 *
 * @ok: no count was missed.  The first look says where the axis stands.
 */
void encoder_look(struct encoder *e, int64_t count, bool ok, int32_t put);

/** encoder_shift() - the pulses count from elsewhere: by @by more. */
void encoder_shift(struct encoder *e, int32_t by);

/**
 * encoder_reset() - an operator's reset.
 * Return: true if the place of the axis is lost with it.
 */
bool encoder_reset(struct encoder *e);

/** encoder_extra() - what to add to the target; @go: on the way back. */
int32_t encoder_extra(struct encoder *e, bool go);

/** encoder_is_well() - it is, and all that was lost is made good. */
bool encoder_is_well(const struct encoder *e);

#endif /* IO_ENCODER_H */
