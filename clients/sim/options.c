/* SPDX-License-Identifier: Apache-2.0 */
/* options.c - edmsim: the table of its options, and their combinations */
#include "sim.h"

#include "cmdline.h"
#include "names.h"
#include "interp/setting_text.h"

#include <math.h>
#include <string.h>
#include <sysexits.h>

#define AT(field)	.at = offsetof(struct sim_options, field)
#define FLAG(field)	.kind = CMDLINE_FLAG, AT(field)
#define WORD(field)	.kind = CMDLINE_WORD, AT(field)
#define WHOLE(field)	.kind = CMDLINE_WHOLE, AT(field)
#define NUMBER(field, low, high) \
	.kind = CMDLINE_NUMBER, AT(field), .min = (low), .max = (high)
#define CALL(function)	.kind = CMDLINE_CALL, .take = (function)

static int refuse(const char *what, const char *value, const char *wanted)
{
	return cmdline_refuse("edmsim", what, value, wanted);
}

/* One line for each, and the names of the meanings for files of dialects. */
static int take_document_dialects(void *to, const char *text)
{
	(void)to, (void)text;
	for (int i = 0; interp_dialect_word(i); i++)
		printf("%s\n", interp_dialect_word(i));
	printf("\nmeanings:\n");
	for (int i = 0; interp_dialect_meaning(i); i++)
		printf("%s\n", interp_dialect_meaning(i));
	return EX_OK;
}

static const char *strategy_word(int i)
{
	return i < INTERP_NSTRATEGIES ?
	       interp_strategy_name((enum interp_strategy)i) : NULL;
}

static int take_strategy(void *to, const char *text)
{
	struct sim_options *o = to;
	char all[160];

	o->strategy = interp_strategy_parse(text);
	return o->strategy >= 0 ? -1 :
	       refuse("--strategy", text, names_join(strategy_word, all,
						     sizeof(all)));
}

static const char *coupling_word(int i)
{
	return i < INTERP_NCOUPLINGS ?
	       interp_coupling_name((enum interp_coupling)i) : NULL;
}

static int take_coupling(void *to, const char *text)
{
	struct sim_options *o = to;
	char all[160];

	o->coupling = interp_coupling_parse(text);
	return o->coupling >= 0 ? -1 :
	       refuse("--coupling", text, names_join(coupling_word, all,
						     sizeof(all)));
}

static int take_emit(void *to, const char *text)
{
	struct sim_options *o = to;

	if (strcmp(text, "3b") != 0 && strcmp(text, "4b") != 0 &&
	    strcmp(text, "iso") != 0)
		return refuse("--emit", text, "3b, 4b or iso");
	o->emit = text;
	return -1;
}

static int take_document_config(void *to, const char *text)
{
	(void)to, (void)text;
	config_document(stdout);
	return EX_OK;
}

static int take_document_tech(void *to, const char *text)
{
	(void)to, (void)text;
	edmsim_tech_document();
	return EX_OK;
}

