/* SPDX-License-Identifier: Apache-2.0 */
/* interrupt.c - a job that a power cut or the death of edmd ended early */
#include "interrupt.h"

#include "inside.h"
#include "jobs.h"
#include "jobs_log.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Does the last checkpoint belong to this run of this job? */
static bool is_of_run(struct jobs *j, const struct store_job *job)
{
	const struct checkpoint *c = &j->last;
	static struct inside a;
	char hex[65];

	inside_read(j, job->n, &a);

	sodium_bin2hex(hex, sizeof(hex), c->base.job.sha256,
		       sizeof(c->base.job.sha256));
	return c->there && c->base.job.n == job->n &&
	       c->base.job.run == a.run && strcmp(hex, job->sha256) == 0;
}

/* A PLC can start a job without asking this service. */
bool interrupt_saw_begin(struct jobs *j)
{
	return is_of_run(j, &j->queue.job) &&
	       j->last.base.snap.job_cycles > 0;
}

void interrupt_init(struct jobs *j)
{
	struct store_job job;

	j->unseen |= (uint32_t)store_number(j->store, "elsewhere", 0);
	j->interrupted[0] = '\0';
	if (store_interrupted(j->store, &job) == 0)
		snprintf(j->interrupted, sizeof(j->interrupted), "%s", job.id);
}

/* Take the totals of the job from the checkpoint. */
static void take_sums(struct queue *q, const struct checkpoint_base *b)
{
	q->snap = b->snap;
	q->depth_mm = b->snap.depth_mm;
}

static void say_when(char *to, size_t size, int64_t utime)
{
	const time_t at = (time_t)(utime / 1000000);
	struct tm tm;

	localtime_r(&at, &tm);
	strftime(to, size, "%Y-%m-%d %H:%M:%S", &tm);
}

/* -- Axes that nothing measures ------------------------------------------- */

/* Axes that cannot be homed: they stand where an operator says. */
static uint32_t unhomeable(const struct jobs *j)
{
	uint32_t axes = 0;

	for (uint32_t i = 0; i < INTERP_NAXES; i++)
		if (j->config->manual[i].method == 0)
			axes |= 1u << i;
	return axes & j->config->axes.present;
}

static void set_unseen(struct jobs *j, uint32_t what)
{
	if (what == j->unseen)
		return;
	j->unseen = what;
	store_set_number(j->store, "elsewhere", what);
}

static void note_unseen(struct jobs *j, uint32_t axes)
{
	set_unseen(j, axes | j->unseen);
}

void interrupt_answered(struct jobs *j)
{
	set_unseen(j, 0);
}

/*
 * What was seen last of an axis that nothing measures is kept as the way from
 * where it is shown, so that it is still right when the axis was jogged.
 */
#define NOT_SEEN	INT64_MIN

static const char *key_of(const char *what, int axis)
{
	static char key[16];

	snprintf(key, sizeof(key), "%s %c", what, INTERP_AXIS_LETTERS[axis]);
	return key;
}

static const char *way_key(int axis)
{
	return key_of("seen-nm", axis);
}

static const char *own_key(int axis)
{
	return key_of("own-nm", axis);
}

static double shown_mm(const struct shm_snapshot *s, int axis)
{
	return s->pos[axis] * s->pulse_mm[axis];
}

/* What an absolute drive counts where its axis is shown at 0, mm; NAN: there is
 * none, or it is not up. */
static double own_mm(const struct jobs *j, const struct shm_snapshot *s, int i)
{
	const struct config_drive *d = &j->config->drive[i];

	if (!s->has_origin || !d->absolute)
		return (double)NAN;
	return (s->origin[i] * d->pulses / d->increments + s->home_shift[i]) *
	       s->pulse_mm[i];
}

/* The place of axis @i that its drive tells, which was not asleep while the
 * power was off; NAN: nothing tells.  A drive counts modulo 2^32. */
static double told_mm(struct jobs *j, int i)
{
	const struct config_drive *d = &j->config->drive[i];
	const struct shm_snapshot *s = &j->link.snap;
	const int64_t then = store_number(j->store, own_key(i), NOT_SEEN);
	const double turn_mm = 0x1p32 * d->pulses / d->increments *
			       s->pulse_mm[i];

	if (then == NOT_SEEN)
		return (double)NAN;
	return shown_mm(s, i) + remainder(own_mm(j, s, i) - 1e-6 * (double)then,
					  turn_mm);
}

/* NAN contradicts nothing. */
static bool contradicts(const struct jobs *j, double told, double mm)
{
	return fabs(told - mm) > j->config->can402.resync_mm;
}

static void keep_own(struct jobs *j, const struct shm_snapshot *was, int i)
{
	const double own = own_mm(j, was, i);

	if (was->axes_key != j->link.snap.axes_key)
		store_set_number(j->store, own_key(i), NOT_SEEN);
	else if (!isnan(own) && !(j->unseen >> i & 1))
		store_set_number(j->store, own_key(i), llround(own * 1e6));
}

