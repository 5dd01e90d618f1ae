/* SPDX-License-Identifier: Apache-2.0 */
/*
 * alarms.c - the fault in words: what it is, why, what clears it
 */
#include "ctl.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

struct words {
	const char *fault, *what, *why, *clear;
};

#define RESET	"edmctl reset; then start goes on, stop ends the job"

/* clang-format off */
static const struct words words[] = {
	{ "e-stop", "emergency stop",
	  "the e-stop input is on, or estop was commanded",
	  "release the button; " RESET },
	{ "short-not-cleared", "a short circuit that a retract did not clear",
	  "debris or a broken piece between electrode and work, or contact "
	  "elsewhere",
	  "flush and look; edmctl retract MM moves further back; " RESET },
	{ "gap-lost", "the gap voltage cannot be read",
	  "sensor, wiring or [gap] source",
	  "mend the sensor; " RESET },
	{ "io-lost", "the drives or lines do not answer",
	  "power, cable or bus of the machine",
	  "mend it, home where the place is in doubt; " RESET },
	{ "contact", "a touch while positioning",
	  "something stands in the way of electrode or wire",
	  "clear the way; retract or jog away; " RESET },
	{ "soft-limit", "the path leaves the travel of an axis",
	  "the program, or its work offset, leads outside [axis] travel_*",
	  "edmctl reset, edmctl stop; correct the program" },
	{ "program", "the program in memory is damaged",
	  "a segment failed its check",
	  "edmctl reset, edmctl stop; submit it again" },
	{ "overrun", "too many periods missed in a row",
	  "the host is not fit for real time, or too busy",
	  "edmctl doctor; " RESET },
	{ "retract-at-start", "still short where the way back ends",
	  "the short is at the start of the path",
	  "flush and look; " RESET },
	{ "retract-time", "a retract took too long",
	  "[gap] retract_max_s is over and it is still short",
	  "flush and look; " RESET },
	{ "retract-count", "many retracts without erosion between them",
	  "[gap] abort_count; the cut does not go on",
	  "flush, or a gentler condition; " RESET },
	{ "arcing", "arcs that neither pause nor retract ended",
	  "debris in the gap, or too much energy for its size",
	  "flush, clean the electrode, longer off time; " RESET },
	{ "wire-broken", "the wire is broken",
	  "energy, tension or flushing",
	  "thread it; " RESET },
	{ "gap-stuck", "the gap signal stands still, or is noise",
	  "sensor or wiring",
	  "mend the sensor; " RESET },
	{ "limit-switch", "an axis ran onto its limit switch",
	  "not homed, a wrong travel_*, or a switch that failed",
	  "edmctl reset; without a job edmctl jog AXIS MM, away from the "
	  "switch" },
	{ "door", "the door is open",
	  "it was opened while a job ran, or its switch failed",
	  "close it; " RESET },
	{ "dielectric", "the dielectric is too low to spark in",
	  "its level switch",
	  "fill up; " RESET },
	{ "home-not-found", "homing met no switch or no index mark",
	  "the switch or its wiring, or home_dir, in the machine file",
	  "edmctl reset; mend it; edmctl home" },
};
/* clang-format on */

static const struct words *words_of(const char *fault)
{
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (strcmp(words[i].fault, fault) == 0)
			return &words[i];
	return NULL;
}

static void print_now(const struct talk_status *s)
{
	const struct words *w = words_of(s->fault);

	if (strcmp(s->daemon, "ok") != 0)
		printf("edmd       %s; its last word follows.  systemctl start "
		       "edmd\n", s->daemon);
	if (strcmp(s->fault, "none") == 0) {
		printf("fault      none\n");
		return;
	}
	printf("fault      %s%s%s\n", s->fault, w ? ": " : "",
	       w ? w->what : "");
	if (w)
		printf("why        %s\nclear      %s\n", w->why, w->clear);
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
	const struct words *w = words_of(s->fault);
	json_t *all = json_pack("{s:s,s:s,s:s,s:s,s:s,s:s,s:O}", "daemon",
				s->daemon, "fault", s->fault, "what",
				w ? w->what : "", "why", w ? w->why : "",
				"clear", w ? w->clear : "", "job", s->job,
				"alarms", rows);

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
	int rc;

	if (!s)
		return ctl_unanswered(c, talk_interrupted() ? -EINTR :
				      -ETIMEDOUT);
	rc = ctl_ask(c, &(struct talk_question) { .verb = "alarms" }, &a);
	if (rc)
		return rc;
	rows = json_loads(a.body, 0, NULL);
	talk_answer_free(&a);
	if (!json_is_array(rows)) {
		json_decref(rows);
		return EX_PROTOCOL;
	}
	if (c->json) {
		rc = print_json(s, rows);
	} else {
		print_now(s);
		print_past(rows);
	}
	json_decref(rows);
	return rc ? rc : strcmp(s->fault, "none") != 0;
}
