/* SPDX-License-Identifier: Apache-2.0 */
/* restore.c - make a cycle that goes on where another one was killed */
#include "restore.h"
#include "path/place.h"
#include "path/timed.h"
#include "path/walk.h"

#include <math.h>
#include <string.h>

/* Actions before the farthest place were done, wherever the walk stands now. */
static uint32_t last_done(const struct cycle *c)
{
	const struct interp_program *p = &c->cursor.p;
	uint32_t i = c->cursor.index;

	while (i + 1 < p->head->nsegs && p->segs[i + 1].s_mm < c->far_mm)
		i++;
	return i;
}

static void restore_aux(struct cycle *c, uint32_t what)
{
	if (what <= INTERP_AUX_POWER_NEGATIVE)
		c->job.power_off = what == INTERP_AUX_POWER_OFF;
}

/* Set what the program has done on its way there. */
static void restore_actions(struct cycle *c)
{
	const struct interp_program *p = &c->cursor.p;

	c->job.action_done = last_done(c);
	c->conditions.of_cut = p->segs[c->job.action_done].cond;
	for (uint32_t i = 0; i <= c->job.action_done; i++) {
		const struct interp_seg *s = &p->segs[i];

		/* Nobody knows how much of its time was over, so all of it
		 * counts again. */
		if (s->kind == INTERP_TIMED && s->arg > c->job.action_done) {
			timed_begin(c, s->arg);
			c->timed.from_mm = s->s_mm;
		}
		if (s->kind == INTERP_TIMED_END)
			timed_over(c, i);
		if (s->kind == INTERP_MCODE)
			mcode_over(c, i);
		walk_pass_change(c, s);
		if (s->kind == INTERP_AUX)
			restore_aux(c, INTERP_AUX_OF(s->arg));
	}
}

/* If the PLC was told an M code and has not answered, it is still told that
 * code. */
static void restore_mcode(struct cycle *c, const struct cycle_past *past)
{
	c->mcode.number = past->mcode;
	c->mcode.at = past->mcode_at;
	if (past->mcode)
		walk_meet_change(c, past->mcode_at);
	/* The code was answered while the job stood. */
	c->mcode.done = past->mcode == 0 && past->mcode_at != 0;
}

/* This comes before anything is sent to the axes: it says where they stand. */
static void restore_probe(struct cycle *c, const struct cycle_past *past)
{
	struct probe *t = &c->probe;

	memcpy(t->shift, past->shift, sizeof(t->shift));
	memcpy(t->found, past->found, sizeof(t->found));
	t->once = past->found_once;
	t->twice = past->found_twice;
	place_target(c, c->cursor.pos);
}

/* If the machine is beside the path, it must be on the escape that begins
 * there; otherwise nobody knows where it is. */
static bool restore_place(struct cycle *c, const struct cycle_past *past)
{
	int32_t pos[INTERP_NAXES];

	if (memcmp(c->out.target, past->pos, sizeof(c->out.target)) == 0)
		return true;
	for (int i = 0; i < INTERP_NAXES; i++)
		pos[i] = (int32_t)((uint32_t)past->pos[i] -
				   (uint32_t)past->shift[i]);
	return escape_find(c, pos);
}

enum cycle_restored cycle_restore(struct cycle *c,
				  const struct interp_cursor *at,
				  const struct cycle_past *past,
				  enum cycle_answer *ret_answer)
{
	/* After a probing motion the axes and the program differ.
	 * restore_place() compares them. */
	c->manual.used = false;
	*ret_answer = cycle_load_at(c, at, past->far_mm);
	if (*ret_answer != ANSWER_DONE)
		return RESTORE_NOT_LOADED;
	c->manual.used = true;
	restore_probe(c, past);
	if (!restore_place(c, past))
		return RESTORE_ELSEWHERE;
	/* All values must be restored; with some of them it would be another
	 * cut. */
	if (!conditions_restore(c, past->sets, past->nsets))
		return RESTORE_OTHER_VALUES;
	c->out.pump = past->pump;
	restore_actions(c);
	restore_mcode(c, past);
	c->stand = past->stand;
	asking_restore(c);
	stand_begin(c, STAND_RESTART, 0);
	if (isfinite(past->back_mm))
		c->back_mm = fmax(c->back_mm, past->back_mm);
	if (isfinite(past->sure_mm))
		c->resync.sure_mm = past->sure_mm;
	for (int i = 0; i < INTERP_NAXES; i++)
		if (isfinite(past->moved_mm[i]))
			c->resync.moved_mm[i] = past->moved_mm[i];
	memcpy(c->resync.seen, past->seen, sizeof(past->seen));
	c->resync.unseen = false;
	memcpy(c->resync.moved_way, past->moved_way, sizeof(past->moved_way));
	c->resync.moved_beside = past->moved_beside;
	c->resync.adrift = past->adrift;
	c->resync.sure_beside = escape_is_out(&c->escape);
	c->totals = past->totals;
	c->depth = past->depth;
	return RESTORED;
}

void cycle_restore_faults(struct cycle *c, enum cycle_fault first,
			  uint64_t faults)
{
	fault_latch(&c->fault, first);
	for (uint32_t i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++)
		if (faults >> i & 1)
			fault_latch(&c->fault, (enum cycle_fault)i);
	c->fault.fresh = c->fault.untold = 0;
	c->outcome = c->loaded ? OUTCOME_FAULT : c->outcome;
	c->state = STATE_FAULT;
}
