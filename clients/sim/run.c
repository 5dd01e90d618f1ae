/* SPDX-License-Identifier: Apache-2.0 */
/* run.c - runs the cycle, as fast as the processor can or at a given speed */
#include "sim.h"
#include "clocks.h"
#include "standard.h"
#include "trials.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

/* Cycles between two looks at the clock. */
#define LOOK_CYCLES	4096

static volatile sig_atomic_t interrupted;

static void on_signal(int sig)
{
	(void)sig;
	interrupted = 1;
}

bool run_interrupted(void)
{
	return interrupted;
}

static int set_up(struct sim_run *r)
{
	const uint64_t seed = r->o->seed_given ? r->o->seed :
						 (uint64_t)r->config->sim.seed;
	const struct virtual_options o = {
		.config = r->config, .program = &r->job.program, .seed = seed,
		.dry_run = r->o->dry_run,
		.there_and_back = r->o->there_and_back,
	};
	int err = virtual_open(&r->v, &o);

	if (err)
		return err == -EINVAL ? EX_SOFTWARE : EX_OSERR;
	r->spent = calloc(r->job.program.head->nconds, sizeof(*r->spent));
	if (!r->spent)
		return EX_OSERR;
	err = record_open(r);
	r->deviation = r->o->report != NULL;
	r->v.cycle.on_point = record_point;
	r->v.cycle.on_point_arg = r;
	return err;
}

static void progress(const struct sim_run *r, bool last)
{
	const double len = r->job.program.head->length_mm;
	const double share = len > 0 ? r->v.cycle.far_mm / len : 1;

	if (r->o->quiet || !isatty(STDERR_FILENO))
		return;
	standard_control(stderr, "\r");
	fprintf(stderr, "%3.0f %%  %10.1f s  %-8s %s", share * 100,
		virtual_s(&r->v), state_duty[r->v.cycle.state].name,
		last ? "\n" : "");
}

/* Sleep until virtual time is due. */
static void pace(const struct sim_run *r, double from_s)
{
	const double due_s = from_s + virtual_s(&r->v) / r->o->speed;
	const double wait_s = due_s - clock_s(CLOCK_MONOTONIC);
	const struct timespec t = {
		.tv_sec = (time_t)wait_s,
		.tv_nsec = (long)((wait_s - (double)(time_t)wait_s) * 1e9),
	};

	if (wait_s > 0)
		nanosleep(&t, NULL);
}

/* The job is held by a programmed stop, or at an end of there and back. */
static void go_on(struct sim_run *r)
{
	struct cycle *c = &r->v.cycle;

	if (!virtual_stands(&r->v))
		return;
	if (r->o->there_and_back && r->leg == 0 &&
	    c->far_mm >= r->job.program.head->length_mm - 1e-9) {
		r->leg = 1;
		cycle_command(c, &(struct cycle_command) {
			.verb = CYCLE_RETRACT, .arg_mm = 1e9,
		});
		return;
	}
	if (r->leg == 1) {
		r->leg = 2;
		c->config.hold_at_end = false;
	}
	virtual_go_on(&r->v);
}

static bool over(struct sim_run *r)
{
	const struct cycle *c = &r->v.cycle;

	if (virtual_is_over(&r->v)) {
		r->result.outcome = cycle_outcome_name(c->outcome);
		return true;
	}
	if (interrupted ||
	    (r->o->limit_s > 0 && virtual_s(&r->v) >= r->o->limit_s)) {
		r->result.outcome = "limit";
		return true;
	}
	return false;
}

static void spend(struct sim_run *r)
{
	struct sim_spent *s = &r->spent[r->v.cycle.cursor.seg.cond];

	s->cycles += state_duty[r->v.cycle.state].running;
	s->eroding += r->v.cycle.state == STATE_ERODE;
}

static void cycles(struct sim_run *r)
{
	const double from_s = clock_s(CLOCK_MONOTONIC);
	struct cycle *c = &r->v.cycle;

	for (uint64_t n = 1; !over(r); n++) {
		if (c->state == STATE_HOLD)
			go_on(r);
		virtual_step(&r->v);
		record_cycle(r);
		spend(r);
		if (r->on_cycle)
			r->on_cycle(r);
		if (n % LOOK_CYCLES == 0)
			progress(r, false);
		if (r->o->speed > 0 && n % 16 == 0)
			pace(r, from_s);
	}
	r->result.wall_s = clock_s(CLOCK_MONOTONIC) - from_s;
	progress(r, true);
}

/* The distance from the programmed end to the place where it stands. */
static int32_t end_error(const struct sim_run *r)
{
	const struct interp_program *p = &r->job.program;
	const int64_t *end = p->nodes + (uint64_t)p->head->nsegs *
					p->head->naxes;
	int32_t worst = 0;

	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const int32_t at = r->v.cycle.cursor.pos[p->head->column[j]];
		const int32_t d = abs(at - interp_round_sub(end[j]));

		worst = d > worst ? d : worst;
	}
	return worst;
}

int run_job(struct sim_run *r)
{
	int err = set_up(r);

	if (err)
		return err;
	signal(SIGINT, on_signal);
	signal(SIGTERM, on_signal);
	cycles(r);
	r->result.end_error_pulses = end_error(r);
	if (!r->v.cycle.config.dry_run)
		io_sim_result(&r->v.io, &r->result.cut);
	virtual_close(&r->v);
	return record_close(r);
}
