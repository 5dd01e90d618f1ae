/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs_drive.c - the drives of a bus, and their objects
 */
#include "verb.h"

#include "nearest.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

/* -- What is known of them ------------------------------------------------- */

static double period_s(const struct jobs *j)
{
	return (double)j->link.snap.period_ns * 1e-9;
}

static json_t *emergency_put(const struct jobs *j,
			     const struct cia402_emergency *e, uint64_t now)
{
	const double ago_s = (double)(now - e->at) * period_s(j);
	char code[8], maker[16];

	snprintf(code, sizeof(code), "%04x", e->code);
	snprintf(maker, sizeof(maker), "%02x %02x %02x %02x %02x",
		 e->maker[0], e->maker[1], e->maker[2], e->maker[3],
		 e->maker[4]);
	return json_pack("{s:I,s:s,s:s,s:i,s:s}", "utime",
			 (json_int_t)((double)jobs_utime() - ago_s * 1e6),
			 "code", code, "text", cia402_emergency_text(e->code),
			 "register", e->error_register, "maker", maker);
}

/* The oldest first. */
static json_t *emergencies_put(const struct jobs *j,
			       const struct cia402_drive *d, uint64_t now)
{
	const uint32_t n = d->emergencies;
	json_t *all = json_array();

	for (uint32_t i = n > CIA402_EMERGENCIES ? n - CIA402_EMERGENCIES : 0;
	     i < n; i++)
		json_array_append_new(all, emergency_put(j, &d->emergency[
				      i % CIA402_EMERGENCIES], now));
	return all;
}

static json_t *drive_put(const struct jobs *j, const struct cia402_drive *d,
			 uint64_t now)
{
	const char axis[2] = { INTERP_AXIS_LETTERS[d->axis], '\0' };
	const struct shm_snapshot *s = &j->link.snap;
	const double mm = s->pos[d->axis] * s->pulse_mm[d->axis];
	const bool up = d->phase == DRIVE_RUNNING && d->heard;
	const bool lost = d->lost || s->unplaced >> d->axis & 1;

	return json_pack("{s:s,s:i,s:s,s:s,s:s,s:i,s:i,s:s,s:f,s:i,s:b,s:i,"
			 "s:o}", "axis", axis, "node", d->node,
			 "phase", cia402_phase_name(d->phase),
			 "state", up ? cia402_state_name(d->state) : "",
			 "trouble", cia402_trouble_name(d->trouble),
			 "status", d->status,
			 "mode", d->shows_mode ? d->mode : 0, "mode_name",
			 d->shows_mode ? cia402_mode_name(d->mode) : "",
			 "place_mm", mm, "increments", (int)d->actual,
			 "lost", lost, "emergencies", (int)d->emergencies,
			 "history", emergencies_put(j, d, now));
}

static bool told(const struct jobs *j, struct cia402_told *ret)
{
	return j->link.state == LINK_OK && shm_drives(j->link.status, ret);
}

void verbs_drives(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c)
{
	json_t *all = json_array();
	struct cia402_told t = { .n = 0 };

	(void)v;
	if (j->link.state != LINK_OK) {
		json_decref(all);
		verbs_answer(j, c, EX_UNAVAILABLE, "edmd is not there; "
			     "systemctl start edmd");
		return;
	}
	told(j, &t);
	for (uint32_t i = 0; i < t.n; i++)
		json_array_append_new(all, drive_put(j, &t.drive[i], t.at));
	verbs_answer_json(j, c, json_pack("{s:o}", "drives", all));
}

/* -- What is asked --------------------------------------------------------- */

static void refuse_object(struct jobs *j, const struct jobs_lcm_command *c,
			  const char *text)
{
	const struct cia402_object *o;
	struct nearest near;
	char reason[240];

	nearest_init(&near, text);
	for (size_t i = 0; (o = cia402_object_row(i)); i++)
		nearest_offer(&near, o->name);
	snprintf(reason, sizeof(reason), "no such object '%.40s'; %s%s%sa "
		 "number as 6064 or 60c2:1, or a name of CiA 402 as position "
		 "actual value", text, near.word[0] ? "did you mean " : "",
		 near.word, near.word[0] ? "? else " : "");
	verbs_answer(j, c, EX_DATAERR, reason);
}

static bool is_value(double x)
{
	return x == floor(x) && x >= -2147483648.0 && x <= 4294967295.0;
}

