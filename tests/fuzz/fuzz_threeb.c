/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_threeb.c - read any bytes with the readers of records and of wire
 * dialects, and write records of what they accept
 *
 * If a text is accepted, it must be a sound program.  Its records must be
 * accepted again, and end at the same pulse.  If it is refused, the refusal
 * must have a place inside the text, and words.  The first byte chooses the
 * dialect.
 */
#include "interp/compile.h"
#include "fuzz_help.h"

/*
 * Compile @text; NULL if it was refused, which @must_take forbids.  What was
 * written may have more records than its source: an arc that none says is cut.
 */
static void *compile(const struct interp_text *text,
		     const struct interp_machine *m, bool must_take,
		     struct interp_program *p)
{
	const struct interp_build_options bo = { .machine = m };
	/* Set at the machine, but for what was written from a program. */
	const struct interp_setting set = {
		.wire_mm = text->bytes % 2 ? 0.1 : 0,
		.scale = text->bytes % 5 ? 0 : 1.005,
		.turn_deg = text->bytes % 7 ? 0 : 30,
		.mirror = (int)(text->bytes / 2 % INTERP_NMIRRORS),
	};
	const struct interp_compile_options o = {
		.nc = { .machine = m,
			.tech = text->bytes % 3 ? fuzz_tech() : NULL,
			.segs_max = must_take ? UINT32_MAX : 1000,
			.executed_max = must_take ? UINT32_MAX : 10000,
			.feed_mm_s = 1 },
		.threeb = { .offset_um = 100,
			    .set = must_take ?
				   (struct interp_setting) { 0 } : set },
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
		fuzz_check_refusal(rc, &diag, text->bytes);
	else
		block = fuzz_lay_out(b, lines, p);
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
	struct fuzz_text t = { 0 };
	const struct interp_sink to = { fuzz_put, &t };
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
	const struct interp_machine m = fuzz_machine(500);
	struct interp_program p;
	struct interp_text text;
	void *block;

	if (size == 0)
		return 0;
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
