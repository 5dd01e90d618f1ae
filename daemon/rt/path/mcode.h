/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mcode.h - M codes that the PLC carries out
 *
 * The PLC is told one code at a time.  It answers with the same number when the
 * code is done; then edmd takes the number away, and then the PLC its answer.
 * Only after that comes the next code.  A program that has to wait stands in
 * front of the code, without sparks.  interp/mcode_arg.h says when each code is
 * told and what waits for it.
 *
 * On the way back every code is passed.  On the way forward again, a "skip"
 * code is passed too, and a "redo" code is told again, unless a jump led over
 * it.  The way back ends at a "stop" code that was done.
 *
 * Without a PLC all codes are passed.
 *
 * Threads: RT-safe.
 */
#ifndef RT_MCODE_H
#define RT_MCODE_H

#include <stdbool.h>
#include <stdint.h>

struct cycle;

/* Private to mcode.c, but for `number`. */
struct mcode {
	uint8_t number;			/* told to the PLC; 0: none */
	bool done;			/* that of segment `at` was answered */
	bool busy;			/* the PLC's last answer is still
					 * there */
	uint32_t at;			/* segment in front of which it waits */
	uint32_t back_to;		/* lowest segment walked back to, or
					 * that of the last code */
	bool waits;			/* in this period, for an answer */
	uint64_t waited;		/* cycles */
};

/** mcode_begin() - a program is loaded, the cursor stands on segment @index. */
void mcode_begin(struct cycle *c, uint32_t index);

/** mcode_hear() - once a period, before the walk: what the PLC has done. */
void mcode_hear(struct cycle *c);

/** mcode_follow() - once a period, after the walk. */
void mcode_follow(struct cycle *c);

/** mcode_again() - is the one of segment @i told again on the way forward? */
bool mcode_again(const struct cycle *c, uint32_t i, uint32_t arg);

/** mcode_over() - that of segment @i is done: what the way back makes of it. */
void mcode_over(struct cycle *c, uint32_t i);

/** mcode_meet() - the walk is in front of segment @next, the M code of @arg.
 *  Return: true to pass it, false to wait. */
bool mcode_meet(struct cycle *c, uint32_t next, uint32_t arg);

/** mcode_line() - of the program: that of the code it waits for, else that
 *  where it is. */
uint32_t mcode_line(const struct cycle *c);

#endif /* RT_MCODE_H */
