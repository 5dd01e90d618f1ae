/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config.h - the machine file: one table of keys
 *
 * Each key has a section, name, unit, default, smallest and largest value and
 * a line of help, in keys.c.  Parser, range check, --print-config and
 * docs/config.md come from that table.  A misspelt key, a value out of range
 * or of the wrong kind is refused with its line.
 *
 * Threads: startup only.
 */
#ifndef CONFIG_H
#define CONFIG_H

#include "interp/axis.h"
#include "interp/diag.h"
#include "interp/nc.h"

#include <stdio.h>

enum config_backend { BACKEND_SIM, BACKEND_NULL };

/* [gap] */
struct config_gap {
	int source;			/* 0 sim; more with their backends */
	double servo_v, short_v, open_v;
	double feed_gain_mm_s_v, feed_max_mm_s, approach_mm_s;
	double retract_mm_s, retract_limit_mm, retract_wait_s;
};

/* [jump] */
struct config_jump {
	double height_mm, every_s, v_max_mm_s, a_max_mm_s2, j_max_mm_s3;
	double short_of_mm;
};

/* [sim]: the simulated gap process; io/sim.c says what each does. */
struct config_sim {
	double seed;			/* whole number */
	double speed;			/* periods run for each period of time */
	double on_us, off_us, peak_a, open_v, spark_v;
	double short_gap_mm, best_gap_mm, open_gap_mm;
	double standoff_mm;		/* air before the workpiece */
	double area_mm2;		/* frontal area of the electrode */
	double removal_mm3_min;		/* at the best gap, clean */
	double wear_ratio;		/* electrode length lost per depth */
	double debris_per_mm;		/* debris made per mm eroded, 0..1 scale */
	double debris_settle_s;		/* time constant, undisturbed */
	double debris_gap_mm;		/* gap lost at debris 1 */
	double flush_mm;		/* jump stroke that halves the debris */
	double bridge_per_s;		/* debris bridges per second at debris 1 */
	double bridge_mm;		/* mean length of a bridge */
	double bridge_settle_s;		/* it shrinks with this time constant */
	double noise_v;			/* sigma of the gap voltage */
};

struct machine_config {
	/* [machine] */
	char name[32];
	double period_us;		/* 0: by backend */
	int backend;			/* enum config_backend */
	int strategy;			/* enum interp_strategy */
	double tolerance_pulses;	/* mu */
	uint32_t perpendicular;		/* 1: mu is square to the path */
	int coupling;			/* enum interp_coupling */
	double feed_default_mm_min;	/* before the first F; 0: F demanded */
	uint32_t optional_stop;		/* 1: M1 holds */
	double threeb_unit_um;		/* of lengths in 3B and 4B programs */
	double fourb_offset_um;		/* of the wire, by 4B's D and DD */
	double cpu;			/* core the cycle is pinned to; -1: none */
	double priority;		/* SCHED_FIFO */
	double overrun_limit;		/* missed periods in a row; 0: no fault */

	struct interp_machine axes;	/* [axis.X] ... [axis.V] */
	double start_mm[INTERP_NAXES];	/* where a simulated machine begins */
	double work_offset_mm[INTERP_NC_NWORK][INTERP_NAXES];	/* [work] */

	struct interp_wire wire;	/* [wire] */
	double offset_mm[INTERP_NOFFSETS];	/* [wire] offset_*_mm */

	struct config_gap gap;
	struct config_jump jump;
	struct config_sim sim;

	char lcm_url[128];		/* [lcm] url */
	double dds_domain;		/* [dds] domain */
	double dds_hz;
	char store_dir[256];		/* [jobs] store: SQLite database's folder */
};

/** config_defaults() - the built-in machine: eight axes, +-200 mm. */
void config_defaults(struct machine_config *c);

/**
 * config_read() - defaults, then the file.
 *
 * Return: 0; -errno if it cannot be opened; -EINVAL with @diag filled.
 */
int config_read(struct machine_config *c, const char *path,
		struct interp_diag *diag);

/** config_period_ns() - the period in force. */
int64_t config_period_ns(const struct machine_config *c);

/** config_print() - every key with its value, as a machine file. */
void config_print(const struct machine_config *c, FILE *f);

/** config_document() - docs/config.md. */
void config_document(FILE *f);

struct cycle_config;

/** config_cycle() - what the cycle needs of it, in pulses and cycles. */
void config_cycle(const struct machine_config *c, struct cycle_config *ret);

#endif /* CONFIG_H */
