/* SPDX-License-Identifier: Apache-2.0 */
/* job.c - reads and compiles the text of the job */
#include "compiling.h"
#include "clocks.h"
#include "entry.h"
#include "sim.h"
#include "trials.h"
#include "grow.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>

#define JOB_BYTES_MAX	(1u << 30)

struct text {
	char *at;
	size_t n;
};

static int refuse_file(const char *path, const char *why)
{
	fprintf(stderr, "edmsim: %s: %s; a file of NC code, or - for stdin\n",
		path, why);
	return EX_NOINPUT;
}

static int read_all(FILE *f, const char *path, struct text *t)
{
	const int err = grow_read(f, JOB_BYTES_MAX, &t->at, &t->n);

	return err == 0 ? 0 :
	       err == -ENOMEM ? EX_OSERR :
	       refuse_file(path, err == -EFBIG ? "more than 1 GiB" :
						 strerror(-err));
}

static int text_load(const char *path, struct text *t)
{
	struct stat st;
	FILE *f;
	int err;

	if (strcmp(path, "-") == 0)
		return read_all(stdin, path, t);
	f = fopen(path, "rb");
	if (!f)
		return refuse_file(path, strerror(errno));
	if (fstat(fileno(f), &st) == 0 && S_ISDIR(st.st_mode))
		err = refuse_file(path, "is a directory");
	else
		err = read_all(f, path, t);
	fclose(f);
	return err;
}

/* All refusals of a text, for --check. */
struct refusals {
	const char *path;		/* NULL: they are only counted */
	uint32_t n;
};

static void say_one(void *arg, const struct interp_diag *d)
{
	struct refusals *all = arg;

	all->n++;
	if (all->path)
		interp_diag_tell(d, all->path);
}

/* Enough to see whether a dialect accepts a text. */
#define TRIED_SEGS_MAX	1000000u
#define TRIED_WALKED_MAX	10000000u

static bool is_taken(const struct interp_text *text, const char *name,
		     struct config_compiling of)
{
	struct interp_text tried = *text;
	struct interp_diag diag;
	struct interp_build *b;
	uint32_t lines;
	int err;

	tried.dialect = interp_dialect_by_name(name);
	if (!interp_dialect_is_nc(tried.dialect))
		return false;
	of.text.nc.notes = NULL;
	of.text.nc.refused = NULL;
	of.text.nc.segs_max = TRIED_SEGS_MAX;
	of.text.nc.executed_max = TRIED_SEGS_MAX;
	of.build.walked_max = TRIED_WALKED_MAX;
	b = interp_build_create(&of.build);
	err = b ? interp_compile(&tried, &of.text, b, &lines, &diag) : -ENOMEM;
	interp_build_destroy(b);
	return err == 0;
}

/* Print how many there were, and which dialects refuse nothing. */
static void say_all(const struct refusals *all, const struct interp_text *text,
		    const struct config_compiling *of)
{
	bool any = false;

	fprintf(stderr, "%s: %u refusal%s%s\n", all->path, all->n,
		all->n == 1 ? "" : "s", all->n == INTERP_NC_REFUSED_MAX ?
		", and perhaps more" : "");
	for (int i = 0; interp_dialect_word(i); i++) {
		if (!is_taken(text, interp_dialect_word(i), *of))
			continue;
		fprintf(stderr, any ? " %s" : "%s: taken by dialect %s",
			any ? interp_dialect_word(i) : all->path,
			interp_dialect_word(i));
		any = true;
	}
	if (any)
		fputc('\n', stderr);
}

/* @arg: the job's path. */
static void say_note(void *arg, uint32_t line, const char *text)
{
	fprintf(stderr, "%s:%u: note: %s\n", (const char *)arg, line, text);
}

static int lay_out(struct sim_job *job, struct interp_build *b,
		   const char *path)
{
	const struct interp_build_about about = { .lines = job->lines,
						  .name = path };
	size_t bytes;

	job->block = interp_build_take(b, &about, &bytes);
	if (!job->block)
		return EX_OSERR;
	return interp_program_map(&job->program, job->block, bytes) ?
	       EX_SOFTWARE : 0;
}

