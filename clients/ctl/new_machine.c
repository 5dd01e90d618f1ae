/* SPDX-License-Identifier: Apache-2.0 */
/*
 * new_machine.c - asks a few questions, and writes a machine file
 *
 * The answers come from standard input, one a line.  An empty one takes what
 * stands in brackets.  Nothing is written before the last answer.
 */
#include "ctl.h"
#include "new_machine.h"

#include "config.h"
#include "names.h"
#include "output.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

/* Return: false: the answers have ended. */
bool new_answer(bool *over, const char *question, const char *plain,
		   char ret[WORD_MAX])
{
	char line[256];
	size_t n;
	int c;

	fprintf(stderr, "%s [%s]: ", question, plain);
	if (*over || !fgets(line, sizeof(line), stdin)) {
		*over = true;
		return false;
	}
	/* What is longer is one answer too, and a wrong one. */
	while (!strchr(line, '\n') && (c = getchar()) != EOF && c != '\n')
		;
	n = strcspn(line, "\r\n");
	line[n] = '\0';
	while (n && isblank((unsigned char)line[n - 1]))
		line[--n] = '\0';
	n = strspn(line, " \t");
	snprintf(ret, WORD_MAX, "%s", line[n] ? line + n : plain);
	if (!isatty(STDIN_FILENO))
		fprintf(stderr, "%s\n", ret);
	return true;
}

/* One of the words, which are divided by blanks. */
bool new_choose(bool *over, const char *question, const char *words,
		   char ret[WORD_MAX])
{
	char plain[WORD_MAX];
	size_t n;

	snprintf(plain, sizeof(plain), "%.*s", (int)strcspn(words, " "), words);
	while (new_answer(over, question, plain, ret)) {
		const char *at = strchr(ret, ' ') ? NULL : words;

		n = strlen(ret);
		for (; at && (at = strstr(at, ret)); at += n)
			if ((at == words || at[-1] == ' ') &&
			    (at[n] == ' ' || !at[n]))
				return true;
		fprintf(stderr, "one of %s\n", words);
	}
	return false;
}

bool new_numbers(bool *over, const char *question, const char *plain,
		    const struct wanted *w, double *const *ret)
{
	char word[WORD_MAX], *end;

	while (new_answer(over, question, plain, word)) {
		const char *at = word;
		int i;

		for (i = 0; i < w->n; i++, at = end) {
			*ret[i] = strtod(at, &end);
			if (end == at || !(*ret[i] >= w->from) ||
			    !(*ret[i] <= w->to))
				break;
		}
		if (i == w->n && at[strspn(at, " \t")] == '\0')
			return true;
		fprintf(stderr, "%s%d number%s, from %g to %g\n",
			i == w->n ? "no more than " : "", w->n,
			w->n > 1 ? "s" : "", w->from, w->to);
	}
	return false;
}

/* -- The questions --------------------------------------------------------- */

static bool ask_name(struct machine *m)
{
	while (new_answer(&m->over, "name of the machine", "edm", m->name)) {
		if (names_machine_ok(m->name))
			return true;
		fprintf(stderr, "%s\n", NAMES_MACHINE_WANTED);
	}
	return false;
}

static bool is_wire(const struct machine *m)
{
	return strcmp(m->kind, "wire") == 0;
}

static bool axes_fit(struct machine *m)
{
	const char *must = is_wire(m) ? "XY" : "Z";

	for (char *at = m->axes; *at; at++) {
		*at = (char)toupper((unsigned char)*at);
		if (!strchr(AXES, *at) || strchr(m->axes, *at) != at)
			return false;
	}
	for (; *must; must++)
		if (!strchr(m->axes, *must))
			return false;
	return true;
}

static bool ask_axes(struct machine *m)
{
	while (new_answer(&m->over, "axes", is_wire(m) ? "XYUV" : "XYZC",
			  m->axes)) {
		if (axes_fit(m))
			return true;
		fprintf(stderr, "each once, of X Y Z A B C U V; a %s machine "
			"has %s\n", m->kind, is_wire(m) ? "X and Y" : "Z");
	}
	return false;
}

static bool is_rotary(char axis)
{
	return strchr("ABC", axis) != NULL;
}

