/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_electrode.h - the table of electrodes, in the store
 *
 * docs/electrodes.md tells what the numbers mean.  An electrode has a number,
 * by which programs call it: T3.  Lengths and wear are along Z.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_STORE_ELECTRODE_H
#define JOBS_STORE_ELECTRODE_H

#include "store.h"

#include "interp/axis.h"

#define STORE_ELECTRODES_MAX	256
/* Numbers of electrodes.  T80 to T99 are the words of pumps and supplies in
 * some dialects. */
#define STORE_ELECTRODE_NUMBER_MAX	9999
#define STORE_ELECTRODE_PUMPS_MIN	80
#define STORE_ELECTRODE_PUMPS_MAX	99

enum store_electrode_state {
	ELECTRODE_THERE, ELECTRODE_WORN, ELECTRODE_ABSENT, ELECTRODE_NSTATES
};

struct store_electrode {
	uint32_t n;			/* its number */
	char name[32], material[32], note[104];
	double undersize_mm;		/* on one side */
	double length_mm;		/* from the reference to the tip, when
					 * it was new */
	double wear_mm;			/* of this length lost so far */
	double x_mm, y_mm, c_deg;	/* what it shifts X Y, at C 0, and C by:
					 * as it sits in its holder */
	double spark_s;			/* it has sparked */
	double life_mm, life_s;		/* worn out at so much wear, or after so
					 * much sparking; 0: no limit */
	enum store_electrode_state state;	/* as the operator says */
};

/** store_electrode_ok() - may an electrode have number @n? */
bool store_electrode_ok(double n);

/** store_electrode_state_name() - "there", "worn", "absent". */
const char *store_electrode_state_name(enum store_electrode_state s);

/** store_electrode_by() - what it shifts the axes by; X Y at C 0. */
void store_electrode_by(const struct store_electrode *e,
			double ret[INTERP_NAXES]);

/** store_electrode_find() - 0, -ENOENT, or -EIO: it cannot be known. */
int store_electrode_find(struct store *s, uint32_t n,
			 struct store_electrode *ret);
/** store_electrode_put() - a new one, or new values of one. */
int store_electrode_put(struct store *s, const struct store_electrode *e);
int store_electrode_remove(struct store *s, uint32_t n);

/** store_electrodes() - all of them, by number, at most @room.  Return: how
 *  many. */
size_t store_electrodes(struct store *s, struct store_electrode *to,
			size_t room);

/** store_electrodes_json() - an array of those above number @after, as many as
 *  fit one answer; to be freed.  NULL: the store failed. */
char *store_electrodes_json(struct store *s, uint32_t after);

/* -- How jobs used them ---------------------------------------------------- */

/* Part @part of job @job, from one change of the electrode to the next. */
struct store_worn {
	uint32_t job, part;
	uint32_t electrode;		/* 0: none */
	double by[INTERP_NAXES];	/* what the axes were shifted by */
	double before_mm, after_mm;	/* its wear */
	double before_s, after_s;	/* how long it had sparked */
	bool known;			/* after_mm counts all that was cut */
};

/** store_worn_add() - on the disk, or refused. */
int store_worn_add(struct store *s, const struct store_worn *w);
int store_worn_put(struct store *s, const struct store_worn *w);
/** store_worn_list() - of job @n, by part, from part @from on, at most @room.
 *  Return: how many. */
size_t store_worn_list(struct store *s, uint32_t n, uint32_t from,
		       struct store_worn *to, size_t room);
/** store_worn_next() - the number that the next part of job @n will have. */
uint32_t store_worn_next(struct store *s, uint32_t n);
/** store_worn_drop() - forget the parts of job @n that have not begun: their
 *  after_s is below 0. */
int store_worn_drop(struct store *s, uint32_t n);

#endif /* JOBS_STORE_ELECTRODE_H */
