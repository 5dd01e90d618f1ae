/* SPDX-License-Identifier: Apache-2.0 */
/* tally.c - what the job in the machine comes to */
#include "tally.h"
#include "inside.h"
#include "faults.h"
#include "jobs.h"
#include "store_tally.h"

#include "interp/tech_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define CALLED_US	180000000	/* a condition was called, then at most
					 * so often */
#define STOOD_US	10000000	/* it stands */
#define TRAIL_US	1800000000
#define STEPS		2000.0		/* in the path, at first */
#define STEP_MIN_MM	0.001

/* -- Sums ------------------------------------------------------------------ */

static struct tally_sums sums_of(const struct shm_snapshot *s)
{
	const double period_s = (double)s->period_ns / 1e9;

	return (struct tally_sums) {
		.job_s = (double)s->job_cycles * period_s,
		.erode_s = (double)s->erode_cycles * period_s,
		.energy_j = s->energy_j, .jumps = s->jumps,
		.retracts = s->retracts, .shorts = s->shorts, .arcs = s->arcs,
	};
}

/* A checkpoint may be a little older than what was seen.  Then nothing is added
 * until the sums have come up to it again. */
static double more(double now, double *seen)
{
	const double d = now > *seen ? now - *seen : isnan(now) ? NAN : 0;

	*seen += d;
	return d;
}

static uint32_t count(uint32_t now, uint32_t *seen)
{
	const uint32_t d = now > *seen ? now - *seen : 0;

	*seen += d;
	return d;
}

static struct tally_row *row_of(struct tally *t, const char *condition)
{
	for (uint32_t i = 0; i < t->nrows; i++)
		if (strcmp(t->row[i].condition, condition) == 0)
			return &t->row[i];
	if (t->nrows == TALLY_CONDITIONS)
		return &t->row[t->nrows - 1];
	if (t->nrows == TALLY_CONDITIONS - 1)
		condition = "others";
	snprintf(t->row[t->nrows].condition, sizeof(t->row[0].condition), "%s",
		 condition);
	return &t->row[t->nrows++];
}

static void add(struct tally *t, const struct tally_sums *now,
		const char *condition)
{
	struct tally_sums *seen = &t->seen, *to;

	if (now->job_s <= seen->job_s && now->shorts <= seen->shorts &&
	    t->nrows > 0)
		return;
	to = &row_of(t, condition)->sums;
	to->job_s += more(now->job_s, &seen->job_s);
	to->erode_s += more(now->erode_s, &seen->erode_s);
	to->energy_j += more(now->energy_j, &seen->energy_j);
	to->jumps += count(now->jumps, &seen->jumps);
	to->retracts += count(now->retracts, &seen->retracts);
	to->shorts += count(now->shorts, &seen->shorts);
	to->arcs += count(now->arcs, &seen->arcs);
}

static void name_condition(char to[16], const struct shm_snapshot *s)
{
	to[0] = '\0';
	if (s->cond_letter)
		interp_tech_name(s->cond_letter, s->cond_number, to, 16);
}

/* -- Trail ----------------------------------------------------------------- */

static void drop_every_second(struct tally *t)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i < t->npoints; i += 2)
		t->point[n++] = t->point[i];
	t->npoints = n;
	t->step_mm *= 2;
}

static void keep_point(struct tally *t, const struct tally_point *p)
{
	if (t->npoints == TALLY_POINTS)
		drop_every_second(t);
	t->point[t->npoints++] = *p;
}

static double distance(const struct tally_point *a, const struct tally_point *b)
{
	const double x = a->mm[0] - b->mm[0], y = a->mm[1] - b->mm[1];
	const double z = a->mm[2] - b->mm[2];

	return sqrt(x * x + y * y + z * z);
}

/* Ways back, jumps and escapes are no part of it. */
static bool is_on_its_way(const struct shm_snapshot *s)
{
	return s->state == SHM_TRAVEL || s->state == SHM_APPROACH ||
	       s->state == SHM_ERODE || s->state == SHM_PROBE;
}

/* @edge: it is the beginning or the end, whatever the state. */
static void follow_trail(struct tally *t, const struct shm_snapshot *s,
			 bool edge)
{
	const struct tally_point *last = t->npoints ?
					 &t->point[t->npoints - 1] : NULL;
	const bool under_power = is_on_its_way(s) && s->state != SHM_TRAVEL;
	struct tally_point p = { .place_mm = s->place_mm,
				 .cut = t->under_power };

	if (!edge && !is_on_its_way(s))
		return;
	t->under_power = under_power;
	for (int i = 0; i < 3; i++)
		p.mm[i] = s->pos[i] * s->pulse_mm[i];
	if (!last) {
		t->length_mm = s->length_mm;
		t->step_mm = fmax(s->length_mm / STEPS, STEP_MIN_MM);
		keep_point(t, &p);
	} else if (p.place_mm > last->place_mm &&
		   (distance(&p, last) >= t->step_mm || edge ||
		    p.cut != last->cut)) {
		keep_point(t, &p);
	}
}

