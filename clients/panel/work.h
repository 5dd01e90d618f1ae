/* SPDX-License-Identifier: Apache-2.0 */
/*
 * work.h - what the panel has a process of its own do: edm-panel --work WHAT
 *
 *	check	standard input is a job's text; writes an answer and its path
 *	path	the path of the program that is loaded
 *	verify	standard input is a password's hash, a newline, the password
 *	tech	the technology table as JSON
 *
 * check and path write one line of JSON, filled up with blanks to a multiple of
 * 8 bytes with its newline; then, if it says "ok", `points` times: place in mm
 * (double), all of them; X Y Z less `origin` (float), all of them; line
 * (uint32); kind (uint8, enum flat_kind); and, if `upper`, in between the last
 * two: X Y of the upper guide (float).
 *
 * Exit: 0 done, 1 the answer is no, 70 no memory.
 */
#ifndef PANEL_WORK_H
#define PANEL_WORK_H

#include <stdint.h>

struct work {
	const char *what;
	const char *config;		/* the machine file */
	const char *machine;		/* its name */
	const char *name;		/* check: the name of the file, which
					 * tells its dialect */
	const char *start;		/* check: eight places, mm; NULL: those
					 * of the machine file */
	const char *setting;		/* check: interp/setting.h */
	uint64_t program;		/* path: the number of the program */
	double tolerance_mm;		/* 0: by the extent of the path */
};

/** work_run() - do it. Return: the exit code. */
int work_run(const struct work *w);

#endif /* PANEL_WORK_H */
