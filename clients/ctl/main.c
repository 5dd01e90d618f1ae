/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - edmctl: options and the table of verbs
 */
#include "ctl.h"

#include <getopt.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define URL_DEFAULT	TALK_URL

struct verb {
	const char *name, *args;
	int (*run)(struct ctl *c);
	int takes, needs;		/* arguments */
	bool offline;			/* asks no machine */
	const char *options;		/* letters of its own options */
	const char *help;
};

/* clang-format off */
static const struct verb verbs[] = {
	{ "submit", "FILE", ctl_submit, 1, 1, false, "nihw",
	  "send a job of NC code; - is standard input" },
	{ "queue", "", ctl_queue, 0, 0, false, "",
	  "the job loaded and those that wait" },
	{ "show", "JOB", ctl_show, 1, 1, false, "",
	  "all about one job" },
	{ "start", "[JOB]", ctl_start, 1, 0, false, "",
	  "start the job that is ready or held, and the queue" },
	{ "hold", "", ctl_command, 0, 0, false, "",
	  "power off, stop on the path" },
	{ "resume", "", ctl_command, 0, 0, false, "",
	  "go on after a hold" },
	{ "stop", "", ctl_command, 0, 0, false, "",
	  "end the job where it stands" },
	{ "retract", "MM", ctl_retract, 1, 1, false, "",
	  "back along the path, then held" },
	{ "step", "+N|-N", ctl_step, 1, 1, false, "",
	  "held: to the Nth node of the path, ahead or back" },
	{ "jog", "AXIS MM", ctl_jog, 2, 2, false, "",
	  "idle: move one axis so far" },
	{ "home", "[AXIS]", ctl_home, 1, 0, false, "",
	  "idle: find the place of one axis, or of all" },
	{ "override", "PERCENT", ctl_override, 1, 1, false, "",
	  "speed of positioning, of what is programmed" },
	{ "set", "KEY VALUE", ctl_set, 2, 2, false, "",
	  "a value of the condition in force; VALUE default: back" },
	{ "reset", "", ctl_command, 0, 0, false, "",
	  "leave the fault, to held" },
	{ "estop", "", ctl_command, 0, 0, false, "",
	  "power off, no motion, until reset" },
	{ "remove", "JOB", ctl_remove, 1, 1, false, "",
	  "take a job that has not begun out of the queue" },
	{ "status", "", ctl_status, 0, 0, false, "",
	  "the machine now; exits with 69 if edmd is not there" },
	{ "alarms", "", ctl_alarms, 0, 0, false, "",
	  "the fault, why and what clears it; and the last ones" },
	{ "faults", "[FAULT]", ctl_faults, 1, 0, true, "",
	  "what every fault, or one, means and what clears it" },
	{ "doctor", "", ctl_doctor, 0, 0, false, "",
	  "what this host lacks for cutting, and the command that mends it" },
	{ "watch", "", ctl_watch, 0, 0, false, "o",
	  "the machine as it goes, until Ctrl-C" },
	{ "record", "CSV", ctl_record, 1, 1, false, "epU",
	  "every cycle to a trace file, until Ctrl-C" },
	{ "latency", "[S]", ctl_latency, 1, 0, false, "",
	  "how late edmd woke, of S seconds from now or since its start" },
	{ "history", "", ctl_history, 0, 0, false, "",
	  "jobs that have ended, newest first" },
	{ "keys", "list|add NAME ROLE|remove NAME", ctl_keys, 3, 1, false, "",
	  "who may command: viewer, operator, service" },
	{ "identify", "CSV", ctl_identify, true, true, true, "p",
	  "the loops of the axes, from what record wrote" },
};

static const struct option longs[] = {
	{ "machine", required_argument, NULL, 'm' },
	{ "url",     required_argument, NULL, 'u' },
	{ "key",     required_argument, NULL, 'k' },
	{ "json",    no_argument,       NULL, 'j' },
	{ "timeout", required_argument, NULL, 't' },
	{ "name",    required_argument, NULL, 'n' },
	{ "id",      required_argument, NULL, 'i' },
	{ "hold",    no_argument,       NULL, 'h' },
	{ "wait",    no_argument,       NULL, 'w' },
	{ "once",    no_argument,       NULL, 'o' },
	{ "every",   required_argument, NULL, 'e' },
	{ "plot",    required_argument, NULL, 'p' },
	{ "until-end", no_argument,     NULL, 'U' },
	{ "help",    no_argument,       NULL, 'H' },
	{ "version", no_argument,       NULL, 'V' },
	{ NULL, 0, NULL, 0 },
};
/* clang-format on */

