/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - edmctl: options and the table of verbs
 */
#include "ctl.h"

#include "cmdline.h"
#include "faults.h"
#include "names.h"
#include "nearest.h"

#include "interp/tech.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* If the id were cut, two jobs could become one. */
static int take_id(void *to, const char *id)
{
	struct ctl *c = to;

	c->id = id;
	if (*id && strlen(id) < TALK_WORD_MAX)
		return -1;
	fprintf(stderr, "edmctl: --id of %zu bytes; 1 to %d of A-Z a-z 0-9 . _ "
		"-\n", strlen(id), TALK_WORD_MAX - 1);
	return EX_USAGE;
}

static int take_from_line(void *to, const char *word)
{
	struct ctl *c = to;
	char *end;
	long n = strtol(word, &end, 10);

	if (end == word || *end || n < 1 || n > INT32_MAX)
		return cmdline_refuse("edmctl", "--from-line", word,
				      "the number of a line of the file, 1 is "
				      "the first");
	c->from_line = (int)n;
	return -1;
}

static int take_every(void *to, const char *word)
{
	struct ctl *c = to;
	char *end;
	long n = strtol(word, &end, 10);

	if (end == word || *end || n < 1 || n > 1000000)
		return cmdline_refuse("edmctl", "--every", word,
				      "a whole number, 1 to 1000000");
	c->every = (unsigned int)n;
	return -1;
}

struct verb {
	const char *name, *args;
	int (*run)(struct ctl *c);
	int takes, needs;		/* arguments */
	bool offline;			/* asks no machine */
	const char *options;		/* of its own, in a row */
	const char *help;
};

/* clang-format off */
static const struct verb verbs[] = {
	{ "submit", "FILE", ctl_submit, 1, 1, false, 
	  "name id hold wait from-line from-place electrode taper "
	  "wire-offset scale turn mirror plane second-plane",
	  "send a job of NC code; - is standard input" },
	{ "queue", "", ctl_queue, 0, 0, false, "",
	  "print the loaded job and those that wait" },
	{ "show", "JOB", ctl_show, 1, 1, false, "",
	  "print everything about one job" },
	{ "start", "[JOB]", ctl_start, 1, 0, false, "wait",
	  "start the job that is ready or held; the queue goes on" },
	{ "hold", "", ctl_command, 0, 0, false, "",
	  "switch the power off and stop on the path" },
	{ "resume", "[JOB [AXES]]", ctl_resume, 2, 0, false, "wait",
	  "go on after a hold; or with a job that was interrupted" },
	{ "stop", "", ctl_command, 0, 0, false, "",
	  "end the job where it stands" },
	{ "done", "[NUMBER]", ctl_done, 1, 0, false, "",
	  "say that what the job asks for is done, or which electrode is in" },
	{ "retract", "MM", ctl_retract, 1, 1, false, "wait",
	  "go back along the path; the job is then held" },
	{ "step", "+N|-N", ctl_step, 1, 1, false, "wait",
	  "while held: go to the Nth node of the path, + or -" },
	{ "jog", "AXIS MM", ctl_jog, 2, 2, false, "wait",
	  "while idle: move one axis by this distance" },
	{ "jog-on", "AXIS MM/S", ctl_jog_on, 2, 2, false, "",
	  "while idle: move one axis at this speed, until Ctrl-C" },
	{ "home", "[AXIS]", ctl_home, 1, 0, false, "wait",
	  "while idle: home one axis, or all" },
	{ "place", "AXIS as-seen|is MM", ctl_place, 3, 2, false, "",
	  "while idle: say where an axis stands that nothing homes" },
	{ "override", "PERCENT", ctl_override, 1, 1, false, "",
	  "set the speed of positioning, in percent" },
	{ "set", "KEY VALUE", ctl_set, 2, 2, false, "",
	  "set a value of the condition in force; `default` undoes it" },
	{ "reset", "", ctl_command, 0, 0, false, "",
	  "leave the fault; the job is then held" },
	{ "estop", "", ctl_command, 0, 0, false, "",
	  "switch the power off; no motion until a reset" },
	{ "move", "JOB -1|+1|front|back", ctl_move, 2, 2, false, "",
	  "move a waiting job by one, or before or behind all" },
	{ "remove", "JOB", ctl_remove, 1, 1, false, "",
	  "remove a job that has not begun, or was interrupted" },
	{ "clear", "", ctl_clear, 0, 0, false, "",
	  "remove all jobs that wait in the queue" },
	{ "totals", "[WORD]", ctl_totals, 1, 0, false, "",
	  "print what each day cut; of jobs with WORD, if it is given" },
	{ "status", "", ctl_status, 0, 0, false, "",
	  "print the machine's state; exit 69 if there is no edmd" },
	{ "alarms", "", ctl_alarms, 0, 0, false, "",
	  "print the faults, why they came and what clears them" },
	{ "faults", "[FAULT]", ctl_faults, 1, 0, true, "",
	  "print what a fault, or each, means and what clears it" },
	{ "doctor", "", ctl_doctor, 0, 0, false, "pulses fix root",
	  "print what this host lacks, and the command that helps" },
	{ "watch", "", ctl_watch, 0, 0, false, "once line",
	  "show the machine while it runs, until q or Ctrl-C" },
	{ "record", "CSV", ctl_record, 1, 1, false, "every plot until-end",
	  "write every cycle to a trace file, until Ctrl-C" },
	{ "latency", "[S]", ctl_latency, 1, 0, false, "",
	  "print how late edmd woke, in the next S seconds or ever" },
	{ "history", "[JOB]", ctl_history, 1, 0, false, "csv picture",
	  "print the jobs that have ended, newest first; or one" },
	{ "support", "[FILE]", ctl_support, 1, 0, false, "",
	  "write one archive for who helps from afar; no secrets" },
	{ "keys", "list|add NAME ROLE|remove NAME", ctl_keys, 3, 1, false, "",
	  "who may command; by role" },
	{ "electrode", "list|show N|add N|set N|remove N|use N|measure N",
	  ctl_electrode, CTL_WORDS_MAX - 1, 1, false, "",
	  "the table of electrodes, and which one is in the holder" },
	{ "mdi", "LINE ...", ctl_mdi, CTL_WORDS_MAX - 1, 1, false, "",
	  "while idle: carry out lines of NC code at once" },
	{ "offset", "[G54|T3 X=0|X@0|Z=probe|bore ...]", ctl_offset,
	  CTL_WORDS_MAX - 1, 0, false, "",
	  "print the work offsets; touch off an axis, or feel for it" },
	{ "tech", "[versions|show N|set C120.servo_v=30|save FILE|back N]",
	  ctl_tech, CTL_WORDS_MAX - 1, 0, false, "",
	  "change the technology table on the host; its versions" },
	{ "generator", "[set FIELD VALUE|walk]", ctl_generator, 3, 0, false,
	  "every", "what the generator is asked for and tells; try it" },
	{ "drive", "[list|watch|emcy|scope X|get X OBJECT|set X OBJECT N|store X]",
	  ctl_drive, CTL_WORDS_MAX - 1, 0, false, "",
	  "how the drives of a bus are; their objects and emergencies" },
	{ "new-machine", "FILE", ctl_new_machine, 1, 1, true, "",
	  "ask a few questions, and write a machine file" },
	{ "commission", "FILE [again STEP]", ctl_commission, 3, 1, false, "",
	  "walk a new machine from its e-stop to its first cut" },
	{ "identify", "CSV", ctl_identify, true, true, true, "plot",
	  "find the loops of the axes in a file that record wrote" },
};

