/* SPDX-License-Identifier: Apache-2.0 */
/* forecaster.c - runs the job in the machine in virtual time */
#include "forecaster.h"

#include "jobs.h"
#include "compiler.h"
#include "jobs_log.h"
#include "store_learnt.h"
#include "compiling.h"
#include "thread.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#define LEARN_S		20.0		/* less of a condition is not learnt
					 * from */

struct forecasting {
	pthread_t thread;
	atomic_bool ends;
	int fd;				/* readable when the thread is done */
	sd_event_source *source;
	struct jobs *jobs;
	const struct machine_config *config;
	char machine[SHM_NAME_MAX];
	uint32_t n;			/* of the job */
	char id[64], name[64];
	int block;			/* its program; -1: program.<n> */
	double most_s;
	int err;
	struct forecast forecast;
	char electrode[64], work[64];
};

/* -- The thread ------------------------------------------------------------ */

static void name_materials(struct forecasting *f)
{
	struct config_tech tech;

	if (config_tech_load(&tech, f->config, NULL) == 0 && tech.table) {
		snprintf(f->electrode, sizeof(f->electrode), "%.63s",
			 tech.table->electrode);
		snprintf(f->work, sizeof(f->work), "%.63s",
			 tech.table->workpiece);
	}
	config_tech_free(&tech);
}

static int forecaster_work(struct forecasting *f)
{
	struct interp_program p;
	const void *block;
	size_t bytes;
	int err = f->block >= 0 ?
		  shm_program_map(&block, &bytes, f->block) :
		  shm_program_read(&block, &bytes, f->machine, f->n);

	/* A job that is over has no program any more. */
	if (err < 0)
		return err == -ENOENT ? -ECANCELED : err;
	err = interp_program_map(&p, block, bytes);
	if (err == 0)
		err = forecast_make(&f->forecast, f->config, &p, f->most_s,
				    &f->ends);
	if (err == 0 && f->block < 0)
		err = forecast_vary(&f->forecast, f->config, &p, &f->ends);
	shm_program_unmap(block, bytes);
	return err;
}

static void *forecaster_main(void *arg)
{
	struct forecasting *f = arg;
	uint64_t one = 1;

	/* The loop goes first, as in compiler.c. */
	pthread_setschedparam(pthread_self(), SCHED_BATCH,
			      &(struct sched_param) { .sched_priority = 0 });
	name_materials(f);
	f->err = forecaster_work(f);
	/* Writing 1 to an eventfd whose count is 0 cannot fail. */
	if (write(f->fd, &one, sizeof(one)) != sizeof(one))
		abort();
	return NULL;
}

/* -- The loop -------------------------------------------------------------- */

static void forecasting_free(struct forecasting *f)
{
	sd_event_source_unref(f->source);
	if (f->fd >= 0)
		close(f->fd);
	if (f->block >= 0)
		close(f->block);
	forecast_free(&f->forecast);
	free(f);
}

static double learnt_factor(struct jobs *j, const char *condition,
			    const char *electrode, const char *work)
{
	return store_learnt_factor(j->store, &(struct store_learnt) {
		condition, electrode, work,
	});
}

static void take_learnt(struct jobs *j)
{
	struct eta *l = &j->eta;

	for (uint32_t i = 0; l->cond && i < l->forecast.nconds; i++)
		if (*l->cond[i].all_s > 0)
			eta_learnt(l, i, learnt_factor(j, l->forecast.cond[i],
						       j->forecaster.electrode,
						       j->forecaster.work));
}

/* The one in the holder is known better than what a table was made for. */
static void correct_materials(struct jobs *j, struct forecasting *f)
{
	const uint32_t held = electrode_held(j);
	struct store_electrode e;

	if (held && store_electrode_find(j->store, held, &e) == 0 &&
	    *e.material)
		snprintf(f->electrode, sizeof(f->electrode), "%s", e.material);
}

/* What it will take; -1: that cannot be told. */
static double whole_s(struct jobs *j, const struct forecasting *f)
{
	const struct forecast *of = &f->forecast;
	double s = of->moved_s + of->other_s;

	if (f->err < 0 || !of->nparts)
		return -1;
	for (uint32_t i = 0; i < of->nparts; i++) {
		const struct forecast_part *p = &of->part[i];
		const double factor = *p->cut_s > 0 ?
			learnt_factor(j, of->cond[p->cond], f->electrode,
				      f->work) : 0;

		s += *p->cut_s * (factor > 0 ? factor : 1);
	}
	return s;
}

