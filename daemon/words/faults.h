/* SPDX-License-Identifier: Apache-2.0 */
/*
 * faults.h - the one table of faults
 *
 * The cycle, edmd, edmctl, edm-dds, the PLC's files and the documents take
 * numbers, names, words and consequences of a fault from here.  A new fault is
 * a new last row, and the call of fault_latch() where it is found.  The numbers
 * are in shared memory and on the PLC's bus: rows keep their order.
 *
 * Threads: any; the table is constant, and needs nothing of the cycle.
 */
#ifndef WORDS_FAULTS_H
#define WORDS_FAULTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How the motion ends.  In each case the sparks are off in the same period. */
enum fault_motion {
	FAULT_BRAKES,			/* along the path: the axes are good, or
					 * all but one are */
	FAULT_ENDS,			/* at once: no further lattice point */
	FAULT_BACKS_OFF,		/* as FAULT_BRAKES; in a cut it then
					 * goes back along the path, and
					 * stands */
};

/* When a fault can come up. */
enum fault_scope {
	FAULT_IN_JOB,			/* a job is walked, or an axis homed:
					 * the motion itself finds it */
	FAULT_IN_POWER,			/* sparks are on, or about to be */
	FAULT_IN_MOTION,		/* anything moves, or is about to */
	FAULT_ALWAYS,			/* at a stand and without a job too */
};

#define FAULT_RESET	"edmctl reset; then start goes on, stop ends the job"

/* clang-format off */
#define FAULT_ROWS(F) \
F(NONE, "none", FAULT_BRAKES, false, FAULT_IN_JOB, \
  "no fault", \
  "nothing is wrong", \
  "nothing to do") \
F(ESTOP, "e-stop", FAULT_ENDS, true, FAULT_ALWAYS, \
  "emergency stop", \
  "the e-stop input is on, or edmctl estop was given", \
  "release the button; " FAULT_RESET) \
F(SHORT_NOT_CLEARED, "short-not-cleared", FAULT_BRAKES, false, FAULT_IN_JOB, \
  "a short circuit that a retract did not clear", \
  "it retracted the whole [gap] retract_limit_mm and was still short after retract_wait_s: a chip, a bridge, a worn electrode, or contact elsewhere", \
  "look at the gap and flush; edmctl reset; edmctl retract MM moves farther back; then start or stop") \
F(GAP_LOST, "gap-lost", FAULT_BRAKES, false, FAULT_IN_MOTION, \
  "the gap cannot be read", \
  "no reading came, or one that cannot be true: the sensor, its wiring, or [gap] source", \
  "repair the sensor; " FAULT_RESET) \
F(IO_LOST, "io-lost", FAULT_ENDS, true, FAULT_ALWAYS, \
  "the machine does not answer", \
  "power, cable or lines of the machine", \
  "repair the connection; with backend gpio restart edmd; home where the place is in doubt; " FAULT_RESET) \
F(CONTACT, "contact", FAULT_BRAKES, false, FAULT_IN_MOTION, \
  "the electrode met something where it should be free", \
  "a short while positioning or jogging that was not there when the motion began, or contact before a probing motion began", \
  "edmctl reset; edmctl retract or jog away; clear the way; then start or stop") \
F(SOFT_LIMIT, "soft-limit", FAULT_ENDS, false, FAULT_IN_JOB, \
  "the path leaves the travel of an axis", \
  "the next lattice point lies outside travel_min and travel_max; after a probing motion the work stands elsewhere than the program expects", \
  "edmctl reset; edmctl stop; correct the program or its work offset") \
F(PROGRAM, "program", FAULT_ENDS, false, FAULT_IN_JOB, \
  "the program in memory is damaged", \
  "a segment failed its check", \
  "edmctl reset; edmctl stop; submit the job again and report it") \
F(OVERRUN, "overrun", FAULT_ENDS, true, FAULT_IN_MOTION, \
  "too many periods missed in a row", \
  "overrun_limit periods were missed: the host is too busy, or not set up for real time", \
  "edmctl doctor says what the host lacks; " FAULT_RESET) \
F(RETRACT_AT_START, "retract-at-start", FAULT_BRAKES, false, FAULT_IN_JOB, \
  "still short where the way back ends", \
  "it retracted to the start of the program or of the motion and the short is still there", \
  "look at the gap and flush; begin the program farther out; " FAULT_RESET) \
F(RETRACT_TIME, "retract-time", FAULT_BRAKES, false, FAULT_IN_JOB, \
  "a retract took too long", \
  "it lasted longer than [gap] retract_max_s", \
  "look at the gap and flush; " FAULT_RESET) \
F(RETRACT_COUNT, "retract-count", FAULT_BRAKES, false, FAULT_IN_JOB, \
  "many retracts and no erosion between them", \
  "[gap] abort_count retracts in a row: debris, or a servo voltage too near the short", \
  "flush, or choose a gentler condition; " FAULT_RESET) \
F(ARCING, "arcing", FAULT_BRAKES, false, FAULT_IN_POWER, \
  "arcs that a longer off time, a jump and a retract did not end", \
  "debris in the gap, or too much energy for its area", \
  "flush, look for burns, clean the electrode, lower the duty; " FAULT_RESET) \
F(WIRE_BROKEN, "wire-broken", FAULT_BACKS_OFF, false, FAULT_IN_POWER, \
  "the wire is broken", \
  "it broke in a cut, or a cut was about to begin without one: energy, tension or flushing", \
  "thread the wire; " FAULT_RESET) \
