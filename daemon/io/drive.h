/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive.h - one CiA 402 drive in cyclic synchronous position mode, as its
 * master sees it: frames in, frames out, no socket
 *
 * While the drive is in NMT state pre-operational, it is set up by SDO, with
 * one request at a time and at most one step per period: its identity;
 * heartbeats in both directions; one RPDO (6040 and 607A) and one TPDO (6041,
 * 6064 and 6061), both with every SYNC; the values that the machine file asks
 * for; mode 8; the interpolation time. Then it is started, and led by its
 * statusword through the state machine of CiA 402.
 *
 * Its target is its own actual position until it is enabled, shows mode 8 and
 * reports that it follows (bit 12). So enabling it moves nothing.
 *
 * A drive that restarted has lost its count, unless the machine file says that
 * it is absolute. Then `lost` is set until somebody tells it where it stands. A
 * restart that nobody heard is found when the drive is set up: edmd wrote its
 * own node into object 1016:1, and a drive forgets this when it loses power.
 *
 * Units: pulses are those of the machine, increments those of the drive; time
 * is in cycles.
 *
 * Threads: RT-safe; one object belongs to one thread.
 */
#ifndef IO_DRIVE_H
#define IO_DRIVE_H

#include "can_msg.h"

#include <stdbool.h>
#include <stddef.h>

/* States of CiA 402, by the statusword. */
enum drive_state {
	DRIVE_NOT_READY,		/* to switch on; or not heard yet */
	DRIVE_DISABLED,			/* switch on disabled */
	DRIVE_READY,			/* to switch on */
	DRIVE_SWITCHED_ON,
	DRIVE_ENABLED,			/* operation enabled */
	DRIVE_QUICK_STOP,
	DRIVE_FAULT_REACTION,
	DRIVE_FAULT,
	DRIVE_NSTATES,
	DRIVE_NO_STATE = DRIVE_NSTATES	/* a statusword that is no state */
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
	DRIVE_EMERGENCY,		/* it is in the state fault, or sent an
					 * EMCY and does not answer */
	DRIVE_FELL_OFF,			/* it left operation enabled by
					 * itself */
	DRIVE_FOLLOWING,		/* too far from its target */
	DRIVE_MUTE,			/* no heartbeat */
	DRIVE_NO_ANSWER,		/* no TPDO for too many SYNCs */
	DRIVE_STRANGE,			/* its statusword is no state */
	DRIVE_REBOOTED,			/* its settings are gone */
	DRIVE_MISCONFIGURED,		/* an SDO refused */
	DRIVE_OTHER_MODE,		/* left mode 8, or never came to it */
	DRIVE_NOT_LED,			/* bit 12: it ignores its target */
	DRIVE_LIMITED,			/* bit 11: its target is clipped */
	DRIVE_NOT_STARTED,		/* NMT: not operational any more */
	DRIVE_POWERLESS,		/* it does not take power, or lost it */
	DRIVE_TWICE,			/* more answers than SYNCs: whose are
					 * they? */
	DRIVE_NTROUBLES
};

/* A number the machine file wants in a drive. */
struct drive_write {
	uint16_t index;
	uint8_t sub, bytes;
	uint32_t value;
	bool may_miss;			/* a drive may not have the object */
};

#define DRIVE_WRITES	24
#define DRIVE_LEAVES	8

struct drive_config {
	uint8_t node;			/* 1 ... 127 */
	uint8_t master;			/* our own node, for its heartbeat */
	int32_t increments, pulses;	/* this many increments are this many
					 * pulses; neither is 0 */
	uint32_t period_us;		/* of SYNC: interpolation time */
	uint32_t heartbeat_ms;
	uint32_t beat_cycles;		/* no heartbeat for this long: mute */
	uint32_t answer_cycles;		/* an SDO is repeated after this */
	uint32_t missing_max;		/* TPDOs missing in a row */
	int32_t following_max;		/* pulses; 0: not supervised */
	double lag_cycles;		/* it may lag by what it moves in this
					 * many cycles */
	uint32_t limited_cycles;	/* bit 11 may be set for this long */
	bool absolute;			/* it keeps its place without power */
	bool held;			/* it has no brake and keeps its torque
					 * in quick stop too */
	bool no_follow_bit;		/* it does not have bit 12 */
	uint32_t identity[4];		/* 1018:1 ... 4, where ... */
	uint8_t identified;		/* ... this has bit 0 ... 3 */
	struct drive_write write[DRIVE_WRITES];
	uint32_t nwrites;
	uint16_t leave[DRIVE_LEAVES];	/* objects that the set-up does not
					 * touch */
	uint32_t nleaves;
};

