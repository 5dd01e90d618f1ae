/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive.h - one CiA 402 drive in cyclic synchronous position mode, as its
 * master sees it: frames in, frames out, no socket
 *
 * While the drive is in NMT state pre-operational, it is set up by SDO, with
 * one request at a time and at most one step per period: its identity;
 * heartbeats in both directions; one RPDO (6040 and 607A) and one TPDO (6041,
 * 6064 and 6061), both with every SYNC, and another TPDO for digital inputs
 * (60FD) if these are asked for; the values that the machine file asks
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
#include "cia402.h"

#include <stdbool.h>
#include <stddef.h>

/* Where the master wants it. */
enum drive_goal {
	DRIVE_GO_OFF,			/* no torque */
	DRIVE_GO_STOP,			/* quick stop, then off */
	DRIVE_GO_ON,
	DRIVE_NGOALS
};

/* A number the machine file wants in a drive. */
struct drive_write {
	uint16_t index;
	uint8_t sub, bytes;
	uint32_t value;
	bool may_miss;			/* a drive may not have the object */
};

#define DRIVE_WRITES	32
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
	bool interpolates;		/* mode 7, its target is 60C1:1; else
					 * mode 8 and 607A */
	bool homes;			/* it homes by itself when told, ... */
	bool homes_here;		/* ... where it stands, and so without
					 * motion */
	uint32_t home_cycles;		/* longest time for that, ... */
	uint32_t enable_cycles;		/* ... and to change its mode */
	bool absolute;			/* it keeps its place without power */
	bool held;			/* it has no brake and keeps its torque
					 * in quick stop too */
	bool no_follow_bit;		/* it does not have bit 12 */
	bool reads_inputs;		/* its digital inputs, 60FD, in TPDO2 */
	bool latches;			/* its touch probe 1 is used */
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

/* What came of homing by itself. */
enum drive_homed {
	DRIVE_NOT_HOMED,
	DRIVE_HOMED,
	DRIVE_UNFOUND,
};

