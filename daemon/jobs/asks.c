/* SPDX-License-Identifier: Apache-2.0 */
/* asks.c - why the machine stands, and what it asks of whom, in words */
#include "asks.h"

#include "jobs.h"
#include "process.h"
#include "stands.h"
#include "waits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct shm_snapshot *snap_of(const struct jobs *j)
{
	return &j->link.snap;
}

/* Is the job that stands the one of this service? */
static bool is_ours(const struct jobs *j)
{
	return j->link.state == LINK_OK && j->queue.job.n &&
	       snap_of(j)->program == j->queue.job.n;
}

static bool same(const struct asks_what *a, const struct asks_what *b)
{
	return a->why == b->why && a->of == b->of && a->line == b->line &&
	       a->confirmed == b->confirmed;
}

/* -- What it asks for, in words -------------------------------------------- */

/* Line @line of the text, without blanks at its ends. */
static void copy_line(const char *text, uint32_t line, char *to, size_t size)
{
	const char *end;
	int n;

	for (uint32_t i = 1; text && i < line; i++) {
		text = strchr(text, '\n');
		text = text ? text + 1 : NULL;
	}
	*to = '\0';
	if (!text)
		return;
	text += strspn(text, " \t\r");
	end = text + strcspn(text, "\r\n");
	while (end > text && (end[-1] == ' ' || end[-1] == '\t'))
		end--;
	n = end - text < 160 ? (int)(end - text) : 160;
	snprintf(to, size, "%.*s", n, text);
}

static void ask_stop(struct jobs *j, const struct asks_what *w, char *to,
		     size_t size)
{
	char *text = NULL, words[200];
	size_t bytes;

	*words = '\0';
	if (store_text(j->store, j->queue.job.n, &text, &bytes) == 0)
		copy_line(text, w->line, words, sizeof(words));
	free(text);
	snprintf(to, size, "the program stops in line %u%s%s; %s", w->line,
		 *words ? ": " : "", words, stand_row(w->why)->asks);
}

static void ask_electrode(struct jobs *j, const struct asks_what *w, char *to,
			  size_t size)
{
	struct store_electrode e = { .n = 0 };
	const uint32_t held = electrode_held(j);
	char is[48] = "";

	if (w->of)
		store_electrode_find(j->store, w->of, &e);
	if (held)
		snprintf(is, sizeof(is), " (%u is in)", held);
	if (w->confirmed)
		snprintf(to, size, "electrode %u is in; edmctl start goes on",
			 w->of);
	else if (w->of == 0)
		snprintf(to, size, "take the electrode out%s; edmctl done 0, "
			 "then edmctl start", is);
	else
		snprintf(to, size, "put electrode %u%s%s in%s; edmctl done %u, "
			 "then edmctl start", w->of, *e.name ? " " : "",
			 e.name, is, w->of);
}

/* What somebody has to set; without a number it is the generator's own. */
static void settings_text(const struct shm_snapshot *s, uint32_t fields,
			  char *to, size_t size)
{
	size_t n = 0;

	*to = '\0';
	for (int i = 0; i < SHM_NGENERATOR && n < size; i++) {
		const char *unit = process_unit(i);
		char value[32] = "";

		if (!(fields >> i & 1))
			continue;
		if (!isnan(s->asked[i]))
			snprintf(value, sizeof(value), " %.10g%s%s",
				 s->asked[i], *unit ? " " : "", unit);
		n += (size_t)snprintf(to + n, size - n, "%s%s%s", n ? ", " : "",
				      process_name(i), value);
	}
}

static void ask_setting(const struct jobs *j, const struct asks_what *w,
			char *to, size_t size)
{
	const struct shm_snapshot *s = snap_of(j);
	char values[200], of[16] = "";

	settings_text(s, w->of, values, sizeof(values));
	if (s->cond_letter)
		snprintf(of, sizeof(of), " for %c%u", s->cond_letter,
			 s->cond_number);
	if (w->confirmed)
		snprintf(to, size, "the generator is set; edmctl start goes "
			 "on");
	else
		snprintf(to, size, "set %s%s at the generator; edmctl done, "
			 "then edmctl start",
			 values, of);
}