#define NVERBS		(sizeof(verbs) / sizeof(verbs[0]))
#define COMMON_OPTIONS	"mujtk"

/* No option is short, so -1 is a word: a number below 0.  Words in order. */
#define DIGITS		"0123456789."
#define SHORTS		"-0::1::2::3::4::5::6::7::8::9::.::"

/* The verb, its arguments, and one that is too much. */
struct words {
	char *at[5];
	int n;
};

static void print_usage(FILE *f)
{
	fputs("Usage: edmctl [--machine NAME] [--url URL] [--json] "
	      "[--timeout S] VERB ...\n\nVerbs:\n", f);
	for (size_t i = 0; i < NVERBS; i++)
		fprintf(f, "  %-8s %-9s %s\n", verbs[i].name, verbs[i].args,
			verbs[i].help);
	fputs("\nOptions:\n"
	      "  --machine NAME  of the machine; default: edm\n"
	      "  --url URL       of LCM; default: " URL_DEFAULT "\n"
	      "  --key FILE      to sign with; default: EDM_KEY, or the host's\n"
	      "  --json          print results as JSON\n"
	      "  --timeout S     wait for an answer so long; default: 3\n"
	      "  --name NAME     submit: of the job; default: the file's\n"
	      "  --id ID         submit: of the job; the same id twice is one "
	      "job\n"
	      "  --hold          submit: load it, wait for start\n"
	      "  --wait          submit: follow it; exit 0 if done, 1 if not\n"
	      "  --once          watch: one line\n"
	      "  --every N       record: one cycle of N; default: 1\n"
	      "  --plot FILE     record, identify: then draw it, .png or "
	      ".svg\n"
	      "  --until-end     record: until the job that runs, or the "
	      "next, ends\n"
	      "  --help          this\n"
	      "  --version       its version\n", f);
}

/* Cut short, two jobs would be one. */
static int id_take(struct ctl *c, const char *id)
{
	c->id = id;
	if (*id && strlen(id) < TALK_WORD_MAX)
		return 0;
	fprintf(stderr, "edmctl: --id of %zu bytes; 1 to %d of A-Z a-z 0-9 . _ "
		"-\n", strlen(id), TALK_WORD_MAX - 1);
	return EX_USAGE;
}

static int every_take(struct ctl *c, const char *word)
{
	char *end;
	long n = strtol(word, &end, 10);

	if (end == word || *end || n < 1 || n > 1000000) {
		fprintf(stderr, "edmctl: --every %s; a whole number of "
			"cycles, 1 to 1000000\n", word);
		return EX_USAGE;
	}
	c->every = (unsigned int)n;
	return 0;
}

static int option_take(struct ctl *c, int opt)
{
	char *end;

	switch (opt) {
	case 'm':
		c->machine = optarg;
		break;
	case 'u':
		c->url = optarg;
		break;
	case 'k':
		c->key = optarg;
		break;
	case 'j':
		c->json = true;
		break;
	case 't':
		c->timeout_s = strtod(optarg, &end);
		if (*end || !(c->timeout_s > 0 && c->timeout_s <= 3600)) {
			fprintf(stderr, "edmctl: --timeout %s; seconds above "
				"0, at most 3600\n", optarg);
			return EX_USAGE;
		}
		break;
	case 'n':
		c->name = optarg;
		break;
	case 'i':
		return id_take(c, optarg);
	case 'h':
		c->hold = true;
		break;
	case 'w':
		c->wait = true;
		break;
	case 'o':
		c->once = true;
		break;
	case 'e':
		return every_take(c, optarg);
	case 'p':
		c->plot = optarg;
		break;
	case 'U':
		c->until_end = true;
		break;
	}
	return 0;
}

