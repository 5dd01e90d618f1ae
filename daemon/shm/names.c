/* SPDX-License-Identifier: Apache-2.0 */
/*
 * names.c - words for the numbers in shared memory
 *
 * The same words as the cycle's own, which readers of shared memory do not
 * link; test_shm.c holds them together.
 */
#include "shm.h"

static const char *name_of(const char *const *names, uint32_t count,
			   uint32_t i)
{
	return i < count && names[i] ? names[i] : "?";
}

const char *shm_state_name(uint32_t state)
{
	static const char *const names[] = {
		[SHM_IDLE]	= "idle",
		[SHM_TRAVEL]	= "travel",
		[SHM_APPROACH]	= "approach",
		[SHM_ERODE]	= "erode",
		[SHM_RETRACT]	= "retract",
		[SHM_JUMP]	= "jump",
		[SHM_HOLD]	= "hold",
		[SHM_FAULT]	= "fault",
		[SHM_JOG]	= "jog",
		[SHM_HOME]	= "home",
		[SHM_PROBE]	= "probe",
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
