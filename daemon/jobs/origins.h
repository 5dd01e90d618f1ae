/* SPDX-License-Identifier: Apache-2.0 */
/* origins.h - where the loaded program counts from, by segment: offset.h */
#ifndef JOBS_ORIGINS_H
#define JOBS_ORIGINS_H

#include <stdint.h>

struct interp_origin;

/* All 0 at first. */
struct offset {
	uint32_t n;			/* the program that this is of */
	struct interp_origin *origins;
	uint64_t norigins;
};

#endif /* JOBS_ORIGINS_H */
