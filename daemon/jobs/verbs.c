/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs.c - what a COMMAND may ask for: one table
 *
 * A verb of the machine goes to edmd, and is answered when edmd has answered.
 * The other verbs are answered at once.
 */
#include "act.h"
#include "inside.h"
#include "electrode.h"
#include "faults.h"
#include "interrupt.h"
#include "keyring.h"
#include "mdi.h"
#include "offset.h"
#include "verb.h"

#include "interp/tech_table.h"
#include "jobs_log.h"
#include "nearest.h"
#include "store_trust.h"
#include "verbs.h"
#include "verbs_tech.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define RETRACT_MAX_MM	10000.0
#define STEP_MAX	100
#define OVERRIDE_MAX	2.0
#define SIGN_US		100000		/* a sign of a press may not be older */
#define DRIVE_US	60000000	/* a drive may need so long to answer */

/* A command on its way to edmd. */
struct asked {
	struct jobs *jobs;
	struct asker by;
	char name[KEYFILE_NAME_MAX];	/* of the key that asks */
	const struct verb *verb;
	uint32_t arg;			/* what edmd was asked for */
	double arg_mm;
	struct asks_stand at;		/* when it was asked */
};

int verbs_answer(struct jobs *j, const struct jobs_lcm_command *c, int code,
		 const char *reason)
{
	char failed[200];
	int err = 0;

	if (c->act)
		err = act_answered(j, c->act, code, reason);
	if (err && code == 0) {
		snprintf(failed, sizeof(failed), "the store failed, so it is "
			 "not kept: %s", store_why(j->store));
		code = EX_IOERR;
		reason = failed;
		store_act_end(j->store, c->act, code, reason);
	}
	jobs_answer(j, &(struct jobs_lcm_ack) {
		.key = c->key, .client = c->client, .seq = c->seq, .code = code,
		.reason = reason,
	});
	return err;
}

void verbs_answer_json(struct jobs *j, const struct jobs_lcm_command *c,
		       json_t *o)
{
	char *body = o ? json_dumps(o, JSON_COMPACT | JSON_REAL_PRECISION(15)) :
			 NULL;

	jobs_answer(j, &(struct jobs_lcm_ack) {
		.key = c->key, .client = c->client, .seq = c->seq,
		.code = body ? 0 : EX_SOFTWARE, .body = body,
		.reason = body ? "done" : "no memory",
	});
	free(body);
	json_decref(o);
}

/* Refusals of the cycle that do not depend on the state; NULL: the state
 * refuses. */
static const char *refusal(int code)
{
	static const char *const why[] = {
		[SHM_NOT_HOMED] = "an axis is not homed; home first, a job "
				  "that is held must be stopped for it",
		[SHM_AT_LIMIT] = "an axis is on its limit switch; jog it away "
				 "from the switch",
		[SHM_BEYOND] = "that is outside the axis's travel; ask for a "
			       "shorter way, or for a place within it",
		[SHM_NO_NODE] = "the path has fewer nodes in that direction; "
				"ask for fewer",
		[SHM_NOT_PASSED] = "the path up to that node was not passed "
				   "yet; start cuts on",
		[SHM_ELSEWHERE] = "the axes are not where the program begins; "
				  "submit it again",
		[SHM_PLC_HOLDS] = "the PLC holds: nothing may move until it "
				  "lets go",
		[SHM_NO_POWER] = "an axis cannot have power: safe torque "
				 "off, its supply or its enable input; "
				 "repair that, then ask again",
		[SHM_OVER] = "that stand is over: somebody was quicker; look "
			     "what the machine wants now",
		[SHM_STILL_THERE] = "what caused the fault is still there; "
				    "edmctl alarms says what clears it",
	};

	return code >= 0 && code < (int)(sizeof(why) / sizeof(why[0])) ?
	       why[code] : NULL;
}

/* edmd said neither yes nor no; NULL: it said one of them. */
static const char *gone(int code)
{
	switch (code) {
	case SHM_LATE:
	case -ETIMEDOUT:
		return "edmd did not take it in time; it is not done, and will "
		       "not be";
	case SHM_TAKEN:
		return "edmd took it and does not answer; status shows what "
		       "comes of it";
	case SHM_CUT_SHORT:
		return "edmd ended before it answered: nobody knows whether it "
		       "was begun; it will not be done again; status shows "
		       "where the machine stands";
	case -ENOTCONN:
		return "edmd went away before it took it; it is not done, and "
		       "will not be";
	default:
		return NULL;
	}
}

