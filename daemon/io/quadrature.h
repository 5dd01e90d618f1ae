/* SPDX-License-Identifier: Apache-2.0 */
/*
 * quadrature.h - an encoder's count, from edges of two lines or from a counter
 *
 * The kernel keeps the edges of A and B, each with its time.  The edges of both
 * are counted in the order of these times.  An edge is counted one period after
 * it was read; only then is it certain that no earlier edge is still to come.
 * Edges were missed if one does not change the level of its line, or if there
 * were more than the kernel keeps.  From then on the count is not trusted.
 *
 * A counter of the kernel's counter interface is read as it is.  It starts
 * again at 0 after its ceiling.
 *
 * Threads: quadrature_read() is RT-safe, with two system calls at most; the
 * others are startup only.
 */
#ifndef IO_QUADRATURE_H
#define IO_QUADRATURE_H

#include "lines.h"

#include "interp/diag.h"

#define QUADRATURE_KEPT	(2 * LINES_EVENTS)

struct quadrature {
	struct lines *lines;		/* A and B; NULL: a counter */
	uint8_t level[2];
	struct lines_event kept[QUADRATURE_KEPT];
	int nkept;
	uint64_t read_ns;		/* when it was read last */

	int fd;				/* of the counter's count; -1: none */
	uint64_t round, raw;		/* its ceiling plus 1; its last
					 * reading */

	int64_t count;
	bool missed;
};

/** quadrature_edges() - count the edges of @lines, which are watched: A, then
 *  B. */
int quadrature_edges(struct quadrature *q, struct lines *lines);

/**
 * quadrature_counter() - read the counter @name, such as counter0/count0.
 *
 * @folder: /sys/bus/counter/devices.
 * Return: 0; or -errno, with found and wanted of @diag filled.
 */
int quadrature_counter(struct quadrature *q, const char *folder,
		       const char *name, struct interp_diag *diag);

/**
 * quadrature_read() - once a period, at @now_ns of CLOCK_MONOTONIC.
 * Return: false if counts were missed.
 */
bool quadrature_read(struct quadrature *q, uint64_t now_ns);

/** quadrature_again() - trust the count again from here on. */
void quadrature_again(struct quadrature *q);

/** quadrature_close() - release the lines, or close the counter. */
void quadrature_close(struct quadrature *q);

#endif /* IO_QUADRATURE_H */
