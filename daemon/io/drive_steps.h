/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_steps.h - what a drive is asked, in order, while it is brought up
 *
 * Private to drive_setup.c.  A step writes an object, or reads one that must
 * have a certain value.  A step is left out if a value that was read before
 * makes it needless, if the machine file says so, or if the drive does not have
 * the object.
 */
#ifndef IO_DRIVE_STEPS_H
#define IO_DRIVE_STEPS_H

#include "drive.h"

struct drive_step {
	struct drive_write write;	/* of a read, only where */
	uint8_t what;			/* private */
	bool reads;
	bool has_choice;		/* refused: another value may do */
	bool kept;			/* refused: it has that value already */
};

/**
 * drive_step_due() - get the present step; steps that are not due are skipped.
 * Return: false if no step is left.
 */
bool drive_step_due(struct drive *d, struct drive_step *ret);

/** drive_step_fits() - has the object, read into d->word, a good value? */
bool drive_step_fits(struct drive *d, const struct drive_step *s);

/**
 * drive_step_finds_restart() - does d->word, which was read, show that the
 * drive forgot what was written?  Then the set-up must begin again.
 */
bool drive_step_finds_restart(const struct drive *d,
			      const struct drive_step *s);

/**
 * drive_step_forgets() - may this step not be repeated alone?  It overwrites
 * the value that shows whether the drive was switched off meanwhile.
 */
bool drive_step_forgets(const struct drive_step *s);

/** drive_step_done() - a write was stored: go to the next step. */
void drive_step_done(struct drive *d, const struct drive_step *s);

/** drive_step_missing() - skip all steps of this object. */
void drive_step_missing(struct drive *d, const struct drive_step *s);

/** drive_step_choose() - try the next value. Return: false: there is none. */
bool drive_step_choose(struct drive *d);

/** drive_step_owns() - is this object written by the set-up, or sent as a PDO?
 *  Then it is not for anybody else to write. */
bool drive_step_owns(const struct drive *d, uint16_t index);

struct interp_diag;

/**
 * drive_eds_check() - does this EDS allow all that the set-up writes?
 * Return: 0; -ENOENT; -EINVAL; with found and wanted of @diag filled.
 * Startup only.
 */
int drive_eds_check(const char *path, const struct drive_config *c,
		    struct interp_diag *diag);

#endif /* IO_DRIVE_STEPS_H */
