/* SPDX-License-Identifier: Apache-2.0 */
/*
 * press.c - a key of the page that moves an axis while it is pressed
 */
#include "press.h"
#include "clocks.h"
#include "panel.h"
#include "verbs.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>

#define HEARD_S		0.15		/* a sign may name an answer that is at
					 * most so old */

static void on_answer(void *arg, const struct service_answer *a)
{
	struct press *p = arg;

	if (a->code == 0) {
		p->begun = true;
	} else if (a->code != EX_UNAVAILABLE && p->code == 0) {
		/* If a sign was lost or late, the next one decides. */
		p->code = a->code;
		snprintf(p->reason, sizeof(p->reason), "%s", a->reason);
	}
}

/* Send it to edmd. A sign that cannot be sent is as good as a lost one. */
static void pass_on(struct browser *b, double mm_s)
{
	struct press *p = socket_press(b);
	struct share_who who;
	char text[64];
	const struct service_question q = {
		.verb = "jog-on", .job = "", .text = text, .arg = mm_s,
		.flags = SERVICE_ONCE, .who = &who,
	};

	verbs_who(b, VERBS_ACT, &who);
	snprintf(text, sizeof(text), "%s %u%s", p->axis, p->number,
		 p->begun ? "" : " begin");
	service_ask(socket_panel(b)->service, &q, on_answer, p);
}

static void tell(struct browser *b, const char *what)
{
	const struct session *s = socket_session(b);

	panel_note(socket_panel(b), "%s (%s, %s): jog-on %s %s",
		   s ? s->user : "nobody", s ? role_name(s->role) : "none",
		   s ? s->address : "gone", socket_press(b)->axis, what);
}

void press_end(struct browser *b)
{
	struct press *p = socket_press(b);

	if (!p->number)
		return;
	if (p->begun || p->nsaid > 1) {
		pass_on(b, 0);
		tell(b, p->code ? p->reason : "ends");
	}
	service_forget(socket_panel(b)->service, p);
	*p = (struct press) { .number = 0 };
}

static void begin(struct browser *b, int64_t page_number, const char *axis)
{
	struct press *p = socket_press(b);

	press_end(b);
	p->number = 1 + randombytes_uniform(VERB_PRESS_MAX);
	p->page_number = page_number;
	snprintf(p->axis, sizeof(p->axis), "%s", axis);
	tell(b, "begins");
}

static void answer(struct browser *b, int64_t n, int code, const char *reason)
{
	struct press *p = socket_press(b);

	p->said[p->nsaid % PRESS_SAID].n = n;
	p->said[p->nsaid++ % PRESS_SAID].at_s = clock_s(CLOCK_MONOTONIC);
	socket_answer(b, n, code, reason, NULL);
}

static bool is_fresh(const struct press *p, int64_t heard)
{
	for (unsigned int i = 0; i < PRESS_SAID && i < p->nsaid; i++)
		if (p->said[i].n == heard)
			return clock_s(CLOCK_MONOTONIC) - p->said[i].at_s <
			       HEARD_S;
	return false;
}

void press_take(struct browser *b, int64_t n, const json_t *o)
{
	struct press *p = socket_press(b);
	const char *axis = json_string_value(json_object_get(o, "text"));
	const double mm_s = json_number_value(json_object_get(o, "arg"));
	const int64_t number = json_integer_value(json_object_get(o, "press"));
	const int64_t heard = json_integer_value(json_object_get(o, "heard"));

	if (!axis || strlen(axis) >= sizeof(p->axis) || number < 1) {
		socket_answer(b, n, EX_DATAERR, "an axis as text, and a number "
			      "of its own for each press", NULL);
		return;
	}
	if (mm_s == 0) {
		if (p->page_number == number)
			press_end(b);
		socket_answer(b, n, 0, "done", NULL);
		return;
	}
	/* The first sign only begins the exchange. When the page has heard the
	 * answer to it, its next sign can show that it is new. */
	if (p->page_number != number)
		begin(b, number, axis);
	if (p->code) {
		socket_answer(b, n, p->code, p->reason, NULL);
		return;
	}
	if (heard && !is_fresh(p, heard)) {
		p->code = EX_UNAVAILABLE;
		snprintf(p->reason, sizeof(p->reason), "the connection is too "
			 "slow for this, or was interrupted; press again");
		socket_answer(b, n, p->code, p->reason, NULL);
		return;
	}
	if (heard && strcmp(axis, p->axis) == 0)
		pass_on(b, mm_s);
	answer(b, n, 0, "felt");
}
