/* SPDX-License-Identifier: Apache-2.0 */
/* electrode.c - what a job asks for, and what it takes off its electrodes */
#include "electrode.h"

#include "inside.h"
#include "jobs.h"
#include "jobs_log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NOTHING_MM	1e-9

uint32_t electrode_held(struct jobs *j)
{
	return (uint32_t)store_number(j->store, "electrode", 0);
}

/* -- What the compiler gets ------------------------------------------------ */

static void put_asked(struct electrode *e, uint32_t number,
		      const double by[INTERP_NAXES])
{
	size_t i = 0;

	while (i < e->nasked && e->asked[i].number != number)
		i++;
	if (i == STORE_ELECTRODES_MAX)
		return;
	if (i == e->nasked)
		e->nasked++;
	e->asked[i] = (struct interp_electrode) { .number = number };
	memcpy(e->asked[i].by, by, sizeof(e->asked[i].by));
}

/* A job that is resumed has the electrode and the shifts with which it began,
 * whatever was measured since. */
static void as_it_began(struct jobs *j, uint32_t n,
			struct interp_electrodes *to)
{
	static struct store_worn w[INTERP_ELECTRODES_MAX];
	static struct inside a;
	const struct checkpoint_job *last = &a.base.job;
	const size_t k = store_worn_list(j->store, n, 0, w,
					 INTERP_ELECTRODES_MAX);

	/* Its sender named a place, and it has not begun yet. */
	if (inside_read(j, n, &a) < 0 || last->n == 0)
		return;
	for (size_t i = k; i-- > 0;)
		if (w[i].electrode)
			put_asked(&j->electrode, w[i].electrode, w[i].by);
	/* If the store was damaged, its rows are lost. */
	if (k == 0 && last->electrode)
		put_asked(&j->electrode, last->electrode, last->by);
	to->chosen = k ? w[0].electrode : last->electrode;
	if (to->chosen == 0)
		to->held = 0;
}

void electrode_request(struct jobs *j, const struct store_job *job,
		       uint32_t chosen, struct compiler_request *ret)
{
	static struct store_electrode all[STORE_ELECTRODES_MAX];
	const size_t n = store_electrodes(j->store, all, STORE_ELECTRODES_MAX);
	struct electrode *e = &j->electrode;

	double by[INTERP_NAXES];

	e->nasked = 0;
	for (size_t i = 0; i < n; i++) {
		store_electrode_by(&all[i], by);
		put_asked(e, all[i].n, by);
	}
	ret->electrodes.held = electrode_held(j);
	ret->electrodes.chosen = job ? job->electrode : chosen;
	ret->from.held = ret->electrodes.held;
	if (ret->goes_on && job)
		as_it_began(j, job->n, &ret->electrodes);
	memcpy(ret->electrode, e->asked, sizeof(ret->electrode));
	ret->electrodes.n = e->nasked;
	/* A text that is sent is refused; a job that is there waits. */
	ret->electrodes.unknown_ok = job != NULL;
	ret->wants_wear = !job && e->nasked > 0;
}

/* -- May it begin? --------------------------------------------------------- */

static double end_of(const struct interp_wear *w, uint32_t k)
{
	return k + 1 < w->nchanges ? w->change[k + 1].s_mm : HUGE_VAL;
}

/* What part @k takes off up to @far_mm, but for what was cut before. */
static struct interp_wear_part used(const struct interp_wear *w, uint32_t k,
				    double cut_mm, double far_mm)
{
	const double from = fmax(w->change[k].s_mm, cut_mm);
	const double to = fmin(end_of(w, k), far_mm);
	struct interp_wear_part a = interp_wear_at(w, from);
	const struct interp_wear_part b = interp_wear_at(w, fmax(from, to));

	a.wear_mm = b.wear_mm - a.wear_mm;
	a.unknown_mm = b.unknown_mm - a.unknown_mm;
	return a;
}

static double need_of(const struct interp_wear *w, double cut_mm,
		      uint32_t number)
{
	double mm = 0;

	for (uint32_t k = 0; k < w->nchanges; k++)
		if (w->change[k].number == number)
			mm += used(w, k, cut_mm, HUGE_VAL).wear_mm;
	return mm;
}

bool electrode_is_worn(const struct store_electrode *e)
{
	return (e->life_mm > 0 && e->wear_mm >= e->life_mm - NOTHING_MM) ||
	       (e->life_s > 0 && e->spark_s >= e->life_s - NOTHING_MM);
}

static bool lasts(const struct store_electrode *e, double need_mm)
{
	return e->state == ELECTRODE_THERE && !electrode_is_worn(e) &&
	       (!(e->life_mm > 0) ||
		e->life_mm - e->wear_mm >= need_mm - NOTHING_MM);
}