/* What the machine does, behind "the machine". */
static const char *state_words(uint32_t state)
{
	switch (state) {
	case SHM_IDLE:
		return "is idle: no job is loaded";
	case SHM_HOLD:
		return "is held";
	case SHM_FAULT:
		return "has a fault";
	case SHM_JOG:
		return "jogs an axis";
	case SHM_HOME:
		return "homes its axes";
	default:
		return "is at work on a job";
	}
}

static void verb_stand(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c);

/* A start, and nobody has confirmed; or something else was. */
static void refuse_asks(struct jobs *j, const struct jobs_lcm_command *c,
			bool not_asked)
{
	const char *asks = asks_text(j);
	char reason[ASKS_TEXT_MAX + 40];

	snprintf(reason, sizeof(reason), "%s: %s", not_asked ?
		 "that is not what the machine asks for" : "not before this",
		 *asks ? asks : "it asks for nothing");
	verbs_answer(j, c, REFUSED, reason);
}

/* What a guard sees keeps everything from beginning. */
static void refuse_seen(struct jobs *j, const struct jobs_lcm_command *c,
			int fault)
{
	char reason[240];

	snprintf(reason, sizeof(reason), "nothing may move now: %s; edmctl "
		 "faults %s tells why, and what clears it",
		 fault_table[fault].what, fault_table[fault].name);
	verbs_answer(j, c, REFUSED, reason);
}

static bool is_of_drive(const struct verb *v)
{
	return v->machine == SHM_OBJECT_GET || v->machine == SHM_OBJECT_SET;
}

/* What is taken alone counts: who is refused has held and confirmed nothing. */
static void keep_who(const struct asked *a)
{
	switch (a->verb->machine) {
	case SHM_DO_HOLD:
	case SHM_DO_RETRACT:
		asks_held(a->jobs, a->name);
		break;
	case SHM_DO_START:
	case SHM_DO_RESUME:
		asks_held(a->jobs, "");
		asks_answered(a->jobs, &a->at, a->name, true);
		break;
	case SHM_DO_CONFIRM:
		asks_answered(a->jobs, &a->at, a->name, false);
		break;
	default:
		break;
	}
}

static void on_answer(void *arg, int code)
{
	struct asked *a = arg;
	struct jobs *j = a->jobs;
	const struct jobs_lcm_command c = reply_asker_command(&a->by);
	const char *done = begun_is(a->verb) ? "begun" : "done";
	char reason[160];

	if (a->verb->machine == SHM_DO_START ||
	    a->verb->machine == SHM_DO_RESUME)
		queue_started(j, code);
	if (code == SHM_DONE && begun_is(a->verb))
		begun_keep(j, &a->by);
	if (code == SHM_DONE)
		keep_who(a);
	if (code == SHM_DONE && a->verb->machine == SHM_DO_PLACE)
		done = interrupt_placed(j, (int)a->arg, a->arg_mm);
	if (code == SHM_DONE && is_of_drive(a->verb))
		verbs_drive_end(j, a->verb, &c, a->arg);
	else if (code == SHM_DONE)
		verbs_answer(j, &c, 0, done);
	else if (gone(code))
		verbs_answer(j, &c, EX_UNAVAILABLE, gone(code));
	else if (code == -ESHUTDOWN)
		;			/* the next service knows more */
	else if (code > 0 && a->verb->run == verb_stand &&
		 (queue_is_kept(j) || upload_hold_all(&j->uploads)))
		verbs_answer(j, &c, 0, "nothing runs; what waits begins at the "
			     "next start");
	else if (code == SHM_NO_PROGRAM)
		verbs_answer(j, &c, REFUSED, "no job is loaded; submit one");
	else if (code == SHM_NOT_UP)
		verbs_answer(j, &c, REFUSED,
			     "the drives are not up yet; edmd's journal tells "
			     "which; try again when they are");
	else if (code == SHM_BAD_ARGUMENT)
		verbs_answer(j, &c, EX_DATAERR, a->verb->machine == SHM_DO_SET ?
		       "edmd refused the value: with the others in force, "
		       "short_v < window_low_v <= servo_v <= window_high_v < "
		       "open_v < ignition_v must hold" :
		       "edmd refused the value; it must be finite and in "
		       "range");
	else if (code == SHM_ASKS || code == SHM_NOT_ASKED)
		refuse_asks(j, &c, code == SHM_NOT_ASKED);
	else if (code > SHM_SEEN && code < SHM_SEEN + CYCLE_NFAULTS)
		refuse_seen(j, &c, code - SHM_SEEN);
	else if (refusal(code))
		verbs_answer(j, &c, REFUSED, refusal(code));
	else {
		snprintf(reason, sizeof(reason), "the machine %s; %s wants %s",
			 state_words(j->link.snap.state), a->verb->name,
			 a->verb->wants);
		verbs_answer(j, &c, REFUSED, reason);
	}
	free(a);
}

