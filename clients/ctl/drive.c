/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive.c - the drives of a bus: how they are, their objects, their emergencies
 */
#include "ctl.h"

#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define LOOK_MS		250		/* between two looks of watch */
#define OBJECT_S	60		/* a drive may be slow, or write its
					 * memory */
#define WANTED		"edmctl drive list | watch | emcy | scope X [S] | " \
			"get X OBJECT | set X OBJECT VALUE | store X"

static int not_understood(const char *which)
{
	fprintf(stderr, "edmctl: drive %s: not understood; " WANTED "\n",
		which);
	return EX_USAGE;
}

static int ask(struct ctl *c, json_t **ret)
{
	return ctl_ask_json(c, &(struct talk_question) { .verb = "drives" },
			    ret);
}

static json_t *drives_of(json_t *o)
{
	return json_object_get(o, "drives");
}

/* -- How they are ---------------------------------------------------------- */

/* What was wrong last, if it is not over. */
static void print_trouble(json_t *d)
{
	json_t *all = json_object_get(d, "history");
	json_t *last = json_array_get(all, json_array_size(all) - 1);
	const char *trouble = ctl_text_of(d, "trouble");
	const char *code = ctl_text_of(last, "code");

	if (json_is_true(json_object_get(d, "lost")))
		printf("its place is lost; ");
	printf("%s", strcmp(trouble, "well") == 0 ? "" : trouble);
	if (*code && strcmp(code, "0000") != 0)
		printf("%semergency %s: %s, maker's %s",
		       strcmp(trouble, "well") == 0 ? "" : "; ", code,
		       ctl_text_of(last, "text"), ctl_text_of(last, "maker"));
}

static void print_drive(json_t *d)
{
	const char *state = ctl_text_of(d, "state");

	printf("%-4s %4.0f %-23s %-28s %11.4f %12.0f  ",
	       ctl_text_of(d, "axis"), ctl_number_of(d, "node"),
	       *state ? state : ctl_text_of(d, "phase"),
	       ctl_text_of(d, "mode_name"), ctl_number_of(d, "place_mm"),
	       ctl_number_of(d, "increments"));
	print_trouble(d);
}

static void print_all(json_t *o, const char *end)
{
	json_t *d;
	size_t i;

	printf("AXIS NODE %-23s %-28s %11s %12s  ERROR%s", "STATE", "MODE",
	       "PLACE", "INCREMENTS", end);
	json_array_foreach(drives_of(o), i, d) {
		print_drive(d);
		fputs(end, stdout);
	}
}

static int refuse_none(void)
{
	fprintf(stderr, "edmctl: drive: this machine has no drives on a bus; "
		"backend = can402 has\n");
	return 1;
}

static int list(struct ctl *c)
{
	json_t *o = NULL;
	int err = ask(c, &o);

	if (err == 0 && c->json)
		err = ctl_put_json(o);
	else if (err == 0 && json_array_size(drives_of(o)) == 0)
		err = refuse_none();
	else if (err == 0)
		print_all(o, "\n");
	json_decref(o);
	return err;
}

/* On a terminal the lines are drawn again where they are. */
static int watch(struct ctl *c)
{
	const bool tty = isatty(STDOUT_FILENO);
	int err = 0;

	while (err == 0 && !talk_interrupted()) {
		json_t *o = NULL;

		err = ask(c, &o);
		if (err == 0 && json_array_size(drives_of(o)) == 0)
			err = refuse_none();
		else if (err == 0)
			print_all(o, tty ? "\033[K\n" : "\n");
		fflush(stdout);
		talk_wait(c->talk, LOOK_MS);
		if (err == 0 && tty && !talk_interrupted())
			printf("\033[%zuA", json_array_size(drives_of(o)) + 1);
		json_decref(o);
	}
	return talk_interrupted() ? 0 : err;
}

void ctl_drives_ill(struct ctl *c)
{
	json_t *o = NULL, *d;
	size_t i;

	if (ask(c, &o) != 0)
		return;
	json_array_foreach(drives_of(o), i, d) {
		if (strcmp(ctl_text_of(d, "trouble"), "well") == 0 &&
		    !json_is_true(json_object_get(d, "lost")))
			continue;
		printf("drive      %s (node %.0f): ", ctl_text_of(d, "axis"),
		       ctl_number_of(d, "node"));
		print_trouble(d);
		putchar('\n');
	}
	json_decref(o);
}

