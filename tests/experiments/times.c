/* SPDX-License-Identifier: Apache-2.0 */
/*
 * times.c - the time left that is told, and the true one
 *
 * Kinds of job are run in virtual time, on a machine whose process removes from
 * half to twice of what its forecast believes.  Ten times a second, from a
 * tenth of its time on, what eta.h and the way that was cut say is compared
 * with the truth.  Nothing here depends on how fast the host is.
 *
 * The weights of eta.c were chosen with the first twelve kinds at half, all and
 * twice.  Two more kinds, and what lies between, were looked at while the rule
 * was made.  The last four were written when it was finished.
 */
#include "compiling.h"
#include "eta.h"
#include "forecast.h"
#include "tried/length_eta.h"
#include "virtual.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))
#define SAMPLES_MAX	500000		/* 14 hours */
#define HELD_OUT	14		/* the first of these */
#define NEAR		0.2		/* of the truth: good */

struct kind {
	const char *name, *machine, *dialect;
	const char *text;		/* or, ... */
	const char *file;		/* ... of the examples */
};

/* What else is otherwise than was forecast. */
struct truth {
	double override;		/* of positioning */
	double lower_mm;		/* the work, where it is probed */
};

#define TECH	"examples/copper-steel.tech"
#define SINKER	"examples/machine.ini"
#define WIRE	"examples/wire.ini"
#define FIVE	"examples/five-axis.ini"
#define PROBE	"examples/probe.ini"

#define FAR_APART \
	"M3\nF60\nC120\nM98 P10 L8\nG90 G0 Z5\nM30\n" \
	"O10\nG90 G0 Z.1\nG1 Z-.2\nG0 Z80\nG91 G0 X14 Y6\nG90\nM99\n"

