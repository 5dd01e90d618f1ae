/* SPDX-License-Identifier: Apache-2.0 */
/* offset.c - work offsets: touched off, kept, given to the compiler */
#include "offset.h"

#include "inside.h"
#include "electrode.h"
#include "mdi.h"
#include "offset_put.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define BACK_LEAST_MM	0.2		/* after a contact */

/* -- For the compiler ------------------------------------------------------ */

/* A job that goes on after an interruption has those of its beginning. */
static bool goes_on(struct jobs *j, const struct store_job *job)
{
	static struct inside a;

	return inside_read(j, job->n, &a) == 0 && !inside_is_named(&a);
}

int offset_request(struct jobs *j, const struct store_job *job,
		   struct compiler_request *ret)
{
	double mm[INTERP_NC_NWORK][WORK_NROWS];
	int err = 0;

	if (job && !goes_on(j, job))
		err = store_work_keep(j->store, job->n);
	if (err)
		return -EIO;
	err = offset_read(j, job ? job->n : 0, mm, NULL);
	for (int i = 0; i < INTERP_NC_NWORK; i++) {
		memcpy(ret->work_mm[i], mm[i], sizeof(ret->work_mm[i]));
		ret->work_turn_deg[i] = mm[i][WORK_TURN];
	}
	return err;
}

/* -- Carried out ----------------------------------------------------------- */

/* The length is that of what is in the holder. */
static const char *why_not_electrode(struct jobs *j, const struct touch *t)
{
	static char why[160];
	struct store_electrode e;

	if (store_electrode_find(j->store, t->electrode, &e) < 0)
		snprintf(why, sizeof(why), "electrode %u is not in the table; "
			 "electrode add %u", t->electrode, t->electrode);
	else if (electrode_held(j) != t->electrode)
		snprintf(why, sizeof(why), "electrode %u is not in the holder; "
			 "put it in, and electrode use %u", t->electrode,
			 t->electrode);
	else if (t->form == TOUCH_SKEW && !offset_has_c(j))
		return "nothing turns the electrode: the machine has no C, or "
		       "C is in its table; turn it by hand";
	else if (t->form == TOUCH_BOSS || t->form == TOUCH_BORE)
		return t->felt & ~t->here && !j->config->measure.there ?
		       "where the middle of the reference is, nobody knows; "
		       "X=12.5 Y=3, or [electrode] measure = yes, measure_x_mm "
		       "and measure_y_mm of the machine file" : NULL;
	else if (t->form != TOUCH_SKEW)
		return electrode_no_length(&e, t->is_new);
	else
		return NULL;
	return why;
}

/* A corner tells two places of two walls, each seen from another place. */
static const char *why_not_turned(struct jobs *j, const struct touch *t)
{
	double mm[INTERP_NC_NWORK][WORK_NROWS];

	if (t->work < 0 || t->form != TOUCH_CORNER ||
	    offset_read(j, 0, mm, NULL) < 0 || mm[t->work][WORK_TURN] == 0)
		return NULL;
	return "a corner in a system that is turned; two edges, one after the "
	       "other: X=probe+ and Y=probe+; or clear before it";
}

/* Where the machine stands has to be certain. */
static const char *why_not(struct jobs *j, const struct touch *t)
{
	const uint32_t moved = t->here | t->felt |
			       (t->form == TOUCH_BOSS ? 1u << INTERP_Z : 0) |
			       (t->form == TOUCH_SKEW ? 1u << t->along : 0);

	if (!t->form && j->queue.job.n && !queue_is_leaving(&j->queue))
		return "a job is loaded, which has the offsets as they were; "
		       "try again when it has ended";
	if (moved && j->link.state != LINK_OK)
		return "edmd is not there, so it is not known where the axes "
		       "stand; systemctl start edmd";
	if (moved && !t->form && j->link.snap.state != SHM_IDLE)
		return "the machine is not idle; try again when it stands";
	if (moved & (j->link.snap.unplaced | (j->config->require_home ?
					      j->link.snap.unhomed : 0)))
		return "the place of this axis is not certain; edmctl home, or "
		       "edmctl place";
	return t->work < 0 ? why_not_electrode(j, t) : why_not_turned(j, t);
}

