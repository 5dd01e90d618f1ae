/* SPDX-License-Identifier: Apache-2.0 */
/* electrode.c - the table of electrodes: list, show, add, set, remove, use */
#include "ctl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

static int what(void)
{
	fprintf(stderr, "edmctl: electrode: not understood; electrode list, "
		"show N, add N KEY=VALUE..., set N KEY=VALUE..., remove N, use "
		"N (use 0: the holder is empty), measure N [new]; KEY is name, "
		"material, undersize, length, wear, life (mm), minutes, "
		"sparked (min), state or note\n");
	return EX_USAGE;
}

/* Pages of the table, each from behind the last number of the one before. */
static int all(struct ctl *c, json_t **ret)
{
	struct talk_question q = { .verb = "electrodes" };
	json_t *page = NULL;
	size_t n;
	int err;

	*ret = json_array();
	do {
		err = ctl_ask_json(c, &q, &page);
		if (err)
			break;
		json_array_extend(*ret, page);
		n = json_array_size(page);
		q.arg = ctl_number_of(json_array_get(page, n ? n - 1 : 0),
				      "n");
		json_decref(page);
	} while (n > 0);
	return err;
}

static bool is_held(json_t *e)
{
	return json_is_true(json_object_get(e, "held"));
}

static void print_row(json_t *e)
{
	const bool limited = ctl_number_of(e, "life_mm") > 0 ||
			     ctl_number_of(e, "life_s") > 0;
	char left[16] = "-";

	if (limited)
		snprintf(left, sizeof(left), "%.0f %%",
			 100 * ctl_number_of(e, "left"));
	printf("%c%4.0f  %-16s %-10s %9.3f %9.3f %8.4f %8.1f %6s  %s%s%s\n",
	       is_held(e) ? '>' : ' ', ctl_number_of(e, "n"),
	       ctl_text_of(e, "name"), ctl_text_of(e, "material"),
	       ctl_number_of(e, "undersize_mm"), ctl_number_of(e, "length_mm"),
	       ctl_number_of(e, "wear_mm"), ctl_number_of(e, "spark_s") / 60,
	       left, ctl_text_of(e, "state"), *ctl_text_of(e, "note") ? "  " :
	       "", ctl_text_of(e, "note"));
}

static void print_limit(const char *label, double value, double unit,
			const char *name)
{
	if (value > 0)
		printf("%-10s %.6g %s\n", label, value / unit, name);
}

static void print_one(json_t *e)
{
	printf("electrode  %.0f\nname       %s\nmaterial   %s\n"
	       "undersize  %.4f mm on each side\nlength     %.4f mm when new\n"
	       "wear       %.4f mm\nsparked    %.1f min\n",
	       ctl_number_of(e, "n"), ctl_text_of(e, "name"),
	       ctl_text_of(e, "material"), ctl_number_of(e, "undersize_mm"),
	       ctl_number_of(e, "length_mm"), ctl_number_of(e, "wear_mm"),
	       ctl_number_of(e, "spark_s") / 60);
	print_limit("life", ctl_number_of(e, "life_mm"), 1, "mm of wear");
	print_limit("life", ctl_number_of(e, "life_s"), 60, "min of sparks");
	printf("left       %.0f %%\nstate      %s%s\n",
	       100 * ctl_number_of(e, "left"), ctl_text_of(e, "state"),
	       is_held(e) ? ", in the holder" : "");
	if (*ctl_text_of(e, "note"))
		printf("note       %s\n", ctl_text_of(e, "note"));
}

static void print_rows(json_t *rows)
{
	json_t *e;
	size_t i;

	puts(json_array_size(rows) ?
	     "    N  NAME             MATERIAL   UNDERSIZE    LENGTH     WEAR"
	     "  SPARKED   LEFT  STATE" : "none");
	json_array_foreach(rows, i, e)
		print_row(e);
}

static int list(struct ctl *c)
{
	json_t *rows = NULL;
	int err = all(c, &rows);

	if (err == 0 && c->json)
		err = ctl_put_json(rows);
	else if (err == 0)
		print_rows(rows);
	json_decref(rows);
	return err;
}

static int show(struct ctl *c, double n)
{
	json_t *rows = NULL, *e, *it = NULL;
	size_t i;
	int err = all(c, &rows);

	json_array_foreach(rows, i, e)
		if (ctl_number_of(e, "n") == n)
			it = e;
	if (err == 0 && !it) {
		fprintf(stderr, "edmctl: electrode show %g: no such "
			"electrode; edmctl electrode list has them\n", n);
		err = EX_NOINPUT;
	} else if (err == 0 && c->json) {
		err = ctl_put_json(it);
	} else if (err == 0) {
		print_one(it);
	}
	json_decref(rows);
	return err;
}

/* The words KEY=VALUE, each on a line. */
static void join(const struct ctl *c, char *to, size_t size)
{
	size_t n = 0;

	*to = '\0';
	for (int i = 0; c->more[i] && n < size; i++)
		n += (size_t)snprintf(to + n, size - n, "%s\n", c->more[i]);
}

static int change(struct ctl *c, double n)
{
	char verb[32], text[2000];

	snprintf(verb, sizeof(verb), "electrode-%s", c->arg);
	join(c, text, sizeof(text));
	return ctl_say(c, &(struct talk_question) {
		.verb = verb, .arg = n, .text = text,
	});
}

int ctl_electrode(struct ctl *c)
{
	static const char *const bare[] = { "show", "remove", "use" };
	char *end = NULL;
	const double n = c->value ? strtod(c->value, &end) : 0;
	const bool number = end && end != c->value && !*end;

	if (strcmp(c->arg, "list") == 0 && !c->value)
		return list(c);
	if (number && strcmp(c->arg, "measure") == 0 &&
	    (!c->third || strcmp(c->third, "new") == 0))
		return ctl_say(c, &(struct talk_question) {
			.verb = "electrode-measure", .arg = n,
			.text = c->third,
		});
	if (number && c->third && (strcmp(c->arg, "add") == 0 ||
				   strcmp(c->arg, "set") == 0))
		return change(c, n);
	if (number && strcmp(c->arg, "add") == 0)
		return change(c, n);
	for (size_t i = 0; i < sizeof(bare) / sizeof(bare[0]); i++)
		if (number && !c->third && strcmp(c->arg, bare[i]) == 0)
			return i == 0 ? show(c, n) : change(c, n);
	return what();
}
