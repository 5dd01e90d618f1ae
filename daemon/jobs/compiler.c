/* SPDX-License-Identifier: Apache-2.0 */
/* compiler.c - NC code to a program, in a thread of its own */
#include "compiler.h"
#include "parallel.h"
#include "compiling.h"
#include "thread.h"

#include <errno.h>
#include <sodium.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

/*
 * A short text with calls inside calls can ask for any number of segments.
 * This limit means some seconds of work and less than a GB.  A text of 64 MiB
 * that has every line itself stays below it.
 */
#define SEGS_MAX	8000000u
#define EXECUTED_MAX	32000000u
#define LONG_BYTES	(1u << 18)	/* of a text: worth a second thread */

struct compiler {
	pthread_t thread;
	int fd;				/* becomes readable when the thread is
					 * done */
	sd_event_source *source;
	struct compiler_request request;
	char *text;			/* that was read */
	struct interp_build *build;
	struct interp_build_memory memory;
	void *block;			/* of the program, as it is mapped */
	size_t block_bytes;
	int block_err;
	struct compiler_result result;
	atomic_bool over;		/* the thread needs nothing any more */
	compiler_done_fn done;
	void *arg;
};

/* The table is read for each job, so a corrected table is used from the next
 * job on. */
static int read_tech(struct compiler *c, struct config_tech *t)
{
	struct compiler_result *r = &c->result;
	uint8_t hash[crypto_hash_sha256_BYTES];
	const int err = config_tech_load(t, c->request.config, NULL);

	if (err < 0)
		config_tech_why(t, err, r->tech_refusal,
				sizeof(r->tech_refusal));
	if (err < 0 || !t->table)
		return err;
	crypto_hash_sha256(hash, (const uint8_t *)t->text, t->bytes);
	sodium_bin2hex(r->tech_sha256, sizeof(r->tech_sha256), hash,
		       sizeof(hash));
	return 0;
}

static void take_note(void *arg, uint32_t line, const char *text)
{
	struct compiler_result *r = arg;

	if (r->nnotes < COMPILER_NOTES_MAX) {
		struct compiler_note *n = &r->note[r->nnotes];

		n->line = line;
		snprintf(n->text, sizeof(n->text), "%s", text);
	}
	r->nnotes++;
}

/* The values that were set are those of its conditions from now on. */
static int go_on(struct compiler *c)
{
	const struct shm_sets *sets = &c->request.sets;
	const uint64_t n = sets->n < SHM_SETS_MAX ? sets->n : SHM_SETS_MAX;

	for (uint64_t i = 0; i < n; i++)
		interp_build_set(c->build, sets->set[i].cond,
				 sets->set[i].field, sets->set[i].value);
	return interp_build_from(c->build, &c->request.from,
				 &c->result.entry, &c->result.diag);
}

static int measure(struct compiler *c, const void *block, size_t bytes)
{
	struct compiler_result *r = &c->result;
	struct interp_program p;
	int err = interp_program_map(&p, block, bytes);

	if (err == 0 && c->request.wants_wear)
		err = interp_wear_measure(&r->wear, &p);
	if (err == 0)
		memcpy(r->start_pulses, p.head->start_pulses,
		       sizeof(r->start_pulses));
	return err;
}

/* A program for edmd is put together where edmd finds it. */
static void *block_grow(void *arg, void *at, size_t bytes)
{
	struct compiler *c = arg;

	c->block_err = at ?
		shm_program_resize(c->result.block, &c->block, c->block_bytes,
				   bytes) :
		shm_program_begin(&c->result.block, &c->block,
				  c->request.wants_block, bytes);
	if (c->block_err < 0)
		return NULL;
	c->block_bytes = bytes;
	return c->block;
}

static int block_write(struct compiler *c)
{
	struct interp_build_about about = {
		.lines = c->result.lines, .name = c->request.name,
	};
	size_t bytes;
	void *block;
	int err;

	memcpy(about.hash, c->request.sha256, sizeof(about.hash));
	block = interp_build_take(c->build, &about, &bytes);
	if (!block)
		return -ENOMEM;
	err = measure(c, block, bytes);
	if (!c->request.wants_block)
		free(block);
	return err;
}

static bool wants_program(const struct compiler *c)
{
	return c->request.wants_wear || c->request.wants_block;
}

