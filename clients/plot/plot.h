/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plot.h - a picture of a job from its trace
 *
 * Draws path, place, gap voltage, feed and states of a trace CSV on one
 * sheet, with gnuplot.  The CSV has a heading and these columns first:
 *
 *	t_s,line,s_mm,feed_mm_s,gap_v,state,X,Y,Z,A,B,C,U,V
 *
 * and may have X_actual ... V_actual behind them.
 *
 * A trace of any length is read in little memory: it is thinned to the
 * smallest and largest value of each strip of time, so that a short spike
 * stays in the picture.
 *
 * Threads: any one thread, not in the cycle; it waits for gnuplot.
 */
#ifndef PLOT_H
#define PLOT_H

#include <stdbool.h>
#include <stdio.h>

struct plot_options {
	const char *program;	/* for messages: "edmsim" */
	const char *trace;	/* the CSV, a regular file */
	const char *output;	/* .png or .svg */
	const char *title;	/* of the sheet; NULL: the trace's name */
	double servo_v;		/* levels drawn over the gap voltage; */
	double short_v;		/* 0: not drawn */
	double open_v;
};

/**
 * plot_check() - can @output be drawn at all?
 *
 * To be asked before a long job: is the ending known, may the file be written,
 * is gnuplot there.
 * Return: 0, -EINVAL (ending), -ENOPKG (gnuplot) or that of the file; the
 * reason is on stderr.
 */
int plot_check(const char *program, const char *output);

/**
 * plot_trace() - read the trace and draw it.
 *
 * Return: 0, or a negative errno with the reason on stderr: as plot_check(),
 * -EINVAL also for a line that is no trace, -ENODATA for an empty trace,
 * -EIO if gnuplot failed, or that of the file that could not be opened.
 */
int plot_trace(const struct plot_options *o);

/* A picture by a script of the caller's own. */
struct plot_script {
	const char *program;	/* for messages */
	const char *output;	/* .png or .svg */
	void (*write)(FILE *f, const void *arg, bool svg);	/* the script,
				 * which draws to its standard output */
	const void *arg;
};

/** plot_script() - after plot_check(). Return: 0, -EIO or -errno, told. */
int plot_script(const struct plot_script *s);

#endif /* PLOT_H */
