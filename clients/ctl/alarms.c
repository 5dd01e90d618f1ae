/* SPDX-License-Identifier: Apache-2.0 */
/*
 * alarms.c - the faults in words: what they are, why they came, what clears
 * them
 */
#include "ctl.h"
#include "faults.h"
#include "hunting.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

static const struct fault_row *row_of(const char *fault)
{
	for (int i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++)
		if (strcmp(fault_table[i].name, fault) == 0)
			return &fault_table[i];
	return NULL;
}

static void print_fault(const char *name)
{
	const struct fault_row *row = row_of(name);

	printf("fault      %s%s%s\n", name, row ? ": " : "",
	       row ? row->what : "");
	if (row)
		printf("why        %s\nclear      %s\n", row->why, row->clear);
}

static void print_hunting(const struct talk_status *s)
{
	if (s->hunts == 0)
		return;
	printf("warning    hunting: %d times many retracts in a row without "
	       "progress\nadvice     %s\n", s->hunts, HUNTING_ADVICE);
}

static void print_now(const struct talk_status *s)
{
	char all[sizeof(s->faults)], *at = all;

	if (strcmp(s->daemon, "ok") != 0)
		printf("edmd       %s; its last word follows.  systemctl start "
		       "edmd\n", s->daemon);
	if (strcmp(s->fault, "none") == 0) {
		printf("fault      none\n");
		print_hunting(s);
		return;
	}
	print_hunting(s);
	print_fault(s->fault);
	memcpy(all, s->faults, sizeof(all));
	for (char *name; (name = strsep(&at, " ")); )
		if (*name && strcmp(name, s->fault) != 0)
			print_fault(name);
	if (*s->job)
		printf("job        %s in line %d, at %.3f mm\n", s->job,
		       s->line, s->place_mm);
}

static void print_past(json_t *rows)
{
	json_t *row;
	char at[32];
	size_t i;

	json_array_foreach(rows, i, row) {
		const char *text = json_string_value(json_object_get(row,
								     "text"));

		ctl_when(at, row, "utime");
		printf("%s  %s\n", at, text ? text : "");
	}
}

static int print_json(const struct talk_status *s, json_t *rows)
{
	const struct fault_row *w = row_of(s->fault);
	json_t *all = json_pack("{s:s,s:s,s:s,s:s,s:s,s:s,s:s,s:O}", "daemon",
				s->daemon, "fault", s->fault, "faults",
				s->faults, "what", w ? w->what : "", "why",
				w ? w->why : "", "clear", w ? w->clear : "",
				"job", s->job, "alarms", rows);

	if (!all)
		return EX_SOFTWARE;
	json_dumpf(all, stdout, JSON_PRESERVE_ORDER);
	putchar('\n');
	json_decref(all);
	return 0;
}

int ctl_alarms(struct ctl *c)
{
	const struct talk_status *s = ctl_first_status(c);
	struct talk_answer a;
	json_t *rows;
	int err;

	if (!s)
		return ctl_unanswered(c, talk_interrupted() ? -EINTR :
				      -ETIMEDOUT);
	err = ctl_ask(c, &(struct talk_question) { .verb = "alarms" }, &a);
	if (err)
		return err;
	rows = json_loads(a.body, 0, NULL);
	talk_answer_free(&a);
	if (!json_is_array(rows)) {
		json_decref(rows);
		return EX_PROTOCOL;
	}
	if (c->json) {
		err = print_json(s, rows);
	} else {
		print_now(s);
		if (strcmp(s->daemon, "ok") == 0 &&
		    strcmp(s->fault, "none") != 0)
			ctl_drives_ill(c);
		print_past(rows);
	}
	json_decref(rows);
	return err ? err : strcmp(s->fault, "none") != 0;
}

/* -- Every fault that exists
 * ------------------------------------------------ */

static json_t *row_json(enum cycle_fault f)
{
	const struct fault_row *row = &fault_table[f];

	return json_pack("{s:i,s:s,s:s,s:s,s:s,s:s,s:s,s:b}", "number", f,
			 "fault", row->name, "what", row->what, "why",
			 row->why, "clear", row->clear, "motion",
			 fault_motion_text(f), "watched", fault_scope_text(f),
			 "drives_off", row->disables);
}

static int print_all_json(void)
{
	json_t *all = json_array();

	for (int i = FAULT_NONE + 1; all && i < CYCLE_NFAULTS; i++)
		json_array_append_new(all, row_json((enum cycle_fault)i));
	if (!all)
		return EX_SOFTWARE;
	json_dumpf(all, stdout, JSON_INDENT(1) | JSON_PRESERVE_ORDER);
	putchar('\n');
	json_decref(all);
	return 0;
}

static void print_row(enum cycle_fault f)
{
	print_fault(fault_table[f].name);
	printf("watched    %s\nmotion     %s\n", fault_scope_text(f),
	       fault_motion_text(f));
}

int ctl_faults(struct ctl *c)
{
	if (c->arg && !row_of(c->arg)) {
		fprintf(stderr, "edmctl: no fault '%s'; edmctl faults lists "
			"them\n", c->arg);
		return EX_USAGE;
	}
	if (c->json)
		return print_all_json();
	for (int i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++) {
		if (c->arg && strcmp(c->arg, fault_table[i].name) != 0)
			continue;
		print_row((enum cycle_fault)i);
		if (!c->arg && i < CYCLE_NFAULTS - 1)
			putchar('\n');
	}
	return 0;
}
