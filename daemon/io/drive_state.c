/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_state.c - the state machine of CiA 402, as tables
 */
#include "drive.h"

/* A state is told by these bits of the statusword. */
static const struct {
	uint16_t mask, value;
	enum drive_state state;
} states[] = {
	{ 0x4f, 0x00, DRIVE_NOT_READY },
	{ 0x4f, 0x40, DRIVE_DISABLED },
	{ 0x6f, 0x21, DRIVE_READY },
	{ 0x6f, 0x23, DRIVE_SWITCHED_ON },
	{ 0x6f, 0x27, DRIVE_ENABLED },
	{ 0x6f, 0x07, DRIVE_QUICK_STOP },
	{ 0x4f, 0x0f, DRIVE_FAULT_REACTION },
	{ 0x4f, 0x08, DRIVE_FAULT },
};

#define DISABLE		0x00		/* disable voltage */
#define QUICK_STOP	0x02
#define SHUTDOWN	0x06
#define SWITCH_ON	0x07
#define ENABLE		0x0f

/* Read a row as "wanted there, and found in this state, command...". */
static const uint16_t control[DRIVE_NGOALS][DRIVE_NSTATES] = {
	[DRIVE_GO_OFF] = {
		[DRIVE_READY]		= SHUTDOWN,
		[DRIVE_SWITCHED_ON]	= SHUTDOWN,
		[DRIVE_ENABLED]		= SHUTDOWN,
	},
	[DRIVE_GO_STOP] = {
		[DRIVE_DISABLED]	= SHUTDOWN,
		[DRIVE_READY]		= SHUTDOWN,
		[DRIVE_SWITCHED_ON]	= SHUTDOWN,
		[DRIVE_ENABLED]		= QUICK_STOP,
		[DRIVE_QUICK_STOP]	= QUICK_STOP,
	},
	[DRIVE_GO_ON] = {
		[DRIVE_DISABLED]	= SHUTDOWN,
		[DRIVE_READY]		= SWITCH_ON,
		[DRIVE_SWITCHED_ON]	= ENABLE,
		[DRIVE_ENABLED]		= ENABLE,
	},
};

enum drive_state drive_state_of(uint16_t status)
{
	for (size_t i = 0; i < sizeof(states) / sizeof(states[0]); i++) {
		if ((status & states[i].mask) == states[i].value)
			return states[i].state;
	}
	return DRIVE_NO_STATE;
}

/* Before it is ready its count may be anything, and in a fault too. */
bool drive_has_place(enum drive_state s)
{
	return s != DRIVE_NOT_READY && s != DRIVE_FAULT_REACTION &&
	       s != DRIVE_FAULT;
}

uint16_t drive_control(enum drive_goal goal, enum drive_state s)
{
	return control[goal][s];
}