static void tell(struct jobs *j, const struct forecasting *f, double s)
{
	const struct jobs_note n = { .kind = "forecast", .job = f->id };
	const char *why = *f->forecast.why_not ? f->forecast.why_not :
			  f->err ? strerror(-f->err) : "";
	const int min = (int)(s / 60);

	store_set_forecast(j->store, f->n, s, s < 0 ? why : "");
	queue_recount(j);
	if (s < 0)
		jobs_note(j, &n, "job %s: no forecast: how long it takes "
			  "cannot be told: %s", f->name, why);
	else
		jobs_note(j, &n, "job %s takes %d h %02d min %02d s, by "
			  "forecast", f->name, min / 60, min % 60,
			  (int)s % 60);
}

/* It comes again when nobody waits for a first look. */
static void put_off(struct jobs *j, const struct forecasting *f)
{
	if (f->block < 0) {
		j->forecaster.put_off = true;
		return;
	}
	store_set_forecast(j->store, f->n, STORE_PUT_OFF, "");
	j->forecaster.looks_later = true;
}

static void take(struct jobs *j, struct forecasting *f)
{
	struct forecaster *to = &j->forecaster;

	if (f->err == -ETIME) {
		put_off(j, f);
		return;
	}
	correct_materials(j, f);
	tell(j, f, whole_s(j, f));
	if (f->block >= 0 || j->queue.job.n != f->n)
		return;
	memcpy(to->electrode, f->electrode, sizeof(to->electrode));
	memcpy(to->work, f->work, sizeof(to->work));
	if (f->err == 0 && eta_give(&j->eta, &f->forecast, f->n) == 0)
		take_learnt(j);
}

static int on_forecast(sd_event_source *source, int fd, uint32_t events,
		       void *arg)
{
	struct forecasting *f = arg;
	struct jobs *j = f->jobs;

	(void)source, (void)fd, (void)events;
	pthread_join(f->thread, NULL);
	j->forecaster.now = NULL;
	if (f->err != -ECANCELED)
		take(j, f);
	forecasting_free(f);
	return 0;
}

/* @block belongs to it. */
static int begin(struct jobs *j, const struct store_job *job, int block,
		 double most_s)
{
	struct forecasting *f = calloc(1, sizeof(*f));
	int err;

	if (!f)
		return -ENOMEM;
	f->jobs = j;
	f->config = j->config;
	f->n = job->n;
	f->block = block;
	f->most_s = most_s;
	snprintf(f->id, sizeof(f->id), "%s", job->id);
	snprintf(f->name, sizeof(f->name), "%s", job->name);
	snprintf(f->machine, sizeof(f->machine), "%s", j->machine);
	f->fd = eventfd(0, EFD_CLOEXEC);
	err = f->fd < 0 ? -errno :
	      sd_event_add_io(j->event, &f->source, f->fd, EPOLLIN,
			      on_forecast, f);
	if (err >= 0)
		err = thread_start(&f->thread, &(struct thread) {
			.name = "jobs-forecast", .run = forecaster_main,
			.arg = f,
		});
	if (err < 0)
		forecasting_free(f);
	else
		j->forecaster.now = f;
	return err;
}

static void follow(struct jobs *j)
{
	const struct shm_snapshot *s = &j->queue.snap;
	const double period_s = (double)s->period_ns * 1e-9;
	struct eta_told t;

	eta_look(&j->eta, s->far_mm, &(struct eta_spent) {
		.cut_s = (double)s->cut_cycles * period_s,
		.moved_s = (double)s->moved_cycles * period_s,
		.other_s = (double)s->other_cycles * period_s,
	});
	if (!eta_rose(&j->eta, &t))
		return;
	jobs_note(j, &(struct jobs_note) {
		.kind = "longer", .job = j->queue.job.id,
		.place_mm = s->place_mm,
	}, "job %s takes longer: %s takes %.2f times its forecast; %d min "
		  "%02d s are left", j->queue.job.name,
		  *j->eta.forecast.cond[t.cond] ?
		  j->eta.forecast.cond[t.cond] : "cutting", t.factor,
		  (int)t.left_s / 60, (int)t.left_s % 60);
}

/* -- Those that wait ------------------------------------------------------- */

