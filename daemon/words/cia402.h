/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cia402.h - drives of CiA 402 in words, and what is told of them
 *
 * States, troubles, modes, emergencies and objects have the words of CiA 301
 * and CiA 402 (IEC 61800-7-201).  The master of the drives fills the structs;
 * shared memory carries them as they are.
 *
 * Threads: any; the tables are constant.
 */
#ifndef WORDS_CIA402_H
#define WORDS_CIA402_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/* An emergency message. */
struct cia402_emergency {
	uint16_t code;			/* 0: the error is over */
	uint8_t error_register;		/* object 1001 */
	uint8_t maker[5];		/* the maker's own field */
	uint64_t at;			/* period in which it came */
};

#define CIA402_NDRIVES		8
#define CIA402_EMERGENCIES	8	/* the last ones of a drive */

struct cia402_drive {
	uint8_t axis, node;
	uint8_t phase, state, trouble;	/* as the enums above */
	int8_t mode;			/* 6061, where it shows that */
	bool shows_mode, heard, lost;	/* lost: its place means nothing */
	uint16_t status;		/* statusword */
	int32_t actual;			/* increments: 6064 */
	uint32_t emergencies;		/* all that came; the last ones: */
	struct cia402_emergency emergency[CIA402_EMERGENCIES];
};

/* An object that somebody asks for, or sets. */
struct cia402_request {
	uint8_t axis, sub;
	uint16_t index;
	bool sets;
	uint32_t value;			/* ... to this */
};

/* What became of it. */
enum cia402_end {
	CIA402_NOTHING,			/* nothing was asked yet */
	CIA402_UNDER_WAY,
	CIA402_DONE,
	CIA402_ABORTED,			/* by the drive: code */
	CIA402_SILENT,			/* it did not answer */
	CIA402_NOT_UP,			/* it is not there, is being set up, or
					 * was set up anew meanwhile */
	CIA402_OWN,			/* edmd writes that object itself */
	CIA402_POWERED,			/* it has torque */
	CIA402_LONG,			/* more than four bytes */
};

struct cia402_answer {
	struct cia402_request of;
	uint32_t end;			/* enum cia402_end */
	uint32_t code;			/* of the abort */
	uint32_t bytes;			/* that the object has */
	uint32_t was, now;		/* set: before, and read back */
};

/* All of it. */
struct cia402_told {
	uint64_t at;			/* this period */
	uint32_t n;
	uint32_t pad;
	struct cia402_drive drive[CIA402_NDRIVES];
	struct cia402_answer answer;
};

/** cia402_has_torque() - does a drive in this state move or hold its axis? */
bool cia402_has_torque(uint32_t state);

/** cia402_state_name() ... - in words; "?" for a number that is none. */
const char *cia402_state_name(uint32_t state);
const char *cia402_trouble_name(uint32_t trouble);
const char *cia402_phase_name(uint32_t phase);
const char *cia402_mode_name(int mode);

/** cia402_abort_text() - an abort code of CiA 301. */
const char *cia402_abort_text(uint32_t code);

/** cia402_emergency_text() - an emergency, as exactly as the standards have
 *  it. */
const char *cia402_emergency_text(uint16_t code);

struct cia402_object {
	uint16_t index;
	uint8_t sub;
	bool is_signed;
	const char *name;
};

/** cia402_object_at() - NULL: it has no name here. */
const struct cia402_object *cia402_object_at(uint16_t index, uint8_t sub);

/** cia402_object_row() - the table, row by row; NULL behind its end. */
const struct cia402_object *cia402_object_row(size_t i);

/**
 * cia402_object_read() - "6064", "6064:0", "0x60c2:1" or the name of an object.
 *
 * Signs between the words of a name, and capitals, do not matter.
 *
 * Return: false: it is neither.
 */
bool cia402_object_read(const char *text, uint16_t *ret_index,
			uint8_t *ret_sub);

#endif /* WORDS_CIA402_H */