/* The places of this edmd are not those of the one before; @was NULL: nobody
 * knows what that showed. */
static void keep_seen(struct jobs *j, const struct shm_snapshot *was)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		const bool doubt = j->unseen >> i & 1;
		int64_t way = doubt ? store_number(j->store, way_key(i), 0) : 0;

		if (!(unhomeable(j) >> i & 1))
			continue;
		if (!was)
			way = NOT_SEEN;
		else if (way != NOT_SEEN)
			way += llround((shown_mm(was, i) -
					shown_mm(&j->link.snap, i)) * 1e6);
		store_set_number(j->store, way_key(i), way);
		if (was)
			keep_own(j, was, i);
	}
}

#define NOT_UP	"the drives are not up yet; edmd's journal tells which; again " \
		"when they are"

/* Its drive knows where it stands, and was not asked yet. */
static bool is_asleep(const struct jobs *j, int i)
{
	return j->drives_to_ask && j->config->drive[i].absolute;
}

/* Was axis @i moved while edmd was away, as its drive tells?  NULL, or that. */
static const char *moved(struct jobs *j, int i)
{
	const int64_t way = store_number(j->store, way_key(i), 0);
	const double told = told_mm(j, i);
	const double seen = shown_mm(&j->link.snap, i) + 1e-6 * (double)way;
	static char text[160];

	if (way == NOT_SEEN || !contradicts(j, told, seen))
		return NULL;
	snprintf(text, sizeof(text), "%c was seen last at %.3f, and its drive "
		 "tells %.3f: it was moved; look, and place %c is MM",
		 INTERP_AXIS_LETTERS[i], seen, told, INTERP_AXIS_LETTERS[i]);
	return text;
}

const char *interrupt_as_seen(struct jobs *j, int axis, double *ret_mm)
{
	const bool in_doubt = (j->unseen | (*j->interrupted ? unhomeable(j) :
						       0)) >> axis & 1;
	const int64_t way = store_number(j->store, way_key(axis), 0);
	struct shm_snapshot s;
	double told;

	if (!in_doubt)
		return "this axis is shown where it was seen last; place AXIS "
		       "is MM says another place";
	if (way == NOT_SEEN)
		return "nobody knows where it was seen last; look, and place "
		       "AXIS is MM";
	if (!j->link.status || !shm_snapshot(j->link.status, &s))
		return "edmd is not there";
	*ret_mm = shown_mm(&s, axis) + 1e-6 * (double)way;
	if (is_asleep(j, axis))
		return NOT_UP;
	told = told_mm(j, axis);
	if (!isnan(told))
		*ret_mm = told;
	return moved(j, axis);
}

const char *interrupt_placed(struct jobs *j, int axis, double mm)
{
	const double told = told_mm(j, axis);
	static char text[160];
	const int n = snprintf(text, sizeof(text), "%c was shown at %.3f; "
			       "somebody says that it stands at %.3f",
			       INTERP_AXIS_LETTERS[axis],
			       shown_mm(&j->link.snap, axis), mm);

	if (contradicts(j, told, mm))
		snprintf(text + n, sizeof(text) - (size_t)n,
			 ", and its drive tells %.3f", told);
	jobs_note(j, &(struct jobs_note) { .kind = "placed" }, "%s", text);
	store_set_number(j->store, way_key(axis), 0);
	store_set_number(j->store, own_key(axis), NOT_SEEN);
	set_unseen(j, j->unseen & ~(1u << axis));
	return text;
}

const char *interrupt_told(struct jobs *j, uint32_t axes)
{
	static char text[160];

	for (axes &= unhomeable(j); axes; axes &= axes - 1) {
		const int i = __builtin_ctz(axes);
		const double shown = shown_mm(&j->link.snap, i);
		const double told = told_mm(j, i);

		if (is_asleep(j, i))
			return NOT_UP;
		if (!contradicts(j, told, shown))
			continue;
		snprintf(text, sizeof(text), "%c is shown at %.3f, and its "
			 "drive tells that it stands at %.3f: edmctl place "
			 "%c is MM, as it stands", INTERP_AXIS_LETTERS[i],
			 shown, told, INTERP_AXIS_LETTERS[i]);
		return text;
	}
	return NULL;
}

void interrupt_tick(struct jobs *j)
{
	if (!j->drives_to_ask || !j->link.snap.has_origin)
		return;
	j->drives_to_ask = false;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const char *why = unhomeable(j) >> i & 1 ? moved(j, i) : NULL;

		if (!why)
			continue;
		note_unseen(j, 1u << i);
		queue_wait(j);
		jobs_note(j, &(struct jobs_note) { .kind = "waits" }, "%s",
			  why);
	}
}

const char *interrupt_unseen(const struct jobs *j)
{
	if (j->unseen & STORE_UNSEEN)
		return "the store was damaged or gone; see what is left of "
		       "work offsets, electrodes and queue, then edmctl start";
	return j->unseen ? "an axis that cannot be homed was last seen at "
	       "another place than is shown; edmctl status names it; see where "
	       "it stands: edmctl place AXIS as-seen if it was not moved, or "
	       "place AXIS is MM, or edmctl start if what is shown is right" :
	       NULL;
}

