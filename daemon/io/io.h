/* SPDX-License-Identifier: Apache-2.0 */
/*
 * io.h - a machine, as the cycle sees it: read, then write, once a period
 *
 * A backend is a struct of functions and its own state behind `self`.  null.c
 * is the smallest one and the template for the next; sim.c is a sinker or a
 * wire machine with a gap process and a seed.
 *
 * Threads: open and close are startup only; read and write are RT-safe: they
 * do not allocate or block, beyond the hardware's own read and write.
 */
#ifndef IO_H
#define IO_H

#include "interp/tech.h"

#include "cia402.h"

#include <stdbool.h>
#include <stddef.h>
#include <math.h>
#include <stdint.h>

#define IO_NAXES	8		/* as enum interp_axis */
#define IO_NTOLD	16		/* PROCESS_NTOLD of words/process.h */

/* How the pulses of the last period came out, as parts of 1. */
struct io_shares {
	float open;			/* did not ignite, or not in time */
	float spark;			/* ignited after a delay: good */
	float arc;			/* lit at once where the last one was */
	float shorted;			/* no voltage at all */
};

/* What is wrong with a machine's axes. */
enum io_trouble {
	IO_WELL,
	IO_DRIVE,			/* a drive has a fault or is gone */
	IO_FOLLOWING,			/* an axis is not where it was sent */
	IO_BUS,				/* the way to the drives is cut */
	IO_NTROUBLES
};

/* What a PLC says beside the machine; docs/plc.md. */
struct io_plc {
	bool present;			/* the machine file has one */
	bool alive;			/* it is there */
	bool permit;
	bool door_closed, level_ok, temperature_ok, no_fire, wire_whole;
	bool hold;			/* as long as it is true */
	bool start, reset;		/* asked for, in this period only */
	bool confirm;			/* ... what the job asks for is done */
	uint8_t mcode_done;		/* M code carried out; 0: none */
	uint16_t program;		/* to be loaded; 0: none */
	double override;		/* 1: as programmed */
	double axes_c;			/* temperature of axes; 0: unknown */
};

/* What a generator says of what it was asked for. */
struct io_generator {
	uint32_t in_force;		/* io_outputs.asked that is; counts if
					 * it can tell */
	bool trouble;			/* until a reset, or until something
					 * else is asked */
	uint32_t tells;			/* a bit per field of enum process_id
					 * that it tells */
	double told[IO_NTOLD];		/* ... which is this; NAN: nothing was
					 * heard yet.  Sums: since edmd was
					 * there */
};

/* What the machine says, once a period. */
struct io_inputs {
	double gap_v;			/* mean voltage over the last period */
	bool gap_valid;			/* false: no gap sensor, or it is ill */
	struct io_shares shares;	/* from a generator that counts */
	bool shares_valid;
	bool shares_old;		/* they are of an earlier period */
	bool shares_due;		/* none yet since there are sparks, and
					 * they are not late */
	double energy_j;		/* of the discharges of the last period,
					 * from a generator that counts it */
	bool energy_valid;
	bool wire_broken;
	bool contact;			/* contact, by an input of its own */
	bool estop;			/* true: stop everything */
	bool lost;			/* true: the machine does not answer */
	bool busy;			/* pulses are still on their way out: no
					 * lattice point this period */
	bool door_open;
	bool dielectric_low;
	uint32_t limit, home;		/* switches, a bit per axis: on */
	uint32_t limit_low, limit_high;	/* ... of these limit is on at the end
					 * of the axis that is known */
	uint32_t latching;		/* bit per axis: io_outputs.latch is in
					 * force: no mark is missed; */
	uint32_t latched;		/* ... and a mark has passed; until
					 * latch is 0 */
	int32_t latched_at[IO_NAXES];	/* pulses: that mark */
	enum io_trouble trouble;	/* until a reset */
	bool steers;			/* axes without trouble still follow
					 * their targets: they can brake on the
					 * path */
	bool starting;			/* not up yet: nothing can begin */
	uint32_t unplaced;		/* bit per axis: it lost its place in
					 * this period */
	bool powerless;			/* an axis cannot have power now: no
					 * motion may be asked for */
	bool axes_off;			/* not under power: no motion can begin.
					 * Targets are not followed, and where
					 * these end, the axes stand ... */
	int32_t stands_at[IO_NAXES];	/* ... here: pulses */
	int32_t ran_on[IO_NAXES];	/* pulses that they may have run on by
					 * themselves when they were stopped */
	uint32_t slips;			/* bit per axis: pulses that it cannot
					 * go are lost.  Other axes follow as
					 * soon as they can */
	struct io_plc plc;
	struct io_generator generator;
	int32_t actual[IO_NAXES];	/* pulses, measured or last written */
	int32_t own[IO_NAXES];		/* pulses from the drive's own zero, if
					 * it keeps one without power, or has
					 * found one */
	uint32_t homing;		/* bit per axis: its drive is at
					 * io_outputs.home; */
	uint32_t homed, unfound;	/* ... and has found its zero, or has
					 * not, or cannot latch; until home or
					 * latch is 0 */
};