/* Those that would be accepted in its place. */
static void say_others(struct jobs *j, double need_mm, char *to, size_t size)
{
	static struct store_electrode all[STORE_ELECTRODES_MAX];
	const size_t n = store_electrodes(j->store, all, STORE_ELECTRODES_MAX);
	size_t at = 0;

	snprintf(to, size, "no other one is there");
	for (size_t i = 0; i < n && at + 48 < size; i++)
		if (lasts(&all[i], need_mm))
			at += (size_t)snprintf(to + at, size - at, "%s%u%s%s",
					       at ? ", " : "one of ",
					       all[i].n, *all[i].name ? " " :
					       "", all[i].name);
}

static const char *say_why_not(struct jobs *j, const struct store_electrode *e,
			       double need_mm)
{
	static char why[ELECTRODE_WHY_MAX];
	char others[160];

	say_others(j, need_mm, others, sizeof(others));
	if (e->state == ELECTRODE_ABSENT)
		snprintf(why, sizeof(why),
			 "electrode %u %s is absent; bring it "
			 "and electrode set %u state=there, or use %s",
			 e->n, e->name, e->n, others);
	else if (e->state == ELECTRODE_WORN || electrode_is_worn(e))
		snprintf(why, sizeof(why), "electrode %u %s is worn out: %.4f "
			 "mm of wear, %.1f min of sparks; dress it and "
			 "electrode set %u wear=0 sparked=0 state=there, or "
			 "use %s", e->n, e->name, e->wear_mm, e->spark_s / 60,
			 e->n, others);
	else
		snprintf(why, sizeof(why), "electrode %u %s has %.4f mm of its "
			 "life left, and the job takes about %.4f mm; a longer "
			 "life, a part of the job, or %s", e->n, e->name,
			 e->life_mm - e->wear_mm, need_mm, others);
	return why;
}

static const char *why_not(struct jobs *j, const struct interp_wear *w,
			   double cut_mm)
{
	static char why[ELECTRODE_WHY_MAX];
	struct store_electrode e;
	char others[160];

	for (uint32_t k = 0; k < w->nchanges; k++) {
		const uint32_t number = w->change[k].number;
		const double need_mm = need_of(w, cut_mm, number);

		if (number == 0 || end_of(w, k) < cut_mm)
			continue;
		if (store_electrode_find(j->store, number, &e) < 0) {
			say_others(j, need_mm, others, sizeof(others));
			snprintf(why, sizeof(why), "electrode %u is not in the "
				 "table; electrode add %u, or use %s", number,
				 number, others);
			return why;
		}
		if (!lasts(&e, need_mm))
			return say_why_not(j, &e, need_mm);
	}
	return NULL;
}

const char *electrode_check(struct jobs *j, const struct compiler_result *r)
{
	const double cut_mm = r->entry.far_mm - r->entry.from_mm +
			      r->entry.way_mm;

	return why_not(j, &r->wear, cut_mm);
}

/* -- The program that is loaded -------------------------------------------- */

/* Of a job that goes on, what was cut before. */
static double cut_before_mm(struct jobs *j, uint32_t n)
{
	static struct inside a;

	if (inside_read(j, n, &a) < 0)
		return 0;
	return a.base.snap.far_mm - a.from_mm + a.way_mm;
}

static void take_wear(struct jobs *j, uint32_t n, struct interp_wear *wear)
{
	struct electrode *e = &j->electrode;

	electrode_forget(j);
	e->wear = *wear;
	memset(wear, 0, sizeof(*wear));
	e->n = n;
	e->now = -1;
	e->cut_mm = cut_before_mm(j, n);
}

static int take(struct jobs *j, uint32_t n)
{
	struct interp_wear wear = { .nparts = 0 };
	struct interp_program p;
	const void *block;
	size_t bytes;
	int err;

	electrode_forget(j);
	err = shm_program_read(&block, &bytes, j->machine, n);
	if (err < 0)
		return err;
	err = interp_program_map(&p, block, bytes);
	if (err == 0)
		err = interp_wear_measure(&wear, &p);
	shm_program_unmap(block, bytes);
	if (err == 0)
		take_wear(j, n, &wear);
	interp_wear_free(&wear);
	return err;
}

/* As the compiler rounds it. */
static void find_by(const struct jobs *j, uint32_t number,
		    double ret[INTERP_NAXES])
{
	const struct electrode *e = &j->electrode;
	size_t i = 0;

	while (i < e->nasked && e->asked[i].number != number)
		i++;
	for (int k = 0; i < e->nasked && k < INTERP_NAXES; k++) {
		const double pulse_mm = j->config->axes.axis[k].pulse_mm;

		ret[k] = round(e->asked[i].by[k] / pulse_mm) * pulse_mm;
	}
}

