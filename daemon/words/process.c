/* SPDX-License-Identifier: Apache-2.0 */
/*
 * process.c - where the settings of a field are
 */
#include "process.h"

#include <stddef.h>

double *process_setting(enum interp_tech_id id, struct cycle_gap_config *gap,
			struct cycle_jump_config *jump)
{
	switch (id) {
#define SETTING(field, of, member) \
	case INTERP_TECH_##field: \
		return &(of)->member;
	PROCESS_SETTINGS(SETTING)
	default:
		return NULL;
	}
}

void process_base(struct interp_tech *ret, const struct cycle_gap_config *gap,
		  const struct cycle_jump_config *jump)
{
	interp_tech_clear(ret);
#define BASE(field, of, member) \
	ret->v[INTERP_TECH_##field] = (of)->member;
	PROCESS_SETTINGS(BASE)
}
