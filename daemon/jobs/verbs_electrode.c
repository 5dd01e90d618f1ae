/* SPDX-License-Identifier: Apache-2.0 */
/* verbs_electrode.c - the operator's table of electrodes */
#include "electrode.h"
#include "offset_put.h"
#include "verb.h"

#include "plain.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define NUMBER_WANTED	"a whole number from 1 to 9999, but not 80 to 99: " \
			"T80 to T99 are pumps and supplies in some dialects"

/* -- KEY=VALUE ------------------------------------------------------------- */

struct key {
	const char *name;
	enum { WORD, NUMBER, STATE } kind;
	size_t at, size;		/* of the member */
	double min, max;
	double unit;			/* of the value, in that of the
					 * member */
	const char *unit_name;
};

#define E(member)	offsetof(struct store_electrode, member), \
			sizeof(((struct store_electrode *)0)->member)

/* clang-format off */
static const struct key keys[] = {
	{ "name",      WORD,   E(name),         0, 0, 0, "" },
	{ "material",  WORD,   E(material),     0, 0, 0, "" },
	{ "undersize", NUMBER, E(undersize_mm), 0, 100, 1, "mm" },
	{ "length",    NUMBER, E(length_mm),    0, 2000, 1, "mm" },
	{ "wear",      NUMBER, E(wear_mm),      -10, 2000, 1, "mm" },
	{ "x",         NUMBER, E(x_mm),         -100, 100, 1, "mm" },
	{ "y",         NUMBER, E(y_mm),         -100, 100, 1, "mm" },
	{ "c",         NUMBER, E(c_deg),        -360, 360, 1, "degrees" },
	{ "life",      NUMBER, E(life_mm),      0, 2000, 1, "mm" },
	{ "minutes",   NUMBER, E(life_s),       0, 1e6, 60, "minutes" },
	{ "sparked",   NUMBER, E(spark_s),      0, 1e6, 60, "minutes" },
	{ "state",     STATE,  E(state),        0, 0, 0, "" },
	{ "note",      WORD,   E(note),         0, 0, 0, "" },
};
/* clang-format on */

#define NKEYS	(sizeof(keys) / sizeof(keys[0]))

static const struct key *key_find(const char *name, size_t n)
{
	for (size_t i = 0; i < NKEYS; i++)
		if (strlen(keys[i].name) == n &&
		    strncmp(keys[i].name, name, n) == 0)
			return &keys[i];
	return NULL;
}

static int refuse_key(const char *word, char why[400])
{
	size_t n = (size_t)snprintf(why, 400, "no such value '%.40s'; "
				    "KEY=VALUE, KEY one of", word);

	for (size_t i = 0; i < NKEYS; i++)
		n += (size_t)snprintf(why + n, 400 - n, " %s", keys[i].name);
	return -EINVAL;
}

static int take_state(struct store_electrode *e, const char *value,
		      char why[400])
{
	for (int i = 0; i < ELECTRODE_NSTATES; i++) {
		if (strcmp(value, store_electrode_state_name(
					(enum store_electrode_state)i)))
			continue;
		e->state = (enum store_electrode_state)i;
		return 0;
	}
	snprintf(why, 400, "no such state '%.40s'; there, worn or absent",
		 value);
	return -EINVAL;
}

static int take_number(const struct key *k, double *to, const char *value,
		       char why[400])
{
	char *end;
	const double v = strtod(value, &end);

	if (end != value && !*end && v >= k->min && v <= k->max) {
		*to = v * k->unit;
		return 0;
	}
	snprintf(why, 400, "%s=%.40s: not a number that it can have; %g to %g "
		 "%s", k->name, value, k->min, k->max,
		 k->unit_name);
	return -EINVAL;
}

static int take_word(const struct key *k, char *to, const char *value,
		     char why[400])
{
	if (strlen(value) < k->size && plain_is(value)) {
		snprintf(to, k->size, "%s", value);
		return 0;
	}
	snprintf(why, 400, "%s of %zu bytes, or with characters that control a "
		 "terminal; at most %zu bytes of UTF-8", k->name,
		 strlen(value), k->size - 1);
	return -EINVAL;
}

static int take_one(struct store_electrode *e, const char *line,
		    char why[400])
{
	const size_t n = strcspn(line, "=");
	const struct key *k = line[n] ? key_find(line, n) : NULL;
	char *to = k ? (char *)e + k->at : NULL;

	if (!k)
		return refuse_key(line, why);
	if (k->kind == NUMBER)
		return take_number(k, (double *)(void *)to, line + n + 1, why);
	if (k->kind == STATE)
		return take_state(e, line + n + 1, why);
	return take_word(k, to, line + n + 1, why);
}

/* @why is filled with -EINVAL. */
static int take_all(struct store_electrode *e, const char *text,
		    char why[400])
{
	char line[160];
	int err = 0;

	while (*text && err == 0) {
		const size_t n = strcspn(text, "\n");

		if (n >= sizeof(line))
			return refuse_key(text, why);
		memcpy(line, text, n);
		line[n] = '\0';
		err = take_one(e, line, why);
		text += n + (text[n] == '\n');
	}
	return err;
}

