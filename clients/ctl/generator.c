/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator.c - a generator: what it is asked for and tells, and a walk through
 * all of its values
 */
#include "ctl.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

#define STEPS_MOST	128		/* of a field, without --every */
#define POLL_MS		10
#define ODD_IN_ROW	8		/* then it tells nothing as asked */
#define MORE_S		2.0		/* above confirm_s, until it is late */

/* What a walk found. */
struct walk {
	struct ctl *ctl;
	struct line line;
	size_t steps, done, odd, in_row;
	const char *field;		/* that it walks; "": none */
	bool kept;			/* one is not as it was before */
};

static bool is_true(json_t *o, const char *key)
{
	return json_is_true(json_object_get(o, key));
}

/* -- What is asked and told ------------------------------------------------ */

static int ask(struct ctl *c, json_t **ret)
{
	return ctl_ask_json(c, &(struct talk_question) {
		.verb = "generator" }, ret);
}

static void number_text(char to[24], json_t *o, const char *key)
{
	json_t *v = json_object_get(o, key);

	snprintf(to, 24, "-");
	if (json_is_number(v))
		snprintf(to, 24, "%g", json_number_value(v));
}

static void print_reach(json_t *f)
{
	json_t *values = json_object_get(f, "values"), *v;
	size_t i;

	if (!is_true(f, "delivered")) {
		puts("");
		return;
	}
	if (json_array_size(values) == 0)
		printf("%g to %g", ctl_number_of(f, "min"),
		       ctl_number_of(f, "max"));
	if (ctl_number_of(f, "step") > 0)
		printf(" by %g", ctl_number_of(f, "step"));
	json_array_foreach(values, i, v)
		printf("%s%g", i ? " " : "", json_number_value(v));
	putchar('\n');
}

static void print_field(json_t *f)
{
	const char *by = ctl_text_of(f, "by");
	char asked[24], told[24];

	number_text(asked, f, "asked");
	number_text(told, f, "told");
	printf("%-11s %-4s %-7s %10s %10s  ", ctl_text_of(f, "name"),
	       ctl_text_of(f, "unit"), by, asked,
	       is_true(f, "tells") ? told : "");
	print_reach(f);
}

static int show(struct ctl *c)
{
	json_t *o = NULL, *f;
	size_t i;
	int err = ask(c, &o);

	if (err == 0 && c->json) {
		err = ctl_put_json(o);
	} else if (err == 0) {
		printf("interface %s; sparks %s; %s\n",
		       ctl_text_of(o, "interface"),
		       is_true(o, "sparks") ? "on" : "off",
		       !is_true(o, "there") ? "edmd is not there" :
		       is_true(o, "in_force") ? "what is asked is in force" :
		       "it does not have what is asked");
		puts("FIELD       UNIT BY           ASKED       TOLD  REACHES "
		     "IT");
		json_array_foreach(json_object_get(o, "fields"), i, f)
			print_field(f);
	}
	json_decref(o);
	return err;
}

static int set(struct ctl *c)
{
	double value = NAN;
	int err;

	if (!c->third) {
		fprintf(stderr, "edmctl: generator set: not understood; edmctl "
			"generator set FIELD VALUE, or default to take it "
			"back\n");
		return EX_USAGE;
	}
	err = strcmp(c->third, "default") == 0 ? 0 :
	      ctl_number(c, c->third, "a number, or default to take it back",
			 &value);
	return err ? err : ctl_say(c, &(struct talk_question) {
		.verb = "generator-set", .text = c->value, .arg = value,
	});
}

/* -- The walk -------------------------------------------------------------- */

static size_t steps_of(json_t *f)
{
	const double step = ctl_number_of(f, "step");
	const size_t n = json_array_size(json_object_get(f, "values"));

	return n ? n : step > 0 ?
	       (size_t)((ctl_number_of(f, "max") - ctl_number_of(f, "min")) /
			step + 1.5) : 2;
}

