/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission.c - edmctl commission: a new machine, from its e-stop to its first
 * cut, step by step
 */
#include "commission.h"

#include "output.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

/* Where a step is taken. */
enum where {
	ONCE, EACH_AXIS,
};

/* What a machine without it does not need the step for. */
enum needs {
	NOTHING, DRIVES, SWITCHES, METHOD, GAP, GENERATOR, WIRES,
};

/* clang-format off */
static const struct step {
	const char *name;
	enum where where;
	enum needs needs;
	tour_fn *run;
	const char *does;
} table[] = {
	{ "estop", ONCE, NOTHING, tour_estop,
	  "you press the e-stop and let it go; edmd must see both" },
	{ "drives", ONCE, DRIVES, tour_drives,
	  "each drive must be up, without an error" },
	{ "power", EACH_AXIS, NOTHING, tour_power,
	  "the axis gets power and moves by a hair" },
	{ "direction", EACH_AXIS, NOTHING, tour_direction,
	  "it goes toward +, and you say which way it went" },
	{ "scale", EACH_AXIS, NOTHING, tour_scale,
	  "it goes a way that you measure; the scale is corrected" },
	{ "limits", EACH_AXIS, SWITCHES, tour_limits,
	  "it goes to and fro, and you press each limit switch meanwhile" },
	{ "home", EACH_AXIS, METHOD, tour_home,
	  "it homes again and again; the homes must be the same" },
	{ "following", EACH_AXIS, NOTHING, tour_following,
	  "it goes to and fro, also in waves; how it follows is kept" },
	{ "backlash", EACH_AXIS, NOTHING, tour_backlash,
	  "it turns back, and you read the lost motion from a dial" },
	{ "gap", ONCE, GAP, tour_sense,
	  "the gap's voltage, open and touching; thresholds are proposed" },
	{ "generator", ONCE, GENERATOR, tour_generator,
	  "each value that the generator can have is asked for and told" },
	{ "watchdog", ONCE, WIRES, tour_watchdog,
	  "you kill edmd and pull its cable, and look what goes off" },
	{ "latency", ONCE, NOTHING, tour_latency,
	  "how late edmd wakes while the host is busy" },
	{ "cut", ONCE, GAP, tour_cut,
	  "a first program" },
};
/* clang-format on */

#define NSTEPS		(sizeof(table) / sizeof(table[0]))
#define NAME_CHARS	32

/* -- What a step found ----------------------------------------------------- */

static void found(struct tour *w, bool good, const char *form, va_list args)
{
	char text[SAID_CHARS];

	vsnprintf(text, sizeof(text), form, args);
	json_object_set_new(w->now, "good", json_boolean(good));
	json_object_set_new(w->now, "said", json_string(text));
	printf("%s: %s\n", good ? "good" : "WRONG", text);
	fflush(stdout);
}

void tour_good(struct tour *w, const char *form, ...)
{
	va_list args;

	va_start(args, form);
	found(w, true, form, args);
	va_end(args);
}

void tour_wrong(struct tour *w, const char *form, ...)
{
	va_list args;

	va_start(args, form);
	found(w, false, form, args);
	va_end(args);
}

void tour_plot(struct tour *w, const struct tour_plot *p)
{
	json_t *plot = json_object_get(w->now, "plot");

	if (!plot) {
		plot = json_object();
		json_object_set_new(w->now, "plot", plot);
	}
	json_object_set_new(plot, p->name,
			    json_pack("{s:s,s:f,s:o}", "along", p->along,
				      "step", p->step, "y", p->y));
}

/* -- Asking ---------------------------------------------------------------- */

bool tour_choose(struct tour *w, const char *words, char ret[WORD_MAX],
		 const char *form, ...)
{
	char text[SAID_CHARS];
	va_list args;

	va_start(args, form);
	vsnprintf(text, sizeof(text), form, args);
	va_end(args);
	return new_choose(&w->over, text, words, ret);
}

bool tour_number(struct tour *w, double plain, double *ret, const char *form,
		 ...)
{
	static const struct wanted any = { 1, -1e6, 1e6 };
	char text[SAID_CHARS], offered[32];
	va_list args;

	va_start(args, form);
	vsnprintf(text, sizeof(text), form, args);
	va_end(args);
	snprintf(offered, sizeof(offered), "%.6g", plain);
	return new_numbers(&w->over, text, offered, &any, &ret);
}

