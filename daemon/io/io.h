/* SPDX-License-Identifier: Apache-2.0 */
/*
 * io.h - a machine, as the cycle sees it: read, then write, once a period
 *
 * A backend is a struct of functions and its own state behind `self`.  null.c
 * is the smallest one and the template for the next; sim.c is a sinker with a
 * gap process and a seed.
 *
 * Threads: open and close are startup only; read and write are RT-safe: they
 * do not allocate or block, beyond the hardware's own read and write.
 */
#ifndef IO_H
#define IO_H

#include <stdbool.h>
#include <stdint.h>

#define IO_NAXES	8		/* as enum interp_axis */

/* What the machine says, once a period. */
struct io_inputs {
	double gap_v;			/* mean voltage over the last period */
	bool gap_valid;			/* false: no gap sensor, or it is ill */
	bool estop;			/* true: stop everything */
	bool lost;			/* true: the machine does not answer */
	int32_t actual[IO_NAXES];	/* pulses, measured or last written */
};

/* What the cycle wants, once a period. */
struct io_outputs {
	int32_t target[IO_NAXES];	/* pulses, absolute */
	double place_mm;		/* on the path; for a simulated gap */
	uint32_t path;			/* counts the programs loaded */
	bool rapid;			/* positioning through free space */
	bool power;			/* sparks allowed */
	bool negative;			/* electrode polarity */
	bool pump;			/* dielectric */
	char cond_letter;		/* technology condition called; 0: none */
	uint32_t cond_number;
};

struct io_machine {
	const char *name;
	void *self;
	void (*read)(void *self, struct io_inputs *in);
	void (*write)(void *self, const struct io_outputs *out);
	void (*close)(void *self);
	uint32_t edges_per_cycle;	/* most pulses an axis may make in one
					 * period; 0: targets, no such limit */
};

struct machine_config;

/**
 * io_sim_open() - a simulated sinker, see sim.c; @seed as `[sim] seed`.
 * Return: 0 or -ENOMEM.  Startup only.
 */
int io_sim_open(struct io_machine *m, const struct machine_config *c,
		uint64_t seed);

/* What a simulated cut came to. */
struct io_sim_result {
	double removed_mm3;
	double wear_mm;			/* electrode length lost */
	double debris;			/* 0 clean ... 1 choked */
};

/** io_sim_result() - of a machine opened by io_sim_open(). Any time. */
void io_sim_result(const struct io_machine *m, struct io_sim_result *ret);

/** io_null_open() - nothing, correctly: no gap, axes follow at once. */
int io_null_open(struct io_machine *m);

#endif /* IO_H */