static void feel(struct jobs *j, const struct jobs_lcm_command *c,
		 const struct touch *t)
{
	const double back_mm = fmax(j->config->probe.back_mm, BACK_LEAST_MM);
	char text[TOUCH_TEXT_MAX], id[64], name[64];

	snprintf(id, sizeof(id), "offset-%llx", (unsigned long long)c->act);
	touch_text(t, c->text, back_mm, text);
	snprintf(name, sizeof(name), "touch off %.*s",
		 (int)strcspn(text + 1, ")"), text + 1);
	mdi_run(j, c, &(struct mdi) {
		.id = id, .name = name, .text = text, .dialect = "generic",
		.measures = true,
	});
}

static void tell_put(struct jobs *j, const struct jobs_lcm_command *c,
		     const char *told)
{
	jobs_note(j, &(struct jobs_note) { .kind = "offset" }, "%s, says %s",
		  told, c->by ? c->by->name : "");
	verbs_answer(j, c, 0, told);
}

void offset_set(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	struct touch t;
	char why[TOUCH_WHY_MAX], told[TOUCH_WHY_MAX];
	const char *not;

	(void)v;
	if (touch_read(&t, j->config->axes.present, c->text, why) < 0) {
		verbs_answer(j, c, EX_DATAERR, why);
		return;
	}
	not = why_not(j, &t);
	if (not)
		verbs_answer(j, c, REFUSED, not);
	else if (t.form)
		feel(j, c, &t);
	else if (offset_put(j, &t, &j->link.snap, told))
		verbs_answer(j, c, EX_IOERR, "the store failed");
	else
		tell_put(j, c, told);
}

static int read_back(struct jobs *j, struct touch *ret)
{
	char *text = NULL;
	size_t bytes;
	int err = store_text(j->store, j->queue.job.n, &text, &bytes);

	if (err == 0)
		err = touch_of_text(ret, j->config->axes.present, text);
	free(text);
	return err;
}

const char *offset_touched(struct jobs *j)
{
	static char told[TOUCH_WHY_MAX];
	const struct shm_snapshot *s = &j->queue.snap;
	struct touch t = { .work = 0 };

	if (!j->queue.job.measures)
		return "";
	if (read_back(j, &t) < 0)
		snprintf(told, sizeof(told), "what it was to touch off is not "
			 "known; touch off once more");
	else if (!touch_is_found(&t, s))
		snprintf(told, sizeof(told), "nothing was touched off: there "
			 "was no contact");
	else if (!touch_is_one_face(&t, s))
		snprintf(told, sizeof(told), "the two contacts are askew by "
			 "more than 45 degrees, so they are not of one face, "
			 "and nothing was changed; give two places of the face "
			 "that looks that way");
	else if (offset_put(j, &t, s, told))
		snprintf(told, sizeof(told), "it was felt, but the store "
			 "failed; touch off once more");
	jobs_note(j, &(struct jobs_note) {
		.kind = t.work < 0 ? "electrode" : "offset",
		.job = j->queue.job.id,
	}, "%s", told);
	return told;
}

/* -- The list -------------------------------------------------------------- */