#define AT(field)	.at = offsetof(struct ctl, field)
#define SET(key)	CMDLINE_WORD, AT(set[INTERP_SET_##key])

/* The first NCOMMON options are for all verbs.  A verb names the others that it
 * takes. */
static const struct cmdline_row rows[] = {
	{ "machine", "NAME", CMDLINE_WORD, AT(machine), .help =
	  "name of the machine; default: $EDM_MACHINE, or edm" },
	{ "url", "URL", CMDLINE_WORD, AT(url), .help =
	  "URL of LCM; default: the socket of this host; if there is\n"
	  "none, $LCM_DEFAULT_URL, or " TALK_URL },
	{ "key", "FILE", CMDLINE_WORD, AT(key), .help =
	  "key to sign with; default: $EDM_KEY, or the host's key" },
	{ "json", NULL, CMDLINE_FLAG, AT(json), .help =
	  "print results as JSON" },
	{ "timeout", "S", CMDLINE_NUMBER, AT(timeout_s), .min = 1e-3,
	  .max = 3600, .help = "seconds to wait for an answer; default: 3" },
#define NCOMMON	5
	{ "name", "NAME", CMDLINE_WORD, AT(name), .help =
	  "submit: name of the job; default: that of the file" },
	{ "id", "ID", CMDLINE_CALL, .take = take_id, .help =
	  "submit: id of the job; the same id twice is one job" },
	{ "hold", NULL, CMDLINE_FLAG, AT(hold), .help =
	  "submit: load the job and wait for start" },
	{ "wait", NULL, CMDLINE_FLAG, AT(wait), .help =
	  "submit, start, resume: follow the job; retract, step, jog, home:\n"
	  "wait for the end of the motion; exit 0 if it is done, 1 if not" },
	{ "from-line", "N", CMDLINE_CALL, .take = take_from_line, .help =
	  "submit: begin at line N, and wait for start" },
	{ "from-place", "MM", CMDLINE_NUMBER, AT(from_mm), .min = 1e-6,
	  .max = 1e9, .help =
	  "submit: begin at this place of its path, and wait for start" },
	{ "electrode", "N", CMDLINE_NUMBER, AT(electrode), .min = 1,
	  .max = 9999, .help =
	  "submit: begin with electrode N, put in if it is another" },
	{ "taper", "DEG", SET(TAPER), .help =
	  "submit, of a wire: its top leans to the left; below 0 to the right" },
	{ "wire-offset", "MM", SET(WIRE), .help =
	  "submit, of 3B: the wire left of the contour; below 0 right of it" },
	{ "scale", "X", SET(SCALE), .help =
	  "submit, of 3B and 4B: by so much larger" },
	{ "turn", "DEG", SET(TURN), .help =
	  "submit, of 3B and 4B: turned about its start, from X toward Y" },
	{ "mirror", "AXIS", SET(MIRROR), .help =
	  "submit, of 3B and 4B: x, y or exchange" },
	{ "plane", "MM", SET(PLANE), .help =
	  "submit, of a wire: height of the plane of X Y" },
	{ "second-plane", "MM", SET(SECOND), .help =
	  "submit, of a wire: height of the plane of U V" },
	{ "once", NULL, CMDLINE_FLAG, AT(once), .help = "watch: print one line" },
	{ "line", NULL, CMDLINE_FLAG, AT(in_line), .help =
	  "watch: one line, not the whole terminal" },
	{ "every", "N", CMDLINE_CALL, .take = take_every, .help =
	  "record: write one cycle of N; default: 1\n"
	  "generator walk: each Nth step; default: up to 128 of a field" },
	{ "plot", "FILE", CMDLINE_WORD, AT(plot), .help =
	  "record, identify: draw the result, .png or .svg" },
	{ "pulses", "CHIP:LINE", CMDLINE_WORD, AT(pulses), .help =
	  "doctor: measure how fast an output line is; it must be free" },
	{ "fix", "FILE", CMDLINE_WORD, AT(fix), .help =
	  "doctor: set this host up for the machine of FILE" },
	{ "root", "DIR", CMDLINE_WORD, AT(root), .help =
	  "doctor --fix: the host's files lie below DIR, as of an image" },
	{ "csv", NULL, CMDLINE_FLAG, AT(csv), .help =
	  "history: print a table for other programs" },
	{ "picture", "FILE", CMDLINE_WORD, AT(picture), .help =
	  "history: draw the way of one job, .svg" },
	{ "until-end", NULL, CMDLINE_FLAG, AT(until_end), .help =
	  "record: go on until the running job, or the next, ends" },
};
/* clang-format on */

