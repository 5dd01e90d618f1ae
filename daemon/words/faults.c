/* SPDX-License-Identifier: Apache-2.0 */
/*
 * faults.c - the table of faults, and words for its columns
 */
#include "faults.h"

#include <string.h>

#define FAULT_ROW(id, ...)	[FAULT_##id] = { __VA_ARGS__ },

const struct fault_row fault_table[CYCLE_NFAULTS] = {
	FAULT_ROWS(FAULT_ROW)
};

const char *fault_name(uint32_t fault)
{
	return fault < CYCLE_NFAULTS ? fault_table[fault].name : "?";
}

const char *fault_list(uint64_t faults, char *buf, size_t size)
{
	size_t n = 0;

	buf[0] = '\0';
	for (uint32_t i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++) {
		const char *name = fault_table[i].name;
		const size_t length = strlen(name);

		if (!(faults >> i & 1) || n + 1 + length >= size)
			continue;
		if (n > 0)
			buf[n++] = ' ';
		memcpy(buf + n, name, length + 1);
		n += length;
	}
	return buf;
}

const char *fault_motion_text(enum cycle_fault fault)
{
	static const char *const texts[] = {
		[FAULT_BRAKES]		= "brakes",
		[FAULT_ENDS]		= "ends at once",
		[FAULT_BACKS_OFF]	= "brakes, and goes back from the cut",
	};

	if (!fault_table[fault].disables)
		return texts[fault_table[fault].motion];
	return fault_table[fault].motion == FAULT_ENDS ?
	       "ends at once, drives off" :
	       "the other axes brake, then drives off";
}

const char *fault_scope_text(enum cycle_fault fault)
{
	static const char *const texts[] = {
		[FAULT_IN_JOB]		= "in a job or in homing",
		[FAULT_IN_POWER]	= "before and while it sparks",
		[FAULT_IN_MOTION]	= "before and while anything moves",
		[FAULT_ALWAYS]		= "always",
	};

	return texts[fault_table[fault].scope];
}
