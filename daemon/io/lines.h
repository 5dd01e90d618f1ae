/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lines.h - lines of a GPIO chip, by whichever libgpiod there is
 *
 * gpiod1.c and gpiod2.c are the same calls on libgpiod 1.6 and 2.x; the
 * Makefile takes the one that pkg-config speaks of.  Values are levels: 1 is
 * high; inverting is the caller's.
 *
 * Threads: lines_set() and lines_get() are RT-safe, one ioctl each, and so is
 * lines_events(), a read or two; the rest is startup only.
 */
#ifndef IO_LINES_H
#define IO_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LINES_MAX	64		/* of one request */
#define LINES_EVENTS	32		/* edges taken at a time, at the most */

struct lines_chip;
struct lines;

enum lines_pull { LINES_AS_IS, LINES_PULL_UP, LINES_PULL_DOWN, LINES_NO_PULL };

struct lines_wanted {
	const unsigned int *offset;
	const uint8_t *value;		/* of outputs, to begin with */
	size_t n;			/* 1 ... LINES_MAX */
	bool output;
	bool watched;			/* inputs: edges are kept, for
					 * lines_events() */
	enum lines_pull pull;		/* of inputs */
};

/* An edge of a watched line. */
struct lines_event {
	uint64_t ns;			/* CLOCK_MONOTONIC */
	uint8_t slot;			/* which line of the request */
	bool high;			/* level after it */
};

/** lines_chip_open() - the chip of device file @path.  0 or -errno. */
int lines_chip_open(struct lines_chip **ret, const char *path);

/** lines_chip_close() - lines requested of it stay. */
void lines_chip_close(struct lines_chip *chip);

unsigned int lines_chip_count(struct lines_chip *chip);

/** lines_chip_label() - into @buf; empty if there is none. */
void lines_chip_label(struct lines_chip *chip, char *buf, size_t size);

/** lines_chip_user() - is it in use?  By whom, into @buf. */
bool lines_chip_user(struct lines_chip *chip, unsigned int offset, char *buf,
		     size_t size);

/** lines_request() - all of them, in one; 0 or -errno. */
int lines_request(struct lines **ret, struct lines_chip *chip,
		  const struct lines_wanted *w);

/** lines_set() - a level for each line, in one call; 0 or -errno. */
int lines_set(struct lines *l, const uint8_t *value);

/** lines_get() - the level of each line, in one call; 0 or -errno. */
int lines_get(struct lines *l, uint8_t *value);

/**
 * lines_events() - edges that came since the last call; those of one line are
 * in their order.
 *
 * @room: LINES_EVENTS or more.
 * Return: how many, without waiting; -EOVERFLOW if the kernel may have dropped
 * some.
 */
int lines_events(struct lines *l, struct lines_event *ret, int room);

/** lines_release() - NULL is fine. */
void lines_release(struct lines *l);

#endif /* IO_LINES_H */
