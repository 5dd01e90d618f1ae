/* SPDX-License-Identifier: Apache-2.0 */
/* watch.c - one machine, seen through its shared memory */
#include "config.h"
#include "faults.h"
#include "stands.h"
#include "watch.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A cycle that stands still for so long counts as dead, whoever has its pid. */
#define STAND_NS	1000000000LL

void watch_init(struct watch *w, const char *machine)
{
	*w = (struct watch) { .open_error = -ENOENT, .fault_words = "none" };
	snprintf(w->machine, sizeof(w->machine), "%s", machine);
}

void watch_fini(struct watch *w)
{
	shm_close(w->status, sizeof(*w->status));
	w->status = NULL;
}

/*
 * A new edmd may have made a new object with the old name.  So a mapping whose
 * writer is dead is opened again at every look.  An edmd that ends normally
 * removes its object: then the machine is absent, not lost.
 */
static void reopen(struct watch *w)
{
	watch_fini(w);
	w->open_error = shm_status_open(&w->status, w->machine);
	if (w->open_error < 0)
		w->status = NULL;
	if (w->open_error == -ENOENT)
		w->heard = false;
}

/* Take the newest snapshot.  A cycle that moves is the sign of life. */
static void refresh(struct watch *w, int64_t now_ns)
{
	uint32_t instance = w->status->head.instance;
	struct shm_snapshot s;

	if (!shm_snapshot(w->status, &s))
		return;

	if (!w->heard || instance != w->instance || s.cycle != w->last.cycle)
		w->moved_ns = now_ns;
	w->instance = instance;
	w->last = s;
	w->heard = true;
}

static const char *look(struct watch *w, int64_t now_ns)
{
	bool alive = w->status && shm_alive(w->status);

	if (!alive) {
		reopen(w);
		alive = w->status && shm_alive(w->status);
	}
	if (w->status)
		refresh(w, now_ns);
	if (!w->heard)
		return "absent";
	if (!alive || now_ns - w->moved_ns > STAND_NS)
		return "lost";
	return shm_state_name(w->last.state);
}

static edm_GeneratorState generator(const struct shm_snapshot *s)
{
	if (s->state == SHM_FAULT)
		return edm_GENERATOR_ERROR;
	if (s->power)
		return edm_GENERATOR_ACTIVE_HIGH_VOLTAGE;
	return edm_GENERATOR_READY;
}

static double progress(const struct shm_snapshot *s)
{
	double p = s->length_mm > 0 ? s->far_mm / s->length_mm : 0;

	if (!(p > 0))
		return 0;
	return p < 1 ? p : 1;
}

static void fill_place(const struct shm_snapshot *s, edm_MachineState *m)
{
	m->program = s->program;
	m->line = s->line;
	m->progress = progress(s);
	m->place_mm = s->place_mm;
	m->length_mm = s->length_mm;
	m->depth_mm = s->depth_mm;
	m->depth_far_mm = s->depth_far_mm;
	m->feed_mm_s = s->feed_mm_s;
	m->gap_v = s->gap_v;
	for (int i = 0; i < SHM_NAXES; i++)
		m->position_mm[i] = s->pos[i] * s->pulse_mm[i];
}

static void fill_sums(const struct shm_snapshot *s, edm_MachineState *m)
{
	m->jumps = s->jumps;
	m->retracts = s->retracts;
	m->shorts = s->shorts;
	m->overruns = s->overruns;
	m->wake_late_max_us = (double)s->wake_late_max_ns * 1e-3;
}

#define FILL_TOLD(name, id)	m->told_##name = here ? s->told[id] : NAN;

static void fill_generator(const struct watch *w, bool here,
			   edm_MachineState *m)
{
	const struct shm_snapshot *s = &w->last;

	PROCESS_TELLS(FILL_TOLD)
	config_fault_text(w->fault_words, m->told_fault, m->generator_fault,
			  sizeof(m->generator_fault));
}

void watch_look(struct watch *w, int64_t now_ns, edm_MachineState *ret)
{
	const char *state = look(w, now_ns);
	const struct shm_snapshot *s = &w->last;
	bool here = strcmp(state, "absent") != 0 && strcmp(state, "lost") != 0;

	*ret = (edm_MachineState) { 0 };
	snprintf(ret->machine, sizeof(ret->machine), "%s", w->machine);
	snprintf(ret->state, sizeof(ret->state), "%s", state);
	snprintf(ret->fault, sizeof(ret->fault), "%s",
		 w->heard && s->fault ? fault_name(s->fault) : "none");
	snprintf(ret->outcome, sizeof(ret->outcome), "%s",
		 shm_outcome_name(w->heard ? s->outcome : SHM_OUTCOME_NONE));
	fill_generator(w, w->heard && here, ret);
	if (!w->heard)
		return;

	ret->utime = s->time_ns / 1000;
	ret->cycle = s->cycle;
	fill_place(s, ret);
	fill_sums(s, ret);
	/* If nobody controls a generator, nothing can be said about it. */
	if (here) {
		ret->generator_state = generator(s);
		ret->is_on = s->power;
		snprintf(ret->stand, sizeof(ret->stand), "%s",
			 stand_row(s->stand)->name);
	}
}