static int compiler_text(struct compiler *c, const struct config_tech *tech,
			 const struct interp_dialect *dialect)
{
	const struct interp_text text = {
		.at = c->request.text, .bytes = c->request.bytes,
		.dialect = dialect,
	};
	const struct interp_notes notes = { .say = take_note,
					    .arg = &c->result };
	struct config_compiling of;
	int err;

	config_compiling(c->request.config, tech, &of);
	err = config_compiling_set(&of, c->request.setting, &c->result.diag);
	if (err)
		return err;
	of.text.nc.notes = &notes;
	of.text.nc.segs_max = c->request.segs_max ? c->request.segs_max :
						    SEGS_MAX;
	of.text.nc.executed_max = c->request.executed_max ?
				  c->request.executed_max : EXECUTED_MAX;
	memcpy(of.text.nc.work_offset_mm, c->request.work_mm,
	       sizeof(of.text.nc.work_offset_mm));
	memcpy(of.text.nc.work_turn_deg, c->request.work_turn_deg,
	       sizeof(of.text.nc.work_turn_deg));
	c->request.electrodes.at = c->request.electrode;
	of.text.nc.electrodes = &c->request.electrodes;
	memcpy(of.build.start_mm, c->request.start_mm,
	       sizeof(of.build.start_mm));
	of.build.walked_max = c->request.walked_max;
	of.build.begins_inside = c->request.goes_on;
	of.build.from = c->request.goes_on ? &c->request.from : NULL;
	c->memory = (struct interp_build_memory) { block_grow, c };
	of.build.memory = c->request.wants_block ? &c->memory : NULL;
	c->build = interp_build_create(&of.build);
	if (!c->build)
		return -ENOMEM;
	err = interp_compile(&text, &of.text, c->build, &c->result.lines,
			     &c->result.diag);
	if (err == 0 && c->request.goes_on)
		err = go_on(c);
	if (err || !wants_program(c))
		return err;
	return block_write(c);
}

static bool is_the_text(const struct compiler_request *r)
{
	uint8_t hash[crypto_hash_sha256_BYTES];

	if (!r->has_sha256)
		return true;
	crypto_hash_sha256(hash, (const uint8_t *)r->text, r->bytes);
	return memcmp(hash, r->sha256, sizeof(hash)) == 0;
}

/* A long text is not read in the event loop. */
static int take_text(struct compiler *c)
{
	struct compiler_request *r = &c->request;
	int err;

	if (r->text)
		return 0;
	err = r->has_sha256 ?
	      store_text_read(r->text_file, &c->text, &r->bytes) :
	      store_text_fetch(r->text_file, &c->text, &r->bytes);
	r->text = c->text;
	return err;
}

/* What two threads do with the text. */
struct reading {
	struct compiler *c;
	const struct config_tech *tech;
	const struct interp_dialect *dialect;
	bool is_whole;
	int err;
};

static void reading_check(void *arg)
{
	struct reading *r = arg;

	r->is_whole = is_the_text(&r->c->request);
}

static void reading_compile(void *arg)
{
	struct reading *r = arg;

	r->err = compiler_text(r->c, r->tech, r->dialect);
	/* Not its own memory was too small. */
	if (r->err == -ENOMEM && r->c->block_err < 0)
		r->err = r->c->block_err;
}

/* The hash of a long text takes a fifth as long as all that is made of the
 * text.  Until it is known, nothing of that is given away. */
static int check_and_compile(struct reading *r)
{
	if (r->c->request.bytes < LONG_BYTES || parallel_processors() < 2) {
		reading_check(r);
		if (r->is_whole)
			reading_compile(r);
	} else {
		parallel_run(reading_compile, reading_check, r);
	}
	if (r->is_whole)
		return r->err;
	compiler_forget(&r->c->result);
	return -EILSEQ;
}

/* Made before, of the same table and dialect. */
static bool is_made(const struct compiler *c)
{
	const struct compiler_result *r = &c->result, *m = c->request.made;

	return m && strcmp(m->tech_sha256, r->tech_sha256) == 0 &&
	       memcmp(m->dialect_sha256, r->dialect_sha256,
		      sizeof(r->dialect_sha256)) == 0;
}

