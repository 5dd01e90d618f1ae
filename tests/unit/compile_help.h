/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compile_help.h - compile a text of any dialect in a test, and write it back
 *
 * The machine has all axes, with pulses of 0.001 mm or degree, and a travel of
 * 200.  X has 400 to the left, for the published drawing.
 */
#ifndef COMPILE_HELP_H
#define COMPILE_HELP_H

#include "nc_read.h"

#include "interp/compile.h"

struct compiled {
	struct interp_machine machine;
	struct interp_build_options bo;
	struct interp_compile_options o;
	const struct interp_dialect *dialect;
	uint32_t lines;
	struct interp_diag diag;
	struct interp_program p;
	void *block;
	int rc;
};

/* Ready to be altered by the test. */
static inline struct compiled compile_ready(const char *dialect)
{
	const struct nc_read n = nc_ready();
	struct compiled c = { .machine = n.machine };

	c.dialect = interp_dialect_by_name(dialect);
	assert_non_null(c.dialect);
	c.machine.axis[INTERP_X].travel_min_mm = -400;
	return c;
}

static inline void compile_bytes(struct compiled *c, const char *text,
				 size_t bytes)
{
	const struct interp_text t = { text, bytes, c->dialect };
	struct interp_build_about about = { 0 };
	struct interp_build *b;
	size_t size;

	c->o.nc.machine = &c->machine;
	c->bo.machine = &c->machine;
	b = interp_build_create(&c->bo);
	assert_non_null(b);
	c->rc = interp_compile(&t, &c->o, b, &c->lines, &c->diag);
	if (!c->rc) {
		about.lines = c->lines;
		c->block = interp_build_take(b, &about, &size);
		assert_non_null(c->block);
		assert_int_equal(interp_program_map(&c->p, c->block, size), 0);
	}
	interp_build_destroy(b);
}

/* The text must be taken. */
static inline void compile(struct compiled *c, const char *text)
{
	compile_bytes(c, text, strlen(text));
	if (c->rc)
		fail_msg("%s\n%u:%u: %s; %s", text, c->diag.line,
			 c->diag.column, c->diag.found, c->diag.wanted);
}

static inline void compile_done(struct compiled *c)
{
	free(c->block);
	c->block = NULL;
}

/* Segments between INTERP_BEGIN and INTERP_END. */
static inline uint32_t compiled_count(const struct compiled *c)
{
	return c->p.head->nsegs - 2;
}

static inline const struct interp_seg *compiled_seg(const struct compiled *c,
						    uint32_t i)
{
	assert_in_range(i, 0, compiled_count(c) - 1);
	return &c->p.segs[i + 1];
}

static inline const struct interp_arc *compiled_arc(const struct compiled *c,
						    uint32_t i)
{
	assert_int_equal(compiled_seg(c, i)->kind, INTERP_ARC);
	return &c->p.arcs[compiled_seg(c, i)->arg];
}

static inline int64_t compiled_end_sub(const struct compiled *c, uint32_t i,
				       enum interp_axis axis)
{
	const struct interp_program_head *h = c->p.head;

	for (uint32_t j = 0; j < h->naxes; j++) {
		if (h->column[j] == axis)
			return c->p.nodes[(size_t)(i + 2) * h->naxes + j];
	}
	return (int64_t)h->start_pulses[axis] * INTERP_SUB;
}

static inline int32_t compiled_pulse(const struct compiled *c, uint32_t i,
				     enum interp_axis axis)
{
	return interp_round_sub(compiled_end_sub(c, i, axis));
}

static inline double compiled_end(const struct compiled *c, uint32_t i,
				  enum interp_axis axis)
{
	return (double)compiled_end_sub(c, i, axis) / INTERP_SUB *
	       c->p.head->pulse_mm[axis];
}

static inline void assert_same_end(const struct compiled *a, uint32_t i,
				   const struct compiled *b, uint32_t k,
				   int off_pulses)
{
	for (int axis = 0; axis < INTERP_NAXES; axis++) {
		const enum interp_axis x = (enum interp_axis)axis;

		assert_true(abs(compiled_pulse(a, i, x) -
				compiled_pulse(b, k, x)) <= off_pulses);
	}
}

#define assert_refused(c, at_line, at_column, what)			\
	do {								\
		assert_int_equal((c)->rc, -EINVAL);			\
		assert_int_equal((c)->diag.line, at_line);		\
		assert_int_equal((c)->diag.column, at_column);		\
		assert_non_null(strstr((c)->diag.found, what));		\
		assert_true((c)->diag.wanted[0]);			\
	} while (0)

/* Text written back. */
struct emitted {
	char *text;
	size_t n, room;
	struct interp_threeb_left left;
	struct interp_diag diag;
	int rc;
};

static inline int emit_put(void *arg, const char *text, size_t bytes)
{
	struct emitted *e = arg;

	if (e->n + bytes + 1 > e->room) {
		e->room = 2 * (e->room + bytes + 1);
		e->text = realloc(e->text, e->room);
		assert_non_null(e->text);
	}
	memcpy(e->text + e->n, text, bytes);
	e->n += bytes;
	e->text[e->n] = '\0';
	return 0;
}

static inline void emit_threeb(struct emitted *e, const struct compiled *c)
{
	const struct interp_sink to = { emit_put, e };

	e->rc = interp_threeb_write(&c->p, &c->o.threeb, &to, &e->left,
				    &e->diag);
}

static inline void emit_iso(struct emitted *e, const struct compiled *c)
{
	const struct interp_sink to = { emit_put, e };

	e->rc = interp_iso_write(&c->p, &to, &e->diag);
}

static inline void emit_done(struct emitted *e)
{
	free(e->text);
	*e = (struct emitted) { 0 };
}

#endif /* COMPILE_HELP_H */
