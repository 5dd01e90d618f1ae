/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drives.h - the keys of a CiA 402 drive that are lists in a line of text
 *
 * Return, all of them: how many there are, or -EINVAL with @diag's found and
 * wanted filled; "none" is none.  Threads: startup only.
 */
#ifndef CONFIG_DRIVES_H
#define CONFIG_DRIVES_H

#include "config.h"

#define CONFIG_SDO_MAX		16
#define CONFIG_LEAVE_MAX	8

struct config_object {
	uint16_t index;
	uint8_t sub, bytes;		/* 1, 2 or 4 */
	uint32_t value;
};

/** config_drive_sdo() - "6065:0=3e8/4 605e:0=2/2". */
int config_drive_sdo(const char *text, struct config_object *ret,
		     struct interp_diag *diag);

/** config_drive_leave() - "1006 60c2". */
int config_drive_leave(const char *text, uint16_t *ret,
		       struct interp_diag *diag);

enum config_input_id {
	INPUT_LIMIT_LOW, INPUT_LIMIT_HIGH, INPUT_HOME, INPUT_ESTOP,
	INPUT_CONTACT,
	CONFIG_NINPUTS
};

/* A bit of a drive's digital inputs, object 60FD. */
struct config_input {
	bool wired;
	uint32_t mask;			/* the bit */
	uint32_t idle;			/* ... and what it is while off */
};

/**
 * config_drive_inputs() - "limit_low:0 limit_high:1 home:2 estop:!16
 * contact:5"; with "!" an input is on when its bit is 0.
 */
int config_drive_inputs(const char *text,
			struct config_input ret[CONFIG_NINPUTS],
			struct interp_diag *diag);

/**
 * config_drive_identity() - "fb 64100000 x x": words of 1018:1 ... 4; of
 * *ret_given bit 0 ... 3 are set where there is one and not x.
 */
int config_drive_identity(const char *text, uint32_t ret[4],
			  uint8_t *ret_given, struct interp_diag *diag);

#endif /* CONFIG_DRIVES_H */