/* NULL: the client was told why. */
static struct asked *asked_new(struct jobs *j, const struct verb *v,
			       const struct jobs_lcm_command *c)
{
	struct asked *a = calloc(1, sizeof(*a));

	if (!a) {
		verbs_answer(j, c, EX_SOFTWARE, "no memory");
		return NULL;
	}
	a->jobs = j;
	a->verb = v;
	a->at = asks_stand(j);
	reply_asker_keep(&a->by, c);
	snprintf(a->name, sizeof(a->name), "%s", c->by ? c->by->name : "");
	return a;
}

void verbs_settle(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c, int code)
{
	struct asked *a = asked_new(j, v, c);

	if (a)
		on_answer(a, code);
}

void verbs_await(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	struct asked *a = asked_new(j, v, c);
	const struct link_command m = {
		.id = c->act, .answer = on_answer, .answer_arg = a,
	};

	if (a && link_await(&j->link, &m, jobs_now_us()) < 0)
		on_answer(a, SHM_TAKEN);
}

/* A job begins only after the disk has recorded that it may begin. */
static bool may_start(struct jobs *j, const struct verb *v)
{
	const bool starts = v->machine == SHM_DO_START ||
			    v->machine == SHM_DO_RESUME;
	const int err = starts ? queue_promise(j) : 0;
	const int committed = act_commit(j);

	if (!starts || queue_has_begun(j))
		return true;
	if (err || committed)
		queue_unpromise(j);
	return err == 0 && committed == 0;
}

/*
 * Who asked may have given up since, and nothing moves without somebody who
 * waits for it.  A client that still waits signs it again.  What ends a motion
 * is never too late.
 */
static bool is_late(const struct verb *v, const struct jobs_lcm_command *c)
{
	const bool moves = v && (v->machine != VERB_OWN ||
				 v->run == mdi_take || v->run == offset_set);

	return moves && v->kind == VERB_ACTS &&
	       jobs_lcm_is_late(c->signed_us);
}

static void ask_machine(struct jobs *j, const struct verb *v,
			const struct jobs_lcm_command *c, uint32_t arg)
{
	struct asked *a = asked_new(j, v, c);
	struct link_command m = {
		.id = c->act, .verb = v->machine, .arg = arg, .arg_mm = c->arg,
		.take_us = v->kind == VERB_SIGNS ? SIGN_US : 0,
		.answer_us = is_of_drive(v) ? DRIVE_US : 0,
		.answer = on_answer, .answer_arg = a,
	};
	char reason[240];
	int err;

	if (!a)
		return;
	a->arg = arg;
	a->arg_mm = c->arg;
	if (!may_start(j, v)) {
		free(a);
		snprintf(reason, sizeof(reason), "the store is degraded: %s; a "
			 "job begins when that can be stored, one that has "
			 "begun goes on", store_why(j->store));
		verbs_answer(j, c, EX_IOERR, reason);
		return;
	}
	/* The disk may have taken its time over the promise. */
	if (is_late(v, c)) {
		on_answer(a, SHM_LATE);
		return;
	}
	err = link_send(&j->link, &m, jobs_now_us());
	if (err == 0)
		return;
	free(a);
	if (err == -EAGAIN)
		verbs_answer(j, c, EX_TEMPFAIL,
			     "too many commands under way; try again");
	else
		verbs_answer(j, c, EX_UNAVAILABLE,
			     j->link.state == LINK_ABSENT ?
			     "edmd is not there; systemctl start edmd" :
			     "edmd is lost; systemctl status edmd");
}

static void verb_machine(struct jobs *j, const struct verb *v,
			 const struct jobs_lcm_command *c)
{
	ask_machine(j, v, c, 0);
}

/* Its text may name the stand that it was meant for, when that was shown. */
static void verb_of_stand(struct jobs *j, const struct verb *v,
			  const struct jobs_lcm_command *c)
{
	char *end;
	const unsigned long n = strtoul(c->text, &end, 10);

	if (*end || n > UINT32_MAX)
		verbs_answer(j, c, EX_DATAERR, "text is the number of a stand, "
			     "or empty");
	else
		ask_machine(j, v, c, (uint32_t)n);
}

/* A reset may come before the fault is seen. */
static void verb_estop(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c)
{
	upload_hold_all(&j->uploads);
	verb_machine(j, v, c);
}

/* A job that is still sent, checked, compiled or loaded would begin behind
 * it. */
static void verb_stand(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c)
{
	upload_hold_all(&j->uploads);
	queue_keep(j);
	mdi_give_up(j);
	verb_machine(j, v, c);
}