static int compiler_make(struct compiler *c, const struct config_tech *tech,
			 const struct config_dialect *d)
{
	int err = 0;

	if (d->text)
		crypto_hash_sha256(c->result.dialect_sha256,
				   (const uint8_t *)d->text, d->bytes);
	if (is_made(c)) {
		c->result = *c->request.made;
		compiler_take_out(c->request.made);
	} else {
		err = take_text(c);
		if (err == 0)
			err = check_and_compile(&(struct reading) {
				.c = c, .tech = tech, .dialect = d->use,
			});
	}
	return err;
}

/* The file of the dialect is read for each job, too. */
static int compiler_read(struct compiler *c, const struct config_tech *tech)
{
	struct compiler_result *r = &c->result;
	struct config_dialect d;
	int err = config_dialect_load(&d, c->request.config,
				      c->request.dialect, c->request.name);

	if (err == 0)
		err = compiler_make(c, tech, &d);
	else
		config_dialect_why(&d, err, r->tech_refusal,
				   sizeof(r->tech_refusal));
	config_dialect_free(&d);
	return err;
}

static void compile_and_keep(struct compiler *c)
{
	const struct compiler_request *r = &c->request;
	const bool given = r->text != NULL;
	struct config_tech tech;

	c->result.err = read_tech(c, &tech);
	if (c->result.err == 0)
		c->result.err = compiler_read(c, &tech);
	config_tech_free(&tech);
	if (c->result.err == 0 && given && *r->text_file)
		c->result.keep_err = store_text_keep(r->text_file, r->text,
						     r->bytes);
}

/* To free the memory of a long program takes long, too. */
static void compiler_work(struct compiler *c)
{
	c->result.block = -1;
	compile_and_keep(c);
	interp_build_destroy(c->build);
	if (c->block)
		shm_program_unmap(c->block, c->block_bytes);
	free(c->text);
}

void compiler_take_out(struct compiler_result *r)
{
	r->wear = (struct interp_wear) { .nchanges = 0 };
	r->block = -1;
}

void compiler_forget(struct compiler_result *r)
{
	interp_wear_free(&r->wear);
	if (r->block >= 0)
		close(r->block);
	r->block = -1;
}

/* The loop answers clients, also while the compiler has every processor.  So a
 * real-time priority of this service is the loop's alone, and without one the
 * compiler does not displace it when both may run.  Threads that the compiler
 * starts are as it is.  To step back is always allowed. */
static void step_back(void)
{
	pthread_setschedparam(pthread_self(), SCHED_BATCH,
			      &(struct sched_param) { .sched_priority = 0 });
}

static void *compiler_main(void *arg)
{
	struct compiler *c = arg;
	uint64_t one = 1;

	step_back();
	compiler_work(c);
	atomic_store(&c->over, true);
	/* Writing 1 to an eventfd whose count is 0 cannot fail. */
	if (write(c->fd, &one, sizeof(one)) != sizeof(one))
		abort();
	return NULL;
}

static void compiler_free(struct compiler *c)
{
	sd_event_source_unref(c->source);
	if (c->fd >= 0)
		close(c->fd);
	compiler_forget(&c->result);
	if (c->request.made)
		compiler_forget(c->request.made);
	free(c->request.made);
	free(c);
}

static int on_done(sd_event_source *source, int fd, uint32_t events, void *arg)
{
	struct compiler *c = arg;

	(void)source, (void)fd, (void)events;
	pthread_join(c->thread, NULL);
	c->done(c->arg, &c->result);
	compiler_free(c);
	return 0;
}

int compiler_start(struct compiler **ret, sd_event *event,
		   const struct compiler_request *request,
		   compiler_done_fn done, void *arg)
{
	struct compiler *c = calloc(1, sizeof(*c));
	int err;

	if (!c)
		return -ENOMEM;
	c->request = *request;
	c->done = done;
	c->arg = arg;
	c->result.block = -1;
	c->fd = eventfd(0, EFD_CLOEXEC);
	err = c->fd < 0 ? -errno :
	      sd_event_add_io(event, &c->source, c->fd, EPOLLIN, on_done, c);
	if (err >= 0)
		err = thread_start(&c->thread, &(struct thread) {
			.name = "jobs-compile", .run = compiler_main, .arg = c,
		});
	if (err < 0) {
		compiler_free(c);
		return err;
	}
	*ret = c;
	return 0;
}

void *compiler_destroy(struct compiler *c)
{
	void *arg;

	if (!c || !atomic_load(&c->over))
		return NULL;
	arg = c->arg;
	pthread_join(c->thread, NULL);
	compiler_free(c);
	return arg;
}
