/* SPDX-License-Identifier: Apache-2.0 */
/*
 * report.c - the result of a run, for a person and as JSON
 *
 * The keys are a contract.  A key that does not apply is absent.
 */
#include "sim.h"
#include "hunting.h"
#include "path/probe_rest.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <string.h>
#include <sysexits.h>

static double seconds(const struct cycle *c, uint64_t n)
{
	return (double)n * (double)c->config.period_ns * 1e-9;
}

static uint32_t motions(const struct interp_program *p)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i < p->head->nsegs; i++)
		n += p->segs[i].kind < INTERP_BEGIN;
	return n;
}

static void add_int(json_t *o, const char *key, uint64_t v)
{
	json_object_set_new(o, key, json_integer((json_int_t)v));
}

static void add_real(json_t *o, const char *key, double v)
{
	if (isfinite(v))
		json_object_set_new(o, key, json_real(v));
}

static void add_path(json_t *o, const struct sim_run *r)
{
	const struct interp_program_head *h = r->job.program.head;
	const struct sim_result *w = &r->result;
	json_t *pulses = json_object();

	for (uint32_t j = 0; j < h->naxes; j++) {
		const char name[2] = { INTERP_AXIS_LETTERS[h->column[j]] };

		add_int(pulses, name, r->v.cycle.totals.pulses[h->column[j]]);
	}
	add_int(o, "lines", h->lines);
	add_int(o, "segments", motions(&r->job.program));
	add_real(o, "path_mm", h->length_mm);
	json_object_set_new(o, "pulses", pulses);
	add_int(o, "switches", w->switches);
	add_real(o, "deviation_um_max", w->deviation_mm_max * 1e3);
	if (w->points)
		add_real(o, "deviation_um_mean",
			 w->deviation_mm_sum * 1e3 / (double)w->points);
	if (strcmp(w->outcome, "done") == 0)
		json_object_set_new(o, "end_error_pulses",
				    json_integer(w->end_error_pulses));
}

static void add_cut(json_t *o, const struct sim_run *r)
{
	const struct cycle_totals *t = &r->v.cycle.totals;
	const double s = seconds(&r->v.cycle, r->v.cycle.count);

	add_int(o, "retracts", t->retracts);
	add_real(o, "retract_mm_max", t->retract_mm_max);
	add_int(o, "hunts", t->hunts);
	add_int(o, "retracts_in_row_max", t->in_row_max);
	add_int(o, "jumps", t->jumps);
	add_real(o, "jump_s", seconds(&r->v.cycle, t->jump_cycles));
	add_real(o, "erosion_s", seconds(&r->v.cycle, t->erode_cycles));
	add_int(o, "shorts", t->shorts);
	add_int(o, "arcs", t->arcs);
	add_real(o, "removed_mm3", r->result.cut.removed_mm3);
	add_real(o, "removal_mm3_min",
		 s > 0 ? r->result.cut.removed_mm3 / s * 60 : NAN);
	add_real(o, "wear_mm", r->result.cut.wear_mm);
	add_int(o, "burns", r->result.cut.burns);
}

/* The time in each condition, if the program calls any. */
static void add_conditions(json_t *o, const struct sim_run *r)
{
	const struct interp_program *p = &r->job.program;
	json_t *rows = json_array();

	for (uint32_t i = 1; i < p->head->nconds; i++) {
		json_t *row = json_object();
		char name[16];

		interp_tech_name(p->conds[i].letter, p->conds[i].number, name,
				 sizeof(name));
		json_object_set_new(row, "condition", json_string(name));
		add_real(row, "virtual_s",
			 seconds(&r->v.cycle, r->spent[i].cycles));
		add_real(row, "erosion_s",
			 seconds(&r->v.cycle, r->spent[i].eroding));
		json_array_append_new(rows, row);
	}
	if (json_array_size(rows))
		json_object_set(o, "conditions", rows);
	json_decref(rows);
}

