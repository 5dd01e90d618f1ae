/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compile.c - NC code to a program, in a thread of its own
 */
#include "compile.h"

#include "interp/compile.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

struct compile {
	pthread_t thread;
	int fd;				/* readable when it is done */
	sd_event_source *source;
	struct compile_request request;
	struct compile_result result;
	compile_done_fn done;
	void *arg;
};

static int compile_text(struct compile *c)
{
	const struct machine_config *m = c->request.config;
	struct interp_build_options b = {
		.machine = &m->axes,
		.strategy = (enum interp_strategy)m->strategy,
		.tolerance_milli =
			(uint32_t)(m->tolerance_pulses * 1000 + 1e-6),
		.perpendicular = m->perpendicular,
		.coupling = (enum interp_coupling)m->coupling,
	};
	const struct interp_text text = {
		.at = c->request.text, .bytes = c->request.bytes,
		.dialect = interp_dialect_by_file(c->request.name),
	};
	struct interp_compile_options o = {
		.nc = { .machine = &m->axes, .wire = &m->wire,
			.feed_mm_s = m->feed_default_mm_min / 60 },
		.threeb = { .unit_um = m->threeb_unit_um,
			    .offset_um = m->fourb_offset_um },
	};

	memcpy(b.start_mm, c->request.start_mm, sizeof(b.start_mm));
	memcpy(o.nc.work_offset_mm, m->work_offset_mm,
	       sizeof(o.nc.work_offset_mm));
	memcpy(o.nc.offset_mm, m->offset_mm, sizeof(o.nc.offset_mm));
	c->result.build = interp_build_create(&b);
	if (!c->result.build)
		return -ENOMEM;
	return interp_compile(&text, &o, c->result.build, &c->result.lines,
			      &c->result.diag);
}

static void *compile_main(void *arg)
{
	struct compile *c = arg;
	uint64_t one = 1;

	c->result.err = compile_text(c);
	/* An eventfd at 0 takes a 1 without fail. */
	if (write(c->fd, &one, sizeof(one)) != sizeof(one))
		abort();
	return NULL;
}

static void compile_free(struct compile *c)
{
	sd_event_source_unref(c->source);
	if (c->fd >= 0)
		close(c->fd);
	interp_build_destroy(c->result.build);
	free(c);
}

static int on_done(sd_event_source *source, int fd, uint32_t events, void *arg)
{
	struct compile *c = arg;

	(void)source, (void)fd, (void)events;
	pthread_join(c->thread, NULL);
	c->done(c->arg, &c->result);
	compile_free(c);
	return 0;
}

/* Signals are the event loop's: the thread blocks them all. */
static int thread_start(struct compile *c)
{
	sigset_t all, old;
	int err;

	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &old);
	err = pthread_create(&c->thread, NULL, compile_main, c);
	pthread_sigmask(SIG_SETMASK, &old, NULL);
	return -err;
}

int compile_start(struct compile **ret, sd_event *event,
		  const struct compile_request *request,
		  compile_done_fn done, void *arg)
{
	struct compile *c = calloc(1, sizeof(*c));
	int err;

	if (!c)
		return -ENOMEM;
	c->request = *request;
	c->done = done;
	c->arg = arg;
	c->fd = eventfd(0, EFD_CLOEXEC);
	err = c->fd < 0 ? -errno :
	      sd_event_add_io(event, &c->source, c->fd, EPOLLIN, on_done, c);
	if (err >= 0)
		err = thread_start(c);
	if (err < 0) {
		compile_free(c);
		return err;
	}
	*ret = c;
	return 0;
}

void *compile_destroy(struct compile *c)
{
	void *arg;

	if (!c)
		return NULL;
	arg = c->arg;
	pthread_join(c->thread, NULL);
	compile_free(c);
	return arg;
}