/* Rows for all changes of this loading; -1 s: it has not begun to cut. */
static int add_rows(struct jobs *j)
{
	struct electrode *e = &j->electrode;
	uint32_t before;
	int err = 0;

	/* An earlier loading from which nothing came leaves no rows. */
	store_worn_drop(j->store, e->n);
	before = store_worn_next(j->store, e->n);

	for (uint32_t k = 0; k < e->wear.nchanges && err == 0; k++) {
		const uint32_t number = e->wear.change[k].number;

		e->worn[k] = (struct store_worn) {
			.job = e->n, .part = before + k,
			.electrode = number, .after_s = -1,
		};
		find_by(j, number, e->worn[k].by);
		err = store_worn_add(j->store, &e->worn[k]);
	}
	return err;
}

/* A service before this one made them. */
static void find_rows(struct jobs *j)
{
	struct electrode *e = &j->electrode;
	const uint32_t k = e->wear.nchanges;
	const uint32_t next = store_worn_next(j->store, e->n);

	memset(e->worn, 0, sizeof(e->worn));
	for (uint32_t i = 0; i < k; i++)
		e->worn[i] = (struct store_worn) {
			.job = e->n, .part = i, .after_s = -1,
			.electrode = e->wear.change[i].number,
		};
	if (next >= k)
		store_worn_list(j->store, e->n, next - k, e->worn, k);
	for (uint32_t i = 0; i < k; i++)
		if (e->worn[i].after_s >= 0)
			e->now = (int)i;
}

static void tell_load(struct jobs *j)
{
	const struct electrode *e = &j->electrode;
	struct store_electrode is;

	for (uint32_t k = 0; k < e->wear.nchanges; k++) {
		const struct interp_wear_part u = used(&e->wear, k, e->cut_mm,
						       HUGE_VAL);
		const uint32_t number = e->worn[k].electrode;

		if (number == 0 ||
		    store_electrode_find(j->store, number, &is) < 0)
			continue;
		jobs_note(j, &(struct jobs_note) {
			.kind = "electrode", .job = j->queue.job.id,
		}, "job %s: electrode %u %s shifts Z by %+.4f mm; the job "
			  "takes about %.4f mm off it%s", j->queue.job.name,
			  number, is.name, e->worn[k].by[INTERP_Z], u.wear_mm,
			  u.unknown_mm > NOTHING_MM ?
			  ", and what the conditions without a wear ratio take "
			  "is not known" : "");
	}
}

const char *electrode_load(struct jobs *j, struct interp_wear *wear)
{
	const char *why;

	take_wear(j, j->queue.job.n, wear);
	why = j->queue.job.measures ? NULL :
	      why_not(j, &j->electrode.wear, j->electrode.cut_mm);
	if (!why && add_rows(j) < 0)
		why = "the store failed";
	if (!why)
		tell_load(j);
	return why;
}

void electrode_wait(struct jobs *j, uint32_t n, const char *why)
{
	struct electrode *e = &j->electrode;

	e->refused = n;
	snprintf(e->why, sizeof(e->why), "%s", why);
}

bool electrode_waits(struct jobs *j)
{
	struct electrode *e = &j->electrode;
	struct store_job head;

	if (*e->why && (store_head(j->store, &head) < 0 ||
			head.n != e->refused))
		e->why[0] = '\0';
	return *e->why != '\0';
}

/* -- What it takes off ----------------------------------------------------- */

static double sparked_s(const struct shm_snapshot *s)
{
	return (double)s->erode_cycles * (double)s->period_ns / 1e9;
}

/* How much of the sparking of this loading was before part @k. */
static double sparked_before_s(const struct electrode *e, int k)
{
	double s = 0;

	for (int i = 0; i < k; i++)
		s += e->worn[i].after_s - e->worn[i].before_s;
	return s;
}

/* The electrode is as the row says. */
static void write_down(struct jobs *j, const struct store_worn *w)
{
	struct store_electrode e;

	store_worn_put(j->store, w);
	if (w->electrode == 0 ||
	    store_electrode_find(j->store, w->electrode, &e) < 0)
		return;
	e.wear_mm = w->after_mm;
	e.spark_s = w->after_s;
	if (electrode_is_worn(&e) && e.state == ELECTRODE_THERE)
		e.state = ELECTRODE_WORN;
	store_electrode_put(j->store, &e);
}

