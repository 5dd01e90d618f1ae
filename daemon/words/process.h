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
 * Of a condition's, edmd goes by the settings itself: they cross where the
 * machine file lays them out, and nothing is lost where it does not.
 * Those from PROCESS_NFIELDS it can only tell: sums that run on, of pulses and
 * of the energy of their discharges, and the number of its own fault.
 */
enum process_id {
	PROCESS_SENSE = INTERP_NGENERATOR,	/* the voltage to feel contact
						 * by */
	PROCESS_PUMP,
	PROCESS_SPARK,
	PROCESS_NFIELDS,
	PROCESS_OPENS = PROCESS_NFIELDS,
	PROCESS_SPARKS,
	PROCESS_ARCS,
	PROCESS_SHORTS,
	PROCESS_ENERGY_J,
	PROCESS_FAULT,			/* 0: none */
	PROCESS_NTOLD
};

/* No generator does more: a sum that seems to have gone on faster was reset. */
#define PROCESS_MOST_PULSES_S	1e6
#define PROCESS_MOST_W		1e5

/* T(name, id): all that a generator can tell. */
#define PROCESS_TELLS(T) \
	T(peak_a, INTERP_TECH_PEAK_A) \
	T(on_us, INTERP_TECH_ON_US) \
	T(off_us, INTERP_TECH_OFF_US) \
	T(polarity, INTERP_TECH_POLARITY) \
	T(ignition_v, INTERP_TECH_IGNITION_V) \
	T(iso, INTERP_TECH_ISO) \
	T(servo_v, INTERP_TECH_SERVO_V) \
	T(opens, PROCESS_OPENS) \
	T(sparks, PROCESS_SPARKS) \
	T(arcs, PROCESS_ARCS) \
	T(shorts, PROCESS_SHORTS) \
	T(energy_j, PROCESS_ENERGY_J) \
	T(fault, PROCESS_FAULT)

#define PROCESS_VALUES_MAX	64

/* The values of one field that reach the generator. */
struct process_delivers {
	bool there;
	bool by_hand;			/* a person sets it */
	bool stays;			/* until it gets another one */
	bool measured;			/* what it tells is not what is set */
	double min, max, step;		/* with n 0 */
	uint32_t n;			/* else these alone, in any order */
	double value[PROCESS_VALUES_MAX];
};

/** process_name() - of a field of enum process_id, also of one that is only
 *  told. */
const char *process_name(int field);

/** process_unit() - the same; "" if it has none. */
const char *process_unit(int field);

/** process_is_sum() - is it a sum that only runs on? */
static inline bool process_is_sum(int field)
{
	return field >= PROCESS_OPENS && field <= PROCESS_ENERGY_J;
}

/**
 * process_told_text() - what a generator tells, as "peak_a 6 A, sparks 1200",
 * into @buf; "" for nothing.  @told: by enum process_id; NAN: not that.
 */
const char *process_told_text(const double told[PROCESS_NTOLD], char *buf,
			      size_t size);

/**
 * process_nearest() - what the generator does when it is asked for @asked.
 *
 * For the peak current that is the nearest value not above it, for all else the
 * nearest one.  RT-safe.
 * Return: NAN if there is none: it is not delivered, or out of range.
 */
double process_nearest(const struct process_delivers *d, int field,
		       double asked);

/** process_takes() - may a condition give @value?  Also where it is not
 *  delivered and nothing is lost by that.  RT-safe. */
bool process_takes(const struct process_delivers *d, int field, double value);

/** process_is_setting() - is it one that edmd goes by itself too, and is lost
 *  nowhere?  @field: of enum process_id.  RT-safe. */
bool process_is_setting(int field);

/** process_range_text() - which values reach the generator, into @buf. */
void process_range_text(const struct process_delivers *d, int field, char *buf,
			size_t size);

/** process_setting() - where @gap or @jump has field @id; NULL: nowhere, the
 *  generator is asked for it, or nothing goes by it.  RT-safe. */
double *process_setting(enum interp_tech_id id, struct cycle_gap_config *gap,
			struct cycle_jump_config *jump);

/** process_base() - these settings as fields; the others are not given.
 *  RT-safe. */
void process_base(struct interp_tech *ret, const struct cycle_gap_config *gap,
		  const struct cycle_jump_config *jump);

#endif /* WORDS_PROCESS_H */
