/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_steps.h - what a drive is asked, in order, while it is brought up
 *
 * Private to drive_setup.c.  A step is a read that must fit, or a write; some
 * are left out by what was read before them, by what the machine file wants
 * left alone, or because the drive does not have the object.
 */
#ifndef IO_DRIVE_STEPS_H
#define IO_DRIVE_STEPS_H

#include "drive.h"

struct drive_step {
	struct drive_write write;	/* of a read, only where */
	uint8_t what;			/* private */
	bool reads;
	bool has_choice;		/* refused: another value may do */
};

/* Mode 8, cyclic synchronous position, into 6060. */
extern const struct drive_write drive_mode_csp;

/**
 * drive_step_due() - the present step; steps that are not due are skipped.
 *
 * Return: false if no step is left.
 */
bool drive_step_due(struct drive *d, struct drive_step *ret);

/** drive_step_fits() - is d->word, which was read, what it has to be? */
bool drive_step_fits(struct drive *d, const struct drive_step *s);

/** drive_step_done() - a write was accepted: go on to the next step. */
void drive_step_done(struct drive *d, const struct drive_step *s);

/** drive_step_missing() - skip all steps of this object. */
void drive_step_missing(struct drive *d, const struct drive_step *s);

/** drive_step_choose() - try the next value. Return: false if there is none. */
bool drive_step_choose(struct drive *d);

struct interp_diag;

/**
 * drive_eds_check() - would the drive of this EDS accept everything? In
 * drive_eds.c.
 *
 * Return: 0; -ENOENT; -EINVAL; with found and wanted of @diag filled. Startup
 * only.
 */
int drive_eds_check(const char *path, const struct drive_config *c,
		    struct interp_diag *diag);

#endif /* IO_DRIVE_STEPS_H */
