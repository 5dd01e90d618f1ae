/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stamped.h - records from one writer to any number of readers
 *
 * A row of slots that the writer goes round.  Slot i holds record number n when
 * its stamp is 2n + 2; an odd stamp is being written.  No reader can delay the
 * writer: a record may be overwritten while it is read, and the stamp, read
 * before and after, shows it.  A writer that is killed inside a record leaves
 * the others whole; the next one writes the same record again.
 *
 * The slots may be in memory that processes share.  A slot begins with its
 * stamp, a uint64_t; the record behind it is a whole number of 8 bytes.
 *
 * Threads: stamped_put() one; the others any.  RT-safe.
 */
#ifndef COMMON_STAMPED_H
#define COMMON_STAMPED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct stamped {
	void *slots;
	uint64_t *next;			/* records written so far */
	size_t count;			/* of slots; a power of two */
	size_t slot_bytes;
};

/** STAMPED_ROW() - members of a struct: a row of slots for records of @type,
 *  and the number of records so far. */
#define STAMPED_ROW(type, row, so_far, count) \
	struct { \
		uint64_t stamp; \
		type record; \
	} row[count]; \
	uint64_t so_far

/** STAMPED() - of a row of slots, and of the number of records so far. */
#define STAMPED(row, so_far) \
	((struct stamped) { (row), &(so_far), sizeof(row) / sizeof((row)[0]), \
			    sizeof((row)[0]) })

/** stamped_put() - the next record. */
void stamped_put(const struct stamped *r, const void *record);

/** stamped_get() - record @n as a whole.  Return: false if it is gone; @ret may
 *  be written all the same. */
bool stamped_get(const struct stamped *r, uint64_t n, void *ret);

/**
 * stamped_last() - the last record; if the writer comes round meanwhile, the
 * next last one, @tries times.  Return: false if there is none, or none was
 * whole.
 */
bool stamped_last(const struct stamped *r, int tries, void *ret);

#endif /* COMMON_STAMPED_H */
