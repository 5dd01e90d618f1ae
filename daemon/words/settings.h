/* SPDX-License-Identifier: Apache-2.0 */
/*
 * settings.h - what the machine file says and the cycle reads
 *
 * The table of keys (daemon/config/keys_*.c) writes most members of these
 * structs directly.  A time in the file is in seconds; a member in cycles is
 * made of it by config_cycle().
 *
 * Units: in every name.
 * Threads: any; plain data.
 */
#ifndef WORDS_SETTINGS_H
#define WORDS_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

/* -- The gap: [gap] ------------------------------------------------------- */

/* Where the sparks are: in a cavity, or along a wire. */
enum cycle_process {
	PROCESS_SINK,
	PROCESS_WIRE,
	CYCLE_NPROCESSES
};

enum gap_source {
	GAP_SIM,
	GAP_VOLTAGE,
	GAP_SHARES,
	GAP_LINES,
	GAP_CAN,
	GAP_COUNTS,
	GAP_NSOURCES
};

enum gap_filter {
	GAP_MEDIAN,
	GAP_FIRST_ORDER,
	GAP_NFILTERS
};

enum retract_to {
	RETRACT_LIMIT,			/* retract_limit_mm */
	RETRACT_START,			/* the start of the program */
	RETRACT_MOTION,			/* the start of the motion it is in */
	RETRACT_NPLACES
};

/* How far a wire goes back from where it broke. */
enum retreat_to {
	RETREAT_DISTANCE,		/* wire_retreat_mm */
	RETREAT_MOTION,			/* the start of the motion it is in */
	RETREAT_HOLE,			/* the start hole: rt/path/hole.h */
	RETREAT_NPLACES
};

/* A time of the machine file. */
struct cycle_time {
	double s;			/* as the file has it */
	uint64_t cycles;		/* config_cycle() counts them */
};

struct cycle_gap_config {
	enum cycle_process process;
	enum gap_source source;
	enum gap_filter filter;
	uint32_t filter_cycles;		/* 0, 1: none */
	uint32_t short_cycles;		/* so many in a row make a short; 0
					 * counts as 1 */
	double servo_v;			/* the mean gap voltage to hold */
	double short_v;			/* below it the gap is shorted */
	double open_v;			/* above it there is nothing to cut
					 * yet */
	double window_low_v;		/* lower end of the window; 0:
					 * derived */
	double window_high_v;		/* upper end of the window; 0:
					 * servo_v */
	double ignition_v;		/* of an open circuit; 0: not known */
	double gain_mm_s_v;		/* feed per volt outside the window */
	double integral_s;		/* reset time; 0: without an integral */
	double feed_max_mm_s;		/* fastest feed while eroding */
	double creep_mm_s;		/* fastest back, while eroding */
	double feed_a_mm_s2;		/* of the servo; 0: that of the axes */
	double approach_mm_s;		/* feed until the first spark */
	double share_v;			/* volts that a share of 1 is worth */
	double share_set;		/* the weighted share to hold */
	double share_weight;		/* weight of shorts and arcs against
					 * opens */
	double share_short;		/* from this share of shorts on it is a
					 * short */
	double share_open;		/* from this share of opens on it is
					 * open */
	double share_mm;		/* feed that one reading is good for */
	double share_pulses;		/* that a reading is of */
	double share_stale_ms;		/* then there is none any more */
	double retract_mm_s;		/* speed of a retract */
	enum retract_to retract_to;
	double retract_limit_mm;	/* there it stands and waits */
	struct cycle_time retract_wait;	/* after that: fault
					 * short-not-cleared */
	struct cycle_time retract_max;	/* after that: fault retract-time; 0:
					 * never */
	uint32_t retract_escape;	/* 1: leave a short by the escape */
	double abort_count;		/* most retracts without erosion; 0: any
					 * number */
	double progress_mm;		/* so much more depth counts as
					 * erosion */
	double arcing_share;		/* a greater share is arcing; 0: not
					 * watched */
	uint32_t arcing_cycles;		/* the share is a mean over so many */
	double arcing_sigma_v;		/* a plateau that is steadier than
					 * this is an arc; 0: not judged by
					 * voltage */
	double off_us;			/* off time of the generator; 0: not
					 * known */
	double arcing_off_max;		/* largest factor on the off time,
					 * against arcs */
	struct cycle_time arcing_recover;	/* until a step of the
						 * off time is given
						 * back */
	double arcing_retract_mm;		/* least retract out of an
						 * arc */
	struct cycle_time stuck;		/* so long without a change is a fault;
					 * 0: never */
	double noise_limit_v;		/* largest mean change in a cycle; 0:
					 * any */
	double wire_retract_mm;		/* limit of a retract of a wire */
	enum retreat_to wire_retreat_to;	/* from a break */
	double wire_retreat_mm;
};

/* -- Jumps: [jump] -------------------------------------------------------- */

struct cycle_jump_config {
	double height_mm;		/* 0: never */
	struct cycle_time every;	/* erosion between two jumps */
	double every_mm;		/* depth between two jumps; 0: by time
					 * alone */
	uint32_t adaptive;		/* 1: flush.h */
	struct cycle_time every_min, every_max;
	double height_min_mm, height_max_mm;
	double bad_share;		/* bad share of the time between two
					 * jumps */
	double v_max_mm_s, a_max_mm_s2, j_max_mm_s3;
	double a_down_mm_s2;		/* toward the cut; 0: a_max_mm_s2 */
	double short_of_mm;		/* come back to this far above the
					 * cut */
};

/* -- Probing the work: [probe] -------------------------------------------- */

struct probe_config {
	double feed_mm_s;		/* speed to the first contact */
	double fine_mm_s;		/* speed to the contact that counts */
	double back_mm;			/* distance between them; 0: the first
					 * counts */
	struct cycle_time settle;	/* wait for the sensing voltage at
					 * first */
};

/* -- Jogs and homing: [axis.*] -------------------------------------------- */

enum home_method {
	HOME_NONE,
	HOME_SWITCH,
	HOME_SWITCH_INDEX,
	HOME_ABSOLUTE,
	HOME_DRIVE,
	HOME_NMETHODS
};

struct manual_axis {
	bool present;
	double pulse_mm;
	double v_max_mm_s, a_max_mm_s2, j_max_mm_s3;
	double jog_mm_s;
	enum home_method method;
	int home_toward;		/* +1, -1 */
	double home_fast_mm_s, home_slow_mm_s;
	double home_at_mm;		/* the place of the switch */
	double home_back_mm;
	double home_search_mm;		/* beyond where it ought to be found */
	uint32_t home_order;		/* lowest first */
};

#endif /* WORDS_SETTINGS_H */