/* clang-format off */
static const struct cmdline_row rows[] = {
	{ "machine", "FILE", WORD(machine_file), .help =
	  "machine file; default: eight axes, +-200 mm" },
	{ "dialect", "NAME", WORD(dialect), .help =
	  "dialect of the job: a name that --document-dialects\n"
	  "lists, or a file .ini (default: by the job's name for\n"
	  ".3b and .4b, otherwise the machine file's)" },
	{ "document-dialects", NULL, CALL(take_document_dialects), .help =
	  "print the dialects and what their words can mean, and\n"
	  "exit" },
	{ "tech", "FILE", WORD(tech), .help =
	  "technology table, .tech or .enc (machine file's)" },
	{ "print-tech", NULL, FLAG(print_tech), .help =
	  "print that table as a .tech text, and exit" },
	{ "document-tech", NULL, CALL(take_document_tech), .help =
	  "print the fields of a condition as Markdown, and exit" },
	{ "unit-um", "N", NUMBER(unit_um, 0.001, 1000), .help =
	  "unit of a 3B or 4B program (machine file's, 1)" },
	{ "offset-um", "N", NUMBER(offset_um, 0, 10000), .help =
	  "offset of the wire, for 4B (machine file's, 0)" },
	{ "wire-offset", "MM", WORD(set[INTERP_SET_WIRE]), .help =
	  "set for a 3B program: the wire left of its contour,\n"
	  "below 0 right of it (machine file's, 0)" },
	{ "taper", "DEG", WORD(set[INTERP_SET_TAPER]), .help =
	  "set for it: the top leans to the left, below 0 to the\n"
	  "right; of NC code under its G41 or G42 (machine file's\n"
	  "for 3B and 4B, 0)" },
	{ "plane", "MM", WORD(set[INTERP_SET_PLANE]), .help =
	  "set for it: height of the plane of X Y (machine file's)" },
	{ "second-plane", "MM", WORD(set[INTERP_SET_SECOND]), .help =
	  "set for it: height of the plane of U V (machine file's)" },
	{ "scale", "X", WORD(set[INTERP_SET_SCALE]), .help =
	  "set for it: by so much larger (machine file's, 1)" },
	{ "turn", "DEG", WORD(set[INTERP_SET_TURN]), .help =
	  "set for it: turned about its start, from X toward Y\n"
	  "(machine file's, 0)" },
	{ "mirror", "AXIS", WORD(set[INTERP_SET_MIRROR]), .help =
	  "set for it: x, y or exchange (machine file's, none)" },
	{ "emit", "FORMAT", CALL(take_emit), .help =
	  "3b, 4b or iso: write the job to stdout, do not run it" },
	{ "strategy", "NAME", CALL(take_strategy), .help =
	  "simultaneous, point-by-point, centred,\n"
	  "main-direction, min-switch (machine file's)" },
	{ "tolerance", "PULSES",
	  NUMBER(tolerance_pulses, 0, INTERP_TOLERANCE_MAX / 1000), .help =
	  "how far main-direction and min-switch may be off\n"
	  "along the shorter axis (machine file's, 2)" },
	{ "perpendicular", NULL, FLAG(perpendicular), .help =
	  "measure the tolerance square to the path instead" },
	{ "coupling", "NAME", CALL(take_coupling), .help =
	  "of three or more axes: star, tree (machine file's,\n"
	  "star)" },
	{ "fit", "UM", NUMBER(fit_um, 0, 1000), .help =
	  "join cut lines into curves that are this near to\n"
	  "them (machine file's, 0: do not join)" },
	{ "from-line", "N", WHOLE(from_line), .help =
	  "begin at line N, as edmctl submit --from-line does" },
	{ "from-place", "MM", NUMBER(from_mm, 1e-6, 1e9), .help =
	  "begin at this place of the path" },
	{ "dry-run", NULL, FLAG(dry_run), .help =
	  "run without a gap: walk at the programmed feed" },
	{ "there-and-back", NULL, FLAG(there_and_back), .help =
	  "with --dry-run: walk to the end, back, and to the end" },
	{ "period-us", "N", NUMBER(period_us, 20, 20000), .help =
	  "period of the cycle (machine file's, 1000)" },
	{ "seed", "N", WHOLE(seed), .help =
	  "seed of all random processes (machine file's, 1)" },
	{ "speed", "X", NUMBER(speed, 0, 1e6), .help =
	  "run at X times real time; 0: as fast as possible (0)" },
	{ "limit-s", "S", NUMBER(limit_s, 1e-6, 1e9), .help =
	  "stop after S virtual seconds" },
	{ "pulses", "FILE", WORD(pulses), .help =
	  "write a CSV of every lattice point that was passed" },
	{ "trace", "FILE", WORD(trace), .help =
	  "write a CSV of every cycle" },
	{ "report", "FILE", WORD(report), .help =
	  "write a JSON report; - for stdout" },
	{ "plot", "FILE", WORD(plot), .help =
	  "draw a picture, PNG or SVG according to the name" },
	{ "tune-contour", NULL, FLAG(tune), .help =
	  "find the gains of [contour] method on models of the\n"
	  "axes along this job, and print them" },
	{ "check", NULL, FLAG(check), .help =
	  "only read and compile; print what the job would do;\n"
	  "the files that are asked for are those of --dry-run" },
	{ "tune", NULL, FLAG(tune_servo), .help =
	  "find the best servo and jump values and print them as\n"
	  "lines of a machine file; --seed, --limit-s (60)" },
	{ "budget", "N", NUMBER(budget, 1, 1e6), .help =
	  "number of trials of --tune or --tune-contour (200)" },
	{ "json", NULL, FLAG(json), .help =
	  "print the result of --tune as JSON" },
	{ "quiet", NULL, FLAG(quiet), .help =
	  "print no progress and no summary" },
	{ "print-config", NULL, FLAG(print_config), .help =
	  "print the machine file in force, and exit" },
	{ "document-config", NULL, CALL(take_document_config), .help =
	  "print every key of a machine file as Markdown, and exit" },
};
/* clang-format on */