static void note_retract(struct tally *t, const struct shm_event *e,
			 double place_mm)
{
	const double part = t->length_mm > 0 ? place_mm / t->length_mm : 0;
	const double at = floor(part * TALLY_SPOTS);
	struct tally_spot *s = &t->spot[at < 0 ? 0 : at >= TALLY_SPOTS ?
					TALLY_SPOTS - 1 : (int)at];

	s->place_mm = place_mm;
	s->line = e->line;
	s->retracts++;
	t->retracted_ns = e->time_ns;
}

/* -- A job ----------------------------------------------------------------- */

static void begin(struct jobs *j, uint32_t n)
{
	struct tally *t = &j->tally;

	if (t->n == n)
		return;
	*t = (struct tally) { .n = n };
	if (n == 0)
		return;
	tally_read(j, t);
	t->goes_on = inside_read(j, n, &t->again) == 0;
}

static void make_whole(const struct tally *t, struct shm_snapshot *s)
{
	if (t->goes_on)
		inside_whole(&t->again, s);
}

/* Places of an event are those of the program that was loaded. */
static double whole_place_mm(const struct tally *t, double place_mm)
{
	const struct inside *a = &t->again;

	if (!t->goes_on)
		return place_mm;
	return fmax(a->from_mm, place_mm - a->way_mm + a->from_mm);
}

static bool used_is_due(const struct jobs *j, const char *condition,
			bool stands, int64_t now_us)
{
	const struct tally *t = &j->tally;

	if (stands && !t->stood)
		return now_us - t->used_us >= STOOD_US;
	return (j->calls.n > 0 || strcmp(condition, t->written) != 0) &&
	       now_us - t->used_us >= CALLED_US;
}

static void write_due(struct jobs *j, const struct shm_snapshot *s,
		      int64_t now_us)
{
	const bool stands = s->state == SHM_HOLD || s->state == SHM_FAULT;
	struct tally *t = &j->tally;
	char condition[16];

	name_condition(condition, s);
	if (used_is_due(j, condition, stands, now_us)) {
		calls_write(j);
		tally_write_used(j, t);
		snprintf(t->written, sizeof(t->written), "%s", condition);
		t->used_us = now_us;
		t->stood = stands;
	}
	t->stood = t->stood && stands;
	if (t->trail_us == 0)
		t->trail_us = now_us;
	if (now_us - t->trail_us < TRAIL_US)
		return;
	tally_write_trail(j, t);
	t->trail_us = now_us;
}

void tally_look(struct jobs *j, int64_t now_us)
{
	struct shm_snapshot whole = j->queue.snap;
	struct tally *t = &j->tally;
	struct tally_sums now;
	char condition[16];

	begin(j, j->queue.job.n);
	if (t->n == 0 || whole.program != t->n)
		return;
	if (whole.job_cycles == 0 && !t->goes_on) {
		t->npoints = 0;
		follow_trail(t, &whole, true);
	}
	if (whole.job_cycles == 0)
		return;
	make_whole(t, &whole);
	name_condition(condition, &whole);
	now = sums_of(&whole);
	add(t, &now, condition);
	follow_trail(t, &whole, false);
	write_due(j, &whole, now_us);
}

void tally_event(struct jobs *j, const struct shm_event *e, bool again)
{
	struct tally *t = &j->tally;
	double place_mm;

	if (!j->queue.job.n || e->program != j->queue.job.n)
		return;
	begin(j, j->queue.job.n);
	place_mm = whole_place_mm(t, e->place_mm);
	if (e->kind == SHM_EV_STATE && e->code == SHM_RETRACT &&
	    !(again && e->time_ns <= t->retracted_ns))
		note_retract(t, e, place_mm);
	if (e->kind == SHM_EV_FAULT)
		store_fault(j->store, t->n, &(struct store_fault) {
			.time_ns = e->time_ns, .line = e->line,
			.fault = fault_name((uint32_t)e->code),
			.place_mm = place_mm,
		});
}

static void write_all(struct jobs *j, const struct tally *t)
{
	calls_write(j);
	if (t->nrows)
		tally_write_used(j, t);
	if (t->npoints)
		tally_write_trail(j, t);
}

void tally_end(struct jobs *j, const struct shm_snapshot *whole, bool over)
{
	struct tally *t = &j->tally;
	struct tally_sums now = sums_of(whole);
	char condition[16];

	begin(j, j->queue.job.n);
	if (t->n == 0 || whole->job_cycles == 0)
		return;
	name_condition(condition, whole);
	add(t, &now, condition);
	if (over)
		follow_trail(t, whole, true);
	write_all(j, t);
}

void tally_forget(struct jobs *j)
{
	j->tally.n = 0;
}

void tally_settle(struct jobs *j, uint32_t n, const struct shm_ended *e)
{
	const double period_s = (double)e->period_ns / 1e9;
	const struct tally_sums now = {
		.job_s = (double)e->job_cycles * period_s,
		.erode_s = (double)e->erode_cycles * period_s,
		.energy_j = e->energy_j, .jumps = e->jumps,
		.retracts = e->retracts, .shorts = e->shorts, .arcs = e->arcs,
	};

	static struct tally other;
	struct tally *t = &j->tally;

	if (t->n != n) {
		t = &other;
		*t = (struct tally) { .n = n };
		tally_read(j, t);
	}
	add(t, &now, "unknown");
	write_all(j, t);
}
