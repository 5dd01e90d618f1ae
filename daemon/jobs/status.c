/* SPDX-License-Identifier: Apache-2.0 */
/* status.c - STATUS, from edmd's snapshot and the loaded job */
#include "faults.h"
#include "interrupt.h"
#include "jobs.h"
#include "offset.h"
#include "offset_put.h"

#include "interp/setting_text.h"
#include "interp/tech_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define GRACE_US	300000		/* time to find edmd after the start */

/* If anything of this changes, STATUS is sent at once. */
static uint64_t key_of(const struct jobs *j)
{
	const struct shm_snapshot *s = &j->link.snap;

	return (uint64_t)j->link.state << 60 | (uint64_t)(s->state & 15) << 56 |
	       (uint64_t)(s->fault & 255) << 48 |
	       (uint64_t)(*store_why(j->store) != 0) << 47 |
	       (uint64_t)j->queue.job.state << 44 |
	       (uint64_t)(j->queue.behind & 0xfff) << 32 |
	       (uint64_t)(s->stand & 15) << 28 |
	       (uint64_t)s->confirmed << 27 | (j->queue.job.n & 0x7ffffff);
}

static void name_condition(char to[16], const struct shm_snapshot *s)
{
	to[0] = '\0';
	if (s->cond_letter)
		interp_tech_name(s->cond_letter, s->cond_number, to, 16);
}

/* The simulated machine may have a quicker clock. */
static double end_s(const struct jobs *j, double left_s)
{
	const double speed = config_machine_is(j->config, MACHINE_MODEL) ?
			     (double)j->config->sim.speed : 1;

	return (double)jobs_utime() / 1e6 + left_s / speed;
}

/* Without an estimate the share is that of the way. */
static void fill_time(struct jobs_lcm_status *w, const struct jobs *j)
{
	const struct shm_snapshot *s = &j->queue.snap;
	struct eta_told t = { .left_s = -1, .min_s = -1, .max_s = -1 };
	const double passed_s = eta_passed_s(&j->eta);

	if (j->eta.n && j->eta.n == j->queue.job.n)
		eta_tell(&j->eta, &t);
	w->job_s = (double)s->job_cycles * (double)s->period_ns / 1e9;
	w->eta_s = t.left_s;
	w->eta_min_s = t.min_s;
	w->eta_max_s = t.max_s;
	w->eta_by = eta_word(t.by);
	w->end_s = t.left_s >= 0 && j->queue.job.state == JOB_RUNNING ?
		   end_s(j, t.left_s) : 0;
	w->queue_s = j->queue.behind_s;
	w->queue_untold = j->queue.untold;
	w->queue_end_s = end_s(j, fmax(0, t.left_s) + w->queue_s);
	if (t.by)
		w->eta_condition = j->eta.forecast.cond[t.cond];
	w->eta_factor = t.factor;
	w->progress = t.left_s >= 0 && passed_s + t.left_s > 0 ?
		      passed_s / (passed_s + t.left_s) :
		      s->length_mm > 0 ? s->far_mm / s->length_mm : 0;
}

static void fill_job(struct jobs_lcm_status *w, const struct jobs *j)
{
	const struct queue *q = &j->queue;
	const struct shm_snapshot *s = &q->snap;

	w->job = q->job.id;
	w->job_name = q->job.name;
	w->job_state = q->job.n ? store_state_name(q->job.state) : "";
	w->lines = q->job.lines;
	w->line = s->line;
	w->place_mm = s->place_mm;
	w->length_mm = s->length_mm;
	w->depth_mm = s->depth_mm;
	w->depth_far_mm = s->depth_far_mm;
	w->jumps = s->jumps;
	w->retracts = s->retracts;
	w->shorts = s->shorts;
	w->hunts = s->hunts;
	fill_time(w, j);
	w->queue_len = q->behind;
}

/* The job may have planes of its own. */
static double height_mm(const struct jobs *j)
{
	struct interp_wire w = j->config->wire;
	struct interp_setting set;
	struct interp_diag none;

	interp_setting_read(j->queue.job.setting, &set, &w, &none);
	return config_wire_height_mm(j->config, &w);
}

