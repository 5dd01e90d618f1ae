/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - edm-plan: options, and what to do with them
 */
#include "check.h"
#include "measure.h"
#include "plan.h"

#include "interp/compile.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

static const char usage[] =
"Usage: edm-plan --part STL --electrode STL [options] -o OUT PROGRAM\n"
"       edm-plan --part STL --electrode STL [options] -o OUT --end-pose AXES\n"
"       edm-plan --part STL --electrode STL [options] --check PROGRAM\n"
"Plans the way of an electrode into a cavity in the fewest straight blocks of the\n"
"machine's axes, and proves that each keeps a clearance; or proves a program.\n"
"\n"
"  --part FILE          the finished part: the frame of the work, axes at 0\n"
"  --electrode FILE     electrode, stem and holder; its origin is the tip of\n"
"                       [kinematics]\n"
"  --machine FILE       machine file: [kinematics], travel, [work]\n"
"  --check              prove PROGRAM free, or show the first contact\n"
"  --measure            PROGRAM is a list of poses, X Y Z A B C a line: print\n"
"                       the distance at each\n"
"  --end-pose AXES      plan to this pose, as X0,Y0,Z-60,A0: no program is given\n"
"  -o, --output FILE    the program; - is standard output\n"
"  --report FILE        JSON report; - is standard output\n"
"  --picture FILE       SVG of start, nodes and end\n"
"  --view FILE          HTML page to turn it and step through it\n"
"  --times              how long each program takes, by edmsim\n"
"  --clearance MM       to be kept (the gap of [sim] and 0.05)\n"
"  --chord MM           error of the meshes' chords (guessed from their bends)\n"
"  --end-zone MM        so near to the end pose the clearance falls to its own\n"
"  --on-path            nodes of the program only: move none off it\n"
"  --no-pivot           do not look for a better place of the work\n"
"  --unit NAME          of the meshes: mm, inch, m (mm)\n"
"  --part-at X,Y,Z      shift of the part's mesh, mm\n"
"  --electrode-at X,Y,Z shift of the electrode's mesh, mm\n"
"  --any-size           take meshes of under 1 mm or over 10 m\n"
"  --accept-flaws       take open meshes, and meshes that cross themselves\n"
"  --dialect NAME       of PROGRAM (by the file's name: .3b, .4b, else generic)\n"
"  --quiet              no progress, no summary\n"
"  --help, --version\n"
"\n"
"Exit: 0 done, 1 not free or no way found, 64 usage, 65 bad input, 66 no such\n"
"file, 71 out of memory, 73 cannot create, 78 bad machine file.\n";

enum {
	OPT_PART = 256, OPT_ELECTRODE, OPT_MACHINE, OPT_CHECK, OPT_MEASURE,
	OPT_END_POSE, OPT_REPORT, OPT_PICTURE, OPT_VIEW, OPT_TIMES,
	OPT_CLEARANCE, OPT_CHORD, OPT_END_ZONE, OPT_ON_PATH, OPT_NO_PIVOT,
	OPT_UNIT, OPT_PART_AT, OPT_ELECTRODE_AT, OPT_ANY_SIZE, OPT_FLAWS,
	OPT_DIALECT, OPT_QUIET, OPT_HELP, OPT_VERSION,
};

static const struct option options[] = {
	{ "part", required_argument, NULL, OPT_PART },
	{ "electrode", required_argument, NULL, OPT_ELECTRODE },
	{ "machine", required_argument, NULL, OPT_MACHINE },
	{ "check", no_argument, NULL, OPT_CHECK },
	{ "measure", no_argument, NULL, OPT_MEASURE },
	{ "end-pose", required_argument, NULL, OPT_END_POSE },
	{ "output", required_argument, NULL, 'o' },
	{ "report", required_argument, NULL, OPT_REPORT },
	{ "picture", required_argument, NULL, OPT_PICTURE },
	{ "view", required_argument, NULL, OPT_VIEW },
	{ "times", no_argument, NULL, OPT_TIMES },
	{ "clearance", required_argument, NULL, OPT_CLEARANCE },
	{ "chord", required_argument, NULL, OPT_CHORD },
	{ "end-zone", required_argument, NULL, OPT_END_ZONE },
	{ "on-path", no_argument, NULL, OPT_ON_PATH },
	{ "no-pivot", no_argument, NULL, OPT_NO_PIVOT },
	{ "unit", required_argument, NULL, OPT_UNIT },
	{ "part-at", required_argument, NULL, OPT_PART_AT },
	{ "electrode-at", required_argument, NULL, OPT_ELECTRODE_AT },
	{ "any-size", no_argument, NULL, OPT_ANY_SIZE },
	{ "accept-flaws", no_argument, NULL, OPT_FLAWS },
	{ "dialect", required_argument, NULL, OPT_DIALECT },
	{ "quiet", no_argument, NULL, OPT_QUIET },
	{ "help", no_argument, NULL, OPT_HELP },
	{ "version", no_argument, NULL, OPT_VERSION },
	{ 0 },
};

static void refuse(const char *what, const char *value, const char *wanted)
{
	fprintf(stderr, "edm-plan: %s %s; %s\n", what, value, wanted);
	exit(EX_USAGE);
}

static double number(const char *name, double min, double max)
{
	char *end, wanted[80];
	const double v = strtod(optarg, &end);

	if (end != optarg && *end == '\0' && v >= min && v <= max)
		return v;
	snprintf(wanted, sizeof(wanted), "a number from %g to %g", min, max);
	refuse(name, optarg, wanted);
	return 0;
}

