/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nc_read.h - read NC text in a test, and look at the result
 *
 * The machine has all axes, with pulses of 0.001 mm or degree, and a travel of
 * 200.
 */
#ifndef NC_READ_H
#define NC_READ_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "interp/nc.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct nc_read {
	struct interp_machine machine;
	struct interp_nc_options o;
	const struct interp_dialect *dialect;	/* NULL: generic */
	struct interp_nc_result result;
	struct interp_diag diag;
	struct interp_build *build;
	struct interp_program p;
	void *block;
	int rc;
};

/* Ready to be altered by the test before nc_read(). */
static inline struct nc_read nc_ready(void)
{
	struct nc_read n = { .machine.present = (1 << INTERP_NAXES) - 1 };

	for (int i = 0; i < INTERP_NAXES; i++)
		n.machine.axis[i] = (struct interp_axis_limits) {
			.pulse_mm = 0.001,
			.travel_min_mm = -200, .travel_max_mm = 200,
			.v_max_mm_s = 1000, .a_max_mm_s2 = 500,
			.j_max_mm_s3 = 5000,
		};
	return n;
}

static inline void nc_read_bytes(struct nc_read *n, const char *text,
				 size_t bytes)
{
	const struct interp_build_options bo = { .machine = &n->machine };
	struct interp_build_about about = { 0 };
	char *exact = malloc(bytes + !bytes);
	size_t size;

	/* Nothing may be read behind the text: the sanitizer sees that. */
	assert_non_null(exact);
	memcpy(exact, text, bytes);
	n->o.machine = &n->machine;
	n->build = interp_build_create(&bo);
	assert_non_null(n->build);
	n->rc = interp_nc_compile(&(struct interp_text) {
		.at = exact, .bytes = bytes, .dialect = n->dialect },
		&n->o, n->build, &n->result, &n->diag);
	free(exact);
	if (n->rc)
		return;
	about.lines = n->result.lines;
	n->block = interp_build_take(n->build, &about, &size);
	assert_non_null(n->block);
	assert_int_equal(interp_program_map(&n->p, n->block, size), 0);
}

/* The text must be taken. */
static inline void nc_read(struct nc_read *n, const char *text)
{
	nc_read_bytes(n, text, strlen(text));
	if (n->rc)
		fail_msg("%s\n%u:%u: %s; %s", text, n->diag.line,
			 n->diag.column, n->diag.found, n->diag.wanted);
}

static inline struct nc_read nc_read_text(const char *text)
{
	struct nc_read n = nc_ready();

	nc_read(&n, text);
	/* The machine was on this function's stack: nobody builds on. */
	interp_build_destroy(n.build);
	n.build = NULL;
	return n;
}

static inline void nc_done(struct nc_read *n)
{
	interp_build_destroy(n->build);
	free(n->block);
	n->build = NULL;
	n->block = NULL;
}

/* Segments between INTERP_BEGIN and INTERP_END. */
/* A text that is refused there, with these words in what is said. */
struct nc_refusal {
	const char *text;
	uint32_t line, column;
	const char *found, *wanted;
};

static inline void nc_check_refusal(const struct nc_refusal *r)
{
	struct nc_read n = nc_ready();

	nc_read_bytes(&n, r->text, strlen(r->text));
	if (n.rc != -EINVAL || n.diag.line != r->line ||
	    n.diag.column != r->column || !strstr(n.diag.found, r->found) ||
	    !strstr(n.diag.wanted, r->wanted))
		fail_msg("%s\n%d, %u:%u: %s; %s", r->text, n.rc, n.diag.line,
			 n.diag.column, n.diag.found, n.diag.wanted);
	nc_done(&n);
}

static inline uint32_t nc_count(const struct nc_read *n)
{
	return n->p.head->nsegs - 2;
}

/* The i-th of them, from 0. */
static inline const struct interp_seg *nc_seg(const struct nc_read *n,
					      uint32_t i)
{
	assert_in_range(i, 0, nc_count(n) - 1);
	return &n->p.segs[i + 1];
}

/* Where it ends, in subpulses; an axis without a column stands at 0. */
static inline int64_t nc_end_sub(const struct nc_read *n, uint32_t i,
				 enum interp_axis axis)
{
	const struct interp_program_head *h = n->p.head;

	for (uint32_t j = 0; j < h->naxes; j++) {
		if (h->column[j] == axis)
			return n->p.nodes[(size_t)(i + 2) * h->naxes + j];
	}
	return 0;
}

static inline double nc_end(const struct nc_read *n, uint32_t i,
			    enum interp_axis axis)
{
	return (double)nc_end_sub(n, i, axis) / INTERP_SUB *
	       n->p.head->pulse_mm[axis];
}

#define assert_near(a, b)	assert_true(fabs((a) - (b)) < 1e-7)
#define assert_xyz(n, i, x, y, z)				\
	do {							\
		assert_near(nc_end(n, i, INTERP_X), x);		\
		assert_near(nc_end(n, i, INTERP_Y), y);		\
		assert_near(nc_end(n, i, INTERP_Z), z);		\
	} while (0)

/* The arc of the i-th segment. */
static inline const struct interp_arc *nc_arc_of(const struct nc_read *n,
						 uint32_t i)
{
	assert_int_equal(nc_seg(n, i)->kind, INTERP_ARC);
	return &n->p.arcs[nc_seg(n, i)->arg];
}

/* The same path: kinds, arguments, lines aside. */
static inline void assert_same_path(const struct nc_read *a,
				    const struct nc_read *b, int64_t off_sub)
{
	assert_int_equal(nc_count(a), nc_count(b));
	for (uint32_t i = 0; i < nc_count(a); i++) {
		assert_int_equal(nc_seg(a, i)->kind, nc_seg(b, i)->kind);
		assert_int_equal(nc_seg(a, i)->flags, nc_seg(b, i)->flags);
		for (int x = 0; x < INTERP_NAXES; x++) {
			const enum interp_axis axis = (enum interp_axis)x;

			assert_true(llabs(nc_end_sub(a, i, axis) -
					  nc_end_sub(b, i, axis)) <= off_sub);
		}
		if (nc_seg(a, i)->kind == INTERP_ARC)
			assert_near(nc_arc_of(a, i)->sweep,
				    nc_arc_of(b, i)->sweep);
	}
}

/* A small generator, the same everywhere. */
static inline uint32_t nc_random(uint64_t *seed)
{
	*seed = *seed * UINT64_C(6364136223846793005) +
		UINT64_C(1442695040888963407);
	return (uint32_t)(*seed >> 33);
}

#endif /* NC_READ_H */
