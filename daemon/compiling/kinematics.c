/* SPDX-License-Identifier: Apache-2.0 */
/*
 * kinematics.c - [kinematics] of a machine file as joints, and its check
 */
#include "compiling.h"

#include <errno.h>
#include <string.h>

int config_kinematics(const struct machine_config *c,
		      struct interp_kinematics *ret, struct interp_diag *diag)
{
	if (strcmp(c->kinematics.chain, "none") == 0)
		return -ENOENT;
	interp_kin_clear(ret);
	memcpy(ret->tip_mm, c->kinematics.tip_mm, sizeof(ret->tip_mm));
	return interp_kin_parse(ret, c->kinematics.chain, diag);
}

/* The joints of the chain must be axes of the machine. */
int config_check_kinematics(const struct machine_config *c,
			    struct interp_diag *diag)
{
	struct interp_kinematics kin;
	char why[sizeof(diag->found)];
	const int err = config_kinematics(c, &kin, diag);

	diag->line = c->kinematics.line;
	diag->column = 0;
	if (err == -EINVAL) {
		snprintf(why, sizeof(why), "%s", diag->found);
		snprintf(diag->found, sizeof(diag->found),
			 "kinematics.chain: %.130s", why);
	}
	for (uint32_t i = 0; err == 0 && i < kin.njoints; i++) {
		if (c->axes.present & 1u << kin.joint[i].axis)
			continue;
		return interp_diag_say(diag, "kinematics.chain has an axis "
				       "%c, the machine has not; axes with "
				       "present = yes",
				       INTERP_AXIS_LETTERS[kin.joint[i].axis]);
	}
	return err == -EINVAL ? err : 0;
}
