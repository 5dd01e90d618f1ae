/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - edmsim: options, and what to do with them
 */
#include "plot.h"
#include "sim.h"
#include "tune_servo.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static const char usage[] =
"Usage: edmsim [options] JOB\n"
"Runs a job in virtual time: the daemon's own cycle on a simulated machine.\n"
"JOB is NC code (.ngc .nc .iso .3b .4b), - for stdin.\n"
"\n"
"  --machine FILE       machine file; without: eight axes, +-200 mm\n"
"  --dialect NAME       generic, robofil, skd2, sodick, chmer, 3b, 4b\n"
"                       (by the file's name: .3b, .4b, else generic)\n"
"  --tech FILE          technology table, .tech or .enc (machine file's)\n"
"  --print-tech         that table as a .tech text, and exit\n"
"  --document-tech      the fields of a condition as Markdown, and exit\n"
"  --unit-um N          unit of a 3B or 4B program (machine file's, 1)\n"
"  --offset-um N        of the wire, for 4B (machine file's, 0)\n"
"  --emit FORMAT        3b or iso: write the job as that to stdout, no run\n"
"  --strategy NAME      simultaneous, point-by-point, centred, dda,\n"
"                       main-direction, min-switch (machine file's)\n"
"  --tolerance PULSES   how far main-direction and min-switch may stray along\n"
"                       the shorter axis (machine file's, 2)\n"
"  --perpendicular      the tolerance is square to the path instead\n"
"  --coupling NAME      of three and more axes: star, tree, tube (machine\n"
"                       file's, star)\n"
"  --fit UM             join cut lines in a row into curves this near to\n"
"                       them (machine file's, 0: not)\n"
"  --dry-run            no gap: walk at the programmed feed\n"
"  --there-and-back     with --dry-run: to the end, back, to the end again\n"
"  --period-us N        cycle period (machine file's, 1000)\n"
"  --seed N             of every random process (machine file's, 1)\n"
"  --speed X            pace at X times real time; 0 as fast as possible (0)\n"
"  --limit-s S          stop after S virtual seconds\n"
"  --pulses FILE        CSV of every lattice point passed\n"
"  --trace FILE         CSV of every cycle\n"
"  --report FILE        JSON report; - for stdout\n"
"  --plot FILE          picture, PNG or SVG by the name\n"
"  --tune-contour       find the gains of [contour] method on models of the\n"
"                       axes along this job, and print them\n"
"  --check              read and compile only; print what it would do\n"
"  --tune               look for the best servo and jump values of the machine\n"
"                       file, print them as lines of it; --seed, --limit-s (60)\n"
"  --budget N           trials of --tune or --tune-contour (200)\n"
"  --json               what --tune came to as JSON\n"
"  --quiet              no progress, no summary\n"
"  --print-config       the machine file in force, and exit\n"
"  --document-config    every key of a machine file as Markdown, and exit\n"
"  --help, --version\n"
"\n"
"Exit: 0 done, 1 ended by a fault or the limit, 64 usage, 65 bad job,\n"
"66 no such file, 73 cannot create, 78 bad machine file.\n";

enum {
	OPT_MACHINE = 256, OPT_DIALECT, OPT_STRATEGY, OPT_TOLERANCE,
	OPT_PERPENDICULAR, OPT_FIT, OPT_COUPLING, OPT_DRY_RUN, OPT_THERE, OPT_PERIOD,
	OPT_SEED, OPT_SPEED, OPT_LIMIT, OPT_PULSES, OPT_TRACE, OPT_REPORT,
	OPT_PLOT, OPT_TUNE, OPT_CHECK, OPT_EMIT, OPT_UNIT, OPT_OFFSET, OPT_QUIET,
	OPT_TECH, OPT_PRINT_TECH, OPT_DOCUMENT_TECH,
	OPT_TUNE_SERVO, OPT_BUDGET, OPT_JSON,
	OPT_PRINT, OPT_DOCUMENT, OPT_HELP, OPT_VERSION,
};

