/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_tech.c - read any bytes with the readers of technology tables
 *
 * If a table is accepted, its values are within their ranges, and written and
 * read again it is the same.  If it is refused, the refusal has a place inside
 * the text, and words.  The first byte chooses the reader.
 */
#include "interp/tech_table.h"
#include "fuzz_help.h"

/* A table is refused at a place, always. */
static void check_refusal(int rc, const struct interp_diag *d, size_t size)
{
	fuzz_check_refusal(rc, d, size);
	assert(d->line >= 1 && d->column >= 1);
}

static void check_rows(const struct interp_tech_table *t)
{
	for (uint32_t i = 0; i < t->nrows; i++) {
		const struct interp_tech_row *r = &t->row[i];

		assert(interp_tech_ok(&r->tech));
		assert(!interp_tech_order(&r->tech));
		assert(interp_tech_row(t, r->letter, r->number) == r);
	}
	for (uint32_t i = 0; i < t->nsequences; i++) {
		const struct interp_tech_sequence *s = &t->sequence[i];

		assert(interp_tech_sequence(t, s->number) == s);
		for (uint32_t k = 0; k < s->nsteps; k++)
			assert(interp_tech_row(t, s->step[k].letter,
					       s->step[k].number));
	}
}

/* The first time numbers may come out rounded; from then on they stay. */
static void check_written(const struct interp_tech_table *t)
{
	struct fuzz_text a = { 0 }, b = { 0 };
	struct interp_tech_table *again = NULL;
	struct interp_diag d;

	assert(interp_tech_write(t, &(struct interp_sink){ fuzz_put, &a }) ==
	       0);
	assert(interp_tech_read(&again, a.at, a.n, &d) == 0);
	assert(again->nrows == t->nrows &&
	       again->nsequences == t->nsequences);
	assert(interp_tech_write(again,
				 &(struct interp_sink) { fuzz_put, &b }) == 0);
	assert(a.n == b.n && memcmp(a.at, b.at, a.n) == 0);
	interp_tech_table_destroy(again);
	free(a.at);
	free(b.at);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct interp_tech_table *t = NULL;
	struct interp_diag d = { .found = "" };
	char *text;
	int rc;

	if (size == 0)
		return 0;
	/* A copy of its own size: a byte too far is seen. */
	text = malloc(size - 1 ? size - 1 : 1);
	assert(text);
	memcpy(text, data + 1, size - 1);
	rc = (data[0] % 4 == 0 ? interp_tech_read_enc : interp_tech_read)(
		&t, text, size - 1, &d);
	if (rc) {
		check_refusal(rc, &d, size - 1);
	} else {
		check_rows(t);
		check_written(t);
		interp_tech_table_destroy(t);
	}
	free(text);
	return 0;
}
