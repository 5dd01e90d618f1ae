/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour_try.h - the experiment's curves, set values and machine
 */
#ifndef EXPERIMENT_CONTOUR_H
#define EXPERIMENT_CONTOUR_H

#include "interp/trial.h"

#include <stdio.h>

#define PERIOD_S	0.001
#define NORMAL_MM_S2	100.0		/* limit of the normal acceleration */

/* -- spline.c: a rational B-spline in the plane --------------------------- */

#define SPLINE_POINTS	64

struct spline {
	int degree, n;
	double knot[SPLINE_POINTS + 8];
	double point[SPLINE_POINTS][3];	/* w x, w y, w */
	struct interp_contour_path path;
};

/** spline_load() - from tests/experiments/curves.json, or it ends. */
void spline_load(struct spline *c, const char *name);

/** spline_at() - place, first and second derivative at @u. */
void spline_at(const struct spline *c, double u, double ret[3][2]);

/* -- feed.c: set values along it ------------------------------------------ */

struct feed {
	const struct spline *curve;
	size_t n;
	double *u;
	double *mm[2];			/* with room to read before and after */
};

/** feed_make() - at @mm_min where the normal acceleration allows it. */
void feed_make(struct feed *f, const struct spline *c, double mm_min);
void feed_free(struct feed *f);

/* -- bench.c: the machine of the experiment ------------------------------- */

extern const struct interp_axis_loop loop_believed[2];

/* Set values as they are, or with the twin's offsets added. */
struct bench {
	struct feed *feed;
	double *set[2];			/* mm, n + the room of the feed */
	double (*offset_mm)[INTERP_NAXES];
	struct interp_compensate_config config;
	struct interp_trial trial;
};

/** bench_make() - @real: other loops than believed, noise and friction. */
void bench_make(struct bench *b, struct feed *f, bool real);
void bench_free(struct bench *b);

/** bench_twin() - pre-compensate by so many runs of the believed loops. */
void bench_twin(struct bench *b, int rounds, double gain);

/** bench_run() - or it ends. */
struct interp_trial_result bench_run(struct bench *b);

void *must(void *p);

/* -- The tables ----------------------------------------------------------- */

struct speeds {
	struct feed feed[3];		/* 500, 1000, 1500 mm/min */
};

extern const double speed_mm_min[3];

void table_baseline(struct speeds *s);
void table_methods(struct speeds *s);
void table_noise(struct speeds *s);
void table_gains(struct speeds *s);
void table_tuning(struct speeds *s);
void table_identify(struct speeds *s);
void table_maps(struct speeds *s);
void table_learned(struct speeds *s);
void table_foot(struct speeds *s);
void draw(struct speeds *s, const char *folder);

#endif /* EXPERIMENT_CONTOUR_H */