static void refuse_field(struct jobs *j, const struct jobs_lcm_command *c)
{
	char reason[640];
	struct nearest near;
	size_t n;

	nearest_init(&near, c->text);
	for (int i = 0; i < INTERP_NTECH; i++)
		if (interp_tech_is_live((enum interp_tech_id)i))
			nearest_offer(&near, interp_tech_field[i].name);
	n = (size_t)snprintf(reason, sizeof(reason), "no such field '%.40s'; "
			     "%s%s%sone of", c->text,
			     near.word[0] ? "did you mean " : "", near.word,
			     near.word[0] ? "? " : "");
	for (int i = 0; i < INTERP_NTECH && n < sizeof(reason); i++)
		if (interp_tech_is_live((enum interp_tech_id)i))
			n += (size_t)snprintf(reason + n, sizeof(reason) - n,
					      " %s",
					      interp_tech_field[i].name);
	verbs_answer(j, c, EX_DATAERR, reason);
}

/* Does a value of the generator reach it?  Otherwise it is refused. */
static bool reaches(struct jobs *j, const struct jobs_lcm_command *c,
		    enum interp_tech_id id)
{
	struct interp_diag why;
	struct interp_tech t;
	char reason[420];

	interp_tech_clear(&t);
	t.v[id] = c->arg;
	if (!interp_tech_value_ok(id, c->arg) ||
	    config_generator_takes(j->config, &t, "set", &why) == 0)
		return true;
	snprintf(reason, sizeof(reason), "%s; %s", why.found, why.wanted);
	verbs_answer(j, c, EX_DATAERR, reason);
	return false;
}

/* NaN removes the set value; the condition's own value is valid again. */
static void verb_set(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c)
{
	const int id = interp_tech_find(c->text);
	char reason[192], range[96];
	bool fits = true;

	if (id < 0 || !interp_tech_is_live((enum interp_tech_id)id)) {
		refuse_field(j, c);
		return;
	}
	interp_tech_range((enum interp_tech_id)id, range, sizeof(range));
	if (!reaches(j, c, (enum interp_tech_id)id))
		return;
	if (id == INTERP_TECH_JUMP_MM)
		fits = config_jump_fits(j->config, c->arg, range,
					sizeof(range));
	if (isnan(c->arg) || (fits &&
	    interp_tech_value_ok((enum interp_tech_id)id, c->arg))) {
		ask_machine(j, v, c, (uint32_t)id);
		return;
	}
	snprintf(reason, sizeof(reason), "%s %g is out of range; %s",
		 c->text, c->arg, range);
	verbs_answer(j, c, EX_DATAERR, reason);
}

/* NaN takes back; without a field, all of them. */
static void verb_generator_set(struct jobs *j, const struct verb *v,
			       const struct jobs_lcm_command *c)
{
	const int field = verbs_generator_field(j, c);

	if (field >= 0)
		ask_machine(j, v, c, (uint32_t)field);
}

/* The same, by one who may vanish. */
static void verb_generator_try(struct jobs *j, const struct verb *v,
			       const struct jobs_lcm_command *c)
{
	const int field = verbs_generator_field(j, c);

	if (field >= 0)
		ask_machine(j, v, c, (uint32_t)field | VERB_TRY_LEASED);
}

static void verb_drive(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c)
{
	struct jobs_lcm_command to = *c;
	uint32_t arg;

	if (!verbs_drive_arg(j, v, c, &arg))
		return;
	if (v->machine == SHM_OBJECT_GET)
		to.arg = 0;
	else if (to.arg < 0)
		to.arg += 4294967296.0;
	ask_machine(j, v, &to, arg);
}

static void verb_drive_store(struct jobs *j, const struct verb *v,
			     const struct jobs_lcm_command *c)
{
	struct jobs_lcm_command to = *c;

	to.arg = VERBS_STORE_WORD;
	verb_drive(j, v, &to);
}

static void verb_retract(struct jobs *j, const struct verb *v,
			 const struct jobs_lcm_command *c)
{
	if (isfinite(c->arg) && c->arg > 0 && c->arg <= RETRACT_MAX_MM)
		verb_machine(j, v, c);
	else
		verbs_answer(j, c, EX_DATAERR,
			     "no such length; a number of mm above 0, at most "
			     "10000");
}

static void verb_step(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c)
{
	if (c->arg == floor(c->arg) && fabs(c->arg) >= 1 &&
	    fabs(c->arg) <= STEP_MAX)
		verb_machine(j, v, c);
	else
		verbs_answer(j, c, EX_DATAERR,
			     "no such number of nodes; 1 to 100 ahead, -1 to "
			     "-100 back");
}