static const struct kind kinds[] = {
	{ "cavity, three conditions", SINKER, "generic", NULL,
	  "examples/cavity.ngc" },
	{ "planetary cycles", SINKER, "generic", NULL, "examples/orbit.ngc" },
	{ "deep sinking", SINKER, "generic",
	  "G0 Z2\nZ0\nM3\nC120\nG1 Z-6 F600\nG0 Z2\nM30\n", NULL },
	{ "wire, taper", WIRE, "iso", NULL, "examples/taper.ngc" },
	{ "wire, plate, rough and skims", WIRE, "iso", NULL,
	  "examples/wire-plate.ngc" },
	{ "five axes", FIVE, "generic", NULL, "examples/five-axis.ngc" },
	{ "four cavities, two conditions", SINKER, "generic",
	  "M3\nC120\nG0 X0 Y0 Z1\nZ0\nG1 Z-.6 F60\nG0 Z5\nX80 Y20\nZ0\n"
	  "G1 Z-.6\nG0 Z5\nX-80 Y-20\nZ0\nG1 Z-.6\nC100\nG1 Z-.7\nG0 Z5\n"
	  "X60 Y-60\nZ0\nG1 Z-.4\nG0 Z5\nM30\n", NULL },
	{ "sequence Q1", SINKER, "generic",
	  "G0 Z2\nZ0\nM3\nF60\nG120 P1 Z-1.5\nG0 Z2\nM30\n", NULL },
	{ "NURBS in the plane", SINKER, "generic",
	  "G0 Z2\nZ0\nM3\nC110\nG1 Z-.2 F60\n"
	  "G6.2 P4 K0 X0 Y0 R1 F60\nK0 X3 Y4\nK0 X7 Y-4\nK0 X10 Y0\n"
	  "K1\nK1\nK1\nK1\nG0 Z2\nM30\n", NULL },
	{ "two electrodes, stops, dwells", SINKER, "generic",
	  "T1\nG0 Z2\nZ0\nM3\nC120\nG1 Z-1 F60\nG4 P30\nG0 Z3\nM0\nM5\n"
	  "T2\nM3\nG0 X30\nZ0\nC100\nG1 Z-.8\nG4 P60\nG0 Z5\nM30\n", NULL },
	{ "wire, gear", WIRE, "iso", NULL, "examples/wire-gear.ngc" },
	{ "helix down, then a vector", SINKER, "generic",
	  "G0 X2 Y0 Z2\nZ0\nM3\nC120\nG3 X2 Y0 Z-.5 I-2 J0 F60\n"
	  "C110\nG1 X0 Y0 Z-1\nG0 Z2\nM30\n", NULL },
	{ "pocket in layers", SINKER, "generic",
	  "M3\nG0 X0 Y0 Z1\nZ0\nC120\nF60\nG1 Z-.3\nX12\nY6\nX0\nY0\n"
	  "Z-.6\nX12\nY6\nX0\nY0\nC100\nZ-.65\nX12.1\nY6.1\nX-.1\nY-.1\n"
	  "X0\nG0 Z5\nM30\n", NULL },
	{ "three bores, each finished", SINKER, "generic",
	  "M3\nF60\nG0 X0 Y0 Z1\nZ0\nC120\nG1 Z-1\nC110\nG1 Z-1.2\nG0 Z5\n"
	  "X40\nZ0\nC120\nG1 Z-2\nC110\nG1 Z-2.2\nG0 Z5\nX80\nZ0\nC120\n"
	  "G1 Z-3\nC110\nG1 Z-3.2\nG0 Z5\nM30\n", NULL },
	/* Held out. */
	{ "wire, die with relief, then its punch", WIRE, "iso", NULL,
	  "examples/wire-die.ngc" },
	{ "wire, square below, circle above", WIRE, "iso", NULL,
	  "examples/wire-extrusion.ngc" },
	{ "section of a blade", SINKER, "generic", NULL, "examples/blade.ngc" },
	{ "nine holes, then all finished", SINKER, "generic",
	  "M3\nF40\nG0 X0 Y0 Z2\nC120\nM98 P10 L9\nG90 G0 X0 Y0\nC100\n"
	  "M98 P20 L9\nG90 G0 Z5\nM30\n"
	  "O10\nG90 G0 Z.1\nG1 Z-.4\nG0 Z2\nG91 G0 X12\nG90\nM99\n"
	  "O20\nG90 G0 Z.1\nG1 Z-.45\nG4 P4\nG0 Z2\nG91 G0 X12\nG90\nM99\n",
	  NULL },
};

static const struct {
	struct kind kind;
	struct truth truth;
} by_hand[] = {
	{ { "holes far apart", SINKER, "generic", FAR_APART, NULL },
	  { .override = 1 } },
	{ { "... positioned at 10 %", SINKER, "generic", FAR_APART, NULL },
	  { .override = 0.1 } },
	{ { "six faces probed, each cut", PROBE, "generic",
	    "M3\nF60\nC120\nM98 P10 L6\nG90 G0 X0\nM30\n"
	    "O10\nM5\nG91 G0 X5 Y2\nG80 Z-\nG92 Z0\nG91 G0 Z20\nG80 Z-\n"
	    "G92 Z0\nG91 G0 Z1\nM3\nG90 G1 Z-.3\nG0 Z20\nM99\n", NULL },
	  { .override = 1, .lower_mm = 60 } },
};

static const double removals[] = { 0.5, 0.7, 1, 1.4, 2 };

struct job {
	struct machine_config config;
	struct interp_program program;
	void *block;
};

struct sample {
	double far_mm, job_s;
	struct eta_spent spent;
};

/* How far each of them was off. */
struct score {
	int n, near, rose;
	double worst, median;
	double off[SAMPLES_MAX];
};

static struct score by_way, by_time;

static void fail(const char *of, const char *why)
{
	fprintf(stderr, "times: %s: %s\n", of, why);
	exit(1);
}

static char *read_file(const char *path, size_t *bytes)
{
	char *text = malloc(1 << 20);
	FILE *f = fopen(path, "r");

	if (!f || !text)
		fail(path, "cannot be read");
	*bytes = fread(text, 1, 1 << 20, f);
	fclose(f);
	return text;
}

