/* SPDX-License-Identifier: Apache-2.0 */
/*
 * touch.h - what "offset" asks for: its words, the lines that feel for it, and
 * the place that follows from the contacts
 *
 * The words stand in the first line of the text that feels, as a comment.  So
 * whoever follows the job knows what it is for, also after a restart.
 *
 * Units: mm, degrees.  Threads: any.
 */
#ifndef JOBS_TOUCH_H
#define JOBS_TOUCH_H

#include "shm.h"

#include "interp/axis.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TOUCH_WHY_MAX	600
#define TOUCH_TEXT_MAX	600

/* What is felt; docs/probe.md. */
enum touch_form {
	TOUCH_NOTHING,
	TOUCH_EDGE, TOUCH_BORE, TOUCH_BOSS, TOUCH_CORNER,
	TOUCH_SKEW,			/* a face at two places: how it lies */
};

/* What two touches of a face say. */
enum touch_angle { TOUCH_TURN, TOUCH_TILT_X, TOUCH_TILT_Y };

struct touch {
	int work;			/* the system; -1: the electrode */
	uint32_t electrode;
	bool clear;			/* the machine file's again */
	bool is_new;			/* the electrode has no wear */
	uint32_t here, at;		/* axes, by X=5 and X@5 */
	double mm[INTERP_NAXES];
	enum touch_form form;
	uint32_t felt;			/* axes that find something */
	int way[INTERP_NAXES];		/* to the wall: 1 or -1; 0: to both */
	double most_mm;			/* an edge: it goes; 0: to the end of
					 * the travel */
	double radius_mm;		/* of the electrode */
	int along;			/* a skew: from touch to touch it goes
					 * along this axis ... */
	double along_mm;		/* ... so far */
	double off_mm;			/* a skew: so far off the face; 0: not
					 * said */
	double low, high;		/* a number that is refused lies beside
					 * these */
	char words[120];		/* of its cycle: " R10 Q0.1" */
};

/**
 * touch_read() - read @text: a system or an electrode, then words, between
 * them a blank or the end of a line.
 *
 * @present: the axes of the machine.
 * Return: 0; or -EINVAL, and @why says what was found and what is accepted.
 */
int touch_read(struct touch *ret, uint32_t present, const char *text,
	       char why[TOUCH_WHY_MAX]);

/** touch_text() - the lines that feel.  @ask: what touch_read() has read;
 *  @back_mm: behind the contact of an edge. */
void touch_text(const struct touch *t, const char *ask, double back_mm,
		char to[TOUCH_TEXT_MAX]);

/** touch_of_text() - read the first line of such a text again. */
int touch_of_text(struct touch *ret, uint32_t present, const char *text);

/** touch_is_found() - had every axis its contacts? */
bool touch_is_found(const struct touch *t, const struct shm_snapshot *s);

/** touch_at_mm() - where the axes stood at the contacts, as far as they have
 *  some, or stand: machine coordinates of the holder. */
void touch_at_mm(const struct touch *t, const struct shm_snapshot *s,
		 double ret_mm[INTERP_NAXES]);

/** touch_zero_mm() - what is to be taken off the place of @axis there, so that
 *  0 is left: the number that was asked for, less the radius. */
double touch_zero_mm(const struct touch *t, int axis);

/** touch_is_one_face() - may the contacts of a skew be of the face that was
 *  asked for?  Not if they are askew by more than 45 degrees. */
bool touch_is_one_face(const struct touch *t, const struct shm_snapshot *s);

/** touch_angle() - of a skew: how far the face turns the work, or tilts. */
enum touch_angle touch_angle(const struct touch *t,
			     const struct shm_snapshot *s, double *ret_deg);

#endif /* JOBS_TOUCH_H */