#define NVERBS		(sizeof(verbs) / sizeof(verbs[0]))

/* The verb, its arguments, and one that would be too many. */
struct words {
	char *at[CTL_WORDS_MAX + 1];
	int n;
};

static void print_verbs(void)
{
	for (size_t i = 0; i < NVERBS; i++)
		printf("  %-8s %-9s %s\n", verbs[i].name, verbs[i].args,
		       verbs[i].help);
	puts("\nOptions:");
}

static void list_verbs(void)
{
	for (size_t i = 0; i < NVERBS; i++)
		printf("verb\t%s\t%s\t%s\n", verbs[i].name,
		       *verbs[i].args ? verbs[i].args : "-", verbs[i].help);
	for (size_t i = 1; i < CYCLE_NFAULTS; i++)
		printf("word\tFAULT\t%s\n", fault_table[i].name);
	for (size_t i = 0; i < INTERP_NTECH; i++)
		printf("word\tKEY\t%s\n", interp_tech_field[i].name);
}

static const struct cmdline table = {
	.program = "edmctl", .row = rows, .nrows = sizeof(rows) / sizeof(*rows),
	.args_max = 16, .column = 18, .more = print_verbs,
	.list = list_verbs,
	.head = "Usage: edmctl [--machine NAME] [--url URL] [--json] "
		"[--timeout S] VERB ...\n\nVerbs:\n",
};

static bool takes_option(const struct verb *v, const char *name)
{
	const size_t n = strlen(name);

	for (const char *at = v->options; (at = strstr(at, name)); at += n)
		if ((at == v->options || at[-1] == ' ') &&
		    (at[n] == ' ' || at[n] == '\0'))
			return true;
	return false;
}

/* The options of a verb may stand before it, so they are checked at the end. */
static int options_check(const struct verb *v, const struct cmdline_given *g)
{
	for (size_t i = NCOMMON; i < table.nrows; i++) {
		char option[32];

		if (!(g->rows >> i & 1) || takes_option(v, rows[i].name))
			continue;
		snprintf(option, sizeof(option), "--%s", rows[i].name);
		fprintf(stderr, "edmctl: %s takes no %s; --help lists the "
			"options\n", v->name, option);
		return EX_USAGE;
	}
	return 0;
}