static void three(const char *name, double ret[3])
{
	const char *s = optarg;

	for (int k = 0; k < 3; k++) {
		char *end;

		ret[k] = strtod(s, &end);
		if (end == s || !(fabs(ret[k]) <= 1e5) ||
		    *end != (k < 2 ? ',' : '\0'))
			refuse(name, optarg, "three numbers of mm, as in "
			       "0,12.5,-3");
		s = end + 1;
	}
}

static void end_pose(struct job_options *o)
{
	static const char letters[] = INTERP_AXIS_LETTERS;
	const char *s = optarg;

	o->end_given = true;
	for (;;) {
		const char *axis = *s ? strchr(letters, *s & ~0x20) : NULL;
		char *end;
		double v;

		if (!axis)
			break;
		v = strtod(s + 1, &end);
		if (end == s + 1 || !(fabs(v) <= 1e6))
			break;
		o->end[axis - letters] = v;
		if (*end == '\0')
			return;
		if (*end != ',')
			break;
		s = end + 1;
	}
	refuse("--end-pose", optarg, "machine coordinates of the end, as in "
	       "X0,Y0,Z-60,A12.5");
}

static void unit(struct job_options *o)
{
	static const struct { const char *name; double mm; } units[] = {
		{ "mm", 1 }, { "inch", 25.4 }, { "m", 1000 },
	};

	for (unsigned int i = 0; i < sizeof(units) / sizeof(units[0]); i++) {
		if (strcmp(optarg, units[i].name) == 0) {
			o->unit_mm = units[i].mm;
			return;
		}
	}
	refuse("--unit", optarg, "mm, inch or m");
}

static bool take_file(struct job_options *o, int opt)
{
	const char **at = opt == OPT_PART ? &o->part :
			  opt == OPT_ELECTRODE ? &o->electrode :
			  opt == OPT_MACHINE ? &o->machine_file :
			  opt == 'o' ? &o->output :
			  opt == OPT_REPORT ? &o->report :
			  opt == OPT_PICTURE ? &o->picture :
			  opt == OPT_VIEW ? &o->view :
			  opt == OPT_DIALECT ? &o->dialect : NULL;

	if (!at)
		return false;
	*at = optarg;
	if (opt == OPT_DIALECT && !interp_dialect_by_name(optarg))
		refuse("--dialect", optarg, interp_dialect_names());
	return true;
}

static bool take_flag(struct job_options *o, int opt)
{
	bool *at = opt == OPT_TIMES ? &o->times :
		   opt == OPT_ON_PATH ? &o->on_path :
		   opt == OPT_NO_PIVOT ? &o->no_pivot :
		   opt == OPT_ANY_SIZE ? &o->any_size :
		   opt == OPT_FLAWS ? &o->accept_flaws :
		   opt == OPT_QUIET ? &o->quiet : NULL;

	if (at)
		*at = true;
	return at != NULL;
}

static bool take_value(struct job_options *o, int opt)
{
	switch (opt) {
	case OPT_CHECK:
		o->mode = JOB_CHECK;
		return true;
	case OPT_MEASURE:
		o->mode = JOB_MEASURE;
		return true;
	case OPT_CLEARANCE:
		o->clearance_mm = number("--clearance", 0, 100);
		return true;
	case OPT_CHORD:
		o->chord_mm = number("--chord", 0, 100);
		return true;
	case OPT_END_ZONE:
		o->end_zone_mm = number("--end-zone", 0, 1000);
		return true;
	case OPT_UNIT:
		unit(o);
		return true;
	case OPT_PART_AT:
		three("--part-at", o->part_at);
		return true;
	case OPT_ELECTRODE_AT:
		three("--electrode-at", o->electrode_at);
		return true;
	case OPT_END_POSE:
		end_pose(o);
		return true;
	default:
		return false;
	}
}

static void parse(struct job_options *o, int argc, char **argv)
{
	int opt;

	while ((opt = getopt_long(argc, argv, "o:", options, NULL)) != -1) {
		if (opt == OPT_HELP) {
			fputs(usage, stdout);
			exit(0);
		}
		if (opt == OPT_VERSION) {
			puts("edm-plan " EDM_VERSION);
			exit(0);
		}
		if (!take_file(o, opt) && !take_flag(o, opt) &&
		    !take_value(o, opt))
			exit(EX_USAGE);
	}
	if (!o->part || !o->electrode || argc - optind != !o->end_given) {
		fputs(usage, stderr);
		exit(EX_USAGE);
	}
	o->program = o->end_given ? NULL : argv[optind];
	if (o->mode == JOB_PLAN && !o->output)
		refuse("no file", "for the program", "-o FILE, or --check");
	if (o->mode != JOB_PLAN && o->end_given)
		refuse("--end-pose", "beside --check", "one of the two");
}

int main(int argc, char **argv)
{
	static struct job job;
	struct job_options o = { .unit_mm = 1, .clearance_mm = -1,
				 .chord_mm = -1 };
	int r;

	parse(&o, argc, argv);
	bar_catch();
	r = job_load(&job, &o);
	if (r == 0)
		r = o.mode == JOB_CHECK ? check_program(&job) :
		    o.mode == JOB_MEASURE ? measure_poses(&job) :
		    plan_program(&job);
	job_free(&job);
	return r;
}
