/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim.h - edmsim: a job in virtual time
 */
#ifndef SIM_SIM_H
#define SIM_SIM_H

#include "compiling.h"
#include "interp/compile.h"
#include "virtual.h"

#include <stdio.h>

struct sim_options {
	const char *job;
	const char *machine_file;
	int strategy, coupling;		/* -1: the machine file's */
	double tolerance_pulses;	/* with tolerance_given */
	bool tolerance_given, perpendicular;
	double fit_um;			/* with fit_given */
	bool fit_given;
	const char *dialect;		/* a name or a file; NULL: the job's */
	const char *emit;		/* "3b" or "iso": write that, no run */
	double unit_um, offset_um;	/* 0, -1: the machine file's */
	const char *set[INTERP_NSETS];	/* NULL: the machine file's */
	char setting[INTERP_SETTING_MAX];	/* all of them */
	const char *tech;		/* table; NULL: the machine file's */
	const char *pulses, *trace, *report, *plot;
	uint64_t from_line;		/* 0: from_mm */
	double from_mm;			/* 0: at the beginning */
	double period_us;		/* 0: the machine file's */
	double speed, limit_s;		/* 0: as fast as possible; no limit */
	uint64_t seed;
	double budget;			/* of tuning, in trials */
	bool tune_servo, json;
	bool print_tech, print_config;
	bool seed_given, dry_run, there_and_back, check, quiet, tune;
};

/* A compiled job. */
struct sim_job {
	struct interp_program program;
	void *block;
	uint32_t lines;
	double compile_lines_s;
};

/* What happened, beside the cycle's own sums. */
struct sim_result {
	const char *outcome;		/* done, fault, limit */
	double wall_s;
	uint64_t points, switches;
	uint32_t last_moved;
	double deviation_mm_max, deviation_mm_sum;
	int32_t end_error_pulses;
	bool contour_known;
	double contour_mm_max, contour_mm_mean;	/* of models of the axes */
	struct io_sim_result cut;
};

/* Cycles spent in one condition of the program. */
struct sim_spent {
	uint64_t cycles, eroding;
};

struct sim_run {
	const struct sim_options *o;
	const struct machine_config *config;
	struct sim_job job;
	struct virtual v;
	struct sim_result result;
	struct sim_spent *spent;	/* by index of the condition */
	FILE *pulses, *trace, *report;
	struct plot *plot;		/* NULL: no picture is wanted */
	bool deviation;			/* worth its time: a report is wanted */
	struct interp_deviation from;	/* the path: for it */
	void (*on_cycle)(struct sim_run *r);	/* NULL: nobody looks */
	void *on_cycle_arg;
	int leg;			/* of there and back: 0, 1, 2 */
};

/**
 * edmsim_options_read() - read the command line; in options.c. Return: -1 to go
 * on, or an exit code.
 */
int edmsim_options_read(struct sim_options *o, int argc, char **argv);

/**
 * edmsim_tech_load() - load the technology table in force. Return: 0, or an
 * exit code whose reason was printed. Free @ret by config_tech_free() in any
 * case.
 */
int edmsim_tech_load(struct config_tech *ret, const struct sim_options *o,
		  const struct machine_config *c);
/**
 * edmsim_tech_print() - as a .tech text to stdout; edmsim_tech_document() - its
 * fields.
 */
int edmsim_tech_print(const struct config_tech *t);
void edmsim_tech_document(void);

/**
 * job_load() - read and compile. Return: 0, or an exit code whose reason was
 * printed.
 */
int job_load(struct sim_job *job, const struct sim_options *o,
	     const struct machine_config *c);
void job_unload(struct sim_job *job);
/** job_describe() - what --check prints. */
void job_describe(const struct sim_job *job, FILE *f);
/**
 * plan_print() - what each call of a condition will cut: plan.c.  Return: 0 or
 * an exit code.
 */
int plan_print(const struct sim_job *job, const struct machine_config *c,
	       FILE *f);

/** job_emit() - the program as text to stdout. Return: 0 or an exit code. */
int job_emit(const struct sim_job *job, const struct sim_options *o,
	     const struct machine_config *c);

/**
 * run_job() - run the whole job. Return: 0, or an exit code whose reason was
 * printed.
 */
int run_job(struct sim_run *r);
/** run_interrupted() - has a signal ended a run? Any thread. */
bool run_interrupted(void);

/**
 * tune_contour() - run the job dry, find gains, print them. Return: exit code.
 */
int tune_contour(struct sim_run *r);

/**
 * tune_contour_watch() - before a dry run, tune_contour_measure() after it: the
 * contour error that models of the axes would have, if the machine file has
 * their loops.
 */
void tune_contour_watch(struct sim_run *r);
void tune_contour_measure(struct sim_run *r);

/**
 * edmsim_contour_look() - the same, before a dry run of [sim] loops: of the
 * simulated axes, by their scales.  Return: false if there are none.
 */
bool edmsim_contour_look(struct sim_run *r);
void edmsim_contour_looked(struct sim_run *r);

/** record_*() - the files of points, cycles and totals: record.c. */
int record_open(struct sim_run *r);
void record_point(void *arg, const struct cycle *c);
void record_cycle(struct sim_run *r);
int record_close(struct sim_run *r);

/** record_shut() - close @f, the file at @path.  Return: 0, or an exit code
 *  whose reason is told. */
int record_shut(FILE *f, const char *path);

/** report_print() - for a person; report_write() - JSON. */
void report_print(const struct sim_run *r, FILE *f);
int report_write(const struct sim_run *r);

#endif /* SIM_SIM_H */