static const struct cmdline table = {
	.program = "edmsim", .row = rows, .nrows = sizeof(rows) / sizeof(*rows),
	.args_max = 1, .column = 23,
	.head =
"Usage: edmsim [options] JOB\n"
"Runs a job in virtual time, with edmd's own cycle on a simulated machine.\n"
"JOB is NC code (.ngc .nc .iso .3b .4b); - is stdin.\n"
"\n",
	.tail =
"\n"
"Exit: 0 done, 1 ended by a fault or the limit, 64 wrong command line,\n"
"65 job refused, 66 no such file, 73 cannot create, 78 machine file refused.\n",
};

static int check_setting(struct sim_options *o)
{
	struct interp_wire w = { .z_program_mm = -INFINITY,
				 .z_second_mm = INFINITY };
	struct interp_setting s = { 0 };
	struct interp_diag d;

	if (!cmdline_pairs(interp_set_name, o->set, o->setting,
			   sizeof(o->setting)))
		return refuse("what is set for the job", "is too long",
			      "shorter numbers");
	return interp_setting_read(o->setting, &s, &w, &d) == 0 ? -1 :
	       refuse("set for the job:", d.found, d.wanted);
}

/* Checks that need more than one option. */
static int check_together(const struct sim_options *o)
{
	if (!o->job)
		return refuse("no", "JOB", "a file of NC code, or - for stdin; "
			      "--help lists the options");
	if (o->from_line > UINT32_MAX)
		return refuse("--from-line", "too large", "a line of the job");
	if (o->from_line && o->from_mm > 0)
		return refuse("--from-line", "with --from-place",
			      "one of them");
	if (o->check + (o->emit != NULL) + o->tune_servo + o->tune > 1)
		return refuse("two", "of --check, --emit, --tune and "
			      "--tune-contour", "one of them");
	if (o->there_and_back && !o->dry_run)
		return refuse("--there-and-back", "alone",
			      "--dry-run beside it");
	if (o->budget > 0 && !o->tune_servo && !o->tune)
		return refuse("--budget", "alone",
			      "--tune or --tune-contour beside it");
	if (o->json && !o->tune_servo)
		return refuse("--json", "alone", "--tune beside it");
	if (o->tune_servo && (o->trace || o->pulses || o->plot || o->report))
		return refuse("--tune", "with a file of one run",
			      "--json, or one of --trace --pulses --plot "
			      "--report without --tune");
	return -1;
}

int edmsim_options_read(struct sim_options *o, int argc, char **argv)
{
	struct cmdline_given given;
	int code;

	*o = (struct sim_options) {
		.offset_um = -1, .strategy = -1, .coupling = -1,
	};
	code = cmdline_take(&table, o, argc, argv, &given);
	if (code >= 0)
		return code;
	if (cmdline_has(&table, &given, "from-line") && o->from_line == 0)
		return refuse("--from-line", "0", "the number of a line of "
			      "the file, 1 is the first");
	code = check_setting(o);
	if (code >= 0)
		return code;
	o->job = argv[given.first];
	o->dry_run = o->dry_run || o->tune || o->check;
	o->budget = floor(o->budget);
	o->tolerance_given = cmdline_has(&table, &given, "tolerance");
	o->fit_given = cmdline_has(&table, &given, "fit");
	o->seed_given = cmdline_has(&table, &given, "seed");
	return o->print_config || o->print_tech ? -1 : check_together(o);
}