static void verb_override(struct jobs *j, const struct verb *v,
			  const struct jobs_lcm_command *c)
{
	if (c->arg >= 0 && c->arg <= OVERRIDE_MAX)
		verb_machine(j, v, c);
	else
		verbs_answer(j, c, EX_DATAERR,
			     "no such override; 0 to 200 percent");
}

int verbs_axis(struct jobs *j, const struct jobs_lcm_command *c, size_t n)
{
	const char *at = n == 1 ? strchr(INTERP_AXIS_LETTERS,
					 toupper((unsigned char)c->text[0])) :
				  NULL;
	char reason[96], has[INTERP_NAXES + 1];

	jobs_axes(j->config->axes.present, has);
	if (at && strchr(has, *at))
		return (int)(at - INTERP_AXIS_LETTERS);
	snprintf(reason, sizeof(reason), "no axis '%.*s' here; one of %s",
		 (int)(n < 20 ? n : 20), c->text, has);
	verbs_answer(j, c, EX_DATAERR, reason);
	return -1;
}

static void verb_jog(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c)
{
	int axis;

	if (!isfinite(c->arg) || c->arg == 0) {
		verbs_answer(j, c, EX_DATAERR,
			     "no such length; a number of mm or "
			     "degrees, + or -");
		return;
	}
	axis = verbs_axis(j, c, strlen(c->text));
	if (axis >= 0)
		ask_machine(j, v, c, (uint32_t)axis);
}

/* The text is the axis, the number of the press, and `begin` if it begins. */
static void verb_jog_on(struct jobs *j, const struct verb *v,
			const struct jobs_lcm_command *c)
{
	const size_t n = strcspn(c->text, " ");
	char *end = NULL;
	const unsigned long press = strtoul(c->text + n, &end, 10);
	const bool begins = strcmp(end, " begin") == 0;
	int axis;

	if (!isfinite(c->arg)) {
		verbs_answer(j, c, EX_DATAERR, "no such speed; mm/s or deg/s, "
			     "+ or -, 0 ends it");
		return;
	}
	if (press < 1 || press > VERB_PRESS_MAX || (*end && !begins)) {
		verbs_answer(j, c, EX_DATAERR, "this press cannot be read; "
			     "AXIS, a number from 1 to 16777215 that no "
			     "press before it had, and begin if it begins");
		return;
	}
	axis = verbs_axis(j, c, n);
	if (axis >= 0 && jobs_now_us() - c->signed_us > SIGN_US)
		verbs_answer(j, c, EX_UNAVAILABLE, "the message of this press "
			     "came too late; press again");
	else if (axis >= 0)
		ask_machine(j, v, c, (uint32_t)axis | (uint32_t)press << 8 |
			    (begins ? VERB_PRESS_BEGINS : 0));
}

static bool is_homed_by(const struct jobs *j, int axis)
{
	return j->config->axes.present >> axis & 1 &&
	       (j->config->manual[axis].method != 0 ||
		j->link.snap.unplaced >> axis & 1);
}

static void verb_home(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c)
{
	int axis = c->text[0] ? verbs_axis(j, c, strlen(c->text)) :
				INTERP_NAXES;
	bool any = false;

	if (axis < 0)
		return;
	for (int i = 0; i < INTERP_NAXES; i++)
		any = any || (is_homed_by(j, i) &&
			      (axis == i || axis == INTERP_NAXES));
	if (any)
		ask_machine(j, v, c, (uint32_t)axis);
	else
		verbs_answer(j, c, REFUSED, axis == INTERP_NAXES ?
		       "no axis has a home_method; the places they start at "
		       "are good" : "this axis has no home_method; the place "
		       "it starts at is good");
}

/* The text is the axis, and `is` or `as-seen`. */
static void verb_place(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c)
{
	const size_t n = strcspn(c->text, " ");
	const bool seen = strcmp(c->text + n, " as-seen") == 0;
	struct jobs_lcm_command at = *c;
	const int axis = verbs_axis(j, c, n);
	const char *why;

	if (axis < 0)
		return;
	if (!seen && (strcmp(c->text + n, " is") != 0 || !isfinite(c->arg))) {
		verbs_answer(j, c, EX_DATAERR, "AXIS as-seen, or AXIS is and a "
			     "number of mm or degrees");
		return;
	}
	why = j->config->manual[axis].method ?
	      "something homes this axis; edmctl home" :
	      seen ? interrupt_as_seen(j, axis, &at.arg) : NULL;
	if (why) {
		verbs_answer(j, c, REFUSED, why);
		return;
	}
	ask_machine(j, v, &at, (uint32_t)axis);
}

