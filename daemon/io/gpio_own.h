/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpio_own.h - what gpio.c and gpio_open.c share
 *
 * Threads: as in io.h; gpio_edges_write() belongs to the edge thread.
 */
#ifndef IO_GPIO_OWN_H
#define IO_GPIO_OWN_H

#include "adc.h"
#include "config.h"
#include "edges.h"
#include "encoder.h"
#include "io.h"
#include "lines.h"
#include "pulser.h"
#include "quadrature.h"

#include <stdatomic.h>

#define NCHIPS		4

/* Lines of one chip, one direction. */
struct bulk {
	struct lines *lines;		/* NULL: none */
	unsigned int offset[LINES_MAX];
	uint8_t value[LINES_MAX];	/* levels */
	size_t n;
};

enum bulk_kind {
	BULK_OUT,			/* written by the cycle */
	BULK_EDGES,			/* step and dir, by the edge thread */
	BULK_IN,
	NBULKS
};

struct chip {
	char name[CONFIG_LINE_MAX + 32];
	struct lines_chip *chip;
	struct bulk bulk[NBULKS];
};

/* Where a line of the machine file is found; chip < 0: nowhere. */
struct place {
	int8_t chip;
	uint8_t bulk;			/* enum bulk_kind */
	uint8_t slot;
	bool inverted;
};

/* What the log is to say of an axis. */
enum gpio_tell { GPIO_TELL_OFF, GPIO_TELL_MISSED, GPIO_TELL_LOST, GPIO_NTELLS };

struct gpio {
	struct chip chip[NCHIPS];
	int nchips;
	struct place at[CONFIG_NLINES];
	struct pulser pulser;		/* without an edge thread: */
	int64_t changed_ns;		/* its levels are these since */
	struct edges *edges;		/* NULL: a line changes once a period */
	struct edges_told told;
	int32_t shift[IO_NAXES];	/* its pulses less the thread's */
	struct edges_shown shown;
	uint32_t ends;			/* limit switches on, a period ago */
	uint32_t adc_max;		/* periods without a sample */
	uint32_t dead, dead_max;	/* periods in which the thread did
					 * nothing */
	uint64_t in, out;		/* a bit per line: on */
	uint32_t path;			/* program the pulser counts in */
	bool placed;			/* a first target came */
	bool lost;
	uint32_t watchdog_left, watchdog_periods;
	uint32_t refresh_left, refresh_periods;
	uint32_t quiet, quiet_max;	/* periods without a comparator */
	struct io_shares shares;	/* the last ones */
	bool has_gap;			/* comparators */
	struct adc adc;			/* fd -1: none */

	/* gpio_axes.c */
	uint32_t encoders;		/* a bit per axis that has one */
	struct encoder encoder[IO_NAXES];
	struct quadrature quadrature[IO_NAXES];
	bool wanted;			/* the axes are to have power */
	bool joined;			/* they go where the cycle says; before,
					 * it says where they stand */
	uint32_t unplaced;		/* for the next read */
	_Atomic uint32_t tell[GPIO_NTELLS];	/* a bit per axis */
	bool has_power;			/* lines that switch it */
	uint32_t brake_periods;
	int64_t brake_ns;
	uint32_t open_left, close_left;	/* periods until the brakes are open,
					 * or closed */
};

/* Of struct io_machine. */
void gpio_read(void *self, struct io_inputs *in);
void gpio_write(void *self, const struct io_outputs *out);
void gpio_close(void *self);

/**
 * gpio_open_outputs() - request the lines, all off, without axes and gap.
 * Return as io_gpio_open(); gpio_close() ends it.
 */
int gpio_open_outputs(struct gpio **ret, const struct machine_config *c,
		      struct interp_diag *diag);

/**
 * gpio_outputs_write() - write the lines of g->out that belong to the cycle.
 */
void gpio_outputs_write(struct gpio *g);

/**
 * gpio_levels() - set the values of @lines: on if they are in @on.
 * Return: true if any value has changed.
 */
bool gpio_levels(struct gpio *g, uint64_t on, uint64_t lines);

/* -- gpio_axes.c ---------------------------------------------------------- */

/** gpio_put() - pulses put out for axis @i, as the machine counts them. */
int32_t gpio_put(const struct gpio *g, int i);

/** gpio_axes_read() - read encoders; fill what @in says of the axes. */
void gpio_axes_read(struct gpio *g, struct io_inputs *in);

/** gpio_axes_write() - Return: lines that are to be on. */
uint64_t gpio_axes_write(struct gpio *g, const struct io_outputs *out);

/** gpio_axes_counted() - the count of pulses was @before and is another now. */
void gpio_axes_counted(struct gpio *g, const int32_t *before);

/** gpio_axes_close() - close the brakes, then take the power away. */
void gpio_axes_close(struct gpio *g);

/** gpio_note() - io_machine.note */
bool gpio_note(void *self, char *buf, size_t size);

/** gpio_edges_write() - edges_config.write */
bool gpio_edges_write(void *self, uint32_t step, uint32_t dir);

#endif /* IO_GPIO_OWN_H */