/* Everything with which a job is compiled. */
struct tables {
	struct config_tech tech;
	struct config_dialect dialect;
};

/* Is it to begin inside?  Then say where. */
static bool begins_inside(const struct sim_options *o,
			  const struct machine_config *c,
			  struct config_compiling *of,
			  struct interp_build_from *ret)
{
	*ret = (struct interp_build_from) {
		.line = (uint32_t)o->from_line, .far_mm = o->from_mm,
		.up = config_way_out(c),
	};
	memcpy(ret->now_mm, of->build.start_mm, sizeof(ret->now_mm));
	of->build.begins_inside = ret->line || ret->far_mm > 0;
	if (of->build.begins_inside)
		of->build.from = ret;
	return of->build.begins_inside;
}

/* What an operator would hear of a job that begins inside. */
static int begin_inside(const struct sim_options *o,
			const struct machine_config *c,
			const struct interp_build_from *from,
			struct interp_build *b, struct interp_diag *diag)
{
	struct interp_build_entry entry;
	char way[480];
	int err;

	err = interp_build_from(b, from, &entry, diag);
	if (err < 0 || o->quiet)
		return err;
	config_entry_words(c, &entry, way, sizeof(way));
	fprintf(stderr, "%s:%u: note: the job begins here; start %s\n", o->job,
		entry.line, way);
	return 0;
}

static int compile(struct sim_job *job, const struct sim_options *o,
		   const struct machine_config *c, struct text *t,
		   const struct tables *with)
{
	const struct interp_text text = {
		.at = t->at, .bytes = t->n, .dialect = with->dialect.use,
	};
	struct refusals all = { .path = o->job };
	const struct interp_refused refused = { say_one, &all };
	const struct interp_notes notes = { say_note, (void *)(uintptr_t)o->job,
					    o->check };
	struct config_compiling of;
	struct interp_build_from from;
	struct interp_diag diag = { 0 };
	bool inside;
	const double from_s = clock_s(CLOCK_MONOTONIC);
	struct interp_build *b;
	int err;

	config_compiling(c, &with->tech, &of);
	if (config_compiling_set(&of, o->setting, &diag)) {
		interp_diag_tell(&diag, o->job);
		return EX_DATAERR;
	}
	of.text.nc.notes = &notes;
	of.text.nc.refused = o->check ? &refused : NULL;
	inside = begins_inside(o, c, &of, &from);
	b = interp_build_create(&of.build);
	if (!b)
		return EX_OSERR;
	err = interp_compile(&text, &of.text, b, &job->lines, &diag);
	job->compile_lines_s = job->lines / (clock_s(CLOCK_MONOTONIC) - from_s);
	if (err == 0 && inside)
		err = begin_inside(o, c, &from, b, &diag);
	/* Records are read up to the first refusal, which nobody has told. */
	if (err == -EINVAL && all.n == 0)
		say_one(&all, &diag);
	if (err == -EINVAL && o->check)
		say_all(&all, &text, &of);
	/* The text of a million lines is half as large as their program. */
	free(t->at);
	t->at = NULL;
	err = err == 0 ? lay_out(job, b, o->job) :
	    err == -EINVAL ? EX_DATAERR : EX_OSERR;
	interp_build_destroy(b);
	return err;
}

static int dialect_load(struct config_dialect *d, const struct sim_options *o,
			const struct machine_config *c)
{
	char why[1024];
	const int err = config_dialect_load(d, c, o->dialect, o->job);

	if (err == 0)
		return 0;
	config_dialect_why(d, err, why, sizeof(why));
	fprintf(stderr, "edmsim: %s\n", why);
	return o->dialect ? EX_USAGE : EX_CONFIG;
}

