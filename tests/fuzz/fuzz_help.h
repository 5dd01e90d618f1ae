/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_help.h - what the fuzzed readers have in common
 */
#ifndef FUZZ_HELP_H
#define FUZZ_HELP_H

#include "interp/build.h"
#include "interp/tech_table.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What was written. */
struct fuzz_text {
	char *at;
	size_t n, room;
};

/* For a struct interp_sink; @arg is a struct fuzz_text. */
static inline int fuzz_put(void *arg, const char *text, size_t bytes)
{
	struct fuzz_text *t = arg;

	if (t->n + bytes > t->room) {
		t->room = 2 * (t->room + bytes);
		t->at = realloc(t->at, t->room);
		assert(t->at);
	}
	memcpy(t->at + t->n, text, bytes);
	t->n += bytes;
	return 0;
}

/* Refused in words, with a place inside the text, or with none: 0. */
static inline void fuzz_check_refusal(int rc, const struct interp_diag *d,
				      size_t size)
{
	assert(rc == -EINVAL);
	assert(d->line <= size + 1 && d->column <= size + 1);
	assert(d->found[0] && memchr(d->found, 0, sizeof(d->found)));
	assert(d->wanted[0] && memchr(d->wanted, 0, sizeof(d->wanted)));
}

/* The program that was built, sound; to be freed. */
static inline void *fuzz_lay_out(struct interp_build *b, uint32_t lines,
				 struct interp_program *p)
{
	const struct interp_build_about about = { .lines = lines };
	size_t bytes;
	void *block = interp_build_take(b, &about, &bytes);

	assert(block);
	assert(interp_program_map(p, block, bytes) == 0);
	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		assert(interp_program_seg_ok(p, i, &p->segs[i]));
		assert(p->segs[i].line <= lines);
	}
	return block;
}

/* All axes, with @travel_mm either way. */
static inline struct interp_machine fuzz_machine(double travel_mm)
{
	struct interp_machine m = { .present = (1 << INTERP_NAXES) - 1 };

	for (int i = 0; i < INTERP_NAXES; i++)
		m.axis[i] = (struct interp_axis_limits) {
			.pulse_mm = 0.001, .travel_min_mm = -travel_mm,
			.travel_max_mm = travel_mm, .v_max_mm_s = 50,
			.a_max_mm_s2 = 500, .j_max_mm_s3 = 5000,
		};
	return m;
}

/* A small table, for conditions, sequences and definitions. */
static inline const struct interp_tech_table *fuzz_tech(void)
{
	static const char text[] =
		"condition, servo_v, on_us, allowance_mm\n"
		"C001,20,8,0\nC120,15,40,0.1\nE001,15,-,-\n"
		"sequence Q1 = C120 C001\ninline E = - on_us servo_v\n";
	static struct interp_tech_table *t;
	struct interp_diag d;

	if (!t)
		assert(interp_tech_read(&t, text, sizeof(text) - 1, &d) == 0);
	return t;
}

#endif /* FUZZ_HELP_H */
