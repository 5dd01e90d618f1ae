/* SPDX-License-Identifier: Apache-2.0 */
/*
 * emit.h - a compiled program back into text
 *
 * Text leaves line by line through a sink; nothing is kept.
 *
 * Threads: any thread; nothing allocates.  Never in the cycle.
 */
#ifndef INTERP_EMIT_H
#define INTERP_EMIT_H

#include "interp/diag.h"

struct interp_program;

/* Where text goes.  @put gets whole lines, each with its LF.  If it returns
 * anything but 0, the writing ends and that number is returned. */
struct interp_sink {
	int (*put)(void *arg, const char *text, size_t bytes);
	void *arg;
};

/**
 * interp_iso_write() - as NC code of dialect `generic`, one line a segment.
 *
 * G90 places with six decimals of a millimetre or degree, centres as I J K
 * from the start, F where it changes.
 *
 * Return: 0; -EINVAL with @diag filled if the dialect has no word for a part of
 * the program; or what the sink returned.
 */
int interp_iso_write(const struct interp_program *p,
		     const struct interp_sink *to, struct interp_diag *diag);

#endif /* INTERP_EMIT_H */
