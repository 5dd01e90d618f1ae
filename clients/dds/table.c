/* SPDX-License-Identifier: Apache-2.0 */
/* table.c - machines as lines of text or as JSON */
#include "table.h"

#include "process.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BAR	20
#define WORD	64			/* longest member of MachineState */

static const char *const generator_word[] = {
	"undefined", "ready", "active-low-voltage", "active-high-voltage",
	"error",
};

struct word {
	char c[WORD];
};

static struct word clean(const char *s)
{
	struct word w = { "" };

	for (size_t i = 0; i < WORD - 1 && s[i]; i++)
		w.c[i] = s[i] >= ' ' && s[i] <= '~' ? s[i] : '?';
	return w;
}

static struct word state_of(const struct hall_machine *r)
{
	return clean(r->gone ? "gone" : r->disputed ? "disputed" : r->m.state);
}

static void bar(char ret[BAR + 1], double progress)
{
	int full = progress >= 1 ? BAR :
		   progress > 0 ? (int)(progress * BAR) : 0;

	memset(ret, '#', (size_t)full);
	memset(ret + full, '.', (size_t)(BAR - full));
	ret[BAR] = '\0';
}

/* A hostile sample may have numbers that would destroy the columns. */
static double fit(double v, double most)
{
	if (isnan(v))
		return 0;
	return fmax(-most, fmin(most, v));
}

/* A bar while a program is loaded; otherwise how the last job ended. */
static void progress_of(const edm_MachineState *m, char *ret, size_t n)
{
	char done[BAR + 1];

	bar(done, m->progress);
	if (m->program)
		snprintf(ret, n, "[%s] %5.1f %%", done,
			 fit(m->progress, 1) * 100);
	else if (strcmp(m->outcome, "none") != 0)
		snprintf(ret, n, "last job: %s", clean(m->outcome).c);
	else
		snprintf(ret, n, "no job yet");
}

static void print_row(const struct hall_machine *r, FILE *f)
{
	const edm_MachineState *m = &r->m;
	struct word name = clean(m->machine), host = clean(m->host);
	struct word state = state_of(r);
	struct word needs = clean(r->disputed ? r->rival :
				  strcmp(m->fault, "none") == 0 && *m->stand ?
				  m->stand : m->fault);
	char done[96];

	progress_of(m, done, sizeof(done));
	fprintf(f, "%-14s %-14s %-8s %-30s %9.3f mm %6.1f V "
		"%6.2f mm/min %6u %6u  %s%s\n", name.c, host.c, state.c, done,
		fit(m->depth_mm, 9999), fit(m->gap_v, 999),
		fit(m->feed_mm_s * 60, 9999), m->jumps, m->retracts,
		r->disputed ? "told by two; also from " : "", needs.c);
}

void table_print(const struct hall_machine *row, size_t n, FILE *f)
{
	if (n == 0)
		return;
	fprintf(f, "%-14s %-14s %-8s %-30s %12s %8s %13s %6s %6s  %s\n",
		"MACHINE", "HOST", "STATE", "PROGRESS", "DEPTH", "GAP", "FEED",
		"JUMPS", "RETR.", "FAULT OR STAND");
	for (size_t i = 0; i < n; i++)
		print_row(&row[i], f);
}

static json_t *real(double v)
{
	return isfinite(v) ? json_real(v) : json_null();
}

static json_t *json_positions(const edm_MachineState *m)
{
	json_t *a = json_array();

	for (int i = 0; i < 8; i++)
		json_array_append_new(a, real(m->position_mm[i]));
	return a;
}

static const char *generator_of(const edm_MachineState *m)
{
	size_t i = (size_t)m->generator_state;

	return i < sizeof(generator_word) / sizeof(generator_word[0]) ?
	       generator_word[i] : generator_word[0];
}

static void json_words(json_t *o, const struct hall_machine *r)
{
	const edm_MachineState *m = &r->m;

	json_object_set_new(o, "machine", json_string(clean(m->machine).c));
	json_object_set_new(o, "host", json_string(clean(m->host).c));
	json_object_set_new(o, "state", json_string(state_of(r).c));
	json_object_set_new(o, "fault", json_string(clean(m->fault).c));
	json_object_set_new(o, "outcome", json_string(clean(m->outcome).c));
	json_object_set_new(o, "stand", json_string(clean(m->stand).c));
	json_object_set_new(o, "generator_fault",
			    json_string(clean(m->generator_fault).c));
	json_object_set_new(o, "generator_state",
			    json_string(generator_of(m)));
	json_object_set_new(o, "rival", json_string(
			    r->disputed ? clean(r->rival).c : ""));
	json_object_set_new(o, "is_on", json_boolean(m->is_on));
}

static void json_counts(json_t *o, const edm_MachineState *m)
{
	const struct {
		const char *name;
		json_int_t n;
	} count[] = {
		{ "utime", m->utime }, { "cycle", (json_int_t)m->cycle },
		{ "program", m->program }, { "line", m->line },
		{ "jumps", m->jumps }, { "retracts", m->retracts },
		{ "shorts", m->shorts }, { "overruns", m->overruns },
		{ "known", m->known },
	};

	for (size_t i = 0; i < sizeof(count) / sizeof(count[0]); i++)
		json_object_set_new(o, count[i].name,
				    json_integer(count[i].n));
}

#define TOLD_ROW(name, id)	{ "told_" #name, m->told_##name },

static void json_numbers(json_t *o, const edm_MachineState *m)
{
	const struct {
		const char *name;
		double v;
	} number[] = {
		{ "progress", m->progress }, { "place_mm", m->place_mm },
		{ "length_mm", m->length_mm }, { "depth_mm", m->depth_mm },
		{ "depth_far_mm", m->depth_far_mm },
		{ "feed_mm_s", m->feed_mm_s }, { "gap_v", m->gap_v },
		{ "wake_late_max_us", m->wake_late_max_us },
		PROCESS_TELLS(TOLD_ROW)
	};

	for (size_t i = 0; i < sizeof(number) / sizeof(number[0]); i++)
		json_object_set_new(o, number[i].name, real(number[i].v));
}

static json_t *json_row(const struct hall_machine *r)
{
	json_t *o = json_object();

	json_words(o, r);
	json_counts(o, &r->m);
	json_numbers(o, &r->m);
	json_object_set_new(o, "position_mm", json_positions(&r->m));
	json_object_set_new(o, "heard_utime",
			    json_integer(r->heard_ns / 1000));
	return o;
}

void table_print_json(const struct hall_machine *row, size_t n, FILE *f)
{
	json_t *all = json_array();
	json_t *o = json_object();

	for (size_t i = 0; i < n; i++)
		json_array_append_new(all, json_row(&row[i]));
	json_object_set_new(o, "machines", all);
	json_dumpf(o, f, JSON_COMPACT);
	fputc('\n', f);
	json_decref(o);
}
