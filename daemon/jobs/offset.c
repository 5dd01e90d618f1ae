/* SPDX-License-Identifier: Apache-2.0 */
/* offset.c - work offsets: touched off, kept, given to the compiler */
#include "offset.h"

#include "again.h"
#include "electrode.h"
#include "keys.h"
#include "mdi.h"
#include "store_work.h"

#include <ctype.h>
#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sysexits.h>

#define BACK_LEAST_MM	0.2		/* after a contact */
#define WANTED		"a system, G54 to G59.3, and what becomes of it: X=5 " \
			"gives the place where X stands the number 5, X@5 puts " \
			"the origin at machine place 5, X=probe+ or " \
			"Z=probe-20 feels for 0, 20 mm at most, clear takes the machine file's again"

/* What one command asks for. */
struct offset_ask {
	int work;
	bool clear;
	uint32_t touch, at;		/* axes, by X=5 and X@5 */
	double mm[INTERP_NAXES];
	int probe;			/* axis; -1: none */
	char way;			/* '+' or '-' */
	double most_mm;			/* it goes; 0: to the end of the
					 * travel */
};

static const char *work_name(int work)
{
	return config_section[SECTION_WORK].instance[work];
}

static int work_find(const char *name, size_t n)
{
	for (int i = 0; i < INTERP_NC_NWORK; i++)
		if (strlen(work_name(i)) == n &&
		    strncasecmp(work_name(i), name, n) == 0)
			return i;
	return -1;
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

/* -- What a command asks for ----------------------------------------------- */

/* @what: a word, which may have others behind it, each on a line. */
static int refuse(char why[600], const char *what)
{
	const int n = (int)strcspn(what, "\n");

	snprintf(why, 600, "'%.*s'; " WANTED, n < 40 ? n : 40, what);
	return -EINVAL;
}

static int take_probe(struct offset_ask *o, int axis, const char *way,
		      const char *word, char why[600])
{
	char *end = NULL;

	/* Without a sign Z goes down; X and Y have no such side. */
	if (o->probe >= 0 || axis > INTERP_Z || !strchr("+-", *way) ||
	    (!*way && axis != INTERP_Z))
		return refuse(why, word);
	o->probe = axis;
	o->way = *way ? *way : '-';
	if (!*way || !way[1])
		return 0;
	o->most_mm = strtod(way + 1, &end);
	if (end == way + 1 || *end || strchr("+-", way[1]) ||
	    !(o->most_mm >= 1e-3 && o->most_mm <= 1e6))
		return refuse(why, word);
	return 0;
}

static int take_word(const struct jobs *j, struct offset_ask *o,
		     const char *word, char why[600])
{
	const char *at = strchr(INTERP_AXIS_LETTERS,
				toupper((unsigned char)*word));
	const int axis = at && *at ? (int)(at - INTERP_AXIS_LETTERS) : -1;
	uint32_t *of = word[0] && word[1] == '@' ? &o->at : &o->touch;
	char *end;

	if (strcasecmp(word, "clear") == 0) {
		o->clear = true;
		return 0;
	}
	if (axis < 0 || !(j->config->axes.present >> axis & 1) ||
	    (word[1] != '=' && word[1] != '@'))
		return refuse(why, word);
	if (word[1] == '=' && strncasecmp(word + 2, "probe", 5) == 0)
		return take_probe(o, axis, word + 7, word, why);
	o->mm[axis] = strtod(word + 2, &end);
	if (end == word + 2 || *end || !(fabs(o->mm[axis]) <= 1e6) ||
	    (o->touch | o->at) >> axis & 1)
		return refuse(why, word);
	*of |= 1u << axis;
	return 0;
}

static int take_all(const struct jobs *j, struct offset_ask *o,
		    const char *text, char why[600])
{
	size_t n = strcspn(text, "\n");
	char word[64];
	int err = 0;

	*o = (struct offset_ask) { .work = work_find(text, n), .probe = -1 };
	if (o->work < 0)
		return refuse(why, text);
	for (text += n; *text && err == 0; text += n) {
		text += *text == '\n';
		n = strcspn(text, "\n");
		snprintf(word, sizeof(word), "%.*s", (int)n, text);
		if (n >= sizeof(word))
			return refuse(why, word);
		if (n)
			err = take_word(j, o, word, why);
	}
	if (err == 0 && !o->clear && !o->touch && !o->at && o->probe < 0)
		return refuse(why, work_name(o->work));
	if (err == 0 && o->probe >= 0 && (o->clear || o->touch || o->at)) {
		snprintf(why, 600, "a probing motion and something else; one "
			 "axis at a time");
		return -EINVAL;
	}
	return err;
}

/* -- Carried out ----------------------------------------------------------- */

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

/* Where the machine stands has to be certain. */
static const char *why_not(const struct jobs *j, const struct offset_ask *o)
{
	const uint32_t moved = o->touch | (o->probe >= 0 ? 1u << o->probe : 0);

	if (o->probe < 0 && j->queue.job.n && !queue_is_leaving(&j->queue))
		return "a job is loaded, which has the offsets as they were; "
		       "when it has ended";
	if (moved && j->link.state != LINK_OK)
		return "edmd is not there, so it is not known where the axes "
		       "stand; systemctl start edmd";
	if (moved && o->probe < 0 && j->link.snap.state != SHM_IDLE)
		return "the machine is not idle; when it stands";
	if (moved & (j->link.snap.unplaced | (j->config->require_home ?
					      j->link.snap.unhomed : 0)))
		return "the place of this axis is not certain; edmctl home";
	return NULL;
}

static int put(struct jobs *j, const struct offset_ask *o)
{
	const struct shm_snapshot *s = &j->link.snap;
	int err = o->clear ? store_work_clear(j->store, o->work) : 0;

	for (int i = 0; i < INTERP_NAXES && err == 0; i++) {
		const double at_mm = s->pos[i] * s->pulse_mm[i];

		if (o->touch >> i & 1)
			err = store_work_put(j->store, o->work, i, at_mm -
					     o->mm[i] - shift_mm(j, i));
		else if (o->at >> i & 1)
			err = store_work_put(j->store, o->work, i, o->mm[i]);
	}
	return err;
}

/* It moves to the contact, and a little back. */
static void probe(struct jobs *j, const struct jobs_lcm_command *c,
		  const struct offset_ask *o)
{
	const double back_mm = fmax(j->config->probe.back_mm, BACK_LEAST_MM);
	const char axis = INTERP_AXIS_LETTERS[o->probe];
	char text[200], id[64], name[64], most[32] = "";

	snprintf(id, sizeof(id), "offset-%llx", (unsigned long long)c->act);
	snprintf(name, sizeof(name), "touch off %s %c%c", work_name(o->work),
		 axis, o->way);
	/* Behind the contact only distances mean anything. */
	if (o->most_mm > 0)
		snprintf(most, sizeof(most), "%.4f", o->most_mm);
	snprintf(text, sizeof(text), "(%s)\nG21 G91 F60\nG80 %c%c%s\n"
		 "G0 %c%s%.4f\nM2\n", name, axis, o->way, most, axis,
		 o->way == '+' ? "-" : "", back_mm);
	mdi_run(j, c, &(struct mdi) {
		.id = id, .name = name, .text = text, .dialect = "generic",
		.measures = OFFSET_TOUCHES + 8 * (uint32_t)o->work +
			    (uint32_t)o->probe,
	});
}

void offset_set(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	struct offset_ask o;
	char why[600];
	const char *not;

	(void)v;
	if (take_all(j, &o, c->text, why) < 0) {
		verbs_answer(j, c, EX_DATAERR, why);
		return;
	}
	not = why_not(j, &o);
	if (not)
		verbs_answer(j, c, REFUSED, not);
	else if (o.probe >= 0)
		probe(j, c, &o);
	else if (put(j, &o))
		verbs_answer(j, c, EX_IOERR, "the store failed");
	else
		verbs_answer(j, c, 0, "done");
}

void offset_touched(struct jobs *j)
{
	const struct shm_snapshot *s = &j->queue.snap;
	const uint32_t touches = j->queue.job.measures - OFFSET_TOUCHES;
	const int work = (int)(touches / 8), axis = (int)(touches % 8);
	double mm;

	if (j->queue.job.measures < OFFSET_TOUCHES || work >= INTERP_NC_NWORK)
		return;
	if (!(s->found_once >> axis & 1)) {
		jobs_note(j, &(struct jobs_note) {
			.kind = "offset", .job = j->queue.job.id,
		}, "%s %c was not touched off: there was no contact",
			  work_name(work), INTERP_AXIS_LETTERS[axis]);
		return;
	}
	mm = s->found[0][axis] * s->pulse_mm[axis] - shift_mm(j, axis);
	jobs_note(j, &(struct jobs_note) {
		.kind = "offset", .job = j->queue.job.id,
	}, store_work_put(j->store, work, axis, mm) == 0 ?
		  "%s %c touched off: its origin is at %.4f mm" :
		  "%s %c was touched off at %.4f mm, but the store failed",
		  work_name(work), INTERP_AXIS_LETTERS[axis], mm);
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
