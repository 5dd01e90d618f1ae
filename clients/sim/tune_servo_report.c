/* SPDX-License-Identifier: Apache-2.0 */
/* tune_servo_report.c - the result of tuning: lines to paste, or JSON */
#include "keys.h"
#include "tune_servo.h"

#include <jansson.h>
#include <sysexits.h>

static void print_sum(const char *what, const struct trial_sum *s, FILE *f)
{
	fprintf(f, "; %-14s %8.4g %9.3g %9.3g %9.3g %9.3g %9.3g %3u of %u\n",
		what, s->removal_mm3_min, s->shorts_min, s->retracts_min,
		s->arcs_min, s->burns_min, s->wear_mm_mm3, s->faults, s->runs);
}

static void print_sums(const struct tune *t, FILE *f)
{
	fprintf(f, "; %-14s %8s %9s %9s %9s %9s %9s %s\n", "", "mm3/min",
		"shorts", "retracts", "arcs", "burns", "wear", "faults");
	print_sum("before", &t->before, f);
	print_sum("after", &t->after, f);
	if (!t->tested)
		return;
	print_sum("test, before", &t->test_before, f);
	print_sum("test, after", &t->test_after, f);
}

static void print_keys(const struct tune *t, FILE *f)
{
	int section = -1;

	for (uint32_t i = 0; i < t->nkeys; i++) {
		const struct config_key *k = config_key(t->key[i].row);
		char now[32], was[32];

		if ((int)k->section != section)
			fprintf(f, "\n[%s]\n", config_section[k->section].name);
		section = (int)k->section;
		fprintf(f, "%-16s = %-8s ; was %s\n", k->name,
			config_number(tune_value(&t->key[i], &t->now), now,
				      sizeof(now)),
			config_number(tune_value(&t->key[i], t->was), was,
				      sizeof(was)));
	}
}

void tune_print(const struct tune *t, FILE *f)
{
	fprintf(f,
		"; edmsim --tune: %u trials of %u runs, %g s each, from seed "
		"%llu%s\n; score %+.3f; shorts to burns are counts a minute, "
		"wear is mm/mm3\n",
		t->used, t->train.seeds, t->train.limit_s,
		(unsigned long long)t->train.seed,
		t->interrupted ? "; interrupted" : "", t->score);
	print_sums(t, f);
	if (t->tested)
		fprintf(f,
			"; score on the seeds of the test, %llu on: %+.3f%s\n",
			(unsigned long long)t->test.seed, t->test_score,
			t->test_score > 0 ? "" : ": no better than before");
	if (t->better)
		print_keys(t, f);
	else
		fprintf(f,
			"; nothing better than the machine file was found\n");
}

static json_t *sum_json(const struct trial_sum *s)
{
	return json_pack("{s:f,s:f,s:f,s:f,s:f,s:f,s:i,s:i}",
			 "removal_mm3_min", s->removal_mm3_min,
			 "shorts_min", s->shorts_min,
			 "retracts_min", s->retracts_min,
			 "arcs_min", s->arcs_min, "burns_min", s->burns_min,
			 "wear_mm_mm3", s->wear_mm_mm3,
			 "faults", (int)s->faults, "runs", (int)s->runs);
}

static json_t *keys_json(const struct tune *t)
{
	json_t *rows = json_array();

	for (uint32_t i = 0; i < t->nkeys; i++) {
		const struct config_key *k = config_key(t->key[i].row);

		json_array_append_new(rows, json_pack(
			"{s:s,s:s,s:f,s:f}",
			"section", config_section[k->section].name,
			"key", k->name, "was", tune_value(&t->key[i], t->was),
			"now", tune_value(&t->key[i], &t->now)));
	}
	return rows;
}

static json_t *seeds_json(const struct trial *of, double score,
			  const struct trial_sum *before,
			  const struct trial_sum *after)
{
	return json_pack("{s:I,s:f,s:o,s:o}", "seed", (json_int_t)of->seed,
			 "score", score, "before", sum_json(before),
			 "after", sum_json(after));
}

int tune_write(const struct tune *t, FILE *f)
{
	json_t *o = json_pack("{s:i,s:f,s:b,s:b,s:o,s:o}",
			      "trials", (int)t->used,
			      "limit_s", t->train.limit_s,
			      "interrupted", t->interrupted,
			      "better", t->better, "keys", keys_json(t),
			      "train", seeds_json(&t->train, t->score,
						  &t->before, &t->after));
	bool bad;

	if (t->tested)
		json_object_set_new(o, "test", seeds_json(
			&t->test, t->test_score, &t->test_before,
			&t->test_after));
	bad = json_dumpf(o, f, JSON_INDENT(2)) < 0 || fputc('\n', f) < 0 ||
	      fflush(f) != 0;
	json_decref(o);
	return bad ? EX_IOERR : 0;
}
