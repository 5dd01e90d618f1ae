/* SPDX-License-Identifier: Apache-2.0 */
/*
 * names.c - words for the numbers in shared memory
 */
#include "shm.h"

#define NAME(id, name, power, running) [SHM_##id] = name,

static const char *name_of(const char *const *names, uint32_t count,
			   uint32_t i)
{
	return i < count && names[i] ? names[i] : "?";
}

const char *shm_state_name(uint32_t state)
{
	static const char *const names[] = {
		STATE_ROWS(NAME)
	};

	return name_of(names, sizeof(names) / sizeof(names[0]), state);
}

const char *shm_outcome_name(uint32_t outcome)
{
	static const char *const names[] = {
		"none", "done", "fault", "stopped",
	};

	return name_of(names, sizeof(names) / sizeof(names[0]), outcome);
}
