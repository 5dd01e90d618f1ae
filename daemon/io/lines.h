/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lines.h - lines of a GPIO chip, with the version of libgpiod that is
 * installed
 *
 * gpiod1.c and gpiod2.c have the same functions, for libgpiod 1.6 and 2.x; the
 * Makefile takes the one whose version pkg-config reports. Values are levels: 1
 * is high. Inverting a line is left to the caller.
 *
 * Threads: lines_set() and lines_get() are RT-safe, with one ioctl each, and so
 * is lines_events(), with a read or two; the others are startup only.
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

/** lines_chip_open() - open the chip @path.  Return: 0 or -errno. */
int lines_chip_open(struct lines_chip **ret, const char *path);

/** lines_chip_close() - lines that were requested from it stay requested. */
void lines_chip_close(struct lines_chip *chip);

unsigned int lines_chip_count(struct lines_chip *chip);

/** lines_chip_label() - put its label into @buf; "" if it has none. */
void lines_chip_label(struct lines_chip *chip, char *buf, size_t size);

/** lines_chip_user() - is a line in use? @buf gets the name of its user. */
bool lines_chip_user(struct lines_chip *chip, unsigned int offset, char *buf,
		     size_t size);

/** lines_request() - request all lines with one call. Return: 0 or -errno. */
int lines_request(struct lines **ret, struct lines_chip *chip,
		  const struct lines_wanted *w);

/**
 * lines_set() - write a level to each line with one call. Return: 0 or -errno.
 */
int lines_set(struct lines *l, const uint8_t *value);

/**
 * lines_get() - read the level of each line with one call. Return: 0 or -errno.
 */
int lines_get(struct lines *l, uint8_t *value);

/**
 * lines_events() - take the edges since the last call; those of one line are
 * in the order in which they came.
 *
 * @room: LINES_EVENTS or more.
 * Return: how many, without waiting; -EOVERFLOW if the kernel may have dropped
 * some.
 */
int lines_events(struct lines *l, struct lines_event *ret, int room);

/** lines_release() - @l may be NULL. */
void lines_release(struct lines *l);

#endif /* IO_LINES_H */
