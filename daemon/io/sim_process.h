/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_process.h - the inside of the simulated machine; private to sim*.c
 *
 * A period goes through four files, in this order:
 *
 * 	sim_axes.c	where the electrode really is
 * 	sim_pulses.c	what a train of pulses does in this gap
 * 	sim_erosion.c	what the sparks take away, from work and electrode
 * 	sim_debris.c	where that goes; bridges, arcs that stay in one place
 *
 * What probing meets is in sim_probe.c.  docs/process-model.md describes the
 * model, with sources and pictures.
 *
 * Units: in every name; debris is 0 (clean) to 1 (choked).
 *
 * Threads: RT-safe; one object belongs to one thread.
 */
#ifndef IO_SIM_PROCESS_H
#define IO_SIM_PROCESS_H

#include "config.h"
#include "io.h"
#include "rng.h"
#include "sim_map.h"

#include "interp/smaller.h"

/* The pulses in force, and what follows from them alone. */
struct pulse_set {
	double on_us, off_us, open_v;
	bool iso;
	double short_mm;		/* contact: narrower than this */
	double peaks_mm;		/* height of the peaks above that */
	double reach_mm;		/* contact to where nothing ignites */
	double crater_mm3;		/* of one spark */
	double crater_j;		/* its energy */
	double channel;			/* what is left of a spark's when the
					 * next pulse begins, without debris */
};

/* What a train of pulses does in a gap: expected values. */
struct pulse_train {
	double spark, arc, shorted;	/* parts of 1; the rest stays open */
	double late;			/* counted as open, in time or not */
	double volts;			/* mean of the gap */
	double total_us;		/* of a pulse */
	double wait_us;			/* part of that without a spark */
	double ignites;			/* part of those that are no short */
	double per_s;			/* pulses a second */
	double burnt;			/* part of the on time that burns */
};

/* Of one axis, in pulses of its drive. */
struct sim_switches {
	int toward;			/* the switch is on from there on */
	double home, min, max, index;
	int32_t was;			/* a period ago */
	int32_t mark;			/* that passed since it is looked for */
};

struct sim {
	struct config_sim p;
	double period_s;
	double z_pulse_mm;		/* 0: no Z, the depth stays */
	double pulse_mm[3];		/* of X Y Z */
	double delay_us;		/* mean delay at the best gap */
	double late_us;			/* a longer wait is counted as open */
	double best_u;			/* the best gap's place in the reach */
	double reference_mm3;		/* crater of the reference pulse */
	struct rng rng;
	struct io_outputs out;		/* as last written */
	struct pulse_set pulse;
	struct pulse_train train;	/* of the last period */
	bool comparators;		/* they see the gap, and no counter */

	/* Axes. */
	double at_mm;			/* on the path, as the axes stand */
	double axis[IO_NAXES];		/* pulses, as the axes stand */
	uint32_t modelled;		/* bit per axis that is a model */
	bool exact;			/* they are at once where they are
					 * sent, and measured so */
	double drive_mm[IO_NAXES];	/* pulse of each */
	struct interp_axis_model model[IO_NAXES];
	int32_t step[IO_NAXES];		/* of the last period that moved any */
	double wait_s;			/* until an axis that starts moves */
	double stroke_mm;		/* of this period */
	struct sim_switches switches[IO_NAXES];
	uint32_t wired;			/* bit per axis that has any */
	uint32_t latched;		/* ... whose mark passed */

	/* Work and electrode. */
	double begin_mm;		/* on the path: the surface */
	double front_mm;		/* on the path: solid from here on */
	double wear_mm;			/* electrode length lost */
	double removed_mm3;
	double surface_z_mm;		/* where the first spark was */
	double depth_mm;		/* of the cavity */
	bool sparked;
	struct sim_map map;		/* ground it has been over */
	double over_mm;			/* on the path: as far as map knows */
	double turned[IO_NAXES];	/* A B C U V as they stood there */
	double fresh;			/* part of the area that meets ground
					 * that was not eroded before */

	/* Between them. */
	double debris;
	double bridge_mm;		/* a bridge of debris; 0: none */
	double hot;			/* part of the pulses that burn on
					 * where the last one did */
	double powered_s;		/* power on for so long; 0: off */

	/* Counted. */
	uint32_t burns;
	bool burning;
	bool broken;			/* the wire */
	double unpowered_s;
};

/* sim_axes.c */
void sim_axes_init(struct sim *s, const struct machine_config *c);
void sim_axes_place(struct sim *s);	/* at once where they are sent */
/** sim_axes_follow() - @was, @was_off_mm: what was sent a period ago. */
void sim_axes_follow(struct sim *s, const int32_t was[IO_NAXES],
		     double was_off_mm);
/** sim_axis() - where axis @i really is, pulses. */
double sim_axis(const struct sim *s, int i);
void sim_axes_measure(struct sim *s, struct io_inputs *in);

/* sim_switches.c */
void sim_switches_init(struct sim *s, const struct machine_config *c);
void sim_switches_read(struct sim *s, struct io_inputs *in);

/* sim_probe.c */
/** sim_probe() - does the electrode touch the block? */
bool sim_probe(const struct sim *s);

/* sim_pulses.c */
void sim_pulses_init(struct sim *s);
/** sim_pulses_set() - take the pulses that out.pulse asks for. */
void sim_pulses_set(struct sim *s);
/**
 * sim_pulses_train() - what they do in a gap of this width, from which debris
 * has been subtracted.
 */
void sim_pulses_train(struct sim *s, double gap_mm);
/**
 * sim_pulses_shares() - the shares as a generator counts them; may use random
 * numbers.
 */
struct io_shares sim_pulses_shares(struct sim *s);
/**
 * sim_pulses_lines() - what three comparators say, each 0 or 1: what became of
 * most pulses of the period; without @sparks, what a steady supply shows.
 */
struct io_shares sim_pulses_lines(struct sim *s, bool sparks);
/**
 * sim_pulses_volts() - the voltage as a sensor reads it, with @sparks or a
 * steady supply.
 */
double sim_pulses_volts(struct sim *s, bool sparks);
/** sim_pulses_j() - energy of the discharges of a period: sparks and arcs, by
 *  the voltage across them.  A short has no voltage. */
double sim_pulses_j(const struct sim *s);

/* sim_erosion.c */
double sim_area_mm2(const struct sim *s);
/** sim_whole_area_mm2() - the same, behind the tip; of a wire its kerf. */
double sim_whole_area_mm2(const struct config_sim *p);
void sim_erode(struct sim *s);
void sim_wire(struct sim *s);

/* sim_ground.c */
/** sim_map_of() - a map of fresh ground for the electrode or wire of @p. */
void sim_map_of(struct sim_map *m, const struct config_sim *p);
void sim_ground_init(struct sim *s);
/** sim_ground_clear() - another workpiece: all of it is fresh. */
void sim_ground_clear(struct sim *s);
/** sim_ground_follow() - find out what the electrode meets where it is now. */
void sim_ground_follow(struct sim *s);

/* sim_debris.c */
double sim_gap_mm(const struct sim *s);	/* electrode to front */
double sim_side_mm(const struct sim *s);
void sim_wash(struct sim *s);
void sim_bridge(struct sim *s, double gap_mm);
void sim_heat(struct sim *s);

#endif /* IO_SIM_PROCESS_H */
