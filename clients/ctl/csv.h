/* SPDX-License-Identifier: Apache-2.0 */
/* csv.h - read a trace CSV, row by row; see plot.h for its columns */
#ifndef PLOT_CSV_H
#define PLOT_CSV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define CSV_NAXES	8		/* X Y Z A B C U V */

enum csv_state {
	CSV_IDLE, CSV_TRAVEL, CSV_APPROACH, CSV_ERODE, CSV_RETRACT, CSV_JUMP,
	CSV_HOLD, CSV_FAULT, CSV_JOG, CSV_HOME, CSV_PROBE, CSV_NSTATES
};

extern const char *const csv_state_word[CSV_NSTATES];

struct csv_row {
	double t_s, s_mm, feed_mm_s, gap_v;	/* gap_v may be NAN */
	double axis_mm[CSV_NAXES];
	double actual_mm[CSV_NAXES];	/* with has_actual */
	enum csv_state state;
};

/* Fields are private. */
struct csv {
	const char *program, *path;
	FILE *f;
	char text[4096];		/* a line */
	unsigned long line;
	long long read_bytes, all_bytes;
	int percent;			/* last told */
	bool has_actual;		/* to be read */
};

/**
 * csv_open() - open the file and check its heading.
 *
 * @times: how often it will be read from the start.
 *
 * Return: 0; or -errno, and the reason was printed.
 */
int csv_open(struct csv *c, const char *program, const char *path, int times);

/** csv_next() - Return: 1; 0 at the end; -EINVAL, and the place was printed. */
int csv_next(struct csv *c, struct csv_row *ret);

/** csv_close() - also after a csv_open() that failed. */
void csv_close(struct csv *c);

#endif /* PLOT_CSV_H */