bool tour_says_yes(struct tour *w, const char *question)
{
	char word[WORD_MAX];

	return tour_choose(w, "yes no", word, "%s", question) &&
	       strcmp(word, "yes") == 0;
}

/* -- What is kept ---------------------------------------------------------- */

static void kept_path(const struct tour *w, char path[PATH_MAX])
{
	snprintf(path, PATH_MAX, "%s.commission", w->path);
}

static int keep(const struct tour *w)
{
	char path[PATH_MAX], fresh[PATH_MAX + 8];
	FILE *f;
	int err;

	kept_path(w, path);
	snprintf(fresh, sizeof(fresh), "%s.new", path);
	f = fopen(fresh, "we");
	if (f)
		json_dumpf(w->steps, f, JSON_INDENT(1));
	err = f ? output_close(f) : -errno;
	if (err == 0 && rename(fresh, path) < 0)
		err = -errno;
	if (err == 0)
		err = tour_report(w);
	if (err < 0)
		fprintf(stderr, "edmctl: %s: %s\n", path, strerror(-err));
	return err;
}

static int remember(struct tour *w)
{
	char path[PATH_MAX];
	json_error_t e;

	kept_path(w, path);
	w->steps = access(path, F_OK) == 0 ?
		   json_load_file(path, 0, &e) : json_object();
	if (json_is_object(w->steps))
		return 0;
	fprintf(stderr, "edmctl: %s:%d: %s; remove it, and the walk begins "
		"anew\n", path, e.line, e.text);
	return EX_DATAERR;
}

/* The machine file, and the edmd that has read it. */
static int meet(struct tour *w)
{
	struct interp_diag diag = { .line = 0 };
	int err = config_read(&w->config, w->path, &diag);

	if (err == -EINVAL)
		interp_diag_tell(&diag, w->path);
	else if (err < 0)
		fprintf(stderr, "edmctl: %s: %s; a machine file, as "
			"edmctl new-machine writes one\n", w->path,
			strerror(-err));
	if (err < 0)
		return EX_CONFIG;
	/* What is answered would be written into the file of another one. */
	if (strcmp(w->config.name, w->ctl->machine) != 0) {
		fprintf(stderr, "edmctl: %s is the machine '%s', and '%s' is "
			"asked; --machine %s\n", w->path, w->config.name,
			w->ctl->machine, w->config.name);
		return EX_USAGE;
	}
	shm_close(w->status, sizeof(*w->status));
	w->status = NULL;
	err = ctl_shm_open(w->ctl, &w->status);
	if (err == 0 && !ctl_first_status(w->ctl))
		err = ctl_unanswered(w->ctl, w->ctl->talk_err);
	return err;
}

/* -- The walk -------------------------------------------------------------- */

static bool applies(const struct tour *w, const struct step *s)
{
	const struct machine_config *c = &w->config;

	switch (s->needs) {
	case DRIVES:
		return config_machine_is(c, MACHINE_DRIVES);
	case SWITCHES:
		return config_machine_is(c, MACHINE_SWITCHES) &&
		       !config_machine_is(c, MACHINE_NO_WIRES);
	case METHOD:
		return c->manual[w->axis].method != HOME_NONE;
	case GAP:
		return config_backend(c)->has_gap(c);
	case GENERATOR:
		return config_generator_interface(c) >= GENERATOR_CAN;
	case WIRES:
		return !config_machine_is(c, MACHINE_NO_WIRES);
	default:
		return true;
	}
}

static void name_of(const struct tour *w, const struct step *s, char *name)
{
	snprintf(name, NAME_CHARS, s->where == EACH_AXIS ? "%s %c" : "%s",
		 s->name, INTERP_AXIS_LETTERS[w->axis]);
}

/* edmd reads its file when it begins. */
static int restart(struct tour *w)
{
	char word[WORD_MAX];

	w->changed = false;
	if (!tour_choose(w, "done end", word, "%s is changed: restart edmd "
			 "and edmd-jobs; done, when they run", w->path) ||
	    strcmp(word, "done") != 0)
		return -1;
	return meet(w);
}

