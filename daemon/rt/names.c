/* SPDX-License-Identifier: Apache-2.0 */
/*
 * names.c - outcomes and answers in words
 */
#include "cycle.h"

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
	[ANSWER_PLC_HOLDS]	= "the PLC holds",
	[ANSWER_STILL_THERE]	= "what caused the fault is still there",
	[ANSWER_NO_POWER]	= "an axis cannot have power",
	[ANSWER_ASKS]		= "it asks for something that nobody confirmed",
	[ANSWER_NOT_ASKED]	= "that is not asked for",
	[ANSWER_OVER]		= "the stand that it was for is over",
};

const char *cycle_outcome_name(enum cycle_outcome o)
{
	return o <= OUTCOME_STOPPED ? outcomes[o] : "?";
}

const char *cycle_answer_text(enum cycle_answer a)
{
	if (a >= ANSWER_SEEN && a < ANSWER_SEEN + CYCLE_NFAULTS)
		return fault_table[a - ANSWER_SEEN].what;
	return a < CYCLE_NANSWERS ? answers[a] : "?";
}