/* A refused start must not start the queue. */
static bool refused_by_fault(struct jobs *j, const struct jobs_lcm_command *c)
{
	if (!queue_is_faulted(j))
		return false;
	verbs_answer(j, c, REFUSED, "a fault is latched; reset first");
	return true;
}

static void verb_resume(struct jobs *j, const struct verb *v,
			const struct jobs_lcm_command *c)
{
	struct store_job job;
	const bool is_loaded = strcmp(c->job, j->queue.job.id) == 0;

	/* An answer about axes that is given twice must not begin the job. */
	if (*c->job && is_loaded &&
	    (*c->text || j->queue.job.state == JOB_READY)) {
		verbs_answer(j, c, REFUSED, "this job is not interrupted: it "
			     "is loaded already; start begins it");
	} else if (!*c->job || is_loaded) {
		if (!refused_by_fault(j, c))
			verb_machine(j, v, c);
	} else if (store_find(j->store, c->job, &job) < 0) {
		verbs_answer(j, c, EX_NOINPUT,
			     "no such job; edmctl queue lists them");
	} else {
		inside_resume(j, c, &job);
	}
}

/* A waiting job is started when its turn comes. */
static void start_behind(struct jobs *j, const struct jobs_lcm_command *c,
			 const struct store_job *job)
{
	char reason[128];

	if (job->state == JOB_INTERRUPTED) {
		verbs_answer(j, c, REFUSED, "this job was interrupted; look at "
			     "the work, then resume it or remove it");
		return;
	}
	if (job->state != JOB_QUEUED) {
		verbs_answer(j, c, REFUSED,
			     "this job has ended; submit it again");
		return;
	}
	/* A start is one act: if the machine is not ready now, the operator
	 * must start again later. */
	if (queue_unready(j)) {
		snprintf(reason, sizeof(reason), "%s; start it then",
			 queue_unready(j));
		verbs_answer(j, c, REFUSED, reason);
		return;
	}
	interrupt_answered(j);
	queue_go(j);
	store_set_hold(j->store, job->n, false);
	verbs_answer(j, c, 0, "starts when its turn comes");
}

/* What begins after this is not kept back by where the axes were. */
static void start_nothing(struct jobs *j, const struct jobs_lcm_command *c)
{
	const char *why = queue_unready(j);

	if (!j->unseen)
		why = "no job in the queue; submit one";
	if (why) {
		verbs_answer(j, c, REFUSED, why);
		return;
	}
	interrupt_answered(j);
	queue_go(j);
	verbs_answer(j, c, 0, "what was not certain counts as seen, and the "
		     "axes as standing where they are shown; no job waits");
}

static void verb_start(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c)
{
	struct queue *q = &j->queue;
	bool here = q->job.n && !queue_is_leaving(q);
	struct store_job job;

	if (refused_by_fault(j, c))
		return;
	if (*c->job && store_find(j->store, c->job, &job) < 0) {
		verbs_answer(j, c, EX_NOINPUT,
			     "no such job; edmctl queue lists them");
	} else if (*c->job && (!here || job.n != q->job.n)) {
		start_behind(j, c, &job);
	} else if (here && q->loading) {
		q->job.hold = false;
		start_behind(j, c, &q->job);
	} else if (here) {
		verb_of_stand(j, v, c);
	} else if (store_head(j->store, &job) == 0) {
		start_behind(j, c, &job);
	} else {
		start_nothing(j, c);
	}
}

