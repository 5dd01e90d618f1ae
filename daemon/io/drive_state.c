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

const char *drive_state_name(enum drive_state s)
{
	static const char *const names[DRIVE_NSTATES] = {
		[DRIVE_NOT_READY]	= "not ready to switch on",
		[DRIVE_DISABLED]	= "switch on disabled",
		[DRIVE_READY]		= "ready to switch on",
		[DRIVE_SWITCHED_ON]	= "switched on",
		[DRIVE_ENABLED]		= "operation enabled",
		[DRIVE_QUICK_STOP]	= "quick stop active",
		[DRIVE_FAULT_REACTION]	= "fault reaction active",
		[DRIVE_FAULT]		= "fault",
	};

	return s < DRIVE_NSTATES ? names[s] : "?";
}

const char *drive_trouble_name(enum drive_trouble t)
{
	static const char *const names[DRIVE_NTROUBLES] = {
		[DRIVE_WELL]		= "well",
		[DRIVE_EMERGENCY]	= "reports a fault",
		[DRIVE_FELL_OFF]	= "left operation enabled by itself",
		[DRIVE_FOLLOWING]	= "is too far from its target",
		[DRIVE_MUTE]		= "sends no heartbeat",
		[DRIVE_NO_ANSWER]	= "does not answer to SYNC",
		[DRIVE_STRANGE]		= "reports a statusword that is no state "
					  "of CiA 402",
		[DRIVE_REBOOTED]	= "has restarted",
		[DRIVE_MISCONFIGURED]	= "refuses its configuration",
		[DRIVE_OTHER_MODE]	= "is not in mode 8, cyclic "
					  "synchronous position",
		[DRIVE_NOT_LED]		= "ignores its target: bit 12 of its "
					  "statusword is 0",
		[DRIVE_POWERLESS]	= "has no power: safe torque off, its "
					  "supply, or its enable input",
		[DRIVE_LIMITED]		= "clips its target: bit 11 of its "
					  "statusword stays 1",
		[DRIVE_TWICE]		= "answers more often than it is "
					  "asked: are there two with its node?",
		[DRIVE_NOT_STARTED]	= "is no longer operational: somebody "
					  "stopped it by NMT",
	};

	return t < DRIVE_NTROUBLES ? names[t] : "?";
}

const char *drive_abort_text(uint32_t code)
{
	static const struct {
		uint32_t code;
		const char *text;
	} texts[] = {
		{ 0x05030000, "toggle bit not alternated" },
		{ 0x05040000, "SDO protocol timed out" },
		{ 0x05040001, "command not known" },
		{ 0x05040005, "out of memory" },
		{ 0x06010000, "access not supported" },
		{ 0x06010001, "write only" },
		{ 0x06010002, "read only" },
		{ 0x06020000, "no such object" },
		{ 0x06040041, "object cannot be mapped" },
		{ 0x06040042, "more than a PDO holds" },
		{ 0x06040043, "parameters do not go together" },
		{ 0x06040047, "incompatible inside the device" },
		{ 0x06060000, "hardware error" },
		{ 0x06070010, "wrong length" },
		{ 0x06070012, "too long" },
		{ 0x06070013, "too short" },
		{ 0x06090011, "no such sub-index" },
		{ 0x06090030, "value out of range" },
		{ 0x06090031, "value too high" },
		{ 0x06090032, "value too low" },
		{ 0x06090036, "maximum below minimum" },
		{ 0x060a0023, "resource not available" },
		{ 0x08000000, "general error" },
		{ 0x08000020, "cannot be stored" },
		{ 0x08000021, "cannot be stored: local control" },
		{ 0x08000022, "cannot be stored in this state" },
		{ 0x08000023, "no object dictionary" },
		{ 0x08000024, "no data" },
	};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
		if (texts[i].code == code)
			return texts[i].text;
	return "code of the maker";
}