static const struct option options[] = {
	{ "machine", required_argument, NULL, OPT_MACHINE },
	{ "dialect", required_argument, NULL, OPT_DIALECT },
	{ "strategy", required_argument, NULL, OPT_STRATEGY },
	{ "tolerance", required_argument, NULL, OPT_TOLERANCE },
	{ "perpendicular", no_argument, NULL, OPT_PERPENDICULAR },
	{ "fit", required_argument, NULL, OPT_FIT },
	{ "coupling", required_argument, NULL, OPT_COUPLING },
	{ "dry-run", no_argument, NULL, OPT_DRY_RUN },
	{ "there-and-back", no_argument, NULL, OPT_THERE },
	{ "period-us", required_argument, NULL, OPT_PERIOD },
	{ "seed", required_argument, NULL, OPT_SEED },
	{ "speed", required_argument, NULL, OPT_SPEED },
	{ "limit-s", required_argument, NULL, OPT_LIMIT },
	{ "pulses", required_argument, NULL, OPT_PULSES },
	{ "trace", required_argument, NULL, OPT_TRACE },
	{ "report", required_argument, NULL, OPT_REPORT },
	{ "plot", required_argument, NULL, OPT_PLOT },
	{ "tune-contour", no_argument, NULL, OPT_TUNE },
	{ "check", no_argument, NULL, OPT_CHECK },
	{ "emit", required_argument, NULL, OPT_EMIT },
	{ "tech", required_argument, NULL, OPT_TECH },
	{ "print-tech", no_argument, NULL, OPT_PRINT_TECH },
	{ "document-tech", no_argument, NULL, OPT_DOCUMENT_TECH },
	{ "unit-um", required_argument, NULL, OPT_UNIT },
	{ "offset-um", required_argument, NULL, OPT_OFFSET },
	{ "tune", no_argument, NULL, OPT_TUNE_SERVO },
	{ "budget", required_argument, NULL, OPT_BUDGET },
	{ "json", no_argument, NULL, OPT_JSON },
	{ "quiet", no_argument, NULL, OPT_QUIET },
	{ "print-config", no_argument, NULL, OPT_PRINT },
	{ "document-config", no_argument, NULL, OPT_DOCUMENT },
	{ "help", no_argument, NULL, OPT_HELP },
	{ "version", no_argument, NULL, OPT_VERSION },
	{ 0 },
};

static void refuse(const char *what, const char *value, const char *wanted)
{
	fprintf(stderr, "edmsim: %s %s; %s\n", what, value, wanted);
	exit(EX_USAGE);
}

static double number(const char *name, const char *s, double min, double max)
{
	char *end, wanted[80];
	double v;

	errno = 0;
	v = strtod(s, &end);
	if (end != s && *end == '\0' && errno == 0 && v >= min && v <= max)
		return v;
	snprintf(wanted, sizeof(wanted), "a number from %g to %g", min, max);
	refuse(name, s, wanted);
	return 0;
}

static uint64_t whole(const char *name, const char *s)
{
	char *end;
	uint64_t v;

	errno = 0;
	v = strtoull(s, &end, 10);
	if (s[0] < '0' || s[0] > '9' || *end != '\0' || errno != 0)
		refuse(name, s, "a whole number from 0 to 2^64 - 1");
	return v;
}

/* Words, then flags, then numbers; false if none of them. */
static bool take_word(struct sim_options *o, int opt)
{
	switch (opt) {
	case OPT_MACHINE:
		o->machine_file = optarg;
		return true;
	case OPT_TECH:
		o->tech = optarg;
		return true;
	case OPT_STRATEGY:
		o->strategy = optarg;
		return true;
	case OPT_COUPLING:
		o->coupling = optarg;
		return true;
	case OPT_PULSES:
		o->pulses = optarg;
		return true;
	case OPT_TRACE:
		o->trace = optarg;
		return true;
	case OPT_REPORT:
		o->report = optarg;
		return true;
	case OPT_PLOT:
		o->plot = optarg;
		return true;
	case OPT_DIALECT:
		o->dialect = interp_dialect_by_name(optarg);
		if (!o->dialect)
			refuse("--dialect", optarg, interp_dialect_names());
		return true;
	case OPT_EMIT:
		if (strcmp(optarg, "3b") != 0 && strcmp(optarg, "iso") != 0)
			refuse("--emit", optarg, "3b or iso");
		o->emit = optarg;
		return true;
	default:
		return false;
	}
}

