/* SPDX-License-Identifier: Apache-2.0 */
/* virtual.c - a job on a simulated machine, in virtual time */
#include "virtual.h"

#include <errno.h>
#include <string.h>

bool virtual_at_once(const struct machine_config *c, bool dry_run)
{
	return config_machine_is(c, MACHINE_NONE) ||
	       (dry_run && !c->sim.loops);
}

/* Whoever runs it here has neither homed it nor counts missed periods. */
static void configure(struct virtual *v, const struct virtual_options *o,
		      struct cycle_config *ret)
{
	const struct machine_config *c = o->config;

	config_cycle(c, ret);
	ret->dry_run = o->dry_run || config_machine_is(c, MACHINE_NONE);
	ret->overrun_limit = 0;
	ret->require_home = false;
	memcpy(ret->start, o->program->head->start_pulses, sizeof(ret->start));
	if (virtual_at_once(c, o->dry_run))
		ret->contouring.methods = 0;
	if (v->io.edges_per_cycle)
		ret->points_max = v->io.edges_per_cycle;
	if (o->there_and_back) {
		ret->hold_at_end = true;
		ret->gap.retract_mm_s = 1e3;
	}
}

int virtual_open(struct virtual *v, const struct virtual_options *o)
{
	struct cycle_config cc;
	const int err = virtual_at_once(o->config, o->dry_run) ?
			io_null_open(&v->io, NULL, NULL) :
			io_sim_open_seed(&v->io, o->config, o->seed);

	if (err)
		return err;
	configure(v, o, &cc);
	cycle_init(&v->cycle, &cc);
	if (cycle_load(&v->cycle, o->program) != ANSWER_DONE)
		return -EINVAL;
	v->io.write(v->io.self, &v->cycle.out);
	return 0;
}

void virtual_close(struct virtual *v)
{
	if (v->io.close)
		v->io.close(v->io.self);
	v->io = (struct io_machine) { .name = NULL };
}

bool virtual_stands(const struct virtual *v)
{
	const struct cycle *c = &v->cycle;

	return c->state == STATE_HOLD && !c->hold.moving && !c->hold.fails &&
	       c->mover.v_mm_s == 0;
}

void virtual_go_on(struct virtual *v)
{
	struct cycle *c = &v->cycle;

	cycle_command(c, &(struct cycle_command) {
		.verb = CYCLE_CONFIRM, .arg_mm = c->stand.of,
	});
	cycle_command(c, &(struct cycle_command) { .verb = CYCLE_START });
}

void virtual_step(struct virtual *v)
{
	v->io.read(v->io.self, &v->in);
	cycle_step(&v->cycle, &v->in, &v->given);
	v->io.write(v->io.self, &v->given);
}

bool virtual_is_over(const struct virtual *v)
{
	return v->cycle.state == STATE_IDLE || v->cycle.state == STATE_FAULT;
}

double virtual_s(const struct virtual *v)
{
	return (double)v->cycle.count * (double)v->cycle.config.period_ns *
	       1e-9;
}