int job_load(struct sim_job *job, const struct sim_options *o,
	     const struct machine_config *c)
{
	struct text t = { 0 };
	struct tables with = { .tech = { .table = NULL } };
	int err = dialect_load(&with.dialect, o, c);

	if (err == 0)
		err = edmsim_tech_load(&with.tech, o, c);
	if (err == 0)
		err = text_load(o->job, &t);
	if (err == 0)
		err = compile(job, o, c, &t, &with);
	config_tech_free(&with.tech);
	config_dialect_free(&with.dialect);
	if (err == EX_OSERR)
		fprintf(stderr, "edmsim: %s: out of memory\n", o->job);
	free(t.at);
	return err;
}

void job_unload(struct sim_job *job)
{
	free(job->block);
}

/* What is said of the segments of a program. */
struct sums {
	uint32_t motions;
	double cut_mm, free_mm, free_s;	/* cut, and positioned */
	uint32_t cuts, beside;		/* cuts; those that can be left beside
					 * the path */
	uint32_t pieces;		/* of curves */
	const struct interp_seg *slowest; /* of these; NULL: there is none */
	uint32_t dwells;
	double dwell_s;
};

static void add_curve(struct sums *t, const struct interp_seg *s)
{
	t->pieces++;
	if (!t->slowest || s->feed_max_mm_s < t->slowest->feed_max_mm_s)
		t->slowest = s;
}

static void add_motion(struct sums *t, const struct interp_seg *s)
{
	t->motions++;
	if (s->flags & INTERP_SEG_RAPID) {
		t->free_mm += s->length_mm;
		t->free_s += s->length_mm / s->feed_mm_s;
	} else {
		t->cut_mm += s->length_mm;
		t->cuts++;
		t->beside += s->escape != 0;
	}
	if (s->kind == INTERP_CURVE)
		add_curve(t, s);
}

/* In one walk, because a long program does not fit into the processor's
 * cache. */
static struct sums sums_of(const struct interp_program *p)
{
	struct sums t = { 0 };

	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		const struct interp_seg *s = &p->segs[i];

		if (s->kind < INTERP_BEGIN) {
			add_motion(&t, s);
		} else if (s->kind == INTERP_DWELL) {
			t.dwells++;
			t.dwell_s += s->arg * 1e-3;
		}
	}
	return t;
}

/* Say where a curve bends so much that its feed must be reduced. */
static void describe_curves(const struct interp_program *p,
			    const struct sums *t, FILE *f)
{
	const struct interp_seg *slowest = t->slowest;

	if (!slowest)
		return;
	fprintf(f, "curves     %u in %u pieces, %.4g mm/s at most from line %u "
		"on", (unsigned int)p->head->ncurves, t->pieces,
		(double)slowest->feed_max_mm_s, slowest->line);
	fprintf(f, slowest->feed_max_mm_s < slowest->feed_mm_s ?
		": slower than F, it bends too much\n" : "\n");
}

void job_describe(const struct sim_job *job, FILE *f)
{
	const struct interp_program_head *h = job->program.head;
	const enum interp_strategy strategy =
		(enum interp_strategy)h->strategy;
	const struct sums t = sums_of(&job->program);

	fprintf(f, "lines      %u\nsegments   %u\nstrategy   %s\n", h->lines,
		t.motions, interp_strategy_name(strategy));
	if (interp_strategy_takes_tolerance(strategy))
		fprintf(f, "tolerance  %g pulses%s\n",
			h->tolerance_milli / 1000.0,
			h->perpendicular ? ", square to the path" : "");
	if (interp_strategy_couples(strategy))
		fprintf(f, "coupling   %s\n", interp_coupling_name(
			(enum interp_coupling)h->coupling));
	fprintf(f, "path       %.3f mm: %.3f mm cut, %.3f mm positioned in "
		"%.1f s\n", h->length_mm, t.cut_mm, t.free_mm, t.free_s);
	/* It takes time besides that of the path. */
	if (t.dwells)
		fprintf(f, "dwells     %u, %.3f s in all\n", t.dwells,
			t.dwell_s);
	describe_curves(&job->program, &t, f);
	if (h->nescapes > 1)
		fprintf(f, "escapes    %u of %u cut segments; the others, %u, "
			"lift along the path\n", t.beside, t.cuts,
			t.cuts - t.beside);
}