static bool take_flag(struct sim_options *o, int opt)
{
	switch (opt) {
	case OPT_DRY_RUN:
		o->dry_run = true;
		return true;
	case OPT_PERPENDICULAR:
		o->perpendicular = true;
		return true;
	case OPT_THERE:
		o->there_and_back = true;
		return true;
	case OPT_CHECK:
		o->check = true;
		return true;
	case OPT_TUNE:
		o->tune = o->dry_run = true;
		return true;
	case OPT_QUIET:
		o->quiet = true;
		return true;
	case OPT_PRINT_TECH:
		o->print_tech = true;
		return true;
	case OPT_TUNE_SERVO:
		o->tune_servo = true;
		return true;
	case OPT_JSON:
		o->json = true;
		return true;
	default:
		return false;
	}
}

static bool take_number(struct sim_options *o, int opt)
{
	switch (opt) {
	case OPT_PERIOD:
		o->period_us = number("--period-us", optarg, 20, 20000);
		return true;
	case OPT_TOLERANCE:
		o->tolerance_pulses = number("--tolerance", optarg, 0,
					     INTERP_TOLERANCE_MAX / 1000);
		o->tolerance_given = true;
		return true;
	case OPT_FIT:
		o->fit_um = number("--fit", optarg, 0, 1000);
		o->fit_given = true;
		return true;
	case OPT_SEED:
		o->seed = whole("--seed", optarg);
		o->seed_given = true;
		return true;
	case OPT_SPEED:
		o->speed = number("--speed", optarg, 0, 1e6);
		return true;
	case OPT_UNIT:
		o->unit_um = number("--unit-um", optarg, 0.001, 1000);
		return true;
	case OPT_OFFSET:
		o->offset_um = number("--offset-um", optarg, 0, 10000);
		return true;
	case OPT_BUDGET:
		o->budget = floor(number("--budget", optarg, 1, 1e6));
		return true;
	case OPT_LIMIT:
		o->limit_s = number("--limit-s", optarg, 1e-6, 1e9);
		return true;
	default:
		return false;
	}
}

/* Options that print and leave. */
static bool take_print(const struct sim_options *o, int opt, bool *print)
{
	(void)o;
	switch (opt) {
	case OPT_PRINT:
		*print = true;
		return true;
	case OPT_DOCUMENT:
		config_document(stdout);
		exit(0);
	case OPT_DOCUMENT_TECH:
		edmsim_tech_document();
		exit(0);
	case OPT_HELP:
		fputs(usage, stdout);
		exit(0);
	case OPT_VERSION:
		puts("edmsim " EDM_VERSION);
		exit(0);
	default:
		return false;
	}
}

static void parse(struct sim_options *o, int argc, char **argv, bool *print)
{
	int opt;

	while ((opt = getopt_long(argc, argv, "", options, NULL)) != -1) {
		if (!take_print(o, opt, print) && !take_word(o, opt) &&
		    !take_flag(o, opt) && !take_number(o, opt))
			exit(EX_USAGE);
	}
	if (*print || o->print_tech)
		return;
	if (optind + 1 != argc) {
		fputs(usage, stderr);
		exit(EX_USAGE);
	}
	o->job = argv[optind];
	if (o->there_and_back && !o->dry_run)
		refuse("--there-and-back", "alone", "--dry-run beside it");
	if (o->budget > 0 && !o->tune_servo && !o->tune)
		refuse("--budget", "alone", "--tune or --tune-contour beside it");
	if (o->json && !o->tune_servo)
		refuse("--json", "alone", "--tune beside it");
	if (o->tune_servo && (o->trace || o->pulses || o->plot || o->report))
		refuse("--tune", "with a file of one run",
		       "--json, or one of --trace --pulses --plot --report "
		       "without --tune");
}