static void say(struct jobs *j, const struct asks_what *w, char *to,
		size_t size)
{
	const struct stand_row *row = stand_row(w->why);

	switch (w->why) {
	case STAND_NONE:
		*to = '\0';
		break;
	case STAND_STOP:
	case STAND_OPTIONAL:
		ask_stop(j, w, to, size);
		break;
	case STAND_ELECTRODE:
		ask_electrode(j, w, to, size);
		break;
	case STAND_SETTING:
		ask_setting(j, w, to, size);
		break;
	case STAND_MCODE:
		snprintf(to, size, "%s: M%u; %s", row->what, w->of, row->asks);
		break;
	case STAND_COMMAND:
		snprintf(to, size, "%s%s%s; %s", row->what,
			 *j->asks.by ? " of " : "", j->asks.by, row->asks);
		break;
	default:
		snprintf(to, size, "%s; %s", row->what, row->asks);
	}
}

/* The text of a long program is read only when something has changed. */
static const char *of_job(struct jobs *j)
{
	const struct shm_snapshot *s = snap_of(j);
	const struct asks_what now = { s->stand, s->stand_of, s->line,
				  s->confirmed };
	struct asks *t = &j->asks;

	if (t->program == s->program && same(&t->what, &now))
		return t->text;
	t->program = s->program;
	t->what = now;
	say(j, &now, t->text, sizeof(t->text));
	return t->text;
}

/* -- As STATUS has it ------------------------------------------------------ */

static bool queue_stands(const struct jobs *j)
{
	return !j->queue.job.n && j->queue.behind > 0;
}

const char *asks_name(const struct jobs *j)
{
	return is_ours(j) ? stand_row(snap_of(j)->stand)->name : "queue";
}

const char *asks_text(struct jobs *j)
{
	static char why[ASKS_TEXT_MAX];
	struct store_job head;

	if (is_ours(j))
		return of_job(j);
	if (!queue_stands(j) || store_head(j->store, &head) < 0)
		return "";
	return waits_why(j, &head, why, sizeof(why));
}

double asks_stood_s(const struct jobs *j)
{
	const struct shm_snapshot *s = snap_of(j);

	return is_ours(j) ? (double)s->stand_cycles * (double)s->period_ns /
			    1e9 : 0;
}

/* -- As it is told --------------------------------------------------------- */

/* What nobody has commanded is told: somebody has to come. */
static bool calls(uint32_t why)
{
	return why == STAND_STOP || why == STAND_OPTIONAL ||
	       why == STAND_ELECTRODE || why == STAND_SETTING ||
	       why == STAND_PLC;
}

void asks_event(struct jobs *j, const struct shm_event *e)
{
	const struct asks_what w = {
		.why = (uint32_t)e->code, .of = (uint32_t)e->id,
		.line = e->line,
	};
	const int64_t n = (int64_t)(e->id >> 32);
	char asks[ASKS_TEXT_MAX];

	if (!j->queue.job.n || e->program != j->queue.job.n || !calls(w.why))
		return;
	/* The next edmd comes to it again, and so does a reset of a fault. */
	if (store_number(j->store, "stand_told", -1) == n)
		return;
	store_set_number(j->store, "stand_told", n);
	say(j, &w, asks, sizeof(asks));
	jobs_note(j, &(struct jobs_note) {
		.kind = "stands", .job = j->queue.job.id,
		.outcome = stand_row(w.why)->name, .place_mm = e->place_mm,
	}, "job %s, line %u: %s", j->queue.job.name, e->line, asks);
}

void asks_held(struct jobs *j, const char *by)
{
	/* It may have been seen to stand before that was known. */
	j->asks.program = 0;
	snprintf(j->asks.by, sizeof(j->asks.by), "%s", by);
}

struct asks_stand asks_stand(const struct jobs *j)
{
	const struct shm_snapshot *s = snap_of(j);

	return (struct asks_stand) {
		is_ours(j) ? s->kept_stand : STAND_NONE, s->line, s->place_mm,
	};
}

void asks_answered(struct jobs *j, const struct asks_stand *at, const char *by,
		   bool starts)
{
	if (!calls(at->why))
		return;
	jobs_note(j, &(struct jobs_note) {
		.kind = "confirmed", .job = j->queue.job.id,
		.outcome = stand_row(at->why)->name, .place_mm = at->place_mm,
	}, "job %s, line %u: %s: %s, says %s", j->queue.job.name, at->line,
		  stand_row(at->why)->what, starts ? "go on" : "done", by);
}
