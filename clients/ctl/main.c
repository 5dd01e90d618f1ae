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

#define URL_DEFAULT	"udpm://239.255.76.67:7667?ttl=0"

struct verb {
	const char *name, *args;
	int (*run)(struct ctl *c);
	bool takes, needs;		/* an argument */
	const char *options;		/* letters of its own options */
	const char *help;
};

/* clang-format off */
static const struct verb verbs[] = {
	{ "submit", "FILE", ctl_submit, true, true, "nihw",
	  "send a job of NC code; - is standard input" },
	{ "queue", "", ctl_queue, false, false, "",
	  "the job loaded and those that wait" },
	{ "show", "JOB", ctl_show, true, true, "",
	  "all about one job" },
	{ "start", "[JOB]", ctl_start, true, false, "",
	  "start the job that is ready or held, and the queue" },
	{ "hold", "", ctl_command, false, false, "",
	  "power off, stop on the path" },
	{ "resume", "", ctl_command, false, false, "",
	  "go on after a hold" },
	{ "stop", "", ctl_command, false, false, "",
	  "end the job where it stands" },
	{ "retract", "MM", ctl_retract, true, true, "",
	  "back along the path, then held" },
	{ "reset", "", ctl_command, false, false, "",
	  "leave the fault, to held" },
	{ "estop", "", ctl_command, false, false, "",
	  "power off, no motion, until reset" },
	{ "remove", "JOB", ctl_remove, true, true, "",
	  "take a job that has not begun out of the queue" },
	{ "status", "", ctl_status, false, false, "",
	  "the machine now; exits with 69 if edmd is not there" },
	{ "watch", "", ctl_watch, false, false, "o",
	  "the machine as it goes, until Ctrl-C" },
	{ "record", "CSV", ctl_record, true, true, "epU",
	  "every cycle to a trace file, until Ctrl-C" },
	{ "history", "", ctl_history, false, false, "",
	  "jobs that have ended, newest first" },
};

static const struct option longs[] = {
	{ "machine", required_argument, NULL, 'm' },
	{ "url",     required_argument, NULL, 'u' },
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
#define COMMON_OPTIONS	"mujt"

static void print_usage(FILE *f)
{
	fputs("Usage: edmctl [--machine NAME] [--url URL] [--json] "
	      "[--timeout S] VERB ...\n\nVerbs:\n", f);
	for (size_t i = 0; i < NVERBS; i++)
		fprintf(f, "  %-8s %-6s %s\n", verbs[i].name, verbs[i].args,
			verbs[i].help);
	fputs("\nOptions:\n"
	      "  --machine NAME  of the machine; default: edm\n"
	      "  --url URL       of LCM; default: " URL_DEFAULT "\n"
	      "  --json          print results as JSON\n"
	      "  --timeout S     wait for an answer so long; default: 3\n"
	      "  --name NAME     submit: of the job; default: the file's\n"
	      "  --id ID         submit: of the job; the same id twice is one "
	      "job\n"
	      "  --hold          submit: load it, wait for start\n"
	      "  --wait          submit: follow it; exit 0 if done, 1 if not\n"
	      "  --once          watch: one line\n"
	      "  --every N       record: one cycle of N; default: 1\n"
	      "  --plot FILE     record: then draw it, .png or .svg\n"
	      "  --until-end     record: until the job that runs, or the "
	      "next, ends\n"
	      "  --help          this\n"
	      "  --version       its version\n", f);
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
		c->id = optarg;
		break;
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
	if (argc > 0 && v->takes)
		c->arg = argv[0];
	if (argc > (v->takes ? 1 : 0)) {
		fprintf(stderr, "edmctl: %s: '%s' is too much; edmctl %s%s%s\n",
			v->name, argv[v->takes ? 1 : 0], v->name,
			*v->args ? " " : "", v->args);
		return EX_USAGE;
	}
	if (v->needs && !c->arg) {
		fprintf(stderr, "edmctl: %s: what? edmctl %s %s\n", v->name,
			v->name, v->args);
		return EX_USAGE;
	}
	return 0;
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

/* 0: @ret_verb is to be run; < 0: done; else what to exit with. */
static int parse(struct ctl *c, int argc, char **argv,
		 const struct verb **ret_verb)
{
	char given[64] = "";
	size_t n = 0;
	int opt, rc;

	while ((opt = getopt_long(argc, argv, "", longs, NULL)) != -1) {
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
	if (optind == argc) {
		print_usage(stderr);
		return EX_USAGE;
	}
	*ret_verb = verb_find(argv[optind]);
	if (!*ret_verb) {
		fprintf(stderr, "edmctl: no verb '%s'; --help lists them\n",
			argv[optind]);
		return EX_USAGE;
	}
	c->verb = (*ret_verb)->name;
	rc = options_check(*ret_verb, given);
	if (rc == 0)
		rc = arguments_take(c, *ret_verb, argc - optind - 1,
				    argv + optind + 1);
	return rc ? rc : machine_check(c->machine);
}

int main(int argc, char **argv)
{
	struct ctl c = {
		.machine = "edm", .url = URL_DEFAULT, .timeout_s = 3,
	};
	const struct verb *v = NULL;
	int rc = parse(&c, argc, argv, &v);

	if (rc)
		return rc < 0 ? EX_OK : rc;
	if (sodium_init() < 0)
		return EX_SOFTWARE;
	if (talk_open(&c.talk, c.url, c.machine) < 0) {
		fprintf(stderr, "edmctl: cannot open %s; does the host have a "
			"multicast route? ip link set lo multicast on; "
			"ip route add 224.0.0.0/4 dev lo\n", c.url);
		return EX_UNAVAILABLE;
	}
	talk_catch_signals();
	rc = v->run(&c);
	talk_close(c.talk);
	return rc;
}