static void book(struct jobs *j, double far_mm, double sparked)
{
	struct electrode *e = &j->electrode;
	struct store_worn *w = &e->worn[e->now];
	const struct interp_wear_part u = used(&e->wear, (uint32_t)e->now,
					       e->cut_mm, far_mm);

	w->after_mm = w->before_mm + u.wear_mm;
	w->after_s = w->before_s + fmax(0, sparked -
					   sparked_before_s(e, e->now));
	w->known = u.unknown_mm <= NOTHING_MM;
	write_down(j, w);
}

/* Change @k was passed: its electrode is in the holder. */
static void begin(struct jobs *j, int k)
{
	struct store_worn *w = &j->electrode.worn[k];
	struct store_electrode e = { .n = 0 };

	if (w->electrode)
		store_electrode_find(j->store, w->electrode, &e);
	w->before_mm = w->after_mm = e.wear_mm;
	w->before_s = w->after_s = e.spark_s;
	w->known = true;
	store_worn_put(j->store, w);
	store_set_number(j->store, "electrode", w->electrode);
	j->electrode.now = k;
}

/* A change stops in its own segment; it was passed when a later one is
 * walked. */
static void go_to(struct jobs *j, const struct shm_snapshot *s)
{
	struct electrode *e = &j->electrode;

	for (int k = e->now + 1; k < (int)e->wear.nchanges; k++) {
		if (e->wear.change[k].seg >= s->seg)
			break;
		if (e->now >= 0)
			book(j, e->wear.change[k].s_mm, sparked_s(s));
		begin(j, k);
	}
}

void electrode_take(struct jobs *j)
{
	const uint32_t n = j->queue.job.n;

	if (j->electrode.n != n && take(j, n) == 0)
		find_rows(j);
}

void electrode_follow(struct jobs *j)
{
	electrode_take(j);
	if (j->electrode.n == j->queue.job.n)
		go_to(j, &j->queue.snap);
}

double electrode_used_mm(const struct jobs *j)
{
	const struct electrode *e = &j->electrode;

	return e->n && e->now >= 0 ?
	       used(&e->wear, (uint32_t)e->now, e->cut_mm,
		    j->queue.snap.far_mm).wear_mm : 0;
}

void electrode_book(struct jobs *j)
{
	const struct shm_snapshot *s = &j->queue.snap;

	if (j->electrode.n == j->queue.job.n && j->electrode.now >= 0)
		book(j, s->far_mm, sparked_s(s));
}

void electrode_tell(struct jobs *j)
{
	const struct electrode *e = &j->electrode;
	const struct store_worn *w = e->now >= 0 ? &e->worn[e->now] : NULL;

	if (!e->n || e->n != j->queue.job.n || !w || !w->electrode)
		return;
	jobs_note(j, &(struct jobs_note) {
		.kind = "electrode", .job = j->queue.job.id,
	}, "job %s: the wear of electrode %u was %.4f mm and is about %.4f "
		  "mm%s", j->queue.job.name, w->electrode, w->before_mm,
		  w->after_mm, w->known ? "" : ", and what the conditions "
		  "without a wear ratio took off");
}

void electrode_interrupted(struct jobs *j, const struct checkpoint_base *b)
{
	static struct store_worn all[INTERP_ELECTRODES_MAX];
	const size_t n = store_worn_list(j->store, b->job.n,
					 b->job.first_part, all,
					 INTERP_ELECTRODES_MAX);
	double before_s = 0;

	for (size_t i = 0; i < n; i++) {
		struct store_worn *w = &all[i];

		if (w->after_s < 0)
			continue;
		if (w->part == b->job.part) {
			w->after_mm = w->before_mm + b->wear_mm;
			w->after_s = w->before_s +
				     fmax(0, sparked_s(&b->snap) - before_s);
			write_down(j, w);
		}
		before_s += w->after_s - w->before_s;
	}
}

void electrode_settle(struct jobs *j, uint32_t n,
		      const struct shm_ended *ended)
{
	const double all_s = (double)ended->erode_cycles *
			     (double)ended->period_ns / 1e9;
	struct electrode *e = &j->electrode;
	double s;

	if (take(j, n) < 0)
		return;
	find_rows(j);
	for (int k = e->now < 0 ? 0 : e->now; k < (int)e->wear.nchanges &&
	     e->wear.change[k].s_mm <= ended->far_mm; k++) {
		if (k != e->now)
			begin(j, k);
		/* When the electrode was changed is not known: the last one
		 * has the time. */
		s = sparked_before_s(e, k) + e->worn[k].after_s -
		    e->worn[k].before_s;
		book(j, ended->far_mm, end_of(&e->wear, (uint32_t)k) >
		     ended->far_mm ? all_s : s);
	}
	electrode_forget(j);
}

void electrode_forget(struct jobs *j)
{
	struct electrode *e = &j->electrode;

	interp_wear_free(&e->wear);
	e->n = 0;
	e->now = -1;
}
