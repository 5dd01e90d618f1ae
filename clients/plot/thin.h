/* SPDX-License-Identifier: Apache-2.0 */
/*
 * thin.h - a trace of any length, thinned to what a sheet can show
 *
 * Two readings: the survey finds how long, how far and where the events are;
 * the thinning then fills strips of time.  Each strip keeps the smallest and
 * the largest value, so nothing short disappears.
 */
#ifndef PLOT_THIN_H
#define PLOT_THIN_H

#include "csv.h"

#define THIN_BINS	1200		/* strips of time; three points each */
#define THIN_COLUMNS	240		/* of the states' shares */
#define THIN_PATH	4000		/* points of the path */
#define THIN_ZOOM	1300		/* strips of the zoom */

/* A place on the path where something began. */
struct thin_event {
	double t_s, s_mm;
	double axis_mm[CSV_NAXES];
};

struct thin_events {
	struct thin_event *at;
	size_t n, cap;
};

struct thin_survey {
	unsigned long rows;
	double t_min, t_max, s_min, s_max;	/* s, mm */
	double axis_min[CSV_NAXES], axis_max[CSV_NAXES];
	struct thin_events jumps, retracts;
	unsigned long in_state[CSV_NSTATES];	/* rows */
	bool gap;			/* some row has a gap voltage */
	bool cuts;			/* some row is cut, not positioned */
	double cut_min;			/* smallest place, mm, of those */
	double zoom_from_s, zoom_to_s;	/* equal: nothing to zoom at */
};

struct thin_bin {
	double min, max, sum;
	unsigned long n;
};

struct thin_point {
	double axis_mm[CSV_NAXES];
	bool cut;			/* eroded on the way here */
};

struct thin_zoom {
	struct thin_bin place;
	enum csv_state state;
};

struct thin {
	struct thin_survey survey;
	size_t nbins;
	struct thin_bin place[THIN_BINS], gap[THIN_BINS], feed[THIN_BINS];
	double far_mm[THIN_BINS];	/* farthest place so far */
	unsigned long share[THIN_COLUMNS][CSV_NSTATES];
	struct thin_point path[2 * THIN_PATH];
	size_t npath;
	size_t nzoom;
	struct thin_zoom zoom[THIN_ZOOM];
};

/* What a panel shows of a row of strips, and what there is. */
struct thin_span {
	double low, high;		/* to show: twice what means reach */
	double min, max;		/* of all strips */
};

/** thin_span_of() - a rare spike shall not flatten all the rest. */
void thin_span_of(struct thin_span *ret, const struct thin_bin *bin, size_t n);

/**
 * thin_create() - read @c twice.
 *
 * Return: 0, -ENODATA, -ENOMEM, -EINVAL; told on stderr.
 */
int thin_create(struct thin **ret, struct csv *c);

/** thin_destroy() - NULL is fine. */
void thin_destroy(struct thin *t);

#endif /* PLOT_THIN_H */