/* -- Verbs ----------------------------------------------------------------- */

void electrode_list(struct jobs *j, const struct verb *v,
		    const struct jobs_lcm_command *c)
{
	const uint32_t after = c->arg >= 1 && c->arg < 1e6 ?
			       (uint32_t)c->arg : 0;
	char *body = store_electrodes_json(j->store, after);

	(void)v;
	jobs_answer(j, &(struct jobs_lcm_ack) {
		.key = c->key, .client = c->client, .seq = c->seq,
		.code = body ? 0 : EX_IOERR, .body = body,
		.reason = body ? "done" : "the store failed",
	});
	free(body);
}

/* Find the one that is meant, or answer why not. */
bool electrode_find_named(struct jobs *j, const struct jobs_lcm_command *c,
			  struct store_electrode *ret)
{
	const int err = store_electrode_ok(c->arg) ?
		store_electrode_find(j->store, (uint32_t)c->arg, ret) :
		-ENOENT;

	if (err == 0)
		return true;
	if (err == -ENOENT)
		verbs_answer(j, c, EX_NOINPUT, "no such electrode; edmctl "
			     "electrode list has them");
	else
		verbs_answer(j, c, EX_IOERR, "the store failed");
	return false;
}

/* Has it a turn that C cannot give it? */
static bool is_turned(struct jobs *j, const struct jobs_lcm_command *c,
		      const struct store_electrode *e)
{
	if (e->c_deg == 0 || offset_has_c(j))
		return false;
	verbs_answer(j, c, EX_DATAERR, "c: this machine has no C that turns "
		     "the electrode; c=0, or a work system that is turned");
	return true;
}

/* While a job has it, its numbers are those of the job. */
static bool is_busy(struct jobs *j, const struct jobs_lcm_command *c)
{
	if (!j->queue.job.n || queue_is_leaving(&j->queue) ||
	    electrode_held(j) != (uint32_t)c->arg)
		return false;
	verbs_answer(j, c, REFUSED, "a job is loaded that cuts with it; try "
		     "again when the job has ended");
	return true;
}

static void put(struct jobs *j, const struct jobs_lcm_command *c,
		const struct store_electrode *e)
{
	const int err = store_electrode_put(j->store, e);

	j->electrode.why[0] = '\0';
	verbs_answer(j, c, err == 0 ? 0 : EX_IOERR,
		     err == 0 ? "done" : "the store failed");
}

void electrode_add(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c)
{
	static struct store_electrode all[STORE_ELECTRODES_MAX];
	struct store_electrode e = { .n = 0 };
	char why[400];

	(void)v;
	if (!store_electrode_ok(c->arg)) {
		verbs_answer(j, c, EX_DATAERR, "no such number of an "
			     "electrode; " NUMBER_WANTED);
		return;
	}
	e.n = (uint32_t)c->arg;
	if (store_electrode_find(j->store, e.n, &all[0]) == 0)
		verbs_answer(j, c, REFUSED, "this electrode is there already; "
			     "electrode set changes it, or another number");
	else if (store_electrodes(j->store, all, STORE_ELECTRODES_MAX) ==
		 STORE_ELECTRODES_MAX)
		verbs_answer(j, c, REFUSED, "there are 256 electrodes already; "
			     "remove one");
	else if (take_all(&e, c->text, why) < 0)
		verbs_answer(j, c, EX_DATAERR, why);
	else if (!is_turned(j, c, &e))
		put(j, c, &e);
}

void electrode_set(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c)
{
	struct store_electrode e;
	char why[400];

	(void)v;
	if (!electrode_find_named(j, c, &e))
		return;
	if (take_all(&e, c->text, why) < 0)
		verbs_answer(j, c, EX_DATAERR, why);
	else if (!is_turned(j, c, &e) && !is_busy(j, c))
		put(j, c, &e);
}

void electrode_remove(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c)
{
	struct store_electrode e;
	int err;

	(void)v;
	if (!electrode_find_named(j, c, &e) || is_busy(j, c))
		return;
	err = store_electrode_remove(j->store, e.n);
	j->electrode.why[0] = '\0';
	if (err == 0 && electrode_held(j) == e.n)
		err = store_set_number(j->store, "electrode", 0);
	verbs_answer(j, c, err == 0 ? 0 : EX_IOERR,
		     err == 0 ? "removed" : "the store failed");
}

void electrode_use(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c)
{
	struct store_electrode e;
	int err;

	(void)v;
	if (c->arg != 0 && !electrode_find_named(j, c, &e))
		return;
	if (j->queue.job.n && !queue_is_leaving(&j->queue)) {
		verbs_answer(j, c, REFUSED, "a job is loaded; try again when "
			     "it has ended, or write a T word in the program");
		return;
	}
	err = store_set_number(j->store, "electrode", (int64_t)c->arg);
	j->electrode.why[0] = '\0';
	verbs_answer(j, c, err == 0 ? 0 : EX_IOERR, err != 0 ?
		     "the store failed" : c->arg == 0 ?
		     "the holder is empty" : "it is in the holder");
}
