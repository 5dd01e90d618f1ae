/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stands.h - the one table of reasons why a job stands
 *
 * The cycle, the snapshot, STATUS, edmctl, the panel and the PLC's files take
 * number, name and words of a stand from here.  The numbers are in shared
 * memory and on the PLC's bus: rows keep their order, a new one is the last.
 *
 * S(id, name, ends, what, asks): @ends, what ends it; @what, half a sentence
 * for people; @asks, what somebody has to do.
 *
 * Threads: any; the table is constant.
 */
#ifndef WORDS_STANDS_H
#define WORDS_STANDS_H

#include <stdint.h>

/* What ends a stand. */
enum stand_end {
	STAND_BY_ITSELF,
	STAND_BY_START,
	STAND_BY_CONFIRM,		/* start is refused before somebody has
					 * said that it is done */
};

/* clang-format off */
#define STAND_ROWS(S) \
S(NONE, "", STAND_BY_ITSELF, "", "") \
S(READY, "ready", STAND_BY_START, "the job is ready", \
  "edmctl start begins it") \
S(COMMAND, "held", STAND_BY_START, "it was held by command", \
  "edmctl start goes on, edmctl stop ends the job") \
S(PLC, "plc", STAND_BY_START, "the PLC held it", \
  "once the PLC lets go, start goes on") \
S(STOP, "stop", STAND_BY_START, "the program stops here", \
  "edmctl start goes on") \
S(OPTIONAL, "optional-stop", STAND_BY_START, "an optional stop of the program", \
  "edmctl start goes on") \
S(ELECTRODE, "electrode", STAND_BY_CONFIRM, "another electrode is to be put in", \
  "put it in; edmctl done NUMBER, then edmctl start") \
S(SETTING, "setting", STAND_BY_CONFIRM, "the generator is to be set by hand", \
  "set it; edmctl done, then edmctl start") \
S(RESET, "reset", STAND_BY_START, "a fault was reset", \
  "edmctl start goes on, edmctl stop ends the job") \
S(RESTART, "restart", STAND_BY_START, "edmd was started anew", \
  "look at the machine; edmctl start goes on, edmctl stop ends the job") \
S(END, "end", STAND_BY_START, "the program is at its end", \
  "edmctl stop ends the job") \
S(MCODE, "m-code", STAND_BY_ITSELF, "the PLC carries out an M code", \
  "it goes on by itself") \
S(GENERATOR, "generator", STAND_BY_ITSELF, \
  "the generator does not have the condition yet", \
  "it goes on by itself") \
S(OVERRIDE, "override", STAND_BY_ITSELF, "the override is 0", \
  "edmctl override 100, or the knob of the PLC") \
S(POWER, "power", STAND_BY_ITSELF, "the drives do not have power yet", \
  "it goes on by itself")
/* clang-format on */

#define STAND_NUMBER(id, ...)	STAND_##id,
enum stand_reason {
	STAND_ROWS(STAND_NUMBER)
	STAND_NREASONS
};
#undef STAND_NUMBER

struct stand_row {
	const char *name;		/* "electrode" */
	enum stand_end ends;
	const char *what, *asks;	/* half a sentence each, for people */
};

extern const struct stand_row stand_table[STAND_NREASONS];

/** stand_row() - of a number from anywhere; that of NONE if there is none. */
const struct stand_row *stand_row(uint32_t reason);

#endif /* WORDS_STANDS_H */
