/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify.c - finds the loops of the axes in a trace that `record` wrote
 *
 * No machine is needed.  Each axis that moves is identified alone.  The numbers
 * are printed with their standard deviation, and as lines of a machine file.
 * Then the models with these numbers are run beside the trace.
 */
#include "columns.h"
#include "ctl.h"
#include "plot.h"

#include "interp/identify.h"
#include "grow.h"
#include "standard.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sysexits.h>
#include <unistd.h>

#define ROWS_MAX	(1 << 20)	/* 128 MiB; 17 minutes of
					 * milliseconds */
#define SLOW_ROWS	10000		/* for a longer trace, progress is
					 * shown */

static int refuse(const char *path, const char *found, const char *wanted)
{
	fprintf(stderr, "edmctl: identify: %s: %s; %s\n", path, found, wanted);
	return EX_DATAERR;
}

static int refuse_row(const struct csv *f, const char *found)
{
	fprintf(stderr, "%s:%lu: error: %s; a trace that edmctl record wrote, "
		"or a piece of it\n", f->path, f->line, found);
	return EX_DATAERR;
}

static bool grow(struct columns *t)
{
	size_t room = 0;

	for (int i = 0; i < 2 * CSV_NAXES; i++) {
		double **at = i < CSV_NAXES ? &t->target[i] :
					      &t->actual[i - CSV_NAXES];

		room = t->room;
		if (grow_array(at, &room, sizeof(**at)))
			return false;
	}
	t->room = room;
	return true;
}

static bool keep(struct columns *t, const struct csv_row *r)
{
	if (t->n == t->room && !grow(t))
		return false;
	if (t->n == 0)
		t->first_s = r->t_s;
	else
		t->longest_s = fmax(t->longest_s, r->t_s - t->last_s);
	t->last_s = r->t_s;
	for (int i = 0; i < CSV_NAXES; i++) {
		t->target[i][t->n] = r->axis_mm[i];
		t->actual[i][t->n] = r->actual_mm[i];
	}
	t->n++;
	return true;
}

static int read_rows(struct csv *f, const char *path, struct columns *t)
{
	struct csv_row r;
	int got;

	if (!f->has_actual)
		return refuse(path, "it has no X_actual ... V_actual",
			      "a trace that edmctl record wrote");
	while ((got = csv_next(f, &r)) > 0) {
		if (t->n == ROWS_MAX) {
			fprintf(stderr, "edmctl: identify: %s: only the first "
				"%d rows are used\n", path, ROWS_MAX);
			break;
		}
		if (t->n > 0 && !(r.t_s > t->last_s))
			return refuse_row(f, "its time does not rise");
		if (!keep(t, &r))
			return refuse_row(f, "no memory for so many rows");
	}
	if (got < 0)
		return EX_DATAERR;
	if (t->n < 2)
		return refuse(path, "no two rows", "some seconds of motion");
	/* No cycle may be missing, or the model would not match the trace. */
	if (t->longest_s > 1.5 * (t->last_s - t->first_s) / (double)(t->n - 1))
		return refuse(path, "cycles are missing",
			      "a trace recorded with --every 1, none lost");
	return 0;
}

const char *const ctl_identify_key[INTERP_NIDENTIFY] = {
	"loop_gain_1_s", "loop_hz", "loop_damping", "loop_delay_s",
	"loop_feedforward", "friction_mm_s", "friction_s", "backlash_mm",
};

/* Print lines of a machine file; leave out what the trace does not show. */
static void print_keys(const struct interp_identified *d, int axis)
{
	printf("\n[axis.%c]\n", INTERP_AXIS_LETTERS[axis]);
	for (int i = 0; i < INTERP_NIDENTIFY; i++)
		if (d->told[i])
			printf("%s = %.6g\n", ctl_identify_key[i], d->value[i]);
}

static void print_text(const struct interp_identified *d, int axis)
{
	printf("%c: %.3f um left of %.3f um, %u reversals\n",
	       INTERP_AXIS_LETTERS[axis], d->left_mm * 1e3,
	       d->varies_mm * 1e3, d->reversals);
	for (int i = 0; i < INTERP_NIDENTIFY; i++) {
		const struct interp_identify_field *f =
			&interp_identify_field[i];

		if (d->told[i])
			printf("  %-14s %.5g +- %.2g %s\n", f->name,
			       d->value[i], d->sigma[i], f->unit);
		else
			printf("  %-14s %s\n", f->name, d->sought[i] ?
			       "not told by this trace" : "none needed");
	}
	print_keys(d, axis);
	printf("\n");
}

