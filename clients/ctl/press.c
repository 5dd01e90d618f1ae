/* SPDX-License-Identifier: Apache-2.0 */
/*
 * press.c - an axis moves as long as this program runs, or wants it to
 *
 * The program sends a sign many times a second.  If it is killed, or if the
 * network fails, the axis stands still 0.2 s later.
 */
#include "ctl.h"
#include "verbs.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define SIGN_MS		40
#define LATE_S		0.1		/* a sign that is older is useless */

struct press {
	struct ctl *ctl;
	const char *axis;
	bool begun;
	int code;			/* of the refusal that ended it */
	char reason[200];
};

static void on_answer(void *arg, int err, const struct talk_ack *a)
{
	struct press *p = arg;

	if (err < 0)
		return;			/* the next one may arrive */
	if (a->code == 0) {
		p->begun = true;
	} else if (p->code == 0) {
		p->code = a->code;
		snprintf(p->reason, sizeof(p->reason), "%s", a->reason);
	}
}

static int say(struct press *p, double mm_s, uint32_t number)
{
	char text[64];
	const struct talk_question q = {
		.verb = "jog-on", .text = text, .arg = mm_s,
	};

	snprintf(text, sizeof(text), "%.16s %u%s", p->axis, number,
		 p->begun ? "" : " begin");
	return talk_send(p->ctl->talk, &q, LATE_S, on_answer, p);
}

/* Answers come meanwhile, and each of them ends a talk_wait(). */
static void wait_a_bit(struct press *p)
{
	const double until_s = talk_now_s() + SIGN_MS * 1e-3;
	double left_s;

	while (!talk_interrupted() && p->code == 0 &&
	       (left_s = until_s - talk_now_s()) > 0)
		talk_wait(p->ctl->talk, (int)ceil(left_s * 1e3));
}

int ctl_press(struct ctl *c, const struct ctl_press *asked, char *said,
	      size_t size)
{
	const uint32_t number = 1 + randombytes_uniform(VERB_PRESS_MAX);
	struct press p = { .ctl = c, .axis = asked->axis };
	double mm_s;

	while (!talk_interrupted() && p.code == 0 &&
	       !isnan(mm_s = asked->mm_s(asked->arg))) {
		say(&p, mm_s, number);
		wait_a_bit(&p);
	}
	/* If this message is lost, the axis stops a little later. */
	say(&p, 0, number);
	talk_forget(c->talk, &p);
	snprintf(said, size, "%s", p.reason);
	/* A refusal after the axis has moved means that the travel ended
	 * there. */
	return p.begun ? 0 : p.code;
}

static double until_interrupted(void *arg)
{
	return *(const double *)arg;
}

int ctl_jog_on(struct ctl *c)
{
	char *end, said[200];
	double mm_s = strtod(c->value, &end);
	int err;

	if (end == c->value || *end || !isfinite(mm_s) || mm_s == 0) {
		fprintf(stderr, "edmctl: jog-on: '%s' is no speed; mm/s, or "
			"deg/s of A B C, + or -\n", c->value);
		return EX_USAGE;
	}
	if (!c->talk || !ctl_first_status(c))
		return ctl_unanswered(c, c->talk_err);
	fprintf(stderr, "edmctl: %s moves until Ctrl-C\n", c->arg);
	talk_catch_signals();
	err = ctl_press(c, &(struct ctl_press) { .axis = c->arg,
						 .mm_s = until_interrupted,
						 .arg = &mm_s },
			said, sizeof(said));
	if (err)
		fprintf(stderr, "edmctl: jog-on: %s\n", said);
	return err;
}