static bool ask_axis(struct machine *m, char axis)
{
	static const struct wanted travel = { 2, -1e5, 1e5 };
	static const struct wanted pulse = { 1, 1e-3, 1e3 };
	static const struct wanted fast = { 1, 1e-3, 1e5 };
	const int i = (int)(strchr(AXES, axis) - AXES);
	const char *unit = is_rotary(axis) ? "degrees" : "mm";
	char q[96];

	snprintf(q, sizeof(q), "%c: travel from and to, %s", axis, unit);
	do {
		if (!new_numbers(&m->over, q, is_rotary(axis) ? "-360 360" :
							 "-100 100",
			     &travel, (double *[]) { &m->from[i], &m->to[i] }))
			return false;
		if (!(m->from[i] < m->to[i]))
			fprintf(stderr, "the lower one first\n");
	} while (!(m->from[i] < m->to[i]));
	snprintf(q, sizeof(q), "%c: one pulse, in thousandths of %s", axis,
		 unit);
	if (!new_numbers(&m->over, q, "1", &pulse,
			 (double *[]) { &m->pulse_um[i] }))
		return false;
	snprintf(q, sizeof(q), "%c: fastest, %s a second", axis, unit);
	return new_numbers(&m->over, q,
			   strcmp(m->backend, "gpio") == 0 ? "5" : "10", &fast,
			   (double *[]) { &m->v_max[i] });
}

static bool ask_gpio(struct machine *m, char axis)
{
	static const struct wanted lines = { 2, 0, 1023 };
	const int i = (int)(strchr(AXES, axis) - AXES);
	double step = 0, dir = 0;
	char q[96], plain[32];

	snprintf(q, sizeof(q), "%c: lines of step and direction", axis);
	snprintf(plain, sizeof(plain), "%d %d", 2 * i, 2 * i + 1);
	if (!new_numbers(&m->over, q, plain, &lines,
			 (double *[]) { &step, &dir }))
		return false;
	m->step[i] = (int)step;
	m->dir[i] = (int)dir;
	return true;
}

static bool ask_can(struct machine *m, char axis)
{
	static const struct wanted nodes = { 1, 1, 127 };
	static const struct wanted all = { 1, 1e-3, 1e9 };
	const int i = (int)(strchr(AXES, axis) - AXES);
	double node = 0;
	char q[96], plain[32];

	snprintf(q, sizeof(q), "%c: node of the drive", axis);
	snprintf(plain, sizeof(plain), "%d", i + 1);
	if (!new_numbers(&m->over, q, plain, &nodes, (double *[]) { &node }))
		return false;
	m->step[i] = (int)node;
	snprintf(q, sizeof(q), "%c: increments of the drive for a %s", axis,
		 is_rotary(axis) ? "degree" : "mm");
	if (!new_numbers(&m->over, q, "10000", &all,
		     (double *[]) { &m->increments[i] }))
		return false;
	snprintf(q, sizeof(q), "%c: what holds it without power", axis);
	return new_choose(&m->over, q, axis == 'Z' ? "drive free none" :
		      "free drive none", m->holds[i]);
}

/* It becomes a value of the file as it is. */
bool new_is_word(const char *name)
{
	for (const char *at = name; *at; at++) {
		if (isalnum((unsigned char)*at) || strchr("-_./:!", *at))
			continue;
		fprintf(stderr, "letters, digits and - _ . / : ! alone\n");
		return false;
	}
	return true;
}

static bool ask_backend(struct machine *m)
{
	const bool gpio = strcmp(m->backend, "gpio") == 0;
	const bool can = strcmp(m->backend, "can402") == 0;

	do {
		if (gpio && !new_answer(&m->over,
					"the GPIO chip, as gpiodetect lists it",
					"gpiochip0", m->bus))
			return false;
		if (can && !new_answer(&m->over, "the CAN interface",
				       "can0", m->bus))
			return false;
	} while ((gpio || can) && !new_is_word(m->bus));
	for (const char *at = m->axes; *at && (gpio || can); at++)
		if (!(gpio ? ask_gpio(m, *at) : ask_can(m, *at)))
			return false;
	return true;
}

static bool ask_all(struct machine *m)
{
	if (!ask_name(m) ||
	    !new_choose(&m->over, "kind: sinker or wire", "sinker wire",
				m->kind) ||
	    !new_choose(&m->over, "what moves it: null (nothing yet), sim, "
				"gpio, can402", "null sim gpio can402",
				m->backend) || !ask_axes(m))
		return false;
	for (const char *at = m->axes; *at; at++)
		if (!ask_axis(m, *at))
			return false;
	return ask_backend(m) &&
	       new_choose(&m->over, "dialect of its programs (edmsim "
		      "--document-dialects tells what they mean)",
		      EDM_DIALECTS, m->dialect) && new_more(m);
}

/* -- The file -------------------------------------------------------------- */

static void put_axis(FILE *f, const struct machine *m, int i)
{
	if (!strchr(m->axes, AXES[i])) {
		fprintf(f, "[axis.%c]\npresent = no\n\n", AXES[i]);
		return;
	}
	fprintf(f, "[axis.%c]\npulse_mm = %.10g\ntravel_min_mm = %.10g\n"
		"travel_max_mm = %.10g\nv_max_mm_s = %.10g\n"
		"a_max_mm_s2 = %.10g\n", AXES[i], m->pulse_um[i] / 1e3,
		m->from[i], m->to[i], m->v_max[i], m->v_max[i] * 10);
	/* It begins somewhere within its travel. */
	if (m->from[i] > 0 || m->to[i] < 0)
		fprintf(f, "start_mm = %.10g\n", (m->from[i] + m->to[i]) / 2);
	if (strcmp(m->backend, "can402") == 0)
		fprintf(f, "drive_increments = %.0f\ndrive_pulses = %.0f\n"
			"brake = %s\n", round(m->increments[i] * 1e3),
			round(1e6 / m->pulse_um[i]), m->holds[i]);
	new_put_axis(f, m, i);
	fputc('\n', f);
}

