/* SPDX-License-Identifier: Apache-2.0 */
/*
 * thin.h - a run of any length, reduced in one pass to what a sheet can show
 *
 * Rows fall into strips of time. When all strips are used, each two of them
 * become one that is twice as wide. So the length of the run need not be known
 * before.
 */
#ifndef PLOT_THIN_H
#define PLOT_THIN_H

#include "plot.h"

#include <stddef.h>

#define THIN_STRIPS	2400		/* before two and two are joined */
#define THIN_ZOOM	2600
#define THIN_PATH	8000		/* points */
#define THIN_EVENTS	2048

/* Least, greatest and sum of what fell into a strip. */
struct thin_range {
	double min, max, sum;
	unsigned long n;		/* 0: nothing did */
};

struct thin_strip {
	struct thin_range place, gap, feed;
	struct thin_range axis[PLOT_NAXES];
	double far_mm;			/* farthest place so far */
	unsigned long share[PLOT_NSTATES];	/* rows */
};

/* A few jumps, or a retract, in more detail. */
struct thin_detail {
	struct thin_range place;
	int state;			/* the last one in it */
};

struct thin_zoom {
	struct thin_detail at[THIN_ZOOM];
	size_t n;
	double from_s, width_s;
	unsigned long jumps;		/* that begin in it */
	bool retract;			/* one is in it */
	bool whole;			/* it holds all it should */
};

/* A place on the path where something began. */
struct thin_event {
	double t_s, s_mm;
	double axis_mm[PLOT_NAXES];
};

struct thin_events {
	struct thin_event at[THIN_EVENTS];
	size_t n;
	unsigned long seen, every;	/* only each so many is kept */
};

struct thin_point {
	double axis_mm[PLOT_NAXES];
	bool cut;
};

/* What the states' names mean for a picture; -1: there is none such. */
struct thin_states {
	int approach, erode, retract, jump;
};

struct thin {
	struct thin_states is;
	unsigned long rows;
	struct thin_range time, place, axis[PLOT_NAXES];
	unsigned long in_state[PLOT_NSTATES];
	int state;			/* of the row before */
	bool cuts;			/* some row was under power */
	double cut_min;			/* the least place of those */
	struct thin_strip strip[THIN_STRIPS];
	size_t nstrips;
	double width_s;			/* 0: not known yet */
	struct thin_events jumps, retracts;
	struct thin_point path[THIN_PATH];
	size_t npath;
	double least_mm, kept_mm;	/* between two points; the last one */
	struct thin_zoom zoom, trying;	/* the best; the one being filled */
	unsigned long try_at;		/* the next begins at this jump */
};

/**
 * thin_init() - @name is a table of the names of states, NULL behind the last.
 */
void thin_init(struct thin *t, const char *(*name)(int state));

/** thin_add() - Threads: one. */
void thin_add(struct thin *t, const struct plot_row *r);

/**
 * thin_end() - there are no more rows. A zoom that is not complete is kept if
 * it is the only one.
 */
void thin_end(struct thin *t);

/** thin_range_join() - add @b to @a. */
void thin_range_join(struct thin_range *a, const struct thin_range *b);

#endif /* PLOT_THIN_H */