static void compile(struct job *job, const struct kind *k)
{
	struct config_compiling of;
	struct config_tech tech = { .table = NULL };
	struct interp_diag d = { .found = "" };
	struct interp_text text = {
		.dialect = interp_dialect_by_name(k->dialect),
	};
	struct interp_build_about about = { .name = k->name };
	struct interp_build *b;
	char *at = k->file ? read_file(k->file, &text.bytes) : NULL;
	size_t bytes;

	config_defaults(&job->config);
	if (config_read(&job->config, k->machine, &d) < 0 ||
	    config_check_kinematics(&job->config, &d) < 0)
		fail(k->machine, d.found);
	if (strcmp(k->machine, SINKER) == 0)
		config_tech_load(&tech, &job->config, TECH);
	config_compiling(&job->config, &tech, &of);
	text.at = at ? at : k->text;
	text.bytes = at ? text.bytes : strlen(k->text);
	b = interp_build_create(&of.build);
	if (!b || interp_compile(&text, &of.text, b, &about.lines, &d) < 0) {
		fprintf(stderr, "%u: ", d.line);
		fail(k->name, d.found);
	}
	job->block = interp_build_take(b, &about, &bytes);
	interp_build_destroy(b);
	if (!job->block || interp_program_map(&job->program, job->block, bytes))
		fail(k->name, "no program");
	config_tech_free(&tech);
	free(at);
}

static struct sample look_at(const struct cycle *c, double period_s)
{
	const struct cycle_totals *t = &c->totals;

	return (struct sample) {
		c->far_mm, (double)t->cycles * period_s, {
			.cut_s = (double)t->cut_cycles * period_s,
			.moved_s = (double)t->moved_cycles * period_s,
			.other_s = (double)t->other_cycles * period_s,
		},
	};
}

/* The true job: another seed, another removal.  A sample every @every_s.
 * Return: how many. */
static int run(const struct job *job, const struct truth *is, double removal,
	       struct sample *to)
{
	static struct virtual v;
	struct machine_config c = job->config;
	const double every_s = 0.1;
	double period_s;
	int n = 0;

	c.sim.removal_mm3_min *= removal;
	c.sim.block_top_mm -= is->lower_mm;
	v = (struct virtual) { .in = { .gap_v = 0 } };
	if (virtual_open(&v, &(struct virtual_options) {
			.config = &c, .program = &job->program, .seed = 77 }))
		fail("run", "it does not begin");
	v.cycle.override = is->override;
	period_s = (double)v.cycle.config.period_ns * 1e-9;
	while (!virtual_is_over(&v)) {
		const double s = (double)v.cycle.totals.cycles * period_s;

		if (n == SAMPLES_MAX)
			fail("run", "it takes too long to be sampled");
		if (n == 0 || s >= to[n - 1].job_s + every_s)
			to[n++] = look_at(&v.cycle, period_s);
		if (virtual_stands(&v))
			virtual_go_on(&v);
		virtual_step(&v);
	}
	if (v.cycle.outcome != OUTCOME_DONE)
		fail("run", fault_name(v.cycle.fault.first));
	virtual_close(&v);
	return n;
}

static int by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void mark(struct score *s, double told_s, double true_s)
{
	const double off = told_s < 0 ? 99 : fabs(told_s - true_s) / true_s;

	s->off[s->n++] = off;
	s->near += off <= NEAR;
	s->worst = fmax(s->worst, off);
}

static void close_score(struct score *s)
{
	qsort(s->off, (size_t)s->n, sizeof(s->off[0]), by_size);
	s->median = s->off[s->n / 2];
}

static double near_of(const struct score *s)
{
	return (double)s->near / s->n;
}

/* From the first tenth to where no more than two seconds are left. */
static bool counts(double s, double all_s)
{
	return s >= all_s / 10 && all_s - s > 2;
}

