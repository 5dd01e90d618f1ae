/* SPDX-License-Identifier: Apache-2.0 */
/*
 * process.h - the fields of the process: where the cycle keeps each of them
 *
 * interp/tech.h has the one table of names, units and ranges.  Here is what a
 * field is beyond the technology table: a setting of [gap] or [jump], or a
 * value that the generator is asked for.
 *
 * Units: in every name, as in interp/tech.h.
 * Threads: any.
 */
#ifndef WORDS_PROCESS_H
#define WORDS_PROCESS_H

#include "settings.h"

#include "interp/tech.h"

#include <stddef.h>

/* S(id, of, member): a field that replaces a setting of the machine file. */
#define PROCESS_SETTINGS(S) \
	S(SERVO_V, gap, servo_v) \
	S(WINDOW_LOW_V, gap, window_low_v) \
	S(WINDOW_HIGH_V, gap, window_high_v) \
	S(SHORT_V, gap, short_v) \
	S(OPEN_V, gap, open_v) \
	S(GAIN_MM_S_V, gap, gain_mm_s_v) \
	S(INTEGRAL_S, gap, integral_s) \
	S(FEED_MAX_MM_S, gap, feed_max_mm_s) \
	S(RETRACT_MM_S, gap, retract_mm_s) \
	S(ABORT_COUNT, gap, abort_count) \
	S(JUMP_MM, jump, height_mm) \
	S(JUMP_EVERY_S, jump, every.s) \
	S(JUMP_DEPTH_MM, jump, every_mm) \
	S(JUMP_SHORT_OF_MM, jump, short_of_mm)

/*
 * What crosses to the generator: the fields of a condition up to
 * INTERP_NGENERATOR, by enum interp_tech_id, and then these, which are 0 or 1.
 */
enum process_id {
	PROCESS_SENSE = INTERP_NGENERATOR,	/* the voltage to feel contact
						 * by */
	PROCESS_PUMP,
	PROCESS_SPARK,
	PROCESS_NFIELDS
};

#define PROCESS_VALUES_MAX	64

/* The values of one field that reach the generator. */
struct process_delivers {
	bool there;
	bool by_hand;			/* a person sets it */
	double min, max, step;		/* with n 0 */
	uint32_t n;			/* else these alone, in any order */
	double value[PROCESS_VALUES_MAX];
};

/** process_name() - of a field of enum process_id. */
const char *process_name(int field);

/**
 * process_nearest() - what the generator does when it is asked for @asked.
 *
 * For the peak current that is the nearest value not above it, for all else the
 * nearest one.  RT-safe.
 * Return: NAN if there is none: it is not delivered, or out of range.
 */
double process_nearest(const struct process_delivers *d, int field,
		       double asked);

/** process_range_text() - which values reach the generator, into @buf. */
void process_range_text(const struct process_delivers *d, int field, char *buf,
			size_t size);

/** process_names() - of a set of fields, a bit each, into @buf; returns it. */
const char *process_names(uint64_t fields, char *buf, size_t size);

/** process_setting() - where @gap or @jump has field @id; NULL: nowhere, the
 *  generator is asked for it, or nothing goes by it.  RT-safe. */
double *process_setting(enum interp_tech_id id, struct cycle_gap_config *gap,
			struct cycle_jump_config *jump);

/** process_base() - these settings as fields; the others are not given.
 *  RT-safe. */
void process_base(struct interp_tech *ret, const struct cycle_gap_config *gap,
		  const struct cycle_jump_config *jump);

#endif /* WORDS_PROCESS_H */