/* What came of the latch of its index mark. */
enum drive_latch {
	DRIVE_LATCH_OFF,
	DRIVE_LATCH_BEGINS,		/* a mark may be missed yet */
	DRIVE_LATCH_READY,
	DRIVE_LATCH_KEPT,		/* ... and a mark has passed */
	DRIVE_LATCH_FAILED,
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
	bool remode;			/* write 6060 once more: this */
	uint8_t mode_wanted;
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
	bool answered;			/* a TPDO1 came since the last SYNC */
	uint32_t inputs;		/* 60FD, as last heard in TPDO2 */
	bool told_inputs;		/* ... since the last SYNC */
	bool has_inputs;		/* ... at all, since it was set up */
	bool strange;			/* the last statusword was no state */
	uint32_t answers;		/* so many did */
	int32_t surplus;		/* TPDOs more than SYNCs */
	uint32_t edge_for;		/* cycles since a fault reset began */
	uint32_t resetting;		/* cycles it may still report a fault */
	uint32_t malformed;		/* frames of a wrong length, and answers
					 * to nothing asked, in all */
	uint64_t periods;		/* so far */
	uint32_t came;			/* emergencies, in all; the last: */
	struct cia402_emergency history[CIA402_EMERGENCIES];
	/* drive_object.c: what somebody asks for */
	struct cia402_answer object;
	/* drive_home.c: homing by itself */
	uint32_t home_step;		/* enum drive_home_step */
	uint32_t home_for, ready_for;	/* cycles in this step; ready */
	uint32_t still_for;		/* ... and without motion, at: */
	int32_t still_at;
	bool home_asked;
	uint16_t home_fresh;		/* bits 12 and 13 that were 0 since it
					 * began */
	enum drive_homed homed_now;
	int32_t told_pulses;		/* target that the cycle gave last */
	/* drive_latch.c: its touch probe */
	enum drive_latch latch;
	uint32_t latch_step;		/* enum latch_step; 0: nothing */
	uint32_t latch_for, latch_tries;	/* cycles in it; times begun */
	bool latch_sent;		/* a request of it is not answered */
	uint32_t latch_status;		/* 60B9 as last read */
	int32_t latch_from, latch_at;	/* increments: it was switched on; the
					 * mark */
	uint32_t object_step;		/* enum object_step; 0: nothing */
	int32_t object_from;		/* its place when it began */
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

/** drive_latched_at() - the place of the mark that passed, in pulses. */
int32_t drive_latched_at(const struct drive *d);

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
 * drive_follows() - does it show its mode, and report that it follows its
 * target?
 */
bool drive_follows(const struct drive *d);

/** drive_is_in_mode() - does it show the mode in which it follows targets, or
 *  none? */
bool drive_is_in_mode(const struct drive *d);

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

/** drive_mode() - the mode in which it follows targets. */
static inline uint8_t drive_mode(const struct drive_config *c)
{
	return c->interpolates ? 7 : 8;
}

/* -- drive_setup.c: the SDO steps ----------------------------------------- */

/** drive_setup_emit() - the request of the present step, if it is due. */
size_t drive_setup_emit(struct drive *d, struct can_msg *ret);

/** drive_setup_remode() - the request for mode 8, while the drive runs. */
size_t drive_setup_remode(struct drive *d, struct can_msg *ret);

/** drive_download(), drive_upload() - the request that writes or reads. */
struct can_msg drive_download(const struct drive *d,
			      const struct drive_write *w);
struct can_msg drive_upload(const struct drive *d, const struct drive_write *w);

/** drive_sdo_bytes() - how many bytes were read. */
uint8_t drive_sdo_bytes(const struct can_msg *m);

/** drive_abort_passes() - may what a drive refuses now do in a while? */
bool drive_abort_passes(uint32_t code);

/** drive_note_abort() - it refused @w with @code, or, 0, said what will not
 *  do; for the log. */
void drive_note_abort(struct drive *d, const struct drive_write *w,
		      uint32_t code, enum drive_passed passed);

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

/* -- drive_home.c: homing by itself, in mode 6 ----------------------------- */

/**
 * drive_home_ask() - home, or stop doing so; to be called in each period.
 *
 * A drive that does not show its mode cannot.  One whose axis stays where it is
 * without torque changes its mode without torque, one that would fall changes
 * it under torque.  When it is back in its mode and follows, its zero is set so
 * that it stands where it was sent last, and homed_now tells what came of it,
 * until it is not asked any more.
 */
void drive_home_ask(struct drive *d, bool asked);

/** drive_home_step() - once a period. Return: is it under way? */
bool drive_home_step(struct drive *d);

/** drive_is_homing() - it is not led by targets. */
bool drive_is_homing(const struct drive *d);

/** drive_home_control() - the controlword for that. */
uint16_t drive_home_control(const struct drive *d);

/** drive_home_drop() - it is over, and nothing was found. */
void drive_home_drop(struct drive *d);

/** drive_cycles() - so many ms as cycles, 1 at least. */
uint32_t drive_cycles(const struct drive *d, uint32_t ms);

/** drive_dither() - increments by which an axis that is held may move. */
int32_t drive_dither(const struct drive *d);

/* -- drive_latch.c: the place of its index mark ---------------------------- */

/**
 * drive_latch_ask() - keep the place of the next index mark, or stop doing so;
 * to be called in each period.  d->latch tells what came of it, until it is not
 * asked any more.
 *
 * The axis should stand until the latch is ready: what passes before is missed.
 */
void drive_latch_ask(struct drive *d, bool asked);

/** drive_latch_emit() - the request that is due. */
size_t drive_latch_emit(struct drive *d, struct can_msg *ret);

/** drive_latch_receive() - take an answer. Return: false: it is not for us. */
bool drive_latch_receive(struct drive *d, const struct can_msg *m);

/** drive_latch_drop() - it is over, and nothing was found. */
void drive_latch_drop(struct drive *d);

/* -- drive_object.c: an object that somebody asks for, or sets ------------- */

/**
 * drive_object_ask() - begin with @r; its end is that of d->object.
 *
 * Objects that edmd writes itself, and all of a drive that has torque, are not
 * set.  Before an object is set it is read, and once more afterwards.  If that
 * has changed the count of the drive, its place is lost.
 */
void drive_object_ask(struct drive *d, const struct cia402_request *r);

/** drive_object_emit() - the request that is due, unless the set-up runs. */
size_t drive_object_emit(struct drive *d, struct can_msg *ret);

/** drive_object_receive() - take an answer. Return: false: it is not for us. */
bool drive_object_receive(struct drive *d, const struct can_msg *m);

/** drive_object_drop() - the drive is set up anew: what is asked is over. */
void drive_object_drop(struct drive *d);

#endif /* IO_DRIVE_H */