/* The one table of rights: what each verb is, and who may ask for it. */
static const struct verb verbs[] = {
	{ "start", ROLE_OPERATOR, VERB_ACTS, verb_start, SHM_DO_START,
	  "a job that is ready or held" },
	{ "hold", ROLE_OPERATOR, VERB_ENDS, verb_stand, SHM_DO_HOLD,
	  "a job that runs" },
	{ "resume", ROLE_OPERATOR, VERB_ACTS, verb_resume, SHM_DO_RESUME,
	  "a job that is held" },
	{ "stop", ROLE_OPERATOR, VERB_ENDS, verb_stand, SHM_DO_STOP,
	  "a job" },
	{ "retract", ROLE_OPERATOR, VERB_ACTS, verb_retract, SHM_DO_RETRACT,
	  "a job, and no fault; reset first" },
	{ "set", ROLE_OPERATOR, VERB_ACTS, verb_set, SHM_DO_SET,
	  "fewer than 64 values set in a job" },
	{ "estop", ROLE_OPERATOR, VERB_ENDS, verb_estop, SHM_DO_ESTOP,
	  "nothing" },
	{ "reset", ROLE_OPERATOR, VERB_ACTS, verb_machine, SHM_DO_RESET,
	  "a fault" },
	{ "done", ROLE_OPERATOR, VERB_ACTS, verb_of_stand, SHM_DO_CONFIRM,
	  "a job that asks for something" },
	{ "step", ROLE_OPERATOR, VERB_ACTS, verb_step, SHM_DO_STEP,
	  "a job held on its path" },
	{ "jog", ROLE_OPERATOR, VERB_ACTS, verb_jog, SHM_DO_JOG,
	  "it idle: no job loaded, no fault" },
	{ "jog-on", ROLE_OPERATOR, VERB_SIGNS, verb_jog_on, SHM_DO_JOG_ON,
	  "it idle, no job, no fault; and a press that is not over: press "
	  "again" },
	{ "home", ROLE_OPERATOR, VERB_ACTS, verb_home, SHM_DO_HOME,
	  "it idle: no job loaded, no fault" },
	{ "place", ROLE_OPERATOR, VERB_ACTS, verb_place, SHM_DO_PLACE,
	  "it idle: no job loaded, no fault" },
	{ "override", ROLE_OPERATOR, VERB_ACTS, verb_override,
	  SHM_DO_OVERRIDE, "nothing" },
	{ "generator", ROLE_VIEWER, VERB_ASKS, verbs_generator, VERB_OWN, "" },
	{ "generator-set", ROLE_OPERATOR, VERB_ACTS, verb_generator_set,
	  SHM_DO_TRY, "it idle, without sparks: no job loaded, no fault" },
	{ "generator-try", ROLE_OPERATOR, VERB_ACTS, verb_generator_try,
	  SHM_DO_TRY, "it idle, without sparks: no job loaded, no fault" },
	{ "drives", ROLE_VIEWER, VERB_ASKS, verbs_drives, VERB_OWN, "" },
	{ "drive-get", ROLE_VIEWER, VERB_ASKS, verb_drive, SHM_OBJECT_GET,
	  "no other object of a drive under way; ask again" },
	{ "drive-set", ROLE_SERVICE, VERB_ACTS, verb_drive, SHM_OBJECT_SET,
	  "no job loaded, nothing that moves, and no other object of a drive "
	  "under way" },
	{ "drive-store", ROLE_SERVICE, VERB_ACTS, verb_drive_store,
	  SHM_OBJECT_SET, "no job loaded, nothing that moves, and no other "
	  "object of a drive under way" },
	{ "remove", ROLE_OPERATOR, VERB_ENDS, verbs_remove, VERB_OWN, "" },
	{ "move", ROLE_OPERATOR, VERB_ACTS, verbs_move, VERB_OWN, "" },
	{ "text", ROLE_VIEWER, VERB_ASKS, verbs_text, VERB_OWN, "" },
	{ "alarms", ROLE_VIEWER, VERB_ASKS, verbs_alarms, VERB_OWN, "" },
	{ "queue", ROLE_VIEWER, VERB_ASKS, verbs_queue, VERB_OWN, "" },
	{ "show", ROLE_VIEWER, VERB_ASKS, verbs_show, VERB_OWN, "" },
	{ "mdi", ROLE_OPERATOR, VERB_ACTS, mdi_take, VERB_OWN, "" },
	{ "offsets", ROLE_VIEWER, VERB_ASKS, offset_list, VERB_OWN, "" },
	{ "offset", ROLE_OPERATOR, VERB_ACTS, offset_set, VERB_OWN, "" },
	{ "moved", ROLE_VIEWER, VERB_ASKS, begun_tell, VERB_OWN, "" },
	{ "why", ROLE_VIEWER, VERB_ASKS, verbs_why, VERB_OWN, "" },
	{ "values", ROLE_VIEWER, VERB_ASKS, verbs_values, VERB_OWN, "" },
	{ "trail", ROLE_VIEWER, VERB_ASKS, verbs_trail, VERB_OWN, "" },
	{ "totals", ROLE_VIEWER, VERB_ASKS, verbs_totals, VERB_OWN, "" },
	{ "history", ROLE_VIEWER, VERB_ASKS, verbs_history, VERB_OWN, "" },
	{ "electrodes", ROLE_VIEWER, VERB_ASKS, electrode_list, VERB_OWN, "" },
	{ "electrode-add", ROLE_OPERATOR, VERB_ACTS, electrode_add, VERB_OWN,
	  "" },
	{ "electrode-set", ROLE_OPERATOR, VERB_ACTS, electrode_set, VERB_OWN,
	  "" },
	{ "electrode-remove", ROLE_OPERATOR, VERB_ACTS, electrode_remove,
	  VERB_OWN, "" },
	{ "electrode-use", ROLE_OPERATOR, VERB_ACTS, electrode_use, VERB_OWN,
	  "" },
	{ "electrode-measure", ROLE_OPERATOR, VERB_ACTS, electrode_measure,
	  VERB_OWN, "" },
	{ "events", ROLE_VIEWER, VERB_ASKS, verbs_events, VERB_OWN, "" },
	{ "tech-set", ROLE_OPERATOR, VERB_ACTS, verbs_tech_set, VERB_OWN, "" },
	{ "tech-save", ROLE_OPERATOR, VERB_ACTS, verbs_tech_save, VERB_OWN,
	  "" },
	{ "tech-back", ROLE_OPERATOR, VERB_ACTS, verbs_tech_back, VERB_OWN,
	  "" },
	{ "tech-text", ROLE_VIEWER, VERB_ASKS, verbs_tech_text, VERB_OWN, "" },
	{ "tech-versions", ROLE_VIEWER, VERB_ASKS, verbs_tech_versions,
	  VERB_OWN, "" },
	{ "checkpoint", ROLE_VIEWER, VERB_ASKS, verbs_checkpoint, VERB_OWN,
	  "" },
	{ "store", ROLE_VIEWER, VERB_ASKS, verbs_store, VERB_OWN, "" },
	{ "hello", ROLE_VIEWER, VERB_ASKS, keyring_hello, VERB_OWN, "" },
	{ "keys", ROLE_SERVICE, VERB_ASKS, keyring_list, VERB_OWN, "" },
	{ "keys-add", ROLE_SERVICE, VERB_ACTS, keyring_add, VERB_OWN, "" },
	{ "keys-remove", ROLE_SERVICE, VERB_ACTS, keyring_remove, VERB_OWN,
	  "" },
};

