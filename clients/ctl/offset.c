/* SPDX-License-Identifier: Apache-2.0 */
/* offset.c - work offsets, and lines that are carried out at once */
#include "ctl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TEXT_MAX	4096

/* The words after the verb, each on a line.  Return: an exit code. */
static int join(const struct ctl *c, char to[TEXT_MAX])
{
	const char *const first[] = { c->arg, c->value };
	size_t n = 0;

	*to = '\0';
	for (int i = 0; i < 2 && first[i] && n < TEXT_MAX; i++)
		n += (size_t)snprintf(to + n, TEXT_MAX - n, "%s\n", first[i]);
	for (int i = 0; c->value && c->more[i] && n < TEXT_MAX; i++)
		n += (size_t)snprintf(to + n, TEXT_MAX - n, "%s\n", c->more[i]);
	if (n < TEXT_MAX)
		return 0;
	fprintf(stderr, "edmctl: %s: more than %d bytes; a file, with edmctl "
		"submit\n", c->verb, TEXT_MAX - 1);
	return EX_DATAERR;
}

/* The answer names the job; follow it to its end. */
static int follow(struct ctl *c, const char *verb, const char *text)
{
	struct talk_answer a;
	char id[TALK_WORD_MAX];
	int err = ctl_ask(c, &(struct talk_question) {
		.verb = verb, .text = text,
	}, &a);

	if (err)
		return err;
	snprintf(id, sizeof(id), "%s", a.reason);
	talk_answer_free(&a);
	return ctl_wait(c, id);
}

int ctl_mdi(struct ctl *c)
{
	char text[TEXT_MAX];
	const int err = join(c, text);

	return err ? err : follow(c, "mdi", text);
}

/* -- Offsets --------------------------------------------------------------- */

static void print_row(json_t *row)
{
	const char *touched = ctl_text_of(row, "touched"), *name;
	json_t *value;

	printf("%-6s", ctl_text_of(row, "work"));
	json_object_foreach(row, name, value)
		if (json_is_number(value))
			printf(" %s%12.4f%c", name, json_number_value(value),
			       strchr(touched, *name) ? '*' : ' ');
	putchar('\n');
}

static int list(struct ctl *c)
{
	json_t *rows = NULL, *one;
	size_t i;
	int err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "offsets" }, &rows);

	if (err == 0 && c->json) {
		err = ctl_put_json(rows);
	} else if (err == 0) {
		json_array_foreach(rows, i, one)
			print_row(one);
		puts("* touched off; the others are those of the machine "
		     "file");
	}
	json_decref(rows);
	return err;
}

/* What is felt for is a job, which the answer names; it tells what it found. */
int ctl_offset(struct ctl *c)
{
	struct talk_answer a;
	char text[TEXT_MAX], told[TEXT_MAX];
	int err;

	if (!c->arg)
		return list(c);
	err = join(c, text);
	if (err == 0)
		err = ctl_ask(c, &(struct talk_question) {
			.verb = "offset", .text = text }, &a);
	if (err)
		return err;
	snprintf(told, sizeof(told), "%s", a.reason);
	talk_answer_free(&a);
	if (strncmp(told, "offset-", 7) == 0)
		return ctl_wait(c, told);
	if (c->json)
		puts("{\"verb\": \"offset\", \"code\": 0}");
	else
		printf("offset: %s\n", told);
	return 0;
}
