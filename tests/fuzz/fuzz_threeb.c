/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_threeb.c - any bytes at all through the readers of records and of wire
 * dialects, and what they take back out as records
 *
 * What is taken must be a sound program; its records must be taken again, and
 * end at the same pulse; what is refused must be refused with a place inside
 * the text and in words.  The first byte picks the dialect.
 */
#include "interp/compile.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const struct interp_axis_limits limits = {
	.pulse_mm = 0.001, .travel_min_mm = -500, .travel_max_mm = 500,
	.v_max_mm_s = 50, .a_max_mm_s2 = 500, .j_max_mm_s3 = 5000,
};

struct text {
	char *at;
	size_t n, room;
};

static int put(void *arg, const char *text, size_t bytes)
{
	struct text *t = arg;

	if (t->n + bytes > t->room) {
		t->room = 2 * (t->room + bytes);
		t->at = realloc(t->at, t->room);
		assert(t->at);
	}
	memcpy(t->at + t->n, text, bytes);
	t->n += bytes;
	return 0;
}

static void check_refusal(int rc, const struct interp_diag *d, size_t size)
{
	assert(rc == -EINVAL);
	assert(d->line <= size + 1 && d->column <= size + 1);
	assert(d->found[0] && memchr(d->found, 0, sizeof(d->found)));
	assert(d->wanted[0] && memchr(d->wanted, 0, sizeof(d->wanted)));
}

static void *lay_out(struct interp_build *b, uint32_t lines,
		     struct interp_program *p)
{
	const struct interp_build_about about = { .lines = lines };
	const size_t bytes = interp_build_bytes(b);
	void *block = malloc(bytes);

	assert(block);
	interp_build_write(b, &about, block);
	assert(interp_program_map(p, block, bytes) == 0);
	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		assert(interp_program_seg_ok(p, i, &p->segs[i]));
		assert(p->segs[i].line <= lines);
	}
	return block;
}

/* A small table, for conditions, sequences and definitions. */
static const struct interp_tech_table *tech(void)
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

/*
 * Compile @text; NULL if it was refused, which @must_take forbids.  What was
 * written may have more records than its source: an arc that none says is cut.
 */
static void *compile(const struct interp_text *text,
		     const struct interp_machine *m, bool must_take,
		     struct interp_program *p)
{
	const struct interp_build_options bo = { .machine = m };
	const struct interp_compile_options o = {
		.nc = { .machine = m, .tech = text->bytes % 3 ? tech() : NULL,
			.segs_max = must_take ? UINT32_MAX : 1000,
			.executed_max = must_take ? UINT32_MAX : 10000,
			.feed_mm_s = 1 },
		.threeb.offset_um = 100,
	};
	struct interp_build *b = interp_build_create(&bo);
	struct interp_diag diag = { .found = "" };
	void *block = NULL;
	uint32_t lines = 0;
	int rc;

	assert(b);
	rc = interp_compile(text, &o, b, &lines, &diag);
	assert(rc == 0 || !must_take);
	if (rc)
		check_refusal(rc, &diag, text->bytes);
	else
		block = lay_out(b, lines, p);
	interp_build_destroy(b);
	return block;
}

/* Where the axis stands at the end. */
static int64_t end_of(const struct interp_program *p, uint32_t axis)
{
	const struct interp_program_head *h = p->head;

	for (uint32_t j = 0; j < h->naxes; j++) {
		if (h->column[j] == axis)
			return p->nodes[(size_t)h->nsegs * h->naxes + j];
	}
	return 0;
}

static void check_written(const struct interp_program *p,
			  const struct interp_machine *m)
{
	const struct interp_threeb_options o = { 0 };
	struct text t = { 0 };
	const struct interp_sink to = { put, &t };
	struct interp_threeb_left left;
	struct interp_diag diag = { .found = "" };
	struct interp_program again;
	struct interp_text text;
	void *block;

	if (interp_threeb_write(p, &o, &to, &left, &diag) == 0 && t.n > 8) {
		text = (struct interp_text) {
			t.at, t.n, interp_dialect_by_name("3b")
		};
		block = compile(&text, m, true, &again);
		for (uint32_t a = INTERP_X; a <= INTERP_Y; a++)
			assert(llabs(end_of(p, a) - end_of(&again, a)) <=
			       2 * INTERP_SUB);
		free(block);
	}
	free(t.at);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const names[] = {
		"3b", "3b", "3b", "4b", "robofil", "skd2", "sodick", "chmer",
	};
	struct interp_machine m = { .present = (1 << INTERP_NAXES) - 1 };
	struct interp_program p;
	struct interp_text text;
	void *block;

	if (size == 0)
		return 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		m.axis[i] = limits;
	text = (struct interp_text) {
		(const char *)data + 1, size - 1,
		interp_dialect_by_name(names[data[0] % 8]),
	};
	block = compile(&text, &m, false, &p);
	if (block)
		check_written(&p, &m);
	free(block);
	return 0;
}