static void fill_machine(struct jobs_lcm_status *w, const struct jobs *j)
{
	const struct machine_config *c = j->config;
	const struct link *l = &j->link;
	const struct shm_snapshot *s = &l->snap;
	static char faults[512];
	bool there = l->state == LINK_OK;

	w->daemon = link_state_name(l->state);
	w->state = there ? shm_state_name(s->state) : "unknown";
	w->fault = fault_name(s->fault);
	w->faults = fault_list(s->faults, faults, sizeof(faults));
	for (int i = 0; i < JOBS_LCM_NAXES; i++)
		w->pos_mm[i] = s->pos[i] * s->pulse_mm[i];
	if (there) {
		w->gap_v = s->gap_v;
		w->feed_mm_s = s->feed_mm_s;
	}
	w->process = config_process_name(c);
	w->height_mm = height_mm(j);
	w->lean_deg = config_wire_lean_deg(c, w->pos_mm);
	w->overruns = s->overruns;
	w->wake_late_max_us = (uint32_t)(s->wake_late_max_ns / 1000);
}

#define FILL_TOLD(name, id)	w->told_##name = there ? s->told[id] : NAN;

/* What a generator that is not heard now told is not known now. */
static void fill_generator(struct jobs_lcm_status *w, const struct jobs *j)
{
	const struct shm_snapshot *s = &j->link.snap;
	const bool there = j->link.state == LINK_OK;
	static char fault[CONFIG_FAULT_MAX];

	PROCESS_TELLS(FILL_TOLD)
	w->generator_fault = config_fault_text(j->config->generator.fault_words,
					       w->told_fault, fault,
					       sizeof(fault));
}

static void fill_electrode(struct jobs_lcm_status *w, struct jobs *j)
{
	const struct electrode *e = &j->electrode;
	struct store_electrode is;

	w->electrode = electrode_held(j);
	if (w->electrode &&
	    store_electrode_find(j->store, w->electrode, &is) == 0) {
		w->electrode_wear_mm = is.wear_mm;
		w->electrode_shift_mm = is.length_mm - is.wear_mm;
	}
	/* A job has what it was loaded with. */
	if (e->n && e->wear.nchanges)
		w->electrode_shift_mm = e->worn[e->now < 0 ? 0 : e->now]
						.by[INTERP_Z];
	if (e->n && e->now >= 0)
		w->electrode_wear_mm = e->worn[e->now].before_mm +
				       electrode_used_mm(j);
}

static void fill_work(struct jobs_lcm_status *w, struct jobs *j)
{
	struct interp_origin o;

	w->work = "";
	memcpy(w->work_mm, w->pos_mm, sizeof(w->work_mm));
	if (!offset_now(j, &o))
		return;
	w->work = offset_name((int)o.work);
	w->work_turn_deg = o.turn_deg;
	w->wire_pass = o.pass;
	w->wire_passes = o.npasses;
	w->wire_offset_mm = o.wire_mm;
	offset_place_mm(&o, &j->link.snap, w->work_mm);
}

const char *jobs_axes(uint32_t axes, char to[INTERP_NAXES + 1])
{
	size_t n = 0;

	for (int i = 0; i < INTERP_NAXES; i++)
		if (axes >> i & 1)
			to[n++] = INTERP_AXIS_LETTERS[i];
	to[n] = '\0';
	return to;
}

void status_tick(struct jobs *j, int64_t now_us)
{
	uint64_t key = key_of(j);
	struct jobs_lcm_status w = { .line = 0 };
	char condition[16], store[64], axes[INTERP_NAXES + 1];

	if (!due_now(&j->status, key, now_us))
		return;
	/* It is too early to say "absent": that would be a guess. */
	if (j->link.state == LINK_ABSENT && now_us - j->begun_us < GRACE_US)
		return;
	due_sent(&j->status, key, now_us);
	fill_machine(&w, j);
	w.contour_mm = j->twin.last.measured_mm;
	w.contour_predicted_mm = j->twin.last.predicted_mm;
	fill_job(&w, j);
	name_condition(condition, &j->queue.snap);
	w.condition = condition;
	snprintf(store, sizeof(store), "%s%s", *store_why(j->store) ?
		 "degraded: " : "ok", store_why(j->store));
	w.store = store;
	fill_electrode(&w, j);
	fill_work(&w, j);
	fill_generator(&w, j);
	w.interrupted = j->interrupted;
	w.axes = jobs_axes(j->config->axes.present, axes);
	w.lost = j->link.state == LINK_OK ? interrupt_lost(j) : "";
	w.asks = asks_text(j);
	w.stand = *w.asks ? asks_name(j) : "";
	w.stand_s = asks_stood_s(j);
	jobs_lcm_status(j->lcm, &w);
}

void status_guest(void *jobs)
{
	struct jobs *j = jobs;

	due_guest(&j->status);
	status_tick(j, jobs_now_us());
}