static double value_at(json_t *f, size_t i)
{
	json_t *values = json_object_get(f, "values");
	const double min = ctl_number_of(f, "min");
	const double max = ctl_number_of(f, "max");
	const double step = ctl_number_of(f, "step");

	return json_array_size(values) ?
	       json_number_value(json_array_get(values, i)) :
	       step > 0 ? fmin(min + (double)i * step, max) : i ? max : min;
}

/* The last one counts too, whatever lies between. */
static size_t stride_of(const struct ctl *c, json_t *f)
{
	return c->every ? c->every : (steps_of(f) - 1) / STEPS_MOST + 1;
}

/* Where a bit of the count changes alone, it is taken on the way. */
static bool is_taken(const struct ctl *c, json_t *f, size_t i)
{
	const double step = ctl_number_of(f, "step");
	const double at = step > 0 ? round(value_at(f, i) / step) : 0;
	const size_t count = at >= 1 ? (size_t)at : 3;

	return i % stride_of(c, f) == 0 || i + 1 == steps_of(f) ||
	       (c->every == 0 && (count & (count - 1)) == 0);
}

static bool is_walked(json_t *f)
{
	return is_true(f, "delivered") && is_true(f, "tells");
}

static size_t count_steps(const struct ctl *c, json_t *fields)
{
	size_t n = 0, at;
	json_t *f;

	json_array_foreach(fields, at, f)
		for (size_t i = 0; is_walked(f) && i < steps_of(f); i++)
			n += is_taken(c, f, i);
	return n;
}

static int try(struct ctl *c, const char *field, double value)
{
	struct talk_answer a;
	const int err = ctl_ask(c, &(struct talk_question) {
		.verb = "generator-try", .text = field, .arg = value,
	}, &a);

	if (err == 0)
		talk_answer_free(&a);
	return err;
}

static bool same(double a, double b)
{
	return fabs(a - b) <= 1e-6 * fmax(fabs(a), fabs(b));
}

/* What is asked is that; NAN: nothing. */
static bool is_asked(json_t *f, double value)
{
	return isnan(value) ? !json_is_number(json_object_get(f, "asked")) :
			      same(ctl_number_of(f, "asked"), value);
}

/* Wait until the generator has it, or until it is late.  @ret: as it is
 * then. */
static int settle(struct ctl *c, size_t at, double value, json_t **ret,
		  bool *ret_has)
{
	const double from_s = talk_now_s();
	json_t *o = NULL, *f;
	double late_s;
	int err;

	do {
		json_decref(o);
		talk_wait(c->talk, POLL_MS);
		err = ask(c, &o);
		if (err)
			return err;
		f = json_array_get(json_object_get(o, "fields"), at);
		late_s = ctl_number_of(o, "confirm_s") + MORE_S;
		*ret_has = is_true(o, "in_force") && is_asked(f, value);
	} while (!*ret_has && talk_now_s() - from_s < late_s);
	*ret = o;
	return 0;
}

static int tell_odd(struct walk *w, json_t *o, size_t at, double value)
{
	json_t *f = json_array_get(json_object_get(o, "fields"), at);
	char asked[24], told[24];

	number_text(asked, f, "asked");
	number_text(told, f, "told");
	line_end(&w->line);
	if (!is_asked(f, value)) {
		fprintf(stderr, "edmctl: generator walk: %s %g %s: somebody "
			"else asks for %s; one who tries it at a time\n",
			w->field, value, ctl_text_of(f, "unit"), asked);
		return EX_TEMPFAIL;
	}
	w->odd++;
	printf("%s %g %s: asked %s, told %s\n", w->field, value,
	       ctl_text_of(f, "unit"), asked, told);
	return 0;
}

static int step(struct walk *w, json_t *f, size_t at, double value)
{
	char text[80];
	bool has = false;
	json_t *o = NULL;
	int err = try(w->ctl, w->field, value);

	if (err == 0)
		err = settle(w->ctl, at, value, &o, &has);
	if (err == 0 && !has)
		err = tell_odd(w, o, at, value);
	w->in_row = has ? 0 : w->in_row + 1;
	json_decref(o);
	w->done++;
	snprintf(text, sizeof(text), "%zu of %zu  %s %g %s", w->done, w->steps,
		 w->field, value, ctl_text_of(f, "unit"));
	if (err == 0 && !w->ctl->json)
		line_bar(&w->line, (double)w->done / (double)w->steps, text);
	return err;
}