F(GAP_STUCK, "gap-stuck", FAULT_BRAKES, false, FAULT_IN_POWER, \
  "the gap signal stands still while the electrode moves, or is noise", \
  "the sensor or its wiring", \
  "repair the sensor; " FAULT_RESET) \
F(LIMIT_SWITCH, "limit-switch", FAULT_ENDS, false, FAULT_IN_MOTION, \
  "an axis ran onto its limit switch", \
  "it is not homed, travel_min or travel_max is wrong, or the switch failed", \
  "edmctl reset; edmctl retract, or without a job edmctl jog AXIS MM, away from the switch") \
F(DOOR, "door", FAULT_BRAKES, false, FAULT_IN_MOTION, \
  "the door is open", \
  "it was opened while something moved, or its switch failed", \
  "close it; " FAULT_RESET) \
F(DIELECTRIC, "dielectric", FAULT_BRAKES, false, FAULT_IN_POWER, \
  "the dielectric is too low to spark in", \
  "its level switch; where a PLC watches the level, any motion needs it", \
  "fill up; " FAULT_RESET) \
F(HOME, "home-not-found", FAULT_ENDS, false, FAULT_IN_JOB, \
  "homing met no switch or no index mark, or the drive's own place is out of the travel", \
  "the switch or its wiring, or home_dir, home_at_mm or home_search_mm in the machine file", \
  "edmctl reset; repair it, or jog the axis onto its switch; edmctl home") \
F(NO_CONTACT, "no-contact", FAULT_BRAKES, false, FAULT_IN_JOB, \
  "a probing motion met nothing", \
  "it came to its end, or to the end of the travel: the work stands elsewhere", \
  "edmctl reset; edmctl retract backs off; look where the work is; start probes again, stop ends the job") \
F(DRIVE, "drive", FAULT_BRAKES, true, FAULT_ALWAYS, \
  "a drive has a fault", \
  "it reports one, is silent, or was not enabled in time; edmd's log tells which", \
  "repair it; " FAULT_RESET) \
F(FOLLOWING, "following", FAULT_BRAKES, true, FAULT_ALWAYS, \
  "an axis is not where it was sent", \
  "something holds it, or its drive is weak or badly tuned", \
  "find what holds it; " FAULT_RESET) \
F(BUS, "bus", FAULT_ENDS, true, FAULT_ALWAYS, \
  "the bus to the drives does not work", \
  "bus off, the interface is down, or there is another master", \
  "repair the bus; " FAULT_RESET) \
F(PLC_LOST, "plc-lost", FAULT_BRAKES, false, FAULT_IN_MOTION, \
  "the PLC is gone", \
  "its toggle does not turn: the PLC stands, or the bus is cut", \
  "repair PLC or bus; " FAULT_RESET) \
F(PERMIT, "permit", FAULT_BRAKES, false, FAULT_IN_MOTION, \
  "the PLC took its permit away", \
  "the PLC's own program says why", \
  "wait until the PLC permits; " FAULT_RESET) \
F(TEMPERATURE, "temperature", FAULT_BRAKES, false, FAULT_IN_MOTION, \
  "the temperature of the dielectric is out of range", \
  "the PLC says so", \
  "wait until it is in range; " FAULT_RESET) \
F(FIRE, "fire", FAULT_BRAKES, false, FAULT_ALWAYS, \
  "fire", \
  "the PLC's fire detector says so", \
  "put it out; " FAULT_RESET) \
F(MCODE, "m-code", FAULT_BRAKES, false, FAULT_IN_JOB, \
  "the PLC did not carry out an M code in time", \
  "it was not answered within m_timeout_s", \
  "edmctl reset; start waits for the answer again, stop ends the job") \
F(STUCK, "stuck", FAULT_ENDS, false, FAULT_IN_JOB, \
  "the motion stands still and nothing says why", \
  "it is to move, nothing holds it, and no lattice point came for a second: a defect of the path or of edmd", \
  "report it with the program; edmctl reset; start tries again, stop ends the job") \
F(GENERATOR, "generator", FAULT_BRAKES, false, FAULT_IN_POWER, \
  "the generator does not have what the condition asks for", \
  "it is silent, tells another value than it was asked for, or its lines do not answer; edmd's log names the field, what was asked and what was told", \
  "look at the generator and its cable; " FAULT_RESET)
/* clang-format on */

#define FAULT_ENUM(id, ...)	FAULT_##id,

enum cycle_fault {
	FAULT_ROWS(FAULT_ENUM)
	CYCLE_NFAULTS
};

struct fault_row {
	const char *name;		/* "short-not-cleared" */
	enum fault_motion motion;
	bool disables;			/* it takes the power from the axes,
					 * once the motion has ended, because
					 * an axis may not be where it should
					 * be */
	enum fault_scope scope;		/* a guard may name a wider one */
	const char *what, *why;		/* half a sentence each, for people */
	const char *clear;		/* what the operator does */
};

extern const struct fault_row fault_table[CYCLE_NFAULTS];

/** fault_name() - of a number from anywhere; "?" if there is no such fault. */
const char *fault_name(uint32_t fault);

/**
 * fault_list() - the names of a set, bit n for fault n, with blanks between.
 * Return: @buf; what has no room is left out.
 */
const char *fault_list(uint64_t faults, char *buf, size_t size);

/** fault_motion_text() - how the motion ends, drives and all; for a table. */
const char *fault_motion_text(enum cycle_fault fault);

/** fault_scope_text() - when it can come up. */
const char *fault_scope_text(enum cycle_fault fault);

#endif /* WORDS_FAULTS_H */
