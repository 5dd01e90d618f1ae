/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nc.h - read NC code, one pass, into a program
 *
 * The dialect `generic` has the RS-274 words that most sinkers and wire
 * machines share.  The other dialects are those of wire machines.
 * docs/nc-code.md has the tables of all.  The reader keeps the modal state,
 * checks every word, and gives absolute machine coordinates to the builder.  A
 * word that it does not know is refused with its line and column.  Nothing is
 * skipped silently.
 *
 * The memory it needs is bounded by the size of the program: the reader does
 * not call itself, subprograms use a stack of fixed depth, and the number of
 * lines executed has a limit.
 *
 * Threads: allocates.  Never in the cycle.
 */
#ifndef INTERP_NC_H
#define INTERP_NC_H

#include "interp/build.h"
#include "interp/kinematics.h"
#include "interp/mcode_arg.h"
#include "interp/tech_table.h"
#include "interp/job_text.h"
#include "interp/setting.h"
#include "interp/wire.h"

#define INTERP_NC_DEPTH_MAX	8		/* M98 inside M98 */
#define INTERP_NC_LINE_MAX	4096		/* bytes in a line */
#define INTERP_NC_SEGS_MAX	50000000u	/* segments a program may
						 * have */
#define INTERP_NC_EXECUTED_MAX	100000000u	/* lines, repeats counted; a
						 * long one counts as many */


/* Takes remarks about a program that is accepted. */
struct interp_notes {
	void (*say)(void *arg, uint32_t line, const char *text);
	void *arg;
	bool plan;		/* the passes of G152 too */
};

/* Takes the reasons for which a text is refused, in the order of the text: at
 * most INTERP_NC_REFUSED_MAX.  The places of the axes are known only up to the
 * first one.  So behind it only the words are checked. */
struct interp_refused {
	void (*say)(void *arg, const struct interp_diag *diag);
	void *arg;
};

#define INTERP_NC_REFUSED_MAX	100

/* An electrode as a program needs it: docs/electrodes.md. */
struct interp_electrode {
	uint32_t number;		/* of its T word */
	double by[INTERP_NAXES];	/* what the axes are shifted by: Z by
					 * its length minus its wear; X Y, at
					 * C 0, and C */
};

struct interp_electrodes {
	const struct interp_electrode *at;
	size_t n;
	uint32_t held;			/* number of the one in the holder; 0:
					 * none */
	uint32_t chosen;		/* the one that the program begins with;
					 * 0: the one in the holder */
	bool unknown_ok;		/* numbers that are not in the table are
					 * accepted, and shift nothing: the
					 * caller checks the marks in the
					 * program */
};

/* What of a program reaches the generator. */
struct interp_delivery {
	/* Return: 0, or -EINVAL with found and wanted of @why filled; @who is
	 * named in them. */
	int (*takes)(const void *arg, const struct interp_tech *t,
		     const char *who, struct interp_diag *why);
	const void *arg;
	const char *no_pump, *no_sense;	/* what would be accepted instead;
					 * NULL: they do */
};

struct interp_nc_options {
	const struct interp_machine *machine;
	double work_offset_mm[INTERP_NC_NWORK][INTERP_NAXES];
	double work_turn_deg[INTERP_NC_NWORK];	/* about its origin, from X
						 * toward Y */
	const struct interp_wire *wire;	/* lent; NULL: no guides, no corners */
	struct interp_setting set;	/* its taper holds under an offset; the
					 * rest is refused */
	double offset_mm[INTERP_NOFFSETS];	/* D and H; 0: not filled */
	const struct interp_kinematics *kinematics;	/* lent; NULL: no
							 * G43.4 */
	double tip_tolerance_mm;	/* of the tip's way under G43.4, > 0 */
	double feed_mm_s;	/* until the first F; 0: an F is demanded, or,
				 * where programs have none, the fastest X and
				 * Y both go */
	enum interp_escape_mode escape;	/* until the first G140 ... G143 */
	const struct interp_tech_table *tech;	/* lent; NULL: conditions are
				 * taken as they come, without values */
	const struct interp_tech *machine_tech;	/* lent: the machine's own
				 * values, which conditions go over; NULL: not
				 * looked at */
	const struct interp_delivery *delivery;	/* lent; NULL: all does */
	const struct interp_mcode *mcode;	/* lent, INTERP_NMCODES of
				 * them by number: the PLC's; NULL: none */
	const struct interp_electrodes *electrodes;	/* lent; NULL: their
				 * sizes are not known, and T words shift
				 * nothing */
	const struct interp_notes *notes;	/* lent; NULL: nobody listens */
	const struct interp_refused *refused;	/* lent; NULL: the first is
				 * enough */
	uint32_t segs_max;	/* 0: INTERP_NC_SEGS_MAX */
	uint32_t executed_max;	/* 0: INTERP_NC_EXECUTED_MAX */
};

struct interp_nc_result {
	uint32_t lines;			/* lines in the text */
	uint32_t executed;		/* lines executed, subprograms
					 * unrolled */
};

/**
 * interp_nc_compile() - read @text into @b.  LF, CRLF and CR end a line.
 *
 * Return: 0, -EINVAL with all of @diag filled, or -ENOMEM.  @ret is filled only
 * with 0.
 */
int interp_nc_compile(const struct interp_text *text,
		      const struct interp_nc_options *o,
		      struct interp_build *b, struct interp_nc_result *ret,
		      struct interp_diag *diag);

#endif /* INTERP_NC_H */
