/* SPDX-License-Identifier: Apache-2.0 */
/* tech.c - the technology table on the host: changed, saved, its versions */
#include "ctl.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TEXT_MAX	60000
#define PART_MAX	40000

static int done(struct ctl *c, const char *verb, const char *text, double arg)
{
	struct talk_answer a;
	int err = ctl_ask(c, &(struct talk_question) {
		.verb = verb, .text = text, .arg = arg }, &a);

	if (err)
		return err;
	if (c->json)
		printf("{\"verb\": \"%s\", \"code\": 0}\n", verb);
	else
		printf("tech: %s\n", a.reason);
	talk_answer_free(&a);
	return 0;
}

static int versions(struct ctl *c)
{
	json_t *rows = NULL, *row;
	char at[32];
	size_t i;
	int err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "tech-versions" }, &rows);

	if (err == 0 && c->json) {
		err = ctl_put_json(rows);
	} else if (err == 0) {
		if (json_array_size(rows) == 0)
			puts("none was saved yet");
		json_array_foreach(rows, i, row) {
			ctl_when(at, row, "utime");
			printf("%5.0f  %s  %-12s %s\n",
			       ctl_number_of(row, "n"), at,
			       ctl_text_of(row, "by"),
			       ctl_text_of(row, "what"));
		}
	}
	json_decref(rows);
	return err;
}

/* A part from byte @at on.  Return: its bytes, of *ret_all; 0 behind the end,
 * and after a refusal, with *ret_err. */
static size_t show_part(struct ctl *c, double version, size_t at,
			size_t *ret_all, int *ret_err)
{
	static unsigned char part[PART_MAX];
	char from[24];
	const char *hex;
	json_t *o = NULL;
	size_t n = 0;

	snprintf(from, sizeof(from), "%zu", at);
	*ret_err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "tech-text", .text = from, .arg = version }, &o);
	hex = *ret_err ? "" : ctl_text_of(o, "hex");
	*ret_all = *ret_err ? 0 : (size_t)ctl_number_of(o, "bytes");
	if (sodium_hex2bin(part, sizeof(part), hex, strlen(hex), NULL, &n,
			   NULL) < 0)
		n = 0;
	json_decref(o);
	return fwrite(part, 1, n, stdout);
}

static int show(struct ctl *c, double version)
{
	size_t at = 0, n, all;
	int err;

	do {
		n = show_part(c, version, at, &all, &err);
		at += n;
	} while (n && at < all);
	return err ? err : at == all ? 0 : EX_IOERR;
}

static int save(struct ctl *c)
{
	static char text[TEXT_MAX + 2];
	FILE *f = fopen(c->value, "re");
	size_t n;

	if (!f) {
		perror(c->value);
		return EX_NOINPUT;
	}
	n = fread(text, 1, TEXT_MAX + 1, f);
	fclose(f);
	text[n] = '\0';
	if (n <= TEXT_MAX && n == strlen(text))
		return done(c, "tech-save", text, 0);
	fprintf(stderr, "edmctl: %s: a text of up to %d bytes, without NUL\n",
		c->value, TEXT_MAX);
	return EX_DATAERR;
}

static int set(struct ctl *c)
{
	char text[4096];
	size_t n = (size_t)snprintf(text, sizeof(text), "%s\n", c->value);

	for (int i = 0; c->more[i] && n < sizeof(text); i++)
		n += (size_t)snprintf(text + n, sizeof(text) - n, "%s\n",
				      c->more[i]);
	if (n < sizeof(text))
		return done(c, "tech-set", text, 0);
	fprintf(stderr, "edmctl: more than %zu bytes; a file, with edmctl tech "
		"save\n", sizeof(text) - 1);
	return EX_DATAERR;
}

static int wrong(const struct ctl *c)
{
	fprintf(stderr, "edmctl: tech %s%s; versions, show N, set "
		"C120.servo_v=30, save FILE or back N\n", c->arg,
		c->value ? "" : " without what");
	return EX_USAGE;
}

int ctl_tech(struct ctl *c)
{
	const bool has_n = c->arg && (strcmp(c->arg, "show") == 0 ||
				      strcmp(c->arg, "back") == 0);
	double n = 0;

	if (!c->arg || strcmp(c->arg, "versions") == 0)
		return versions(c);
	if (!c->value)
		return wrong(c);
	if (has_n && ctl_number(c, c->value, "the number of a version", &n))
		return EX_USAGE;
	if (strcmp(c->arg, "show") == 0)
		return show(c, n);
	if (strcmp(c->arg, "back") == 0)
		return done(c, "tech-back", "", n);
	if (strcmp(c->arg, "save") == 0)
		return save(c);
	return strcmp(c->arg, "set") == 0 ? set(c) : wrong(c);
}