static int arguments_take(struct ctl *c, const struct verb *v, int argc,
			  char **argv)
{
	if (argc > 0 && v->takes > 0)
		c->arg = argv[0];
	if (argc > 1 && v->takes > 1)
		c->value = argv[1];
	if (argc > 2 && v->takes > 2)
		c->third = argv[2];
	if (argc > 2 && argc <= v->takes)
		memcpy(c->more, argv + 2, (size_t)(argc - 2) * sizeof(*argv));
	if (argc > v->takes) {
		fprintf(stderr, "edmctl: %s: '%s' is too much; edmctl %s%s%s\n",
			v->name, argv[v->takes], v->name, *v->args ? " " : "",
			v->args);
		return EX_USAGE;
	}
	if (argc < v->needs) {
		fprintf(stderr, "edmctl: %s: more is needed; edmctl %s %s\n",
			v->name, v->name, v->args);
		return EX_USAGE;
	}
	return 0;
}

/*
 * A negative number is not an option.  With a blank in front of it, getopt
 * ignores it and strtod() still reads it.
 */
static void negatives_keep(int argc, char **argv)
{
	static char room[2][64];
	size_t n = 0;

	for (int i = 1; i < argc && n < 2; i++) {
		if (argv[i][0] != '-' || !argv[i][1] ||
		    !strchr("0123456789.", argv[i][1]) ||
		    strlen(argv[i]) > sizeof(room[0]) - 2)
			continue;
		snprintf(room[n], sizeof(room[n]), " %s", argv[i]);
		argv[i] = room[n++];
	}
}

static const struct verb *verb_find(const char *name)
{
	for (size_t i = 0; i < NVERBS; i++)
		if (strcmp(verbs[i].name, name) == 0)
			return &verbs[i];
	return NULL;
}

static int refuse_verb(const char *name)
{
	struct nearest near;

	nearest_init(&near, name);
	for (size_t i = 0; i < NVERBS; i++)
		nearest_offer(&near, verbs[i].name);
	fprintf(stderr, "edmctl: no verb '%s'; %s%s%s--help lists them\n",
		name, near.word[0] ? "did you mean " : "", near.word,
		near.word[0] ? "? " : "");
	return EX_USAGE;
}

static void word_take(struct words *w, char *word)
{
	/* The blank of negatives_keep() is removed. */
	if (w->n < (int)(sizeof(w->at) / sizeof(w->at[0])))
		w->at[w->n++] = word + (word[0] == ' ' && word[1] == '-');
}

/* Return: 0: run @ret_verb; < 0: nothing is left to do; else the exit code. */
static int parse(struct ctl *c, int argc, char **argv,
		 const struct verb **ret_verb)
{
	struct words w = { .n = 0 };
	struct cmdline_given given;
	int err = cmdline_take(&table, c, argc, argv, &given);

	if (err >= 0)
		return err == EX_OK ? -1 : err;
	for (int i = given.first; i < argc; i++)
		word_take(&w, argv[i]);
	if (w.n == 0)
		return cmdline_refuse("edmctl", "no", "verb",
				      "--help lists the verbs");
	*ret_verb = verb_find(w.at[0]);
	if (!*ret_verb)
		return refuse_verb(w.at[0]);
	c->verb = (*ret_verb)->name;
	err = options_check(*ret_verb, &given);
	if (err == 0)
		err = arguments_take(c, *ret_verb, w.n - 1, w.at + 1);
	if (err == 0 && !names_machine_ok(c->machine))
		err = cmdline_refuse("edmctl", cmdline_has(&table, &given,
				     "machine") ? "--machine" : "EDM_MACHINE",
				     c->machine, NAMES_MACHINE_WANTED);
	return err;
}

int main(int argc, char **argv)
{
	struct ctl c = {
		.machine = "edm", .timeout_s = 3,
	};
	const char *machine = getenv("EDM_MACHINE");
	const struct verb *v = NULL;
	int err;

	if (machine && *machine)
		c.machine = machine;
	negatives_keep(argc, argv);
	err = parse(&c, argc, argv, &v);
	if (err)
		return err < 0 ? EX_OK : err;
	if (v->offline)
		return v->run(&c);
	if (sodium_init() < 0)
		return EX_SOFTWARE;
	/* Errors in the words of the verb are reported first. */
	c.talk_err = talk_open(&c.talk, &(struct talk_options) {
		.machine = c.machine, .url = c.url, .key = c.key,
		.program = "edmctl",
	}, c.said);
	talk_catch_signals();
	err = v->run(&c);
	talk_close(c.talk);
	return err;
}