/* Return: 0; -1: the person leaves; else an exit code. */
static int take(struct tour *w, const struct step *s)
{
	char name[NAME_CHARS], word[WORD_MAX];
	int err = 0;

	name_of(w, s, name);
	do {
		if (!tour_choose(w, "go skip end", word, "\n%s: %s", name,
				 s->does) || strcmp(word, "end") == 0)
			return -1;
		if (strcmp(word, "skip") == 0)
			return 0;
		w->now = json_pack("{s:s,s:I}", "step", name, "time",
				   (json_int_t)time(NULL));
		json_object_set_new(w->steps, name, w->now);
		if (strcmp(tour_state(w, "idle", 1)->state, "fault") == 0)
			tour_reset(w);
		s->run(w);
		if (!json_object_get(w->now, "good"))
			json_object_del(w->steps, name);
		if (keep(w) < 0)
			return EX_CANTCREAT;
		if (w->changed)
			err = restart(w);
		if (err || w->over)
			return err ? err : -1;
		word[0] = '\0';
		if (!json_is_true(json_object_get(json_object_get(w->steps,
						name), "good")) &&
		    (!tour_choose(w, "again next end", word, "%s is not good "
				  "yet", name) || strcmp(word, "end") == 0))
			return -1;
	} while (strcmp(word, "again") == 0);
	return 0;
}

static bool is_good(const struct tour *w, const struct step *s)
{
	char name[NAME_CHARS];

	name_of(w, s, name);
	return json_is_true(json_object_get(json_object_get(w->steps, name),
					    "good"));
}

static int tour_all(struct tour *w)
{
	int err = 0;

	for (size_t i = 0; i < NSTEPS && err == 0; i++) {
		const int n = table[i].where == EACH_AXIS ? INTERP_NAXES : 1;

		for (w->axis = 0; w->axis < n && err == 0; w->axis++) {
			if (n > 1 && !(w->config.axes.present >> w->axis & 1))
				continue;
			if (applies(w, &table[i]) && !is_good(w, &table[i]))
				err = take(w, &table[i]);
		}
	}
	return err;
}

/* Its steps are taken once more. */
static int forget(struct tour *w, const char *step)
{
	const size_t n = strlen(step);
	const char *name;
	json_t *value;
	void *next;
	bool any = false;

	json_object_foreach_safe(w->steps, next, name, value) {
		if (strncmp(name, step, n) != 0 || (name[n] && name[n] != ' '))
			continue;
		json_object_del(w->steps, name);
		any = true;
	}
	for (size_t i = 0; i < NSTEPS && !any; i++)
		any = strcmp(table[i].name, step) == 0;
	if (any)
		return 0;
	fprintf(stderr, "edmctl: commission: no step '%s'; one of", step);
	for (size_t i = 0; i < NSTEPS; i++)
		fprintf(stderr, " %s", table[i].name);
	fprintf(stderr, "; or one axis of it, as 'scale X'\n");
	return EX_USAGE;
}

static int end(const struct tour *w, int err)
{
	const char *name;
	json_t *s;
	int wrong = 0;

	json_object_foreach(w->steps, name, s)
		wrong += !json_is_true(json_object_get(s, "good"));
	if (err <= 0)
		printf("%s.commission.html tells what was found; edmctl "
		       "commission %s goes on\n", w->path, w->path);
	return err > 0 ? err : wrong > 0;
}

int ctl_commission(struct ctl *c)
{
	static struct tour w;
	int err;

	if (c->value && (strcmp(c->value, "again") != 0 || !c->third)) {
		fprintf(stderr, "edmctl: commission %s %s: not understood; "
			"edmctl commission FILE, or commission FILE again "
			"STEP\n",
			c->arg, c->value);
		return EX_USAGE;
	}
	w = (struct tour) { .ctl = c, .path = c->arg,
			    .by_hand = isatty(STDIN_FILENO) };
	if (!c->talk)
		return ctl_unanswered(c, c->talk_err);
	err = remember(&w);
	if (err == 0 && c->third)
		err = forget(&w, c->third);
	if (err == 0)
		err = meet(&w);
	if (err == 0) {
		fprintf(stderr, "Nothing moves unless you say so: %s.  `end` "
			"leaves the walk; it goes on there.\n", w.by_hand ?
			"hold the space bar" : "go");
		err = end(&w, tour_all(&w));
	}
	shm_close(w.status, sizeof(*w.status));
	json_decref(w.steps);
	return err;
}