bool verbs_drive_arg(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c, uint32_t *ret)
{
	const size_t n = strcspn(c->text, " ");
	const char *object = c->text + n + (c->text[n] == ' ');
	const int axis = verbs_axis(j, c, n);
	uint16_t index = VERBS_STORE_INDEX;
	uint8_t sub = VERBS_STORE_SUB;

	if (axis < 0)
		return false;
	if (!config_machine_is(j->config, MACHINE_DRIVES) ||
	    j->config->can402.node[axis] <= 0) {
		verbs_answer(j, c, REFUSED, "this axis has no drive on a bus; "
			     "backend = can402 and can402.node_X have one");
		return false;
	}
	if (strcmp(v->name, "drive-store") != 0 &&
	    !cia402_object_read(object, &index, &sub)) {
		refuse_object(j, c, object);
		return false;
	}
	if (v->machine == SHM_OBJECT_SET && !is_value(c->arg)) {
		verbs_answer(j, c, EX_DATAERR, "no such value; a whole number, "
			     "-2147483648 to 4294967295");
		return false;
	}
	*ret = SHM_OBJECT(axis, index, sub);
	return true;
}

/* -- What came of it ------------------------------------------------------- */

static double value_of(const struct cia402_answer *a, uint32_t word)
{
	const struct cia402_object *o = cia402_object_at(a->of.index,
							 a->of.sub);
	const int shift = 32 - 8 * (int)a->bytes;

	return o && o->is_signed ? (double)((int32_t)(word << shift) >> shift) :
				   word;
}

static const char *name_of(const struct cia402_answer *a)
{
	const struct cia402_object *o = cia402_object_at(a->of.index,
							 a->of.sub);

	return o ? o->name : "";
}

static const char *refusal(const struct cia402_answer *a)
{
	switch (a->end) {
	case CIA402_SILENT:
		return "the drive does not answer; edmctl drive list shows how "
		       "it is; whether a value was taken is not known: get it";
	case CIA402_NOT_UP:
		return "the drive is not there, or is being set up; edmctl "
		       "drive list shows how it is; ask again when it is up";
	case CIA402_OWN:
		return "edmd writes this object itself when it sets the drive "
		       "up, or sends it in each period; a key of the machine "
		       "file, or drive_leave there if something else is to do "
		       "its work";
	case CIA402_POWERED:
		return "the drive has torque, and an object that is set could "
		       "move its axis; edmctl estop takes the torque, then "
		       "set it and reset";
	case CIA402_LONG:
		return "this object has more than four bytes; one with one, "
		       "two or four";
	default:
		return "edmd has no answer to it; ask again";
	}
}

static void answer_abort(struct jobs *j, const struct jobs_lcm_command *c,
			 const struct cia402_answer *a)
{
	char reason[240];

	snprintf(reason, sizeof(reason), "the drive refuses object %04x:%02x, "
		 "code %08x: %s%s", a->of.index, a->of.sub, a->code,
		 cia402_abort_text(a->code),
		 a->of.index == VERBS_STORE_INDEX ? "; it does not store the "
		 "parameters of the application alone: set them by drive_sdo "
		 "in the machine file" : "");
	verbs_answer(j, c, REFUSED, reason);
}

static void answer_set(struct jobs *j, const struct jobs_lcm_command *c,
		       const struct cia402_answer *a)
{
	const uint32_t mask = UINT32_MAX >> (32 - 8 * a->bytes);
	const bool same = ((a->now ^ a->of.value) & mask) == 0;
	char reason[240];

	snprintf(reason, sizeof(reason), "%04x:%02x is %.0f, it was %.0f%s",
		 a->of.index, a->of.sub, value_of(a, a->now),
		 value_of(a, a->was), same ? "" :
		 ": the drive took the value and has another one");
	verbs_answer(j, c, same ? 0 : REFUSED, reason);
}

static void answer_get(struct jobs *j, const struct jobs_lcm_command *c,
		       const struct cia402_answer *a)
{
	verbs_answer_json(j, c, json_pack("{s:i,s:i,s:s,s:i,s:f}",
				"index", a->of.index, "sub", a->of.sub,
				"name", name_of(a), "bytes", (int)a->bytes,
				"value", value_of(a, a->now)));
}

void verbs_drive_end(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c, uint32_t arg)
{
	struct cia402_told t;
	const struct cia402_answer *a = &t.answer;

	if (!told(j, &t) || arg != SHM_OBJECT(a->of.axis, a->of.index,
					      a->of.sub) ||
	    a->of.sets != (v->machine == SHM_OBJECT_SET))
		t.answer.end = CIA402_NOTHING;
	if (a->end == CIA402_ABORTED)
		answer_abort(j, c, a);
	else if (a->end != CIA402_DONE)
		verbs_answer(j, c, REFUSED, refusal(a));
	else if (v->machine == SHM_OBJECT_GET)
		answer_get(j, c, a);
	else if (a->of.index == VERBS_STORE_INDEX)
		verbs_answer(j, c, 0, "stored");
	else
		answer_set(j, c, a);
}
