/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_tally.h - what a job came to, in the store: by condition, its faults,
 * its trail
 *
 * Threads: one. Calls return the same values as those of store.h.
 */
#ifndef JOBS_STORE_TALLY_H
#define JOBS_STORE_TALLY_H

#include "store.h"

struct store_fault {
	int64_t time_ns;
	const char *fault;
	uint32_t line;			/* of the source */
	double place_mm;
};

/**
 * store_calls() - conditions that job @n has called, in one transaction.
 * @json: an array of [time in ns, name, place in mm], in the order of time.
 */
int store_calls(struct store *s, uint32_t n, const char *json);

/** store_used_write() - the sums of job @n by condition; a JSON array. */
int store_used_write(struct store *s, uint32_t n, const char *json);
/** store_used() - to be freed; NULL: none, or it cannot be read. */
char *store_used(struct store *s, uint32_t n);

/** store_trail_write() - where job @n was; a JSON object. */
int store_trail_write(struct store *s, uint32_t n, const char *json);
/** store_trail() - to be freed; NULL: none, or it cannot be read. */
char *store_trail(struct store *s, uint32_t n);

/** store_fault() - of job @n; the same one twice is kept once. */
int store_fault(struct store *s, uint32_t n, const struct store_fault *f);

#endif /* JOBS_STORE_TALLY_H */
