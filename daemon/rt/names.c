/* SPDX-License-Identifier: Apache-2.0 */
/*
 * names.c - faults, outcomes and answers in words
 */
#include "cycle.h"

static const char *const faults[CYCLE_NFAULTS] = {
	[FAULT_NONE]			= "none",
	[FAULT_ESTOP]			= "e-stop",
	[FAULT_SHORT_NOT_CLEARED]	= "short-not-cleared",
	[FAULT_GAP_LOST]		= "gap-lost",
	[FAULT_IO_LOST]			= "io-lost",
	[FAULT_CONTACT]			= "contact",
	[FAULT_SOFT_LIMIT]		= "soft-limit",
	[FAULT_PROGRAM]			= "program",
	[FAULT_OVERRUN]			= "overrun",
	[FAULT_RETRACT_AT_START]	= "retract-at-start",
	[FAULT_RETRACT_TIME]		= "retract-time",
	[FAULT_RETRACT_COUNT]		= "retract-count",
	[FAULT_ARCING]			= "arcing",
	[FAULT_WIRE_BROKEN]		= "wire-broken",
	[FAULT_GAP_STUCK]		= "gap-stuck",
	[FAULT_LIMIT_SWITCH]		= "limit-switch",
	[FAULT_DOOR]			= "door",
	[FAULT_DIELECTRIC]		= "dielectric",
	[FAULT_HOME]			= "home-not-found",
	[FAULT_NO_CONTACT]		= "no-contact",
	[FAULT_DRIVE]			= "drive",
	[FAULT_FOLLOWING]		= "following",
	[FAULT_BUS]			= "bus",
	[FAULT_PLC_LOST]		= "plc-lost",
	[FAULT_PERMIT]			= "permit",
	[FAULT_TEMPERATURE]		= "temperature",
	[FAULT_FIRE]			= "fire",
	[FAULT_MCODE]			= "m-code",
};

static const char *const outcomes[] = {
	[OUTCOME_NONE]		= "none",
	[OUTCOME_DONE]		= "done",
	[OUTCOME_FAULT]		= "fault",
	[OUTCOME_STOPPED]	= "stopped",
};

static const char *const answers[CYCLE_NANSWERS] = {
	[ANSWER_DONE]		= "done",
	[ANSWER_NO_PROGRAM]	= "no program is loaded",
	[ANSWER_WRONG_STATE]	= "not possible in this state",
	[ANSWER_BAD_ARGUMENT]	= "argument out of range",
	[ANSWER_NOT_HOMED]	= "an axis is not homed",
	[ANSWER_AT_LIMIT]	= "an axis is on its limit switch",
	[ANSWER_BEYOND]		= "outside the travel",
	[ANSWER_NO_NODE]	= "no such node on the path",
	[ANSWER_NOT_PASSED]	= "the path there was not passed before",
	[ANSWER_ELSEWHERE]	= "the program begins elsewhere",
	[ANSWER_NOT_UP]		= "the drives are not up yet",
	[ANSWER_LOCKED]		= "the PLC does not permit it",
};

const char *cycle_fault_name(enum cycle_fault f)
{
	return f < CYCLE_NFAULTS ? faults[f] : "?";
}

const char *cycle_outcome_name(enum cycle_outcome o)
{
	return o <= OUTCOME_STOPPED ? outcomes[o] : "?";
}

const char *cycle_answer_text(enum cycle_answer a)
{
	return a < CYCLE_NANSWERS ? answers[a] : "?";
}