/* Bits of the statusword that are told when they come. */
#define DRIVE_WARNS	0x0880u		/* warning, internal limit */

/* How many of the last targets a measured place may belong to. */
#define DRIVE_SENT	3

/* What happens after a refused SDO. */
enum drive_passed {
	DRIVE_NOT_PASSED,		/* the drive cannot be used */
	DRIVE_WITHOUT,			/* the object is not needed */
	DRIVE_ALREADY,			/* the object has that value already */
	DRIVE_ANOTHER,			/* another value is tried */
	DRIVE_LATER,			/* the same request is sent again */
};

struct drive {
	struct drive_config c;
	enum drive_phase phase;
	enum drive_state state;
	enum drive_goal goal;
	enum drive_trouble trouble;
	bool unset;			/* set it up again at the next reset */
	uint16_t status;		/* statusword */
	uint16_t emergency;		/* last EMCY code; 0: none */
	uint32_t emergencies;		/* with a code, since a reset */
	uint32_t alarmed;		/* so many SYNCs after the last one must
					 * be answered */
	uint32_t aborts;		/* SDOs it refused, in all; the last: */
	uint32_t abort, abort_value;	/* its code, 0: a value read does not
					 * do; what was written, or read */
	uint16_t abort_index;
	uint8_t abort_sub;
	enum drive_passed passed;	/* what came of it */
	uint8_t mode;			/* as it shows it: 6061 */
	bool shows_mode;		/* 6061 is in its TPDO */
	bool heard;			/* a TPDO has come */
	bool stands;			/* ... in a state that has a place */
	bool homed;			/* zero is set: targets are ours */
	bool lost;			/* it restarted: zero means nothing */
	int32_t actual, was;		/* increments, as measured, now and a
					 * period ago */
	int32_t zero;			/* increments at pulse 0 */
	int32_t target;			/* increments, as last sent */
	int32_t sent[DRIVE_SENT];	/* targets of the last SYNCs */
	double lag;			/* increments it may lag by, now */
	bool led;			/* enabled, and follows its targets */
	bool joined;			/* ... which are those of the cycle;
					 * before, it is held where it stood */
	uint32_t step, tries;		/* SDO */
	uint32_t word;			/* read last, for the steps after it */
	uint32_t choice;		/* of interpolation times */
	int8_t time_index;		/* ... as the drive has it */
	uint32_t refused;		/* abort of a write that is read back */
	uint32_t sized;			/* in this step the object has ... */
	uint8_t bytes;			/* ... so many; 0: as usual */
	bool reading_back;
	bool remode;			/* write 6060 once more */
	uint32_t waited;		/* cycles since the last request */
	bool quiet, asked;		/* told to send no PDOs; a request is
					 * not answered yet */
	uint32_t unanswered;		/* steps given up, in all */
	uint32_t busy;			/* aborts that may pass */
	uint32_t silent;		/* cycles since a heartbeat */
	uint32_t missing;		/* SYNCs without a TPDO */
	uint32_t enabled_for;		/* cycles in operation enabled */
	uint32_t limited_for;		/* ... at an internal limit */
	uint32_t mode_waited;		/* cycles switched on in another mode */
	uint32_t lacking;		/* cycles in which it cannot be switched
					 * on */
	bool readied;			/* it could, since it is to have
					 * power */
	bool shows_voltage;		/* bit 4 tells of its supply */
	uint32_t warnings;		/* times a bit of DRIVE_WARNS came */
	bool answered;			/* a TPDO came since the last SYNC */
	bool strange;			/* the last statusword was no state */
	uint32_t answers;		/* so many did */
	int32_t surplus;		/* TPDOs more than SYNCs */
	uint32_t edge_for;		/* cycles since a fault reset began */
	uint32_t resetting;		/* cycles it may still report a fault */
	uint32_t malformed;		/* frames of a wrong length, and answers
					 * to nothing asked, in all */
};

