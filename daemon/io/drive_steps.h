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
 * drive_step_due() - the step at hand; steps that are not due are passed.
 * Return: false: there is none left.
 */
bool drive_step_due(struct drive *d, struct drive_step *ret);

/** drive_step_fits() - d->word, which was read, is what it must be. */
bool drive_step_fits(struct drive *d, const struct drive_step *s);

/**
 * drive_step_finds_restart() - d->word, which was read, tells that it forgot
 * what was written before: all of it is to be done again.
 */
bool drive_step_finds_restart(const struct drive *d, const struct drive_step *s);

/**
 * drive_step_forgets() - is repeating it no way to go on?  What it writes over
 * would have told that the drive was switched off after it was read.
 */
bool drive_step_forgets(const struct drive_step *s);

/** drive_step_done() - a write was stored: on to the next. */
void drive_step_done(struct drive *d, const struct drive_step *s);

/** drive_step_missing() - on past all steps of this object. */
void drive_step_missing(struct drive *d, const struct drive_step *s);

/** drive_step_choose() - try the next value. Return: false: there is none. */
bool drive_step_choose(struct drive *d);

struct interp_diag;

/**
 * drive_eds_check() - drive_eds.c: would the drive of this EDS take it all?
 * Return: 0; -ENOENT; -EINVAL; with found and wanted of @diag filled.
 * Startup only.
 */
int drive_eds_check(const char *path, const struct drive_config *c,
		    struct interp_diag *diag);

#endif /* IO_DRIVE_STEPS_H */
