/* SPDX-License-Identifier: Apache-2.0 */
/*
 * threeb.h - 3B and 4B, the wire code of records: read and write
 *
 *	B X B Y B J G Z		3B, one line or arc in XY
 *	B X B Y B J B R D G Z	4B: R and D or DD, the machine offsets the wire
 *
 * X Y are lengths without a sign: of a line its ratio, of an arc the way from
 * its centre to its start.  J is what the path moves along the axis G counts;
 * it alone fixes the end.  Z names line or arc, sense and quadrant.
 * docs/3b.md has the rules, what is ambiguous and what was decided.
 *
 * Units: lengths of records in units of unit_um, whole numbers.
 * Threads: the reader allocates through the builder; any thread.  Never in
 * the cycle.
 */
#ifndef INTERP_THREEB_H
#define INTERP_THREEB_H

#include "interp/build.h"
#include "interp/emit.h"
#include "interp/job_text.h"
#include "interp/setting.h"

#define INTERP_THREEB_MAX	999999999	/* units in a field */

/* Words that end a program, or pause in it. */
enum interp_threeb_end {
	INTERP_THREEB_DD	= 0x01,
	INTERP_THREEB_D		= 0x02,
	INTERP_THREEB_E		= 0x04,
	INTERP_THREEB_MJ	= 0x08,
	INTERP_THREEB_ENDS	= 0x0f,
};

/* Zeros are the defaults. */
struct interp_threeb_options {
	double unit_um;			/* 0: 1 um; such as 0.1 or 10 */
	uint32_t ends;			/* mask of those known; 0: all */
	bool d_ends;			/* D ends; else it is a pause, the safe
					 * choice: nothing is left uncut */
	bool fourb;			/* 4B records; experimental */
	double offset_um;		/* 4B: wire radius and gap, >= 0 */
	struct interp_setting set;
};

/* What a reader of records needs beside. */
struct interp_threeb_read {
	const struct interp_machine *machine;
	const struct interp_wire *wire;	/* NULL: no guides, no corners */
	const struct interp_threeb_options *options;
	double feed_mm_s;		/* of every record, for there is no F;
					 * 0: the fastest X and Y both go */
	uint32_t segs_max;		/* 0: 50 million */
};

struct interp_threeb_result {
	uint32_t lines;			/* in the text */
	uint32_t records;
};

/**
 * interp_threeb_compile() - read @text into @b; @o says which of the two
 * dialects it is.
 *
 * Starts where @b stands.  Return: 0, -EINVAL with @diag filled, -ENOMEM.
 */
int interp_threeb_compile(const struct interp_text *text,
			  const struct interp_threeb_read *o,
			  struct interp_build *b,
			  struct interp_threeb_result *ret,
			  struct interp_diag *diag);

/* What a program does that records have no word for, and was left out. */
struct interp_threeb_left {
	uint32_t rapids;		/* written as lines that cut */
	uint32_t outputs;		/* power, pump */
	uint32_t waits;			/* dwells, optional stops */
	uint32_t conditions;		/* calls of a condition */
};

/**
 * interp_threeb_write() - a program of lines and arcs in XY as 3B records.
 *
 * Points are rounded to whole units.  Each record starts where a reader of
 * the one before it ends, so no rounding adds up.
 *
 * Return: 0; -EINVAL with @diag filled (the line is the source's) for what
 * records cannot say: other axes, helices; what the sink said.
 */
int interp_threeb_write(const struct interp_program *p,
			const struct interp_threeb_options *o,
			const struct interp_sink *to,
			struct interp_threeb_left *left,
			struct interp_diag *diag);

#endif /* INTERP_THREEB_H */