/* Did this edmd take up the places of the one before?  After a power cut the
 * object in which they were is a new one. */
static bool goes_on(struct jobs *j, const struct shm_snapshot *before)
{
	const struct shm_snapshot *s = &j->link.snap;
	const int64_t born = (int64_t)j->link.status->born;
	const bool same = store_number(j->store, "born", 0) == born;

	store_set_number(j->store, "born", born);
	return same && s->axes_key == before->axes_key &&
	       memcmp(s->pulse_mm, before->pulse_mm, sizeof(s->pulse_mm)) == 0;
}

void interrupt_attach(struct jobs *j)
{
	const struct shm_snapshot *was = &j->last.base.snap, *s = &j->link.snap;
	char places[INTERP_NAXES * 48] = "";
	uint32_t axes = 0;
	size_t n = 0;

	if (goes_on(j, was))
		return;
	keep_seen(j, j->last.there ? was : NULL);
	j->drives_to_ask = true;
	if (!j->last.there)
		return;
	for (uint32_t i = 0; i < INTERP_NAXES; i++) {
		const double then_mm = was->pos[i] * was->pulse_mm[i];
		const double now_mm = s->pos[i] * s->pulse_mm[i];

		if (!(unhomeable(j) >> i & 1) ||
		    fabs(then_mm - now_mm) < 0.6 * s->pulse_mm[i])
			continue;
		axes |= 1u << i;
		n += (size_t)snprintf(places + n, sizeof(places) - n,
				      "%s%c at %.3f, now shown at %.3f",
				      n ? "; " : "", INTERP_AXIS_LETTERS[i],
				      then_mm, now_mm);
	}
	if (!axes)
		return;
	note_unseen(j, axes);
	queue_wait(j);
	jobs_note(j, &(struct jobs_note) { .kind = "waits" },
		  "edmd was started anew, and nothing measures where the axes "
		  "stand: last seen %s; see where each stands: edmctl place "
		  "AXIS as-seen if it was not moved, or place AXIS is MM; then "
		  "edmctl resume JOB if one was interrupted, else edmctl start",
		  places);
}

/* -- The job -------------------------------------------------------------- */

static void keep(struct jobs *j, const struct checkpoint *c)
{
	static struct inside a;
	const struct shm_snapshot *s = &a.base.snap;
	char reason[320], when[32];

	note_unseen(j, unhomeable(j));
	inside_interrupted(j, j->queue.job.n, &c->base, &a);
	inside_write(j, j->queue.job.n, &a);
	take_sums(&j->queue, &a.base);
	say_when(when, sizeof(when), c->utime);
	snprintf(reason, sizeof(reason), "interrupted in %s, line %u, at %.3f "
		 "mm of %.3f, cut to %.3f mm; last seen %s; if the host did not "
		 "go down, edmd's log says why",
		 shm_state_name(s->state), s->line, s->place_mm, s->length_mm,
		 s->far_mm, when);
	queue_end(j, JOB_INTERRUPTED, reason);
	interrupt_init(j);
}

/* It went down before a checkpoint of this run was on the disk. */
static void keep_before(struct jobs *j)
{
	static struct inside a;
	char reason[320];

	if (inside_read(j, j->queue.job.n, &a) < 0 || inside_is_named(&a)) {
		queue_end(j, JOB_STOPPED, "the host or edmd went down in it, "
			  "and no checkpoint of it is left: where it was is "
			  "not known");
		return;
	}
	take_sums(&j->queue, &a.base);
	snprintf(reason, sizeof(reason), "interrupted again, and no checkpoint "
		 "of what was done since the resume is left; before it, it was "
		 "cut to %.3f mm", a.base.snap.far_mm);
	note_unseen(j, unhomeable(j));
	queue_end(j, JOB_INTERRUPTED, reason);
	interrupt_init(j);
}

void interrupt_take(struct jobs *j)
{
	const struct checkpoint *c = &j->last;
	struct queue *q = &j->queue;

	if (!is_of_run(j, &q->job)) {
		keep_before(j);
		return;
	}
	electrode_interrupted(j, &c->base);
	take_sums(q, &c->base);
	/* The checkpoint has the end of the job, but the store did not get
	 * it. */
	if (!c->base.snap.loaded && c->base.snap.outcome == SHM_OUTCOME_DONE)
		queue_end(j, JOB_DONE, "");
	else if (!c->base.snap.loaded && c->base.snap.outcome)
		queue_end(j, JOB_STOPPED, "by command, or after a fault");
	else
		keep(j, c);
}

const char *interrupt_lost(const struct jobs *j)
{
	static char letters[INTERP_NAXES + 1];
	const uint32_t lost = j->link.snap.unhomed | j->unseen |
			      (*j->interrupted ? unhomeable(j) : 0);

	return jobs_axes(lost & j->config->axes.present, letters);
}
