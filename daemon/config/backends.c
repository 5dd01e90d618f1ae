/* SPDX-License-Identifier: Apache-2.0 */
/* backends.c - the table of backends, for the machine file */
#include "keys.h"

static bool backend_has_gap(const struct machine_config *c)
{
	(void)c;
	return true;
}

static bool backend_has_no_gap(const struct machine_config *c)
{
	(void)c;
	return false;
}

static bool backend_can402_has_gap(const struct machine_config *c)
{
	return c->can402.gap_id > 0;
}

#define BACKEND(id, word, open, period, what, gap, checked, points) \
	[BACKEND_##id] = { .name = word, .period_ns = period, .is = what, \
			   .has_gap = gap, .check = checked, \
			   .points_s = points },

static const struct config_backend backend[CONFIG_NBACKENDS] = {
	CONFIG_BACKENDS(BACKEND)
};

const struct config_backend *config_backend(const struct machine_config *c)
{
	return &backend[c->backend];
}

bool config_machine_is(const struct machine_config *c,
		       enum config_machine_is what)
{
	return config_backend(c)->is & what;
}

const char *config_backend_name(int i)
{
	return i >= 0 && i < CONFIG_NBACKENDS ? backend[i].name : NULL;
}