/* What the command line says of pulses goes before the machine file. */
static void configure_pulses(struct machine_config *c,
			     const struct sim_options *o)
{
	if (o->strategy) {
		c->strategy = interp_strategy_parse(o->strategy);
		if (c->strategy < 0)
			refuse("--strategy", o->strategy,
			       "simultaneous, point-by-point, centred, dda, "
			       "main-direction or min-switch");
	}
	if (o->coupling) {
		c->coupling = interp_coupling_parse(o->coupling);
		if (c->coupling < 0)
			refuse("--coupling", o->coupling, "star, tree or tube");
	}
	if (o->tolerance_given)
		c->tolerance_pulses = o->tolerance_pulses;
	if (o->fit_given)
		c->fit_um = o->fit_um;
	if (o->perpendicular)
		c->perpendicular = 1;
}

static int configure(struct machine_config *c, const struct sim_options *o)
{
	struct interp_diag d = { 0 };
	int r = 0;

	config_defaults(c);
	if (o->machine_file)
		r = config_read(c, o->machine_file, &d);
	if (r == 0)
		r = config_check_kinematics(c, &d);
	/* Axes that are led by the cycle have what the cycle has. */
	if (r == 0 && c->sim.loops && !o->tune)
		r = config_check_contouring(c, &d);
	if (r == -EINVAL) {
		config_say(o->machine_file, &d);
		return EX_CONFIG;
	}
	if (r < 0) {
		fprintf(stderr, "edmsim: %s: %s; a machine file\n",
			o->machine_file, strerror(-r));
		return EX_NOINPUT;
	}
	if (o->period_us > 0)
		c->period_us = o->period_us;
	configure_pulses(c, o);
	if (o->unit_um > 0)
		c->threeb_unit_um = o->unit_um;
	if (o->offset_um >= 0)
		c->fourb_offset_um = o->offset_um;
	return 0;
}

static int finish(struct sim_run *r)
{
	const bool to_stdout = r->o->report && strcmp(r->o->report, "-") == 0;
	int e = 0;

	if (!r->o->quiet)
		report_print(r, to_stdout ? stderr : stdout);
	if (r->o->report)
		e = report_write(r, r->o->report);
	if (e == 0 && r->o->plot)
		e = plot_finish(r->plot) < 0 ? EX_CANTCREAT : 0;
	return e ? e : strcmp(r->result.outcome, "done") != 0;
}

static int print_tech(const struct sim_options *o,
		      const struct machine_config *c)
{
	struct config_tech t;
	int e = edmsim_tech_load(&t, o, c);

	if (e == 0)
		e = edmsim_tech_print(&t);
	config_tech_free(&t);
	return e;
}

static void check(const struct sim_run *r)
{
	job_describe(&r->job, stdout);
	plan_print(&r->job, r->config, stdout);
}

static int run_whole(struct sim_run *r)
{
	const bool wanted = r->o->report && r->o->dry_run;
	const bool looks = wanted && edmsim_contour_look(r);
	int e;

	if (wanted && !looks)
		tune_contour_watch(r);
	e = run_job(r);
	if (looks)
		edmsim_contour_looked(r);
	else
		tune_contour_measure(r);
	return e ? e : finish(r);
}

int main(int argc, char **argv)
{
	static struct machine_config config;
	static struct sim_run run;
	struct sim_options o = { .offset_um = -1 };
	bool print = false;
	int e;

	parse(&o, argc, argv, &print);
	e = configure(&config, &o);
	if (e)
		return e;
	if (print) {
		config_print(&config, stdout);
		return 0;
	}
	if (o.print_tech)
		return print_tech(&o, &config);
	if (o.plot && plot_check("edmsim", o.plot) < 0)
		return EX_CANTCREAT;
	run.o = &o;
	run.config = &config;
	e = job_load(&run.job, &o, &config);
	if (e == 0 && o.check)
		check(&run);
	else if (e == 0 && o.tune)
		e = tune_contour(&run);
	else if (e == 0 && o.emit)
		e = job_emit(&run.job, &o, &config);
	else if (e == 0 && o.tune_servo)
		e = tune_servo(&o, &config, &run.job);
	else if (e == 0)
		e = run_whole(&run);
	free(run.spent);
	job_unload(&run.job);
	return e;
}
