/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - edm-plan: options, and what to do with them
 */
#include "check.h"
#include "cmdline.h"
#include "measure.h"
#include "plan.h"

#include "interp/compile.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define PROGRAM	"edm-plan"

static int refuse(const char *what, const char *value, const char *wanted)
{
	return cmdline_refuse(PROGRAM, what, value, wanted);
}

static int three(const char *name, const char *s, double ret[3])
{
	const char *whole = s;

	for (int k = 0; k < 3; k++) {
		char *end;

		ret[k] = strtod(s, &end);
		if (end == s || !(fabs(ret[k]) <= 1e5) ||
		    *end != (k < 2 ? ',' : '\0'))
			return refuse(name, whole, "three numbers of mm, as "
				      "in 0,12.5,-3");
		s = end + 1;
	}
	return -1;
}

static int take_part_at(void *to, const char *text)
{
	return three("--part-at", text, ((struct job_options *)to)->part_at);
}

static int take_electrode_at(void *to, const char *text)
{
	return three("--electrode-at", text,
		     ((struct job_options *)to)->electrode_at);
}

static int take_end_pose(void *to, const char *text)
{
	static const char letters[] = INTERP_AXIS_LETTERS;
	struct job_options *o = to;
	const char *s = text;

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
		o->end_axes |= 1u << (axis - letters);
		if (*end == '\0')
			return -1;
		if (*end != ',')
			break;
		s = end + 1;
	}
	return refuse("--end-pose", text, "machine coordinates of the end, as "
		      "in X0,Y0,Z-60,A12.5");
}

static int take_unit(void *to, const char *text)
{
	static const struct { const char *name; double mm; } units[] = {
		{ "mm", 1 }, { "inch", 25.4 }, { "m", 1000 },
	};

	for (unsigned int i = 0; i < sizeof(units) / sizeof(units[0]); i++) {
		if (strcmp(text, units[i].name) == 0) {
			((struct job_options *)to)->unit_mm = units[i].mm;
			return -1;
		}
	}
	return refuse("--unit", text, "mm, inch or m");
}

#define AT(field)	offsetof(struct job_options, field)

static const struct cmdline_row rows[] = {
	{ "part", "FILE", CMDLINE_WORD, AT(part), .help =
	  "the finished part: the frame of the work, axes at 0" },
	{ "electrode", "FILE", CMDLINE_WORD, AT(electrode), .help =
	  "electrode, stem and holder; its origin is the\n"
	  "tip of [kinematics]" },
	{ "machine", "FILE", CMDLINE_WORD, AT(machine_file), .help =
	  "machine file: [kinematics], travel, [work]" },
	{ "check", NULL, CMDLINE_FLAG, AT(check), .help =
	  "prove PROGRAM free, or show the first contact" },
	{ "measure", NULL, CMDLINE_FLAG, AT(measure), .help =
	  "PROGRAM is a list of poses, X Y Z A B C a line:\n"
	  "print the distance at each" },
	{ "end-pose", "AXES", CMDLINE_CALL, .take = take_end_pose, .help =
	  "plan to this pose, as X0,Y0,Z-60,A0; no PROGRAM" },
	{ "output", "FILE", CMDLINE_WORD, AT(output), .help =
	  "the program; - is standard output" },
	{ "report", "FILE", CMDLINE_WORD, AT(report), .help =
	  "JSON report; - is standard output" },
	{ "picture", "FILE", CMDLINE_WORD, AT(picture), .help =
	  "SVG of start, nodes, end and the clearance" },
	{ "view", "FILE", CMDLINE_WORD, AT(view), .help =
	  "HTML page to turn it and step through it" },
	{ "times", NULL, CMDLINE_FLAG, AT(times), .help =
	  "how long each program takes, by edmsim" },
	{ "clearance", "MM", CMDLINE_NUMBER, AT(clearance_mm), 0, 100, .help =
	  "to be kept (the gap of [sim] and 0.05)" },
	{ "chord", "MM", CMDLINE_NUMBER, AT(chord_mm), 0, 100, .help =
	  "error of the meshes' chords (guessed from bends)" },
	{ "end-zone", "MM", CMDLINE_NUMBER, AT(end_zone_mm), 0, 1000, .help =
	  "so near to the end pose the clearance falls to\nits own" },
	{ "budget", "S", CMDLINE_NUMBER, AT(budget_s), 1, 1e6, .help =
	  "seconds of the processor for the search of\n--end-pose (60)" },
	{ "on-path", NULL, CMDLINE_FLAG, AT(on_path), .help =
	  "nodes of the program only: move none off it" },
	{ "no-pivot", NULL, CMDLINE_FLAG, AT(no_pivot), .help =
	  "do not look for a better place of the work" },
	{ "unit", "NAME", CMDLINE_CALL, .take = take_unit, .help =
	  "of the meshes: mm, inch, m (mm)" },
	{ "part-at", "X,Y,Z", CMDLINE_CALL, .take = take_part_at, .help =
	  "shift of the part's mesh, mm" },
	{ "electrode-at", "X,Y,Z", CMDLINE_CALL, .take = take_electrode_at,
	  .help = "shift of the electrode's mesh, mm" },
	{ "any-size", NULL, CMDLINE_FLAG, AT(any_size), .help =
	  "take meshes of under 1 mm or over 10 m" },
	{ "accept-flaws", NULL, CMDLINE_FLAG, AT(accept_flaws), .help =
	  "take meshes that are open or cross themselves" },
	{ "dialect", "NAME", CMDLINE_WORD, AT(dialect), .help =
	  "of PROGRAM, a name or a file .ini (.3b and .4b by its\n"
	  "name, else the machine file's)" },
	{ "quiet", NULL, CMDLINE_FLAG, AT(quiet), .help =
	  "no progress, no summary" },
};