static json_t *to_json(const struct interp_identified *d, int axis)
{
	const char letter[2] = { INTERP_AXIS_LETTERS[axis], '\0' };
	json_t *j = json_pack("{s:s, s:f, s:f, s:i}", "axis", letter,
			      "left_um", d->left_mm * 1e3,
			      "varies_um", d->varies_mm * 1e3,
			      "reversals", (int)d->reversals);

	for (int i = 0; i < INTERP_NIDENTIFY; i++)
		if (d->told[i])
			json_object_set_new(j, ctl_identify_key[i],
				json_pack("{s:f, s:f}", "value", d->value[i],
					  "sigma", d->sigma[i]));
	return j;
}

static const char *why_not(int err)
{
	return err == -EDOM ?
	       "its motion does not excite the loops; a trace with turns and "
	       "changes of speed, as of examples/identify.ngc" :
	       "too short; some seconds of motion";
}

/* A line on a terminal that is rewritten while the work takes time. */
struct progress {
	int axis, passes;
	bool shown;
};

static void tell_pass(void *arg)
{
	struct progress *p = arg;

	p->passes++;
	if (!p->shown)
		return;
	standard_control(stderr, "\r");
	fprintf(stderr, "edmctl: identify: %c: pass %d over the trace ",
		INTERP_AXIS_LETTERS[p->axis], p->passes);
}

static int identify_axis(const struct columns *t, int axis,
			 struct interp_identified *d)
{
	struct progress p = {
		axis, 0, t->n >= SLOW_ROWS && isatty(STDERR_FILENO)
	};
	const int err = interp_identify(&(struct interp_identify_trace) {
		.target_mm = t->target[axis], .actual_mm = t->actual[axis],
		.n = t->n, .period_s = columns_period_s(t),
		.on_pass = tell_pass, .on_pass_arg = &p,
	}, d);

	if (p.shown)
		standard_control(stderr, "\r\033[K");
	return err;
}

static bool moves(const struct columns *t, int axis)
{
	for (size_t k = 1; k < t->n; k++)
		if (t->target[axis][k] != t->target[axis][0])
			return true;
	return false;
}

/* Return: the number of identified axes. */
static int identify_all(const struct ctl *c, const struct columns *t,
			struct interp_axis_loop *loop, json_t *list)
{
	int told = 0;

	for (int i = 0; i < CSV_NAXES; i++) {
		struct interp_identified d;
		int err;

		if (!moves(t, i))
			continue;
		err = identify_axis(t, i, &d);
		if (err) {
			fprintf(stderr, "edmctl: identify: %s: %c: %s\n",
				c->arg, INTERP_AXIS_LETTERS[i], why_not(err));
			continue;
		}
		told++;
		loop[i] = d.loop;
		if (c->json)
			json_array_append_new(list, to_json(&d, i));
		else
			print_text(&d, i);
	}
	return told;
}

/* Compare what the models do on the path with what the machine did. */
static int contour(const struct ctl *c, const struct columns *t,
		   const struct interp_axis_loop *loop)
{
	struct contour_errors k;
	int err = 0;

	if (ctl_contour_make(&k, t, loop) < 0)
		return 0;
	if (!c->json)
		ctl_contour_print(&k);
	if (c->plot && ctl_contour_draw(&k, c->plot) < 0)
		err = EX_CANTCREAT;
	ctl_contour_free(&k);
	return err;
}

static int identify(const struct ctl *c, const struct columns *t)
{
	struct interp_axis_loop loop[CSV_NAXES] = { 0 };
	json_t *list = json_array();
	const int told = identify_all(c, t, loop, list);

	if (c->json && told > 0) {
		json_dumpf(list, stdout,
			   JSON_INDENT(1) | JSON_REAL_PRECISION(7));
		putchar('\n');
	}
	json_decref(list);
	if (told > 0)
		return contour(c, t, loop);
	return refuse(c->arg, "no axis could be identified",
		      "a trace in which axes move to and fro");
}

int ctl_identify(struct ctl *c)
{
	struct columns t = { 0 };
	struct csv f;
	int err, rc;

	if (c->plot && plot_check("edmctl", c->plot) < 0)
		return EX_USAGE;
	err = csv_open(&f, "edmctl", c->arg, 1);
	rc = err == -EINVAL ? EX_DATAERR : err ? EX_NOINPUT : 0;
	if (rc == 0)
		rc = read_rows(&f, c->arg, &t);
	csv_close(&f);
	if (rc == 0)
		rc = identify(c, &t);
	for (int i = 0; i < CSV_NAXES; i++) {
		free(t.target[i]);
		free(t.actual[i]);
	}
	return rc;
}