/** drive_init() - nothing is known about the drive yet, and its goal is off. */
void drive_init(struct drive *d, const struct drive_config *c);

/**
 * drive_receive() - take a frame. Return: false if it does not come from this
 * drive.
 */
bool drive_receive(struct drive *d, const struct can_msg *m);

/**
 * drive_sync() - a SYNC was sent: count the answers that are missing since the
 * last one.
 */
void drive_sync(struct drive *d);

/**
 * drive_emit() - get the frames to send in this period: SDO, NMT or RPDO.
 *
 * @target: pulses; used while the drive is enabled and @homed.
 * Return: how many, at most DRIVE_EMITS, into @ret.
 */
size_t drive_emit(struct drive *d, int32_t target, struct can_msg *ret);

#define DRIVE_EMITS	2

/** drive_aim() - say in which state the master wants the drive. */
void drive_aim(struct drive *d, enum drive_goal goal);

/**
 * drive_reset() - clear the trouble; a drive that restarted is set up again.
 */
void drive_reset(struct drive *d);

/** drive_set_zero() - the position that it measures now is place @pulses. */
void drive_set_zero(struct drive *d, int32_t pulses);

/**
 * drive_keep_zero() - place 0 is at @zero increments, as before a restart of
 * edmd.
 */
void drive_keep_zero(struct drive *d, int32_t zero);

/** drive_place() - its actual position in pulses, rounded to the nearest. */
int32_t drive_place(const struct drive *d);

/** drive_own_place() - the same from the drive's own zero. */
int32_t drive_own_place(const struct drive *d);

/** drive_stands_at() - where it begins when it joins, in pulses: its actual
 *  position, or, once it has torque, where it is held. */
int32_t drive_stands_at(const struct drive *d);

/**
 * drive_to_increments() - exact for every pulse, so that no rounding adds up.
 */
int32_t drive_to_increments(const struct drive_config *c, int32_t pulses);

/**
 * drive_state_of() - the state that a statusword shows, or DRIVE_NO_STATE.
 */
enum drive_state drive_state_of(uint16_t status);

/**
 * drive_has_place() - can the position that it measures in this state be
 * believed?
 */
bool drive_has_place(enum drive_state s);

/** drive_wanted() - @target, in pulses, as increments of this drive. */
int32_t drive_wanted(const struct drive *d, int32_t target);

/**
 * drive_follows() - does it show mode 8, and report that it follows its target?
 */
bool drive_follows(const struct drive *d);

/**
 * drive_lacks_power() - is it without power, so that it cannot be enabled: by
 * safe torque off, by its supply or by an input of its own?
 *
 * At rest a drive is kept ready to switch on, which gives no torque.  One that
 * stays switch on disabled may not be enabled.  If bit 4 of its statusword,
 * voltage enabled, was ever on in that state, it must be.
 */
bool drive_lacks_power(const struct drive *d);

/** drive_control() - the controlword that leads from state @s toward @goal. */
uint16_t drive_control(enum drive_goal goal, enum drive_state s);

/** drive_state_name(), drive_trouble_name() - for logs. Any thread. */
const char *drive_state_name(enum drive_state s);
const char *drive_trouble_name(enum drive_trouble t);

/** drive_abort_text() - an abort code of CiA 301 in words. Any thread. */
const char *drive_abort_text(uint32_t code);

/* -- drive_setup.c: the SDO steps ----------------------------------------- */

/** drive_setup_emit() - the request of the present step, if it is due. */
size_t drive_setup_emit(struct drive *d, struct can_msg *ret);

/** drive_setup_remode() - the request for mode 8, while the drive runs. */
size_t drive_setup_remode(struct drive *d, struct can_msg *ret);

/** drive_setup_again() - begin again with the first step. */
void drive_setup_again(struct drive *d);

/**
 * drive_setup_end() - the frames that leave the drive alone: it stops watching
 * our heartbeat and becomes pre-operational. Return: 0 or DRIVE_ENDS.
 */
size_t drive_setup_end(const struct drive *d, struct can_msg *ret);

#define DRIVE_ENDS	2

/** drive_setup_receive() - take an answer by SDO. */
void drive_setup_receive(struct drive *d, const struct can_msg *m);

#endif /* IO_DRIVE_H */