static const struct cmdline table = {
	.program = PROGRAM,
	.head =
"Usage: edm-plan --part STL --electrode STL [options] --output FILE PROGRAM\n"
"       edm-plan --part STL --electrode STL [options] --check PROGRAM\n"
"Plans the way of an electrode into a cavity in the fewest straight blocks of\n"
"the machine's axes, each proved to keep a clearance; or proves a program.\n"
"\n",
	.tail =
"\n"
"Exit: 0 done, 1 not free or no way found, 64 usage, 65 bad input, 66 no such\n"
"file, 70 no times, 71 out of memory, 73 cannot create, 74 cannot write,\n"
"78 bad machine file.\n",
	.row = rows, .nrows = sizeof(rows) / sizeof(rows[0]), .args_max = 1,
	.column = 24,
};

/* Do the options fit each other?  -1: they do. */
static int judge(const struct job_options *o)
{
	if (!o->part || !o->electrode)
		return refuse(o->part ? "--electrode" : "--part", "is missing",
			      "--part STL --electrode STL");
	if (!o->program == !o->end_given)
		return refuse("PROGRAM", o->program ? "beside --end-pose" :
			      "is missing", "one of the two");
	if ((o->check || o->measure) && o->end_given)
		return refuse("--end-pose", "beside --check or --measure",
			      "a PROGRAM");
	if ((o->check || o->measure) && o->output)
		return refuse("--output", "beside --check or --measure",
			      "--report, --picture or --view, beside --check");
	if (o->measure && (o->report || o->picture || o->view))
		return refuse("--report, --picture or --view", "beside "
			      "--measure", "the distances on standard output");
	if (!o->check && !o->measure && !o->output)
		return refuse("--output", "is missing", "--output FILE, or "
			      "--check");
	return -1;
}

int main(int argc, char **argv)
{
	static struct job job;
	struct job_options o = { .unit_mm = 1, .clearance_mm = -1,
				 .chord_mm = -1, .budget_s = 60 };
	struct cmdline_given given;
	int err = cmdline_take(&table, &o, argc, argv, &given);

	if (err >= 0)
		return err;
	o.program = given.first < argc ? argv[given.first] : NULL;
	err = judge(&o);
	if (err >= 0)
		return err;
	err = put_check(&o);
	if (err)
		return err;
	/* Before it is loaded Ctrl-C has nothing to save. */
	err = job_load(&job, &o);
	if (err == 0) {
		bar_catch();
		err = o.check ? check_program(&job) :
		    o.measure ? measure_poses(&job) : plan_program(&job);
	}
	job_free(&job);
	return err;
}