static void on_compiled(void *arg, struct compiler_result *r)
{
	struct jobs *j = arg;
	struct forecaster *f = &j->forecaster;
	const int block = r->err == 0 ? dup(r->block) : -1;

	f->compile = NULL;
	free(f->text);
	f->text = NULL;
	/* Why it cannot be compiled is told when it is loaded. */
	if (block < 0 || begin(j, &f->next, block, f->most_s) < 0)
		store_set_forecast(j->store, f->next.n, -1, r->err == -EINVAL ?
				   "it does not compile" : strerror(-r->err));
}

/* @later: of those that were put off. */
static void look(struct jobs *j, bool later)
{
	struct forecaster *f = &j->forecaster;
	bool *looks = later ? &f->looks_later : &f->looks;
	struct compiler_request r;
	size_t bytes = 0;
	int err;

	*looks = store_unforecast(j->store, later, &f->next) == 0;
	f->most_s = later ? FORECAST_S_MAX : FORECASTER_FIRST_S;
	if (!*looks)
		return;
	err = load_request(j, &f->next, &r);
	if (err == 0 && !*r.text_file)
		err = store_text(j->store, f->next.n, &f->text, &bytes);
	r.text = f->text;
	r.bytes = bytes;
	if (err == 0)
		err = compiler_start(&f->compile, j->event, &r, on_compiled, j);
	if (err == 0)
		return;
	free(f->text);
	f->text = NULL;
	store_set_forecast(j->store, f->next.n, -1, strerror(-err));
}

/* A long one under way is put off again for one that has none yet. */
static void make_way(struct jobs *j)
{
	struct forecaster *f = &j->forecaster;
	struct store_job first;

	f->looks = store_unforecast(j->store, false, &first) == 0;
	if (!f->looks || atomic_load(&f->now->ends))
		return;
	atomic_store(&f->now->ends, true);
	f->put_off = f->now->block < 0;
	f->looks_later = f->looks_later || f->now->block >= 0;
}

static void begin_one(struct jobs *j)
{
	const struct queue *q = &j->queue;
	struct forecaster *f = &j->forecaster;
	const bool loaded = q->job.n && f->of != q->job.n &&
			    q->snap.program == q->job.n;
	const bool may = j->link.state == LINK_OK && !q->compile;

	if (f->now && (loaded || (f->now->block < 0 &&
				  f->now->n != q->job.n)))
		atomic_store(&f->now->ends, true);
	if (!q->job.n)
		f->of = 0;
	if (f->now && f->now->most_s > FORECASTER_FIRST_S && f->looks)
		make_way(j);
	if (f->now || f->compile)
		return;
	if (loaded) {
		f->of = q->job.n;
		f->put_off = false;
		begin(j, &q->job, -1, FORECASTER_FIRST_S);
	} else if (f->looks && may) {
		look(j, false);
	} else if (f->put_off && f->of == q->job.n) {
		begin(j, &q->job, -1, FORECAST_S_MAX);
		f->put_off = false;
	} else if (f->looks_later && may) {
		look(j, true);
	}
}

void forecaster_step(struct jobs *j)
{
	const struct queue *q = &j->queue;

	if (j->eta.n && j->eta.n != q->job.n)
		eta_fini(&j->eta);
	begin_one(j);
	if (j->eta.n && q->snap.program == q->job.n)
		follow(j);
}

void forecaster_learn(struct jobs *j)
{
	const struct eta *l = &j->eta;

	if (l->n != j->queue.job.n)
		return;
	for (uint32_t i = 0; l->cond && i < l->forecast.nconds; i++)
		if (l->cond[i].expected_s >= LEARN_S)
			store_learnt_add(j->store, &(struct store_learnt) {
				l->forecast.cond[i], j->forecaster.electrode,
				j->forecaster.work,
			}, l->cond[i].passed_s, l->cond[i].expected_s);
}

/* It looks at `ends` some hundred times a second. */
void forecaster_fini(struct jobs *j)
{
	struct forecasting *f = j->forecaster.now;

	if (f) {
		atomic_store(&f->ends, true);
		pthread_join(f->thread, NULL);
		forecasting_free(f);
	}
	j->forecaster.now = NULL;
	eta_fini(&j->eta);
	if (compiler_destroy(j->forecaster.compile))
		free(j->forecaster.text);
	j->forecaster.compile = NULL;
}
