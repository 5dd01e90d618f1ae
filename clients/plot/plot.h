/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plot.h - a picture of a job, thinned while the job runs, drawn by gnuplot
 *
 * One sheet shows the path, the place along it, the gap voltage, the feed, the
 * axes other than X Y Z, and the share of each state. A run of any length takes
 * the same small memory: rows fall into strips of time that keep their least
 * and their greatest value, so that a short spike stays in the picture. The
 * script trace.gp decides how the sheet looks, and anybody may change it. It
 * stands in the folder share/edmd beside the programs, or in the folder that
 * EDM_SHARE names.
 *
 * Threads: any one thread, not in the cycle; plot_finish() waits for gnuplot.
 */
#ifndef PLOT_H
#define PLOT_H

#include <stdbool.h>
#include <stdio.h>

#define PLOT_NAXES	8		/* X Y Z A B C U V */
#define PLOT_NSTATES	16

struct plot_options {
	const char *program;	/* for messages: "edmsim" */
	const char *output;	/* .png or .svg */
	const char *title;	/* of the sheet */
	const char *(*state_name)(int state);	/* NULL behind the last */
	double servo_v;		/* levels drawn over the gap voltage; */
	double short_v;		/* 0: not drawn */
	double open_v;
	bool upper_by_places;	/* U V are places of the upper guide, not how
				 * far it is from above X Y */
};

/* One cycle. */
struct plot_row {
	double t_s;			/* never falls */
	double s_mm;			/* place along the path */
	double feed_mm_s;
	double gap_v;			/* NAN: not known */
	double axis_mm[PLOT_NAXES];	/* degrees for A B C */
	int state;			/* for state_name() */
	bool cut;			/* this ground is cut, not positioned */
};

struct plot;

/**
 * plot_check() - can @output be drawn at all?
 *
 * Ask this before a long job. It checks that the ending of the name is known,
 * that the file can be written, and that gnuplot is installed.
 *
 * Return: 0, -EINVAL (ending), -ENOPKG (gnuplot) or the -errno of the file; the
 * reason is on stderr.
 */
int plot_check(const char *program, const char *output);

/**
 * plot_begin() - @o must stay until plot_finish(). Return: NULL if there is no
 * memory.
 */
struct plot *plot_begin(const struct plot_options *o);

/** plot_add() - the next row. */
void plot_add(struct plot *p, const struct plot_row *r);

/**
 * plot_finish() - draw what was added, and free @p, which may be NULL.
 *
 * Return: 0, or a negative errno with the reason on stderr: -ENODATA if there
 * was no row, otherwise as plot_draw().
 */
int plot_finish(struct plot *p);

/* A picture by a script of share/edmd, from data of the caller's own. */
struct plot_sheet {
	const char *program;	/* for messages */
	const char *output;	/* .png or .svg */
	const char *script;	/* file name in share/edmd */
	void (*write)(FILE *f, const void *arg);	/* variables and data
				 * blocks, as gnuplot reads them */
	const void *arg;
};

/**
 * plot_draw() - call it after plot_check(). Return: 0; -EIO; -ENOENT: there is
 * no script; or the -errno of the file. The reason is on stderr.
 */
int plot_draw(const struct plot_sheet *s);

#endif /* PLOT_H */