static json_t *row(struct jobs *j, int work, const double *mm, uint32_t set)
{
	json_t *o = json_pack("{s:s}", "work", offset_name(work));
	json_t *from = json_array(), *at = json_array();
	double at_mm[INTERP_NAXES];
	char letters[INTERP_NAXES + 1] = "", name[2] = "";
	struct interp_origin is;
	size_t n = 0;

	for (int i = 0; o && i < INTERP_NAXES; i++) {
		if (!(j->config->axes.present >> i & 1))
			continue;
		name[0] = INTERP_AXIS_LETTERS[i];
		json_object_set_new(o, name, json_real(mm[i]));
		if (set >> i & 1)
			letters[n++] = name[0];
	}
	offset_origin(j, work, mm, &is);
	for (int i = 0; i < INTERP_NAXES; i++)
		json_array_append_new(from, json_real(is.mm[i]));
	offset_place_mm(&is, &j->link.snap, at_mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		json_array_append_new(at, json_real(at_mm[i]));
	json_object_set_new(o, "touched", json_string(letters));
	json_object_set_new(o, "turn_deg", json_real(mm[WORK_TURN]));
	json_object_set_new(o, "tilt_x_deg", json_real(mm[WORK_TILT_X]));
	json_object_set_new(o, "tilt_y_deg", json_real(mm[WORK_TILT_Y]));
	json_object_set_new(o, "from_mm", from);
	json_object_set_new(o, "at_mm", at);
	return o;
}

void offset_list(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	double mm[INTERP_NC_NWORK][WORK_NROWS];
	uint32_t set[INTERP_NC_NWORK];
	json_t *all;

	(void)v;
	if (offset_read(j, 0, mm, set) < 0) {
		verbs_answer(j, c, EX_IOERR, "the store failed");
		return;
	}
	all = json_array();
	for (int i = 0; i < INTERP_NC_NWORK; i++)
		json_array_append_new(all, row(j, i, mm[i], set[i]));
	verbs_answer_json(j, c, all);
}

/* -- In force -------------------------------------------------------------- */

static void forget(struct offset *o)
{
	free(o->origins);
	*o = (struct offset) { .n = 0 };
}

/* The program that edmd has says it, also after a restart of this service. */
static int take(struct jobs *j, uint32_t n)
{
	struct offset *o = &j->offset;
	struct interp_program p;
	const void *block;
	size_t bytes;
	int err;

	forget(o);
	o->n = n;
	err = shm_program_read(&block, &bytes, j->machine, n);
	if (err < 0)
		return err;
	err = interp_program_map(&p, block, bytes);
	if (err == 0 && p.head->norigins > 0)
		o->origins = calloc(p.head->norigins, sizeof(*o->origins));
	if (o->origins) {
		o->norigins = p.head->norigins;
		memcpy(o->origins, p.origins,
		       o->norigins * sizeof(*o->origins));
	}
	shm_program_unmap(block, bytes);
	return err;
}

static const struct interp_origin *at_segment(const struct offset *o,
					      uint32_t seg)
{
	const struct interp_origin *of = NULL;

	for (uint64_t i = 0; i < o->norigins && o->origins[i].seg <= seg; i++)
		of = &o->origins[i];
	return of;
}

bool offset_now(struct jobs *j, struct interp_origin *ret)
{
	const struct shm_snapshot *s = &j->queue.snap;
	double mm[INTERP_NC_NWORK][WORK_NROWS];
	const struct interp_origin *of;

	if (!j->queue.job.n || s->program != j->queue.job.n) {
		if (offset_read(j, 0, mm, NULL) < 0)
			return false;
		offset_origin(j, 0, mm[0], ret);
		return true;
	}
	if (j->offset.n != s->program)
		take(j, s->program);
	of = at_segment(&j->offset, s->seg);
	if (!of || of->work >= INTERP_NC_NWORK)
		return false;
	*ret = *of;
	return true;
}

void offset_place_mm(const struct interp_origin *o,
		     const struct shm_snapshot *s, double ret_mm[INTERP_NAXES])
{
	const struct interp_turn t = interp_turn_of(o->turn_deg, o->mirrored);

	/* A program counts from its contacts. */
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] = (double)(s->pos[i] - s->shift[i]) * s->pulse_mm[i];
	interp_turn_back(&t, ret_mm, ret_mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] -= o->mm[i];
}

void offset_fini(struct jobs *j)
{
	forget(&j->offset);
}
