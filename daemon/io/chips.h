/* SPDX-License-Identifier: Apache-2.0 */
/*
 * chips.h - GPIO chips and lines as a machine file names them, or why not
 *
 * Threads: startup only.
 */
#ifndef IO_CHIPS_H
#define IO_CHIPS_H

#include "lines.h"

#include "interp/diag.h"

/* Who wants a line. */
struct lines_use {
	unsigned int offset;
	const char *key;		/* of the machine file: "gpio.spark" */
};

/** lines_chip_named() - open /dev/@name, or the chip with that label.
 *  Return: 0 or -errno. */
int lines_chip_named(struct lines_chip **ret, const char *name);

/** lines_chip_refuse() - @diag says that chip @name did @err.  Return: @err. */
int lines_chip_refuse(struct interp_diag *diag, int err, const char *key,
		      const char *name);

/**
 * lines_chip_offers() - is the line there, and free?
 * Return: 0, -ERANGE or -EBUSY, with @diag filled.
 */
int lines_chip_offers(struct lines_chip *chip, const char *name,
		      const struct lines_use *use, struct interp_diag *diag);

#endif /* IO_CHIPS_H */