/* edmd asks for what was set, or for what it told before. */
static int give_back(struct walk *w, json_t *f, size_t at)
{
	json_t *set = json_object_get(f, "asked"), *o = NULL;
	bool has = false;
	int err = try(w->ctl, w->field, NAN);

	if (err == 0)
		err = settle(w->ctl, at, json_is_number(set) ?
			     json_number_value(set) : NAN, &o, &has);
	json_decref(o);
	w->field = "";
	w->kept = w->kept || !has;
	return err;
}

static bool gives_up(const struct walk *w)
{
	return w->in_row >= ODD_IN_ROW;
}

static int walk_field(struct walk *w, json_t *f, size_t at)
{
	int err = 0;

	w->field = ctl_text_of(f, "name");
	for (size_t i = 0; err == 0 && i < steps_of(f) && !gives_up(w); i++)
		if (is_taken(w->ctl, f, i))
			err = step(w, f, at, value_at(f, i));
	return err ? err : give_back(w, f, at);
}

static void on_back(void *arg, int err, const struct talk_ack *a)
{
	(void)arg;
	(void)err;
	(void)a;
}

static int walk_end(struct walk *w, int err)
{
	const char *back_again = w->kept ? "it is not as it was before" :
					   "all is as it was before";
	const struct talk_question back = {
		.verb = "generator-try", .text = w->field, .arg = NAN,
	};

	/* Interrupted, nobody waits for the answer. */
	if (talk_interrupted())
		talk_send(w->ctl->talk, &back, w->ctl->timeout_s, on_back,
			  NULL);
	else if (err != EX_UNAVAILABLE && err &&
		 (!*w->field || try(w->ctl, w->field, NAN) == 0))
		fprintf(stderr, "edmctl: generator walk: not at its end; what "
			"it tried is taken back\n");
	if (err)
		return err;
	if (w->ctl->json)
		printf("{\"steps\": %zu, \"odd\": %zu}\n", w->done, w->odd);
	else
		printf("%zu of %zu steps%s, %zu not told as asked; %s\n",
		       w->done, w->steps, gives_up(w) ?
		       ", the last ones all odd" : "", w->odd, back_again);
	return w->odd ? 1 : 0;
}

static int no_walk(json_t *o)
{
	const bool there = is_true(o, "there");

	fprintf(stderr, "edmctl: generator walk: %s\n", there ?
		"the generator tells no value that reaches it; [generator] "
		"told_peak_a = ..., or edmctl generator set FIELD VALUE and "
		"look" : "edmd is not there; systemctl status edmd");
	return there ? EX_CONFIG : EX_UNAVAILABLE;
}

static int walk(struct ctl *c)
{
	struct walk w = { .ctl = c, .field = "" };
	json_t *o = NULL, *fields, *f;
	size_t at;
	int err = ask(c, &o);

	if (err)
		return err;
	fields = json_object_get(o, "fields");
	w.steps = count_steps(c, fields);
	if (w.steps == 0) {
		err = no_walk(o);
		json_decref(o);
		return err;
	}
	talk_catch_signals();
	line_init(&w.line);
	json_array_foreach(fields, at, f)
		if (err == 0 && is_walked(f) && !gives_up(&w))
			err = walk_field(&w, f, at);
	line_end(&w.line);
	err = walk_end(&w, err);
	json_decref(o);
	return err;
}

int ctl_generator(struct ctl *c)
{
	if (!c->arg)
		return show(c);
	if (strcmp(c->arg, "set") == 0)
		return set(c);
	if (strcmp(c->arg, "walk") == 0 && !c->value)
		return walk(c);
	fprintf(stderr, "edmctl: generator: '%s%s%s'; edmctl generator, "
		"generator set FIELD VALUE, or generator walk\n", c->arg,
		c->value ? " " : "", c->value ? c->value : "");
	return EX_USAGE;
}
