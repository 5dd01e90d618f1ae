/* SPDX-License-Identifier: Apache-2.0 */
/*
 * new_machine.h - the answers of edmctl new-machine
 *
 * Threads: one.
 */
#ifndef CTL_NEW_MACHINE_H
#define CTL_NEW_MACHINE_H

#include <stdbool.h>
#include <stdio.h>

#define WORD_MAX	160
#define AXES		"XYZABCUV"
#define NAXES		8

struct machine {
	char name[WORD_MAX], kind[WORD_MAX], backend[WORD_MAX];
	char axes[WORD_MAX], dialect[WORD_MAX], bus[WORD_MAX];
	double from[NAXES], to[NAXES], pulse_um[NAXES], v_max[NAXES];
	int step[NAXES], dir[NAXES];	/* gpio: lines; can402: step is the
					 * node */
	double increments[NAXES];	/* can402: of the drive, for a mm */
	char holds[NAXES][WORD_MAX];	/* can402: without power */
	/* What is behind the dialect: new_machine_more.c. */
	char home[NAXES][WORD_MAX], side[NAXES][WORD_MAX];
	double home_at[NAXES], home_by[NAXES];	/* place; 6098 */
	char home_line[NAXES][WORD_MAX], limit_line[NAXES][WORD_MAX];
	char gap[WORD_MAX], gap_at[3][WORD_MAX];
	char generator[WORD_MAX], reached[WORD_MAX], peak[WORD_MAX];
	char by_hand[WORD_MAX], chain[WORD_MAX];
	double heights[3];		/* of a wire: guides, top of the work */
	bool over;			/* no more answers */
};

/** new_answer() - @plain is the answer to an empty line.
 *  Return: false: the answers have ended. */
bool new_answer(bool *over, const char *question,
			const char *plain, char ret[WORD_MAX]);

/** new_choose() - one of the words, which are divided by blanks; the
 *  first one is offered. */
bool new_choose(bool *over, const char *question,
			const char *words, char ret[WORD_MAX]);

/* So many numbers, each within the range. */
struct wanted {
	int n;
	double from, to;
};

bool new_numbers(bool *over, const char *question,
			 const char *plain, const struct wanted *w,
			 double *const *ret);

/** new_is_word() - is it letters, digits and - _ . / : ! alone?  It is
 *  told if not. */
bool new_is_word(const char *name);

/** new_more() - how axes find their places, the gap, the generator,
 *  joints, the wire. */
bool new_more(struct machine *m);
/** new_put_axis() - what was answered of an axis, for its section. */
void new_put_axis(FILE *f, const struct machine *m, int i);
/** new_put_lines() - ... for [gpio]. */
void new_put_lines(FILE *f, const struct machine *m);
/** new_put_more() - the other sections. */
void new_put_more(FILE *f, const struct machine *m);

#endif /* CTL_NEW_MACHINE_H */
