/* SPDX-License-Identifier: Apache-2.0 */
/*
 * resume_help.h - step edmd's loop by hand, kill it, and start the next one
 *
 * After a crash the next loop has to go on from the last snapshot.
 */
#ifndef RESUME_HELP_H
#define RESUME_HELP_H

#include "plc_help.h"

#include "loop.h"
#include "programs.h"
#include "resume.h"

#include <unistd.h>

#define N	7		/* program.7 */

struct world {
	struct machine_config config;
	struct cycle_config k;
	struct loop l;
	struct made m;
	struct io_inputs in;
	struct io_outputs out;
};

static inline void program_put(struct world *w, const struct made *m)
{
	void *block;

	assert_int_equal(shm_program_create(&block, w->config.name, N,
					    m->bytes), 0);
	memcpy(block, m->block, m->bytes);
	shm_program_unmap(block, m->bytes);
}

static inline void loop_make(struct world *w)
{
	struct shm_status *status = w->l.status;

	memset(&w->l, 0, sizeof(w->l));
	w->l.status = status;
	w->l.io.stays = true;
	cycle_init(&w->l.cycle, &w->k);
	w->l.cycle.plc.present = w->in.plc.present;
	for (int i = 0; i < SHM_NAXES; i++)
		w->l.pulse_mm[i] = PULSE_MM;
}

static inline void world_init(struct world *w)
{
	struct shm_snapshot before;

	memset(w, 0, sizeof(*w));
	config_defaults(&w->config);
	snprintf(w->config.name, sizeof(w->config.name), "resume%d", getpid());
	w->k = usual_config();
	w->in.gap_valid = true;
	w->in.gap_v = OPEN_V;
	assert_int_equal(shm_status_create(&w->l.status, w->config.name,
					   &before), 0);
	loop_make(w);
}

static inline void world_free(struct world *w)
{
	program_close(w->l.program);
	shm_program_remove(w->config.name, N);
	shm_status_destroy(w->l.status, w->config.name);
	if (w->m.block)
		unmake(&w->m);
}

static inline void load_made(struct world *w, struct made m)
{
	w->m = m;
	program_put(w, &w->m);
	w->l.program = program_open(&w->config, N);
	assert_non_null(w->l.program);
	assert_int_equal(cycle_load(&w->l.cycle, &w->l.program->cursor.p),
			 ANSWER_DONE);
	loop_sets(&w->l);
}

static inline void load(struct world *w, struct interp_build *b)
{
	load_made(w, finish(b));
}

static inline void period(struct world *w, double gap_v)
{
	struct shm_snapshot s;

	w->in.gap_v = gap_v;
	cycle_step(&w->l.cycle, &w->in, &w->out);
	loop_snapshot(&w->l, &s);
	shm_snapshot_put(w->l.status, &s);
}

static inline void periods(struct world *w, double gap_v, int n)
{
	while (n-- > 0)
		period(w, gap_v);
}

static inline enum cycle_answer ask(struct world *w, enum cycle_verb v,
				    uint32_t arg, double mm)
{
	const struct cycle_command m = { .verb = v, .arg = arg, .arg_mm = mm };
	const enum cycle_answer answer = cycle_command(&w->l.cycle, &m);

	if (v == CYCLE_SET && answer == ANSWER_DONE)
		loop_sets(&w->l);
	return answer;
}

/* Everything but shared memory is gone. */
static inline void crash(struct world *w)
{
	struct shm_snapshot before;

	assert_true(shm_snapshot(w->l.status, &before));
	program_close(w->l.program);
	loop_make(w);
	resume(&w->l, &w->config, &before);
}

static inline double at_mm(const struct world *w)
{
	return interp_cursor_place_mm(&w->l.cycle.cursor);
}

static inline void cut(struct world *w, double to_mm)
{
	for (int i = 0; i < 100000 && at_mm(w) < to_mm; i++)
		period(w, SPARKING_V);
	assert_true(at_mm(w) >= to_mm);
}

static inline void go_on(struct world *w)
{
	period(w, OPEN_V);
	assert_int_equal(ask(w, CYCLE_START, 0, 0), ANSWER_DONE);
}

#endif /* RESUME_HELP_H */