/* -- Their emergencies ----------------------------------------------------- */

static void print_emergencies(json_t *d)
{
	json_t *e;
	size_t i;
	char at[32];

	json_array_foreach(json_object_get(d, "history"), i, e) {
		ctl_when(at, e, "utime");
		printf("%s  %s  %s %s; register %02x, maker's %s\n", at,
		       ctl_text_of(d, "axis"), ctl_text_of(e, "code"),
		       ctl_text_of(e, "text"),
		       (unsigned int)ctl_number_of(e, "register"),
		       ctl_text_of(e, "maker"));
	}
}

static int emergencies(struct ctl *c)
{
	json_t *o = NULL, *d;
	size_t i;
	int err = ask(c, &o);

	if (err == 0 && c->json)
		err = ctl_put_json(o);
	else if (err == 0)
		json_array_foreach(drives_of(o), i, d)
			print_emergencies(d);
	json_decref(o);
	return err;
}

/* -- Their objects --------------------------------------------------------- */

/* "X position actual value", of all words but the last @less. */
static void join(const struct ctl *c, int less, char *to, size_t size)
{
	size_t n = (size_t)snprintf(to, size, "%s", c->value);
	int words = 0;

	while (c->more[words])
		words++;
	for (int i = 0; i + less < words && n < size; i++)
		n += (size_t)snprintf(to + n, size - n, " %s", c->more[i]);
}

static int get(struct ctl *c)
{
	char text[120], hex[9];
	json_t *o = NULL;
	int err;

	if (!c->value || !c->more[0])
		return not_understood("get");
	join(c, 0, text, sizeof(text));
	err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "drive-get", .text = text }, &o);
	if (err == 0 && c->json) {
		err = ctl_put_json(o);
	} else if (err == 0) {
		const unsigned int bytes = (unsigned int)
			ctl_number_of(o, "bytes");
		const double x = ctl_number_of(o, "value");

		snprintf(hex, sizeof(hex), "%08x", (unsigned int)(int64_t)x);
		printf("%04x:%02x  %.0f  0x%s  %s\n",
		       (unsigned int)ctl_number_of(o, "index"),
		       (unsigned int)ctl_number_of(o, "sub"), x,
		       hex + 8 - 2 * (bytes > 4 ? 4 : bytes),
		       ctl_text_of(o, "name"));
	}
	json_decref(o);
	return err;
}

/* Decimal, or hexadecimal with 0x. */
static int set(struct ctl *c)
{
	char text[120];
	double value;
	int n = 0, err;

	while (c->value && c->more[n])
		n++;
	if (n < 2)
		return not_understood("set");
	join(c, 1, text, sizeof(text));
	err = ctl_number(c, c->more[n - 1], "a whole number, also as 0x10",
			 &value);
	return err ? err : ctl_say(c, &(struct talk_question) {
		.verb = "drive-set", .text = text, .arg = value });
}

static int store(struct ctl *c)
{
	if (!c->value || c->more[0])
		return not_understood("store");
	return ctl_say(c, &(struct talk_question) {
		.verb = "drive-store", .text = c->value });
}

static int scope(struct ctl *c)
{
	return c->value ? ctl_scope(c, c->value, c->more[0]) :
			  not_understood("scope");
}

int ctl_drive(struct ctl *c)
{
	static const struct {
		const char *name;
		int (*run)(struct ctl *c);
		bool is_slow;
	} acts[] = {
		{ "list", list, false }, { "watch", watch, false },
		{ "emcy", emergencies, false }, { "scope", scope, false },
		{ "get", get, true },
		{ "set", set, true }, { "store", store, true },
	};

	for (size_t i = 0; i < sizeof(acts) / sizeof(acts[0]); i++) {
		if (c->arg && strcmp(c->arg, acts[i].name) != 0)
			continue;
		if (acts[i].is_slow && c->timeout_s < OBJECT_S)
			c->timeout_s = OBJECT_S;
		return acts[i].run(c);
	}
	return not_understood(c->arg);
}
