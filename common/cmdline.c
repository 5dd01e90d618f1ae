/* SPDX-License-Identifier: Apache-2.0 */
/* cmdline.c - a program's command line as one table */
#include "cmdline.h"

#include "standard.h"

#include <assert.h>
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define FIRST_ROW	256		/* getopt's value of row 0 */
#define GO_ON		(-1)

enum { ASKED_HELP = FIRST_ROW + CMDLINE_MAX, ASKED_VERSION };

int cmdline_refuse(const char *program, const char *what, const char *value,
		   const char *wanted)
{
	fprintf(stderr, "%s: error: %s %s; %s\n", program, what, value, wanted);
	return EX_USAGE;
}

const char *cmdline_pairs(const char *(*name)(int i),
			  const char *const value[], char *buf, size_t size)
{
	size_t n = 0;

	buf[0] = '\0';
	for (int i = 0; name(i) && n < size; i++)
		if (value[i])
			n += (size_t)snprintf(buf + n, size - n, "%s%s=%s",
					      n ? " " : "", name(i),
					      value[i] + (value[i][0] == ' '));
	return n < size ? buf : NULL;
}

static int refuse_value(const struct cmdline *o, const char *name,
			const char *text, const char *wanted)
{
	char option[40];

	snprintf(option, sizeof(option), "--%s", name);
	/* edmctl puts a blank before a negative number. */
	return cmdline_refuse(o->program, option, text + (text[0] == ' '),
			      wanted);
}

static int number_take(const struct cmdline *o, const struct cmdline_row *r,
		       const char *text, double *ret)
{
	char *end, wanted[80];

	errno = 0;
	*ret = strtod(text, &end);
	if (end != text && *end == '\0' && errno == 0 && *ret >= r->min &&
	    *ret <= r->max)
		return GO_ON;
	snprintf(wanted, sizeof(wanted), "a number from %g to %g", r->min,
		 r->max);
	return refuse_value(o, r->name, text, wanted);
}

static int whole_take(const struct cmdline *o, const struct cmdline_row *r,
		      const char *text, uint64_t *ret)
{
	char *end;

	errno = 0;
	*ret = strtoull(text, &end, 10);
	if (text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0)
		return GO_ON;
	return refuse_value(o, r->name, text,
			    "a whole number from 0 to 2^64 - 1");
}

static int row_take(const struct cmdline *o, const struct cmdline_row *r,
		    char *to, const char *text)
{
	void *at = to + r->at;

	switch (r->kind) {
	case CMDLINE_FLAG:
		*(bool *)at = true;
		return GO_ON;
	case CMDLINE_WORD:
		*(const char **)at = text;
		return GO_ON;
	case CMDLINE_NUMBER:
		return number_take(o, r, text, at);
	case CMDLINE_WHOLE:
		return whole_take(o, r, text, at);
	case CMDLINE_CALL:
		return r->take(to, text);
	}
	return EX_SOFTWARE;
}

/* -- --help --------------------------------------------------------------- */

static void help_row(const struct cmdline *o, const char *name,
		     const char *arg, const char *text)
{
	const int n = printf("  --%s%s%s", name, arg ? " " : "",
			     arg ? arg : "");

	printf("%*s", n < o->column ? o->column - n : 1, "");
	for (; *text; text++) {
		putchar(*text);
		if (*text == '\n')
			printf("%*s", o->column, "");
	}
	putchar('\n');
}

static int help(const struct cmdline *o)
{
	fputs(o->head, stdout);
	if (o->more)
		o->more();
	for (size_t i = 0; i < o->nrows; i++)
		help_row(o, o->row[i].name, o->row[i].arg, o->row[i].help);
	help_row(o, "help", NULL, "this");
	help_row(o, "version", NULL, "its version");
	fputs(o->tail ? o->tail : "", stdout);
	return EX_OK;
}

/* -- The command line ----------------------------------------------------- */

static void longs_make(const struct cmdline *o,
		       struct option longs[CMDLINE_MAX + 3])
{
	assert(o->nrows <= CMDLINE_MAX);
	for (size_t i = 0; i < o->nrows; i++)
		longs[i] = (struct option) {
			.name = o->row[i].name,
			.has_arg = o->row[i].arg ? required_argument :
						   no_argument,
			.val = FIRST_ROW + (int)i,
		};
	longs[o->nrows] = (struct option) { "help", no_argument, NULL,
					    ASKED_HELP };
	longs[o->nrows + 1] = (struct option) { "version", no_argument, NULL,
						ASKED_VERSION };
	longs[o->nrows + 2] = (struct option) { 0 };
}

static int option_take(const struct cmdline *o, int opt, char *to,
		       const char *word, struct cmdline_given *ret)
{
	if (opt == ASKED_HELP)
		return help(o);
	if (opt == ASKED_VERSION) {
		printf("%s " EDM_VERSION "\n", o->program);
		return EX_OK;
	}
	if (opt == ':')
		return cmdline_refuse(o->program, word, "without its value",
				      "--help shows what follows it");
	if (opt == '?')
		return cmdline_refuse(o->program, word, "is no option",
				      "--help lists them");
	ret->rows |= UINT64_C(1) << (opt - FIRST_ROW);
	return row_take(o, &o->row[opt - FIRST_ROW], to, optarg);
}

/* For packaging/completion: a row a line, divided by tabs. */
static int list_options(const struct cmdline *o)
{
	for (size_t i = 0; i < o->nrows; i++)
		printf("option\t%s\t%s\t%.*s\n", o->row[i].name,
		       o->row[i].arg ? o->row[i].arg : "-",
		       (int)strcspn(o->row[i].help, "\n"), o->row[i].help);
	printf("option\thelp\t-\tprint the options\n"
	       "option\tversion\t-\tprint the version\n");
	if (o->list)
		o->list();
	return EX_OK;
}

int cmdline_take(const struct cmdline *o, void *to, int argc, char **argv,
		 struct cmdline_given *ret)
{
	struct option longs[CMDLINE_MAX + 3];
	int opt, code;

	standard_guard(o->program);
	if (argc == 2 && strcmp(argv[1], "--list-options") == 0)
		return list_options(o);
	*ret = (struct cmdline_given) { .first = 0 };
	longs_make(o, longs);
	while ((opt = getopt_long(argc, argv, ":", longs, NULL)) != -1) {
		code = option_take(o, opt, to, argv[optind - 1], ret);
		if (code != GO_ON)
			return code;
	}
	ret->first = optind;
	if (argc - optind <= o->args_max)
		return GO_ON;
	return cmdline_refuse(o->program, "argument",
			      argv[optind + o->args_max],
			      o->args_max ? "one fewer; --help shows which" :
			      "options only; --help lists them");
}

bool cmdline_has(const struct cmdline *o, const struct cmdline_given *g,
		 const char *name)
{
	for (size_t i = 0; i < o->nrows; i++) {
		if (strcmp(o->row[i].name, name) == 0)
			return g->rows >> i & 1;
	}
	assert(0);
	return false;
}