/* What the cycle wants, once a period. */
struct io_outputs {
	int32_t target[IO_NAXES];	/* pulses, absolute */
	double place_mm;		/* on the path; for a simulated gap */
	uint32_t path;			/* another number: another program, or
					 * parts of it skipped; place_mm
					 * begins anew */
	bool rapid;			/* positioning through free space */
	bool enable;			/* axes under power */
	bool reset;			/* for a period: an operator's reset */
	uint32_t home;			/* bit per axis: its drive is to find
					 * its zero by itself */
	uint32_t latch;			/* bit per axis: its next index mark is
					 * looked for */
	bool power;			/* sparks allowed */
	bool sense;			/* the voltage to feel contact by */
	bool pump;			/* dielectric */
	char cond_letter;		/* condition in force; 0: none */
	uint32_t cond_number;
	double pulse[INTERP_NGENERATOR];	/* asked of the generator, by
					 * enum interp_tech_id; NAN: its own
					 * setting */
	uint32_t asked;			/* another number: pulse has changed,
					 * or another job asks for it */
	double off_path_mm;		/* way that an escape has led away from
					 * the path; 0: on the path */
};

/** io_pulse_own() - leave the generator its own settings.  RT-safe. */
static inline void io_pulse_own(struct io_outputs *out)
{
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		out->pulse[i] = (double)NAN;
}

/** io_is_negative() - is the electrode to be negative?  RT-safe. */
static inline bool io_is_negative(const struct io_outputs *out)
{
	return out->pulse[INTERP_TECH_POLARITY] < 0;
}

struct io_machine {
	const char *name;
	void *self;
	void (*read)(void *self, struct io_inputs *in);
	void (*write)(void *self, const struct io_outputs *out);
	void (*close)(void *self);
	/* Write the next line for the log into @buf; false: there is none.
	 * NULL if there never is one.  It is called by another thread than
	 * read and write. */
	bool (*note)(void *self, char *buf, size_t size);
	/* The drives' own counts at pulse 0, for the next edmd; false: they
	 * are not known yet.  NULL if only edmd counts.  RT-safe. */
	bool (*origin)(void *self, int32_t ret[IO_NAXES]);
	/* Take over these counts from the edmd before, so that places go on
	 * from there.  Startup only; NULL if origin is. */
	void (*originate)(void *self, const int32_t zero[IO_NAXES]);
	/* What is known of the drives of a bus.  NULL if it has none.
	 * RT-safe. */
	void (*drives)(void *self, struct cia402_told *ret);
	/* Read or set an object of a drive; what comes of it is told by
	 * drives().  Return: false: another one is under way.  NULL if drives
	 * is.  RT-safe. */
	bool (*object)(void *self, const struct cia402_request *r);
	bool stays;			/* nothing moves it while edmd is away:
					 * it is simulated */
	uint32_t edges_per_cycle;	/* the most pulses of an axis in a
					 * period in which it is not busy; 0:
					 * no limit */
};

struct machine_config;

struct interp_diag;

/*
 * How each backend is opened.  Return: 0 or -errno with found and wanted of
 * @diag filled, but for -ENOMEM.  Startup only.
 */
typedef int io_open_fn(struct io_machine *m, const struct machine_config *c,
		       struct interp_diag *diag);

/** io_sim_open() - a simulated machine, see sim.c. */
io_open_fn io_sim_open;

/** io_sim_open_seed() - the same, but with @seed instead of `[sim] seed`. */
int io_sim_open_seed(struct io_machine *m, const struct machine_config *c,
		     uint64_t seed);

/* What a simulated cut came to. */
struct io_sim_result {
	double removed_mm3;
	double wear_mm;			/* electrode length lost */
	double debris;			/* 0 clean ... 1 choked */
	double gap_mm;			/* electrode to front, now */
	double area_mm2;		/* frontal, now */
	double depth_mm;		/* of the cavity */
	double hot;			/* part of the ignitions that stay in
					 * one place */
	uint32_t burns;			/* times that arcs stayed */
};

/**
 * io_sim_result() - the result of a machine that io_sim_open() opened. Any
 * time.
 */
void io_sim_result(const struct io_machine *m, struct io_sim_result *ret);

/**
 * io_null_open() - a machine that does nothing: it has no gap, and its axes
 * follow at once.
 */
io_open_fn io_null_open;

/**
 * io_gpio_open() - step and direction lines, switches; docs/gpio.md.
 *
 * Sparks and pump are off from the moment at which the lines are requested.
 *
 * Return: -EACCES or -EPERM for missing rights, -EBUSY for a line in use,
 * another -errno for a chip or line that does not exist.
 */
io_open_fn io_gpio_open;

/**
 * io_can402_open() - CiA 402 drives on a CAN bus; can402.h, docs/can402.md.
 *
 * The drives are brought up by the first periods, see io_inputs.starting.
 */
io_open_fn io_can402_open;

#endif /* IO_H */