#define NVERBS	(sizeof(verbs) / sizeof(verbs[0]))

static void refuse_verb(struct jobs *j, const struct jobs_lcm_command *c)
{
	char reason[1024];
	size_t n = (size_t)snprintf(reason, sizeof(reason),
				    "no such verb; one of");

	for (size_t i = 0; i < NVERBS; i++)
		n += (size_t)snprintf(reason + n, sizeof(reason) - n, " %s",
				      verbs[i].name);
	verbs_answer(j, c, EX_USAGE, reason);
}

static const struct verb *verb_find(const char *name)
{
	for (size_t i = 0; i < NVERBS; i++)
		if (strcmp(verbs[i].name, name) == 0)
			return &verbs[i];
	return NULL;
}

enum trust_want verbs_want(const char *verb)
{
	const struct verb *v = verb_find(verb);

	return !v || v->kind == VERB_ASKS ? TRUST_ASKS :
	       v->kind == VERB_ENDS && v->machine != VERB_OWN ? TRUST_ENDS :
	       TRUST_ACTS;
}

static void refuse_role(struct jobs *j, const struct jobs_lcm_command *c,
			const struct verb *v)
{
	char reason[160];

	snprintf(reason, sizeof(reason), "%s is a %s, and %s wants a key of "
		 "role %s", c->by->name, trust_role_name(c->by->role),
		 v->name, trust_role_name(v->role));
	trust_refuse(&j->trust, TRUST_ROLE, c->by->name, c->from,
		     jobs_now_us());
	verbs_answer(j, c, EX_NOPERM, reason);
}

/* It was answered before, or is under way: it is not done again. */
static bool is_repeat(struct jobs *j, const struct jobs_lcm_command *c)
{
	const struct reply *r = reply_find(&j->replies, c->key, c->client,
					   c->seq);

	if (r && r->done)
		jobs_lcm_ack(j->lcm, &(struct jobs_lcm_ack) {
			.key = c->key, .client = c->client, .seq = c->seq,
			.code = r->code,
			.reason = r->reason, .body = r->body,
		});
	return r != NULL;
}

void verbs_take(void *arg, const struct jobs_lcm_command *c)
{
	struct jobs *j = arg;
	const struct verb *v = verb_find(c->verb);

	if (is_repeat(j, c)) {
		mdi_heard(j, c);
		return;
	}
	if (is_late(v, c)) {
		jobs_lcm_ack(j->lcm, &(struct jobs_lcm_ack) {
			.key = c->key, .client = c->client, .seq = c->seq,
			.code = JOBS_LCM_AGAIN, .reason = JOBS_LCM_LATE_TEXT });
		return;
	}
	reply_expect(&j->replies, c);
	if (!v)
		refuse_verb(j, c);
	else if (c->by->role < v->role)
		refuse_role(j, c, v);
	else if (v->kind == VERB_ASKS || v->kind == VERB_SIGNS)
		v->run(j, v, c);
	else
		act_take(j, v, c);
}
