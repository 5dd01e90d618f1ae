/* SPDX-License-Identifier: Apache-2.0 */
/*
 * quadrature.h - an encoder's count, from edges of two lines or from a counter
 *
 * The edges of A and B are kept by the kernel, each with its time; both are
 * taken in the order of these times.  An edge is used one period after it was
 * read: only then it is sure that none before it is still on its way.  An edge
 * that does not change its line, or more edges than the kernel keeps, means
 * that some were missed: from then on the count is not to be believed.
 *
 * A counter of the kernel's counter interface is read as it stands, and counts
 * round at its ceiling.
 *
 * Threads: quadrature_read() RT-safe, two system calls at the most; the others
 * startup only.
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
	uint64_t read_ns;		/* time of the read before */

	int fd;				/* of the counter's count; -1: none */
	uint64_t round, raw;		/* it counts round at; last reading */

	int64_t count;
	bool missed;
};

/** quadrature_edges() - by @lines, watched: A, then B. */
int quadrature_edges(struct quadrature *q, struct lines *lines);

/**
 * quadrature_counter() - by the counter @name, as counter0/count0.
 *
 * @folder: /sys/bus/counter/devices.
 * Return: 0 or -errno with found and wanted of @diag filled.
 */
int quadrature_counter(struct quadrature *q, const char *folder,
		       const char *name, struct interp_diag *diag);

/**
 * quadrature_read() - once a period, at @now_ns of CLOCK_MONOTONIC.
 * Return: false if counts were missed.
 */
bool quadrature_read(struct quadrature *q, uint64_t now_ns);

/** quadrature_again() - believe the count from here on. */
void quadrature_again(struct quadrature *q);

/** quadrature_close() - */
void quadrature_close(struct quadrature *q);

#endif /* IO_QUADRATURE_H */
