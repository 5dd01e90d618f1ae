/* SPDX-License-Identifier: Apache-2.0 */
/*
 * job.h - what a run of edm-plan has loaded: machine, bodies, clearance
 *
 * Units: mm and degrees.  Threads: one; once loaded it is only read.
 */
#ifndef PLAN_JOB_H
#define PLAN_JOB_H

#include "prove.h"
#include "proved.h"
#include "route.h"

struct job_options {
	bool check, measure;
	const char *part, *electrode, *machine_file;
	const char *program;		/* NC code; with --measure, the poses */
	const char *dialect;		/* NULL: by the file's name */
	const char *output, *report, *picture, *view;	/* NULL: none */
	double unit_mm;			/* of the meshes' numbers */
	double part_at[3], electrode_at[3];
	double clearance_mm;		/* < 0: from the machine file's gap */
	double chord_mm;		/* < 0: guessed from the meshes */
	double end_zone_mm;
	double budget_s;		/* of the processor, for a way out */
	double end[INTERP_NAXES];	/* --end-pose, with end_given */
	uint32_t end_axes;		/* bit per axis that --end-pose names;
					 * the others are at 0 */
	bool end_given;
	bool any_size, accept_flaws, quiet, times, on_path, no_pivot;
};

struct job {
	const struct job_options *o;
	struct machine_config config;
	struct interp_kinematics kin;
	struct mesh part, tool;
	struct mesh_findings part_found, tool_found;
	struct tree part_tree, tool_tree;
	struct bodies bodies;
	struct proved proved;
	struct machine_motion motion;
	double clear_mm;		/* asked for */
	double chord_mm;		/* of both meshes, added to it */
};

/** job_load() - Return: 0; else a sysexits code, the reason on stderr. */
int job_load(struct job *j, const struct job_options *o);

void job_free(struct job *j);

/** job_describe() - print what was loaded. */
void job_describe(const struct job *j, FILE *f);

/** job_say_pair() - print the two triangles of @pair. */
void job_say_pair(const struct job *j, const struct near_pair *pair, FILE *f);

/**
 * job_inside() - is a shell of one body inside the other at @pose?
 *
 * A distance cannot show this.  @say: gets which one is inside which.  Return:
 * 1: yes; 0: no; -1: out of memory.
 */
int job_inside(const struct job *j, const struct pose *pose, char *say,
	       size_t size);

/** job_are_apart() - is @mm more than the length of one of the bodies?  Then
 *  they are probably not where they are meant to be. */
bool job_are_apart(const struct job *j, double mm);

/** job_strays_mm() - how far any point may be off block @i of @w. */
double job_strays_mm(const struct route *w, uint32_t i, const struct block *b);

/** job_block() - fill @ret with block @i of @w. */
void job_block(const struct job *j, const struct route *w, uint32_t i,
	       struct block *ret);

/** job_moves_known() - does @w move only axes that the chain has?  If not, it
 *  says so on stderr. */
bool job_moves_known(const struct job *j, const struct route *w,
		     const char *path);

/* The axes that move the electrode. */
struct job_axes {
	uint32_t n;
	enum interp_axis axis[INTERP_NAXES];
	double reach_mm[INTERP_NAXES];	/* by axis: the most that a unit of it
					 * moves any point */
};

/** job_axes_find() - find them, with their reach between @from and @to. */
void job_axes_find(const struct job *j, const double from[INTERP_NAXES],
		   const double to[INTERP_NAXES], struct job_axes *ret);

/** bar_show() - rewrite the one line of progress on stderr; with --quiet, do
 *  nothing. */
void bar_show(const struct job *j, double share, const char *text);

/** bar_best() - from now on the line also shows the best way so far. */
void bar_best(uint32_t blocks, double mm);
void bar_end(const struct job *j);

/** bar_interrupted() - was Ctrl-C pressed? */
bool bar_interrupted(void);
void bar_catch(void);
void bar_forget(void);

#endif /* PLAN_JOB_H */
