/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive.h - one CiA 402 drive in cyclic synchronous position, seen from its
 * master: frames in, frames out, no socket
 *
 * A drive is brought up by SDO, in NMT state pre-operational, one request in
 * flight, a step a period at the most: identity, heartbeats both ways, one
 * RPDO (6040 and 607A), one TPDO (6041 and 6064), both with every SYNC, mode
 * 8, interpolation time.  Then it is started, and led through the state
 * machine of CiA 402 by its statusword.
 *
 * Its target is its own actual position until it is enabled, so that enabling
 * moves nothing.
 *
 * Units: pulses are the machine's, increments the drive's; time in cycles.
 * Threads: RT-safe; one object belongs to one thread.
 */
#ifndef IO_DRIVE_H
#define IO_DRIVE_H

#include "can_msg.h"

#include <stdbool.h>
#include <stddef.h>

/* States of CiA 402, by the statusword. */
enum drive_state {
	DRIVE_NOT_READY,		/* to switch on; or never heard of */
	DRIVE_DISABLED,			/* switch on disabled */
	DRIVE_READY,			/* to switch on */
	DRIVE_SWITCHED_ON,
	DRIVE_ENABLED,			/* operation enabled */
	DRIVE_QUICK_STOP,
	DRIVE_FAULT_REACTION,
	DRIVE_FAULT,
	DRIVE_NSTATES
};

/* Where the master wants it. */
enum drive_goal {
	DRIVE_GO_OFF,			/* no torque */
	DRIVE_GO_STOP,			/* quick stop, then off */
	DRIVE_GO_ON,
	DRIVE_NGOALS
};

/* How far it is brought up. */
enum drive_phase {
	DRIVE_SILENT,			/* asked, not answered yet */
	DRIVE_CONFIGURED_NEXT,		/* SDO steps under way */
	DRIVE_RUNNING,			/* NMT operational: PDOs flow */
	DRIVE_REFUSED,			/* an SDO was aborted: see note */
};

/* What is wrong with it; the first one stays until drive_reset(). */
enum drive_trouble {
	DRIVE_WELL,
	DRIVE_EMERGENCY,		/* EMCY, or state fault */
	DRIVE_FELL_OFF,			/* out of operation enabled by itself */
	DRIVE_FOLLOWING,		/* too far from its target */
	DRIVE_MUTE,			/* no heartbeat */
	DRIVE_NO_ANSWER,		/* no TPDO for too many SYNCs */
	DRIVE_REBOOTED,			/* its settings are gone */
	DRIVE_MISCONFIGURED,		/* an SDO refused */
	DRIVE_NTROUBLES
};

struct drive_config {
	uint8_t node;			/* 1 ... 127 */
	uint8_t master;			/* our own node, for its heartbeat */
	int32_t increments, pulses;	/* so many increments are so many
					 * pulses; both not 0 */
	uint32_t period_us;		/* of SYNC: interpolation time */
	uint32_t heartbeat_ms;
	uint32_t beat_cycles;		/* no heartbeat for so long: mute */
	uint32_t answer_cycles;		/* an SDO is repeated after this */
	uint32_t missing_max;		/* TPDOs missing in a row */
	int32_t following_max;		/* pulses; 0: not supervised */
	int32_t slew_increments;	/* a cycle, to its place when enabled */
};

/* Targets a measured place may belong to. */
#define DRIVE_SENT	3

struct drive {
	struct drive_config c;
	enum drive_phase phase;
	enum drive_state state;
	enum drive_goal goal;
	enum drive_trouble trouble;
	uint16_t status;		/* statusword */
	uint16_t emergency;		/* last EMCY code; 0: none */
	uint32_t emergencies;		/* with a code, since a reset */
	uint32_t abort;			/* SDO abort code, with its place: */
	uint16_t abort_index;
	uint8_t abort_sub;
	bool heard;			/* an actual position has come */
	bool homed;			/* zero is set: targets are ours */
	int32_t actual;			/* increments, as measured */
	int32_t zero;			/* increments at pulse 0 */
	int32_t target;			/* increments, as last sent */
	int32_t sent[DRIVE_SENT];	/* targets of the last SYNCs */
	bool arrived;			/* enabled, and on the machine's place */
	uint32_t step, tries;		/* SDO */
	uint32_t waited;		/* cycles since the last request */
	bool quiet, asked;		/* told to send no PDOs; a request out */
	uint32_t unanswered;		/* steps given up, in all */
	uint32_t silent;		/* cycles since a heartbeat */
	uint32_t missing;		/* SYNCs without a TPDO */
	uint32_t enabled_for;		/* cycles in operation enabled */
	bool answered;			/* a TPDO came since the last SYNC */
	bool edge;			/* fault reset: bit 7 was high */
	uint32_t resetting;		/* cycles it may still report a fault */
	uint32_t malformed;		/* frames of a wrong length, and answers
					 * to nothing asked, in all */
};

/** drive_init() - nothing known, asked for nothing. */
void drive_init(struct drive *d, const struct drive_config *c);

/** drive_receive() - a frame; false if it is not of this drive. */
bool drive_receive(struct drive *d, const struct can_msg *m);

/**
 * drive_sync() - a SYNC went out: count what did not come since the last one.
 */
void drive_sync(struct drive *d);

/**
 * drive_emit() - frames to send this period: SDO, NMT or RPDO.
 *
 * @target: pulses; used while the drive is enabled and @homed.
 * Return: how many, at most DRIVE_EMITS, into @ret.
 */
size_t drive_emit(struct drive *d, int32_t target, struct can_msg *ret);

#define DRIVE_EMITS	1

/** drive_aim() - where the master wants it. */
void drive_aim(struct drive *d, enum drive_goal goal);

/** drive_reset() - forget the trouble; a rebooted one is brought up again. */
void drive_reset(struct drive *d);

/** drive_depart() - its next target is another place: go there slowly. */
void drive_depart(struct drive *d);

/** drive_set_zero() - what it measures now is place @pulses. */
void drive_set_zero(struct drive *d, int32_t pulses);

/** drive_keep_zero() - place 0 is at @zero increments, as it was before. */
void drive_keep_zero(struct drive *d, int32_t zero);

/** drive_place() - its actual position in pulses, toward the nearest. */
int32_t drive_place(const struct drive *d);

/** drive_to_increments() - exact for every pulse: no rounding adds up. */
int32_t drive_to_increments(const struct drive_config *c, int32_t pulses);

/** drive_state_of() - by the statusword. */
enum drive_state drive_state_of(uint16_t status);

/** drive_control() - the controlword that leads from @s toward @goal. */
uint16_t drive_control(enum drive_goal goal, enum drive_state s);

/** drive_state_name(), drive_trouble_name() - for logs. Any thread. */
const char *drive_state_name(enum drive_state s);
const char *drive_trouble_name(enum drive_trouble t);

/* -- drive_setup.c: the SDO steps -------------------------------------------- */

/** drive_setup_emit() - the request of the step at hand, if it is due. */
size_t drive_setup_emit(struct drive *d, struct can_msg *ret);

/** drive_setup_again() - from the first step on. */
void drive_setup_again(struct drive *d);

/**
 * drive_setup_end() - frames that leave it alone: not to watch for our
 * heartbeat any more, and pre-operational.  Return: 0 or DRIVE_ENDS.
 */
size_t drive_setup_end(const struct drive *d, struct can_msg *ret);

#define DRIVE_ENDS	2

/** drive_setup_receive() - an SDO answer. */
void drive_setup_receive(struct drive *d, const struct can_msg *m);

#endif /* IO_DRIVE_H */