static void compare(const struct job *job, const struct sample *t, int n)
{
	static const atomic_bool never;
	struct forecast f;
	struct eta eta = { .n = 0 };
	struct length_eta way = { .nparts = 0 };
	const double all_s = t[n - 1].job_s;

	by_way = by_time = (struct score) { .n = 0 };
	if (forecast_make(&f, &job->config, &job->program, FORECAST_S_MAX,
			  &never) < 0 ||
	    forecast_vary(&f, &job->config, &job->program, &never) < 0 ||
	    *f.why_not || eta_give(&eta, &f, 1) < 0 ||
	    length_eta_measure(&way, &job->program) < 0)
		fail("forecast", *f.why_not ? f.why_not : "no memory");
	for (int i = 0; i < n; i++) {
		struct eta_told told, news;

		eta_look(&eta, t[i].far_mm, &t[i].spent);
		eta_tell(&eta, &told);
		by_time.rose += eta_rose(&eta, &news);
		if (!counts(t[i].job_s, all_s))
			continue;
		mark(&by_time, told.left_s, all_s - t[i].job_s);
		mark(&by_way, length_eta_s(&way, t[i].far_mm, t[i].job_s),
		     all_s - t[i].job_s);
	}
	close_score(&by_way);
	close_score(&by_time);
	eta_fini(&eta);
	length_eta_fini(&way);
}

/* The shares of all kinds, to be divided by their number. */
struct sum {
	double way, near[COUNT(removals)], all;
};

static void print_kind(const struct kind *k, const struct truth *is,
		       struct sum *sum)
{
	static struct sample samples[SAMPLES_MAX];
	static struct job job;
	double least_by_way = 1, most_off = 0, takes_s = 0;
	int most_rose = 0;
	char near[160] = "";

	compile(&job, k);
	for (size_t i = 0; i < COUNT(removals); i++) {
		const int n = run(&job, is, removals[i], samples);
		const size_t at = strlen(near);

		compare(&job, samples, n);
		if (removals[i] == 1)
			takes_s = samples[n - 1].job_s;
		least_by_way = fmin(least_by_way, near_of(&by_way));
		most_off = fmax(most_off, by_time.median);
		most_rose = by_time.rose > most_rose ? by_time.rose : most_rose;
		snprintf(near + at, sizeof(near) - at, " %.0f %% |",
			 near_of(&by_time) * 100);
		sum->way += near_of(&by_way) / COUNT(removals);
		sum->near[i] += near_of(&by_time);
	}
	sum->all++;
	printf("| %s | %.0f | %.0f %% |%s %.1f %% | %d |\n", k->name, takes_s,
	       least_by_way * 100, near, most_off * 100, most_rose);
	fflush(stdout);
	free(job.block);
}

static void print_sum(const char *of, const struct sum *sum)
{
	if (!(sum->all > 0))
		return;
	printf("| %s, in the mean | | %.1f %% |", of,
	       sum->way * 100 / sum->all);
	for (size_t i = 0; i < COUNT(removals); i++)
		printf(" %.1f %% |", sum->near[i] * 100 / sum->all);
	puts(" | |");
}

static bool is_meant(const struct kind *k, int argc, char **argv)
{
	return argc < 2 || strstr(k->name, argv[1]);
}

/* times NAME: only jobs with that in their name. */
int main(int argc, char **argv)
{
	struct sum sum[3] = { { 0 } };

	puts("| job | takes, s | by way: the least | removes 0.5 | 0.7 | 1 | "
	     "1.4 | 2 | median off, at most | told longer |\n"
	     "|---|---|---|---|---|---|---|---|---|---|");
	for (size_t i = 0; i < COUNT(kinds); i++)
		if (is_meant(&kinds[i], argc, argv))
			print_kind(&kinds[i], &(struct truth) { .override = 1 },
				   &sum[i >= HELD_OUT]);
	for (size_t i = 0; i < COUNT(by_hand); i++)
		if (is_meant(&by_hand[i].kind, argc, argv))
			print_kind(&by_hand[i].kind, &by_hand[i].truth,
				   &sum[2]);
	print_sum("the first fourteen", &sum[0]);
	print_sum("the four held out", &sum[1]);
	return 0;
}
