/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_number.c - decimal numbers of NC code, beside those of the C library
 *
 * Random numbers of up to 15 digits, alone in memory or with more behind them;
 * the seed is printed.
 */
#include "walk_help.h"

#include "code/number.h"
#include "seed.h"

#define RUNS	SEED_ROUNDS(400000)

static uint64_t seed;

struct text {
	char at[64];
	size_t n;
	size_t number;			/* so many of them are the number */
};

static void put(struct text *t, char c)
{
	t->at[t->n++] = c;
}

static void put_digits(struct text *t, uint64_t *s, uint64_t n)
{
	while (n-- > 0)
		put(t, (char)('0' + rnd(s) % 10));
}

/* Behind a number stands anything that does not go on with it. */
static void put_rest(struct text *t, uint64_t *s, bool pointed)
{
	static const char behind[] = " Y\n\r\t;(X-+/:%\377\200\001,e";

	for (uint64_t n = rnd(s) % 12; n > 0; n--)
		put(t, behind[rnd(s) % (sizeof(behind) - 1)]);
	if (pointed && rnd(s) % 8 == 0)
		t->at[t->number] = '.';
}

/* At least one digit, at most 15; often with zeros in front. */
static struct text random_number(uint64_t *s)
{
	const uint64_t most = rnd(s) % 2 ? 15 : 7, digits = 1 + rnd(s) % most;
	const uint64_t whole = rnd(s) % (digits + 1);
	const bool pointed = whole < digits || rnd(s) % 4 == 0;
	struct text t = { .n = 0 };

	if (rnd(s) % 2)
		put(&t, rnd(s) % 2 ? '-' : '+');
	put_digits(&t, s, whole);
	if (pointed)
		put(&t, '.');
	put_digits(&t, s, digits - whole);
	t.number = t.n;
	put_rest(&t, s, pointed);
	return t;
}

/* In memory of its own, so that reading beyond it is seen. */
static const char *read_number(const struct text *t, double *ret)
{
	uint8_t *at = malloc(t->n);
	const uint8_t *behind;
	const char *end = NULL;

	assert_non_null(at);
	memcpy(at, t->at, t->n);
	behind = nc_number(at, at + t->n, ret);
	if (behind)
		end = t->at + (behind - at);
	free(at);
	return end;
}

static void a_number_of_15_digits_is_the_nearest_double(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < RUNS; i++) {
		const struct text t = random_number(&s);
		char alone[64];
		double v = NAN, is;

		snprintf(alone, sizeof(alone), "%.*s", (int)t.number, t.at);
		is = strtod(alone, NULL);
		if (read_number(&t, &v) != t.at + t.number ||
		    memcmp(&v, &is, sizeof(v)) != 0)
			fail_msg("%s is read as %.17g", alone, v);
	}
}

static void without_a_digit_it_is_no_number(void **st)
{
	static const char *const texts[] = {
		"", " ", ".", "-", "+.", "X1", "- .", "..1", ".X1234567",
		"-X1234567", "..123456789"
	};
	double v;

	(void)st;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		struct text t = { .n = strlen(texts[i]) };

		memcpy(t.at, texts[i], t.n);
		assert_null(read_number(&t, &v));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_number_of_15_digits_is_the_nearest_double),
		cmocka_unit_test(without_a_digit_it_is_no_number),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