static json_t *report(const struct sim_run *r)
{
	const struct cycle *c = &r->v.cycle;
	json_t *o = json_object();

	json_object_set_new(o, "outcome", json_string(r->result.outcome));
	if (c->fault.first != FAULT_NONE)
		json_object_set_new(o, "fault",
				    json_string(fault_name(c->fault.first)));
	add_int(o, "cycles", c->count);
	add_real(o, "virtual_s", seconds(c, c->count));
	add_real(o, "wall_s", r->result.wall_s);
	add_path(o, r);
	if (!c->config.dry_run)
		add_cut(o, r);
	if (r->result.contour_known) {
		add_real(o, "contour_um_max", r->result.contour_mm_max * 1e3);
		add_real(o, "contour_um_mean", r->result.contour_mm_mean * 1e3);
	}
	add_conditions(o, r);
	add_real(o, "compile_lines_s", r->job.compile_lines_s);
	add_real(o, "cycles_s", (double)c->count / r->result.wall_s);
	return o;
}

int report_write(const struct sim_run *r)
{
	json_t *o = report(r);
	const int bad = json_dumpf(o, r->report, JSON_INDENT(2));
	int err;

	fputc('\n', r->report);
	err = record_shut(r->report, r->o->report);
	json_decref(o);
	return err ? err : bad ? EX_OSERR : 0;
}

/* A servo that goes in and out at one place cuts nothing and causes no
 * fault. */
static void print_hunting(const struct sim_run *r, FILE *f)
{
	const struct cycle *c = &r->v.cycle;
	const struct cycle_gap_config *g = &c->config.gap;

	if (c->totals.hunts == 0)
		return;
	fprintf(f, "hunting    warning: %u times %d retracts and more in a row "
		"without %g um of progress,\n           at most %u.  Raise "
		"[gap] servo_v (%g; short_v is %g), lower feed_gain_mm_s_v "
		"(%g),\n           or jump oftener: lower [jump] every_s; "
		"--tune finds them\n",
		c->totals.hunts, HUNTING_ROW, g->progress_mm * 1e3,
		c->totals.in_row_max, g->servo_v, g->short_v, g->gain_mm_s_v);
}

/* In the words of edmctl alarms, from the same table. */
static void print_fault(const struct sim_run *r, FILE *f)
{
	const struct fault_row *row = &fault_table[r->v.cycle.fault.first];
	const struct interp_seg *beyond = probe_rest_beyond(&r->v.cycle);

	fprintf(f, ": %s at line %u: %s\nwhy        %s\nclear      %s",
		row->name, beyond ? beyond->line : r->v.cycle.cursor.seg.line,
		row->what, row->why, row->clear);
}

void report_print(const struct sim_run *r, FILE *f)
{
	const struct cycle *c = &r->v.cycle;
	const struct cycle_totals *t = &c->totals;
	const double s = seconds(c, c->count);

	fprintf(f, "outcome    %s", r->result.outcome);
	if (c->fault.first != FAULT_NONE)
		print_fault(r, f);
	fprintf(f, "\npath       %.3f mm in %u segments, %u lines\n",
		r->job.program.head->length_mm, motions(&r->job.program),
		r->job.program.head->lines);
	fprintf(f, "time       %.3f s virtual, %.3f s here (%.3g cycles/s)\n",
		s, r->result.wall_s, (double)c->count / r->result.wall_s);
	if (c->config.dry_run)
		return;
	fprintf(f, "erosion    %.1f s; removed %.3f mm3, wear %.4f mm, "
		"%u burns\n",
		seconds(c, t->erode_cycles), r->result.cut.removed_mm3,
		r->result.cut.wear_mm, r->result.cut.burns);
	fprintf(f, "jumps      %u in %.1f s\n", t->jumps,
		seconds(c, t->jump_cycles));
	fprintf(f, "retracts   %u, the longest %.3f mm, from %u shorts\n",
		t->retracts, t->retract_mm_max, t->shorts);
	print_hunting(r, f);
}