static void put_lines(FILE *f, const struct machine *m)
{
	fprintf(f, "[gpio]\nchip = %s\n", m->bus);
	for (int i = 0; i < NAXES; i++)
		if (strchr(m->axes, AXES[i]))
			fprintf(f, "step_%c = %d\ndir_%c = %d\n", AXES[i],
				m->step[i], AXES[i], m->dir[i]);
	new_put_lines(f, m);
	fprintf(f, "; no `spark` line yet: docs/gpio.md says what guards it "
		"wants\n\n");
}

static void put_bus(FILE *f, const struct machine *m)
{
	fprintf(f, "[can402]\ninterface = %s\n", m->bus);
	for (int i = 0; i < NAXES; i++)
		if (strchr(m->axes, AXES[i]))
			fprintf(f, "node_%c = %d\n", AXES[i], m->step[i]);
	fprintf(f, "gap_id = %s\n\n", strcmp(m->gap, "can") == 0 ?
		m->gap_at[0] : "0                  ; no gap yet: "
			       "docs/can402.md");
}

static double slowest(const struct machine *m)
{
	double v = HUGE_VAL;

	for (const char *at = m->axes; *at; at++)
		v = fmin(v, m->v_max[strchr(AXES, *at) - AXES]);
	return v;
}

static void put_process(FILE *f, const struct machine *m)
{
	fprintf(f, "[gap]\n%s", is_wire(m) ? "process = wire\n" : "");
	if (*m->gap && strcmp(m->gap, "none") != 0)
		fprintf(f, "source = %s\n", m->gap);
	fprintf(f, "\n[jump]\nv_max_mm_s = %.10g\n\n", slowest(m));
}

static void put_all(FILE *f, const struct machine *m)
{
	const bool real = strcmp(m->backend, "null") != 0 &&
			  strcmp(m->backend, "sim") != 0;

	fprintf(f, "; Machine file, written by edmctl new-machine.  Every key, "
		"its unit and range:\n; docs/config.md.  What is not here has "
		"its default.\n\n[machine]\nname = %s\nbackend = %s\n"
		"strategy = %s\nfeed_default_mm_min = 30\n%s\n", m->name,
		m->backend, is_wire(m) ? "point-by-point" : "simultaneous",
		real ? "" : "cpu = -1\noverrun_limit = 0           ; a desk "
		"computer may stall\n");
	for (int i = 0; i < NAXES; i++)
		put_axis(f, m, i);
	if (strcmp(m->backend, "gpio") == 0)
		put_lines(f, m);
	if (strcmp(m->backend, "can402") == 0)
		put_bus(f, m);
	put_process(f, m);
	new_put_more(f, m);
	fprintf(f, "[nc]\ndialect = %s\n", m->dialect);
}

/* Each answer was good; whether they go together edmd's own reader says. */
static int judge(const char *path)
{
	static struct machine_config config;
	struct interp_diag diag;
	const int err = config_read(&config, path, &diag);

	if (err == -EINVAL) {
		interp_diag_tell(&diag, path);
		fprintf(stderr, "edmctl: %s is written; mend that line before "
			"edmd takes it\n", path);
		return EX_CONFIG;
	}
	printf("%s is written; edmsim --machine '%s' --check PROGRAM tries "
	       "it\n", path, path);
	return 0;
}

int ctl_new_machine(struct ctl *c)
{
	static struct machine m;
	FILE *f;
	int err;

	if (access(c->arg, F_OK) == 0) {
		fprintf(stderr, "edmctl: %s: it is there already; a new name\n",
			c->arg);
		return EX_CANTCREAT;
	}
	fprintf(stderr, "An empty answer takes what stands in brackets; Ctrl-C "
		"writes nothing.\n");
	if (!ask_all(&m)) {
		fprintf(stderr, "\nedmctl: new-machine: the answers ended; "
			"nothing is written\n");
		return EX_NOINPUT;
	}
	f = fopen(c->arg, "wxe");
	if (f)
		put_all(f, &m);
	err = f ? output_close(f) : -errno;
	if (err < 0) {
		fprintf(stderr, "edmctl: %s: %s\n", c->arg, strerror(-err));
		/* Half a file would be in the way of the next attempt. */
		if (f)
			unlink(c->arg);
		return EX_CANTCREAT;
	}
	return judge(c->arg);
}
