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
	double spark_s;			/* it has sparked */
	double life_mm, life_s;		/* worn out at so much wear, or after so
					 * much sparking; 0: no limit */
	enum store_electrode_state state;	/* as the operator says */
};

/** store_electrode_ok() - may an electrode have number @n? */
bool store_electrode_ok(double n);

/** store_electrode_state_name() - "there", "worn", "absent". */
const char *store_electrode_state_name(enum store_electrode_state s);

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

#endif /* JOBS_STORE_ELECTRODE_H */
