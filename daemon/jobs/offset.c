/* SPDX-License-Identifier: Apache-2.0 */
/* offset.c - work offsets: touched off, kept, given to the compiler */
#include "offset.h"

#include "again.h"
#include "electrode.h"
#include "keys.h"
#include "mdi.h"
#include "store_work.h"
#include "touch.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define BACK_LEAST_MM	0.2		/* after a contact */

static const char *work_name(int work)
{
	return config_section[SECTION_WORK].instance[work];
}

/* -- For the compiler ------------------------------------------------------ */

/* A job that goes on after an interruption has those of its beginning. */
static bool goes_on(struct jobs *j, const struct store_job *job)
{
	static struct again a;

	return again_read(j, job->n, &a) == 0 && !again_is_named(&a);
}

int offset_request(struct jobs *j, const struct store_job *job,
		   struct compiler_request *ret)
{
	int err = 0;

	memcpy(ret->work_mm, j->config->work_offset_mm, sizeof(ret->work_mm));
	if (job && !goes_on(j, job))
		err = store_work_keep(j->store, job->n);
	return err ? -EIO : store_work_read(j->store, job ? job->n : 0,
					    ret->work_mm, NULL);
}

/* -- Written down, and told ------------------------------------------------ */

/* What Z of a program is shifted by now. */
static double shift_mm(struct jobs *j, int axis)
{
	const uint32_t held = electrode_held(j);
	struct store_electrode e;

	if (axis != INTERP_Z || held == 0 ||
	    store_electrode_find(j->store, held, &e) < 0)
		return 0;
	return e.length_mm - e.wear_mm;
}

/* Of every axis: what it was, and what it is. */
static void tell(const struct jobs *j, int work, const double *was,
		 const double *is, char to[TOUCH_WHY_MAX])
{
	const size_t size = TOUCH_WHY_MAX;
	size_t n = (size_t)snprintf(to, size, "%s:", work_name(work));

	for (int i = 0; i < INTERP_NAXES && n < size; i++) {
		const struct interp_axis_limits *a = &j->config->axes.axis[i];

		if (was[i] == is[i])
			continue;
		n += (size_t)snprintf(to + n, size - n, "%s %c was %.4f, is "
				      "%.4f%s", to[n - 1] == ':' ? "" : ";",
				      INTERP_AXIS_LETTERS[i], was[i], is[i],
				      is[i] < a->travel_min_mm ||
				      is[i] > a->travel_max_mm ?
				      ", beyond the travel" : "");
	}
	if (n < size && to[n - 1] == ':')
		snprintf(to + n, size - n, " as it was");
}

static int put_axes(struct jobs *j, const struct touch *t,
		    const struct shm_snapshot *s)
{
	const uint32_t counts = t->form ? t->felt : t->here;
	int err = t->clear ? store_work_clear(j->store, t->work) : 0;

	for (int i = 0; i < INTERP_NAXES && err == 0; i++) {
		if (counts >> i & 1)
			err = store_work_put(j->store, t->work, i,
					     touch_zero_mm(t, s, i) -
					     shift_mm(j, i));
		else if (t->at >> i & 1)
			err = store_work_put(j->store, t->work, i, t->mm[i]);
	}
	return err;
}

static int put_work(struct jobs *j, const struct touch *t,
		    const struct shm_snapshot *s, char told[TOUCH_WHY_MAX])
{
	double was[INTERP_NC_NWORK][INTERP_NAXES];
	double is[INTERP_NC_NWORK][INTERP_NAXES];
	int err;

	memcpy(was, j->config->work_offset_mm, sizeof(was));
	memcpy(is, was, sizeof(is));
	err = store_work_read(j->store, 0, was, NULL);
	if (err == 0)
		err = put_axes(j, t, s);
	if (err == 0)
		err = store_work_read(j->store, 0, is, NULL);
	if (err == 0)
		tell(j, t->work, was[t->work], is[t->work], told);
	return err;
}

/* Without a number the face is the reference of the machine file. */
static int put_electrode(struct jobs *j, const struct touch *t,
			 const struct shm_snapshot *s, char told[TOUCH_WHY_MAX])
{
	const double face_mm = t->here ? 0 : j->config->measure.reference_z_mm;

	return electrode_put_length(j, t->electrode,
				    touch_zero_mm(t, s, INTERP_Z) - face_mm,
				    t->is_new, told);
}

static int put(struct jobs *j, const struct touch *t,
	       const struct shm_snapshot *s, char told[TOUCH_WHY_MAX])
{
	return t->work >= 0 ? put_work(j, t, s, told) :
			      put_electrode(j, t, s, told);
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
	else
		return electrode_no_length(&e, t->is_new);
	return why;
}

/* Where the machine stands has to be certain. */
static const char *why_not(struct jobs *j, const struct touch *t)
{
	const uint32_t moved = t->here | t->felt |
			       (t->form == TOUCH_BOSS ? 1u << INTERP_Z : 0);

	if (!t->form && j->queue.job.n && !queue_is_leaving(&j->queue))
		return "a job is loaded, which has the offsets as they were; "
		       "when it has ended";
	if (moved && j->link.state != LINK_OK)
		return "edmd is not there, so it is not known where the axes "
		       "stand; systemctl start edmd";
	if (moved && !t->form && j->link.snap.state != SHM_IDLE)
		return "the machine is not idle; when it stands";
	if (moved & (j->link.snap.unplaced | (j->config->require_home ?
					      j->link.snap.unhomed : 0)))
		return "the place of this axis is not certain; edmctl home, or "
		       "edmctl place";
	return t->work < 0 ? why_not_electrode(j, t) : NULL;
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
	else if (put(j, &t, &j->link.snap, told))
		verbs_answer(j, c, EX_IOERR, "the store failed");
	else
		verbs_answer(j, c, 0, told);
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
			 "known; once more");
	else if (!touch_is_found(&t, s))
		snprintf(told, sizeof(told), "nothing was touched off: there "
			 "was no contact");
	else if (put(j, &t, s, told))
		snprintf(told, sizeof(told), "it was felt, but the store "
			 "failed; once more");
	jobs_note(j, &(struct jobs_note) {
		.kind = t.work < 0 ? "electrode" : "offset",
		.job = j->queue.job.id,
	}, "%s", told);
	return told;
}

/* -- The list -------------------------------------------------------------- */

static json_t *row(const struct jobs *j, int work, const double *mm,
		   uint32_t set)
{
	json_t *o = json_pack("{s:s}", "work", work_name(work));
	char letters[INTERP_NAXES + 1] = "", name[2] = "";
	size_t n = 0;

	for (int i = 0; o && i < INTERP_NAXES; i++) {
		if (!(j->config->axes.present >> i & 1))
			continue;
		name[0] = INTERP_AXIS_LETTERS[i];
		json_object_set_new(o, name, json_real(mm[i]));
		if (set >> i & 1)
			letters[n++] = name[0];
	}
	json_object_set_new(o, "touched", json_string(letters));
	return o;
}

void offset_list(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	double mm[INTERP_NC_NWORK][INTERP_NAXES];
	uint32_t set[INTERP_NC_NWORK];
	json_t *all;

	(void)v;
	memcpy(mm, j->config->work_offset_mm, sizeof(mm));
	if (store_work_read(j->store, 0, mm, set) < 0) {
		verbs_answer(j, c, EX_IOERR, "the store failed");
		return;
	}
	all = json_array();
	for (int i = 0; i < INTERP_NC_NWORK; i++)
		json_array_append_new(all, row(j, i, mm[i], set[i]));
	verbs_answer_json(j, c, all);
}
