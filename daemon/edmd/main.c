/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - edmd: start, run, end in the reverse order
 */
#include "generator.h"
#include "key.h"
#include "logger.h"
#include "log.h"
#include "options.h"
#include "plc.h"
#include "programs.h"
#include "resume.h"
#include "serve.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

/* This is done before there is any thread: a signal comes to the main thread as
 * it waits for one. */
static void signals_block(void)
{
	sigset_t set;

	serve_signals(&set);
	sigprocmask(SIG_BLOCK, &set, NULL);
}

static int machine_refuse(int err, const struct interp_diag *d)
{
	log_line(LOG_ERROR, "edmd: %s; %s", d->found, d->wanted);
	if (err == -EACCES || err == -EPERM)
		return EX_NOPERM;
	return err == -EBUSY || err == -ENODEV || err == -ENETDOWN ||
	       err == -ENOMEM ? EX_UNAVAILABLE : EX_CONFIG;
}

#define BACKEND_OPEN(id, name, open, period_ns, is, has_gap, check, points_s) \
	[BACKEND_##id] = open,

/* Return: EX_OK, or the exit code. */
static int machine_open(struct loop *l, const struct machine_config *c)
{
	static io_open_fn *const open[] = { CONFIG_BACKENDS(BACKEND_OPEN) };
	struct interp_diag diag = { .found = "the machine cannot be opened",
				    .wanted = "more free memory" };
	int err = open[c->backend](&l->io, c, &diag);

	if (err < 0)
		return machine_refuse(err, &diag);
	err = io_generator_open(&l->io, c, &l->plc.plc, &diag);
	if (err < 0) {
		l->io.close(l->io.self);
		return machine_refuse(err, &diag);
	}
	if (l->io.edges_per_cycle)
		l->cycle.config.points_max = l->io.edges_per_cycle;
	return EX_OK;
}

static void loop_configure(struct loop *l, const struct machine_config *c)
{
	struct cycle_config cycle;

	config_cycle(c, &cycle);
	cycle.dry_run = !config_backend(c)->has_gap(c);
	cycle_init(&l->cycle, &cycle);
	crossing_init(&l->crossing);
	for (int a = 0; a < SHM_NAXES; a++)
		l->pulse_mm[a] = c->axes.axis[a].pulse_mm;
	l->axes_key = key_axes(c);
	l->home_key = key_home(c);
	l->wanted.cpu = (int)c->cpu;
	l->wanted.priority = (int)c->priority;
	l->speed = config_machine_is(c, MACHINE_MODEL) ?
			   (uint32_t)c->sim.speed : 1;
}

static int status_refuse(const char *name, int err)
{
	char path[SHM_PATH_MAX];

	shm_path(path, name, "status");
	if (err == -EBUSY)
		log_line(LOG_ERROR, "edmd: machine %s has an edmd already; one "
			 "with another --name, or end that one", name);
	else if (err == -EPERM || err == -EACCES)
		log_line(LOG_ERROR, "edmd: %s belongs to another user; run as "
			 "that one, or remove it", path);
	else
		log_line(LOG_ERROR, "edmd: %s: %s; remove it, or make room in "
			 "/dev/shm", path, strerror(-err));
	return err == -EBUSY ? EX_UNAVAILABLE : EX_CANTCREAT;
}

static int run(struct loop *l, const struct machine_config *c,
	       struct setup_report *setup)
{
	struct server s = { .loop = l, .config = c };
	int err = loop_start(l, setup);

	if (err < 0) {
		log_line(LOG_ERROR, "edmd: real-time thread: %s",
			 strerror(-err));
		return EX_OSERR;
	}
	report_init(&s.report, l->status);
	report_setup(setup);
	log_line(LOG_INFO, "edmd: machine %s, backend %s, period %g us, speed "
		 "%u, %s", c->name, l->io.name,
		 (double)config_period_ns(c) / 1000, l->speed,
		 l->program ? "a program held" : "no program");
	if (l->cycle.config.dry_run)
		log_line(LOG_INFO, "edmd: no gap: no sparks, jobs walk at "
			 "their programmed feed");
	report_ready();
	serve(&s);
	loop_stop(l);
	return EX_OK;
}

static int commands_open(struct loop *l, const char *name)
{
	int err = shm_command_create(&l->commands, name,
				     l->status->head.instance);

	if (err < 0) {
		log_line(LOG_ERROR, "edmd: the socket for commands: %s",
			 strerror(-err));
		return err;
	}
	err = shm_stop_create(&l->stops, name, l->status);
	if (err < 0)
		log_line(LOG_ERROR, "edmd: the socket for acts that end "
			 "motion: %s; a folder that edmd may write, /run/edmd, "
			 "or none", strerror(-err));
	return err;
}

static int run_with_machine(struct loop *l, const struct machine_config *c,
			    const struct shm_snapshot *before)
{
	struct setup_report setup = { .item = { { .what = NULL } } };
	int code;

	if (commands_open(l, c->name) < 0) {
		shm_command_destroy(l->commands);
		return EX_CANTCREAT;
	}
	setup_process(&setup);
	/* No stand has a number that one of an earlier edmd had. */
	l->cycle.stand.n = l->status->head.instance;
	resume(l, c, before);
	code = run(l, c, &setup);
	program_close(l->program);
	shm_stop_destroy(l->stops);
	shm_command_destroy(l->commands);
	return code;
}

/* The object will be made again.  Say what is lost with it. */
static void tell_foreign(const char *name)
{
	const struct shm_status *s;
	const int err = shm_status_open(&s, name);

	if (err == 0)
		shm_close(s, sizeof(*s));
	if (err == -EPROTO)
		log_line(LOG_WARNING, "edmd: the status in /dev/shm is of "
			 "another version; where its axes stood, and its job, "
			 "are lost: they are taken to stand at start_mm; move "
			 "or home them");
}

static int run_on(struct loop *l, const struct machine_config *c,
		  const struct shm_snapshot *before)
{
	struct interp_diag diag;
	int code = machine_open(l, c);

	if (code != EX_OK)
		return code;
	if (plc_link_open(&l->plc, c, &diag) < 0) {
		log_line(LOG_ERROR, "edmd: %s; %s", diag.found,
			 diag.wanted);
		l->io.close(l->io.self);
		return EX_CONFIG;
	}
	l->cycle.plc.present = config_has_plc(c);
	code = run_with_machine(l, c, before);
	plc_link_close(&l->plc);
	l->io.close(l->io.self);
	return code;
}

/*
 * The status comes first: who does not own it must not use the machine.  After
 * a failure, or if the job has not ended, it stays.  There the next edmd finds
 * the place at which it is held.
 */
static int run_owner(struct loop *l, const struct machine_config *c)
{
	struct shm_snapshot before;
	bool empty;
	int err, code;

	tell_foreign(c->name);
	err = shm_status_create(&l->status, c->name, &before);
	if (err < 0)
		return status_refuse(c->name, err);
	code = run_on(l, c, &before);
	empty = before.cycle == 0 && l->cycle.count == 0;
	if ((code == EX_OK || empty) && !l->cycle.loaded)
		shm_status_destroy(l->status, c->name);
	return code;
}

int main(int argc, char **argv)
{
	struct machine_config config;
	struct loop loop = { .speed = 1 };
	struct options o;
	int code = options_read(&o, argc, argv);

	if (code < 0)
		code = options_config(&o, &config);
	if (code >= 0)
		return code;
	if (o.print_config) {
		config_print(&config, stdout);
		return EX_OK;
	}
	if (o.check)
		return options_check(&o);
	signals_block();
	loop_configure(&loop, &config);
	logger_start();
	code = run_owner(&loop, &config);
	logger_stop();
	return code;
}