/* A verb's options may stand before it, so they are checked at the end. */
static int options_check(const struct verb *v, const char *given)
{
	for (; *given; given++) {
		if (strchr(COMMON_OPTIONS, *given) ||
		    strchr(v->options, *given))
			continue;
		for (int i = 0; longs[i].name; i++)
			if (longs[i].val == *given)
				fprintf(stderr, "edmctl: %s takes no --%s; "
					"--help lists the options\n", v->name,
					longs[i].name);
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
	if (argc > v->takes) {
		fprintf(stderr, "edmctl: %s: '%s' is too much; edmctl %s%s%s\n",
			v->name, argv[v->takes], v->name, *v->args ? " " : "",
			v->args);
		return EX_USAGE;
	}
	if (argc < v->needs) {
		fprintf(stderr, "edmctl: %s: what? edmctl %s %s\n", v->name,
			v->name, v->args);
		return EX_USAGE;
	}
	return 0;
}

/*
 * A number below zero is no option.  With a blank in front getopt passes it by
 * and strtod() reads it the same.
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

static int machine_check(const char *name)
{
	size_t n = strlen(name);

	if (n > 0 && n < 32 && name[strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
		"abcdefghijklmnopqrstuvwxyz0123456789_-")] == '\0')
		return 0;
	fprintf(stderr, "edmctl: --machine %s; 1 to 31 of A-Z a-z 0-9 _ -\n",
		name);
	return EX_USAGE;
}

static void word_take(struct words *w, char *word)
{
	/* Of negatives_keep(). */
	if (w->n < (int)(sizeof(w->at) / sizeof(w->at[0])))
		w->at[w->n++] = word + (word[0] == ' ' && word[1] == '-');
}

/* 0: @ret_verb is to be run; < 0: done; else what to exit with. */
static int parse(struct ctl *c, int argc, char **argv,
		 const struct verb **ret_verb)
{
	struct words w = { .n = 0 };
	char given[64] = "";
	size_t n = 0;
	int opt, rc;

	while ((opt = getopt_long(argc, argv, SHORTS, longs, NULL)) != -1) {
		if (opt == 1 || strchr(DIGITS, opt)) {
			word_take(&w, argv[optind - 1]);
			continue;
		}
		if (opt == 'H')
			print_usage(stdout);
		if (opt == 'V')
			puts("edmctl " EDM_VERSION);
		if (opt == 'H' || opt == 'V')
			return -1;
		rc = opt == '?' ? EX_USAGE : option_take(c, opt);
		if (rc)
			return rc;
		if (n < sizeof(given) - 1 && !strchr(given, opt))
			given[n++] = (char)opt;
	}
	while (optind < argc)
		word_take(&w, argv[optind++]);
	if (w.n == 0) {
		print_usage(stderr);
		return EX_USAGE;
	}
	*ret_verb = verb_find(w.at[0]);
	if (!*ret_verb) {
		fprintf(stderr, "edmctl: no verb '%s'; --help lists them\n",
			w.at[0]);
		return EX_USAGE;
	}
	c->verb = (*ret_verb)->name;
	rc = options_check(*ret_verb, given);
	if (rc == 0)
		rc = arguments_take(c, *ret_verb, w.n - 1, w.at + 1);
	return rc ? rc : machine_check(c->machine);
}

int main(int argc, char **argv)
{
	struct ctl c = {
		.machine = "edm", .url = URL_DEFAULT, .timeout_s = 3,
	};
	const struct verb *v = NULL;
	int rc;

	negatives_keep(argc, argv);
	rc = parse(&c, argc, argv, &v);
	if (rc)
		return rc < 0 ? EX_OK : rc;
	if (v->offline)
		return v->run(&c);
	if (sodium_init() < 0)
		return EX_SOFTWARE;
	if (strncmp(c.url, "udpm://", 7) != 0 &&
	    strncmp(c.url, "memq://", 7) != 0) {
		fprintf(stderr, "edmctl: --url %s; one of LCM, such as "
			URL_DEFAULT "\n", c.url);
		return EX_USAGE;
	}
	/* What is wrong with the words of the verb is said first. */
	c.talk_err = talk_open(&c.talk, &(struct talk_options) {
		.machine = c.machine, .url = c.url, .key = c.key,
		.program = "edmctl",
	}, c.said);
	talk_catch_signals();
	rc = v->run(&c);
	talk_close(c.talk);
	return rc;
}
