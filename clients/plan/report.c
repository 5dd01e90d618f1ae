/* SPDX-License-Identifier: Apache-2.0 */
/*
 * report.c - the JSON report
 */
#include "plan.h"

#include <float.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

static json_t *point(const double p[3])
{
	return json_pack("[f,f,f]", p[0], p[1], p[2]);
}

static json_t *axes(const struct job *j, const double q[INTERP_NAXES])
{
	const uint32_t moves = motion_moves(&j->motion);
	json_t *ret = json_object();

	for (int k = 0; k < INTERP_NAXES; k++) {
		const char name[2] = { INTERP_AXIS_LETTERS[k], '\0' };

		if (moves & 1u << k)
			json_object_set_new(ret, name, json_real(q[k]));
	}
	return ret;
}

static json_t *block(const struct job *j, const struct plan_way *w, uint32_t i)
{
	double q[INTERP_NAXES];

	for (int k = 0; k < INTERP_NAXES; k++)
		q[k] = w->q[i][k] + w->t[i] * (w->q[i + 1][k] - w->q[i][k]);
	return json_pack("{s:f,s:f,s:f,s:o,s:o,s:i,s:i}",
			 "proved_mm", w->proved_mm[i], "strays_mm",
			 w->strays_mm[i], "nearest_t", w->t[i],
			 "nearest_axes", axes(j, q),
			 "nearest_part_mm", point(w->pair[i].p),
			 "part_triangle",
			 (int)j->part_tree.id[w->pair[i].part] + 1,
			 "electrode_triangle",
			 (int)j->tool_tree.id[w->pair[i].tool] + 1);
}

static json_t *way(const struct job *j, const struct plan_way *w)
{
	json_t *blocks = json_array(), *nodes = json_array(), *ret;

	for (uint32_t i = 0; i < w->n; i++)
		json_array_append_new(nodes, axes(j, w->q[i]));
	for (uint32_t i = 0; i + 1 < w->n; i++)
		json_array_append_new(blocks, block(j, w, i));
	ret = json_pack("{s:s,s:i,s:f,s:f,s:o,s:o}", "how", w->how, "blocks",
			(int)w->n - 1, "proved_mm", w->least_mm, "within_mm",
			w->within_mm, "nodes", nodes, "each", blocks);
	if (w->time_pass_s > 0) {
		json_object_set_new(ret, "time_s", json_real(w->time_pass_s));
		json_object_set_new(ret, "time_node_stops_s",
				    json_real(w->time_stop_s));
	}
	return ret;
}

/* A file's name may be any bytes; a JSON text is UTF-8. */
static json_t *name_of(const char *name)
{
	json_t *ret = json_string(name);
	char *plain = ret ? NULL : strdup(name);

	for (char *s = plain; s && *s; s++)
		if (*s & 0x80)
			*s = '?';
	if (plain)
		ret = json_string(plain);
	free(plain);
	return ret;
}

static json_t *body(const struct mesh *m, const struct mesh_findings *f)
{
	return json_pack("{s:o,s:i,s:i,s:i,s:i,s:i,s:b,s:i,s:i,s:i,s:f}",
			 "file", name_of(m->name),
			 "triangles", (int)m->ntris,
			 "doubled", (int)f->doubled,
			 "degenerate", (int)f->degenerate,
			 "joined", (int)f->joined,
			 "turned", (int)f->turned,
			 "inverted", f->inverted > 0,
			 "shells", (int)f->shells,
			 "open_edges", (int)f->open,
			 "crossings", (int)f->crossings,
			 "chord_mm", f->chord_mm);
}

static json_t *dense(const struct plan *p)
{
	json_t *ret = json_pack("{s:i,s:f,s:i,s:b}", "blocks",
				(int)(p->last - p->first), "least_seen_mm",
				p->dense_least_mm, "repaired_nodes",
				(int)p->repaired, "other_lines_carried",
				p->carried);

	if (p->dense_pass_s > 0) {
		json_object_set_new(ret, "time_s", json_real(p->dense_pass_s));
		json_object_set_new(ret, "time_node_stops_s",
				    json_real(p->dense_stop_s));
	}
	return ret;
}

static json_t *pivot(const struct plan *p)
{
	json_t *ret = way(p->j, &p->pivot.way);

	json_object_set_new(ret, "part_shift_mm", point(p->pivot.part_mm));
	json_object_set_new(ret, "electrode_shift_mm", point(p->pivot.tool_mm));
	json_object_set_new(ret, "beyond_travel",
			    json_boolean(p->pivot.outside));
	return ret;
}

static int put(const char *path, json_t *o)
{
	char *text = o ? json_dumps(o, JSON_INDENT(1) |
				       JSON_REAL_PRECISION(9)) : NULL;
	int err;

	json_decref(o);
	if (!text)
		return EX_OSERR;
	err = put_text(path, text);
	free(text);
	return err;
}

static json_t *bodies(const struct job *j)
{
	return json_pack("{s:o,s:o,s:f,s:f}", "part",
			 body(&j->part, &j->part_found), "electrode",
			 body(&j->tool, &j->tool_found), "clearance_mm",
			 j->clear_mm, "chord_mm", j->chord_mm);
}

int report_put(const struct plan *p)
{
	const struct job *j = p->j;
	json_t *o;

	if (!j->o->report)
		return 0;
	o = json_pack("{s:f,s:o,s:I,s:f,s:b}", "end_mm", p->end_mm, "dense",
		      dense(p), "queries", (json_int_t)p->queries, "seconds",
		      p->planned_s, "interrupted", p->stopped);
	if (o)
		json_object_update_new(o, bodies(j));
	if (o && p->greedy.how)
		json_object_set_new(o, "greedy", way(j, &p->greedy));
	if (o && p->fewest.how)
		json_object_set_new(o, "fewest", way(j, &p->fewest));
	if (o)
		json_object_set_new(o, "written", way(j, &p->best));
	if (o && p->pivot.way.how)
		json_object_set_new(o, "pivot", pivot(p));
	return put(j->o->report, o);
}

/* At the start one body may be inside the other: then there is no pair. */
static json_t *contact(const struct job *j, const struct route *w,
		       const struct check_result *r)
{
	json_t *ret = json_pack("{s:i,s:f,s:o,s:b,s:b}", "line",
		(int)w->node[r->inside ? 0 : r->block + 1].line, "t", r->t,
		"axes", axes(j, r->q), "in_lift", r->lift, "given_up",
		r->given_up);

	if (r->inside)
		json_object_set_new(ret, "inside", json_string(r->say));
	else if (!r->given_up)
		json_object_update_new(ret, json_pack("{s:f,s:f,s:o,s:i,s:i}",
			"distance_mm", r->pair.mm, "wanted_mm", r->wanted_mm,
			"part_mm", point(r->pair.p), "part_triangle",
			(int)j->part_tree.id[r->pair.part] + 1,
			"electrode_triangle",
			(int)j->tool_tree.id[r->pair.tool] + 1));
	return ret;
}

int report_put_check(const struct job *j, const struct route *w,
		     const struct check_result *r)
{
	json_t *o;

	if (!j->o->report)
		return 0;
	o = json_pack("{s:b,s:i,s:I}", "proved", r->ok, "blocks",
		      (int)w->n - 1, "queries", (json_int_t)r->queries);
	if (o)
		json_object_update_new(o, bodies(j));
	if (o && !r->inside)
		json_object_update_new(o, json_pack("{s:f,s:i}",
			"least_seen_mm", r->least_mm, "least_line",
			(int)w->node[r->least_block + 1].line));
	if (o && !r->ok)
		json_object_set_new(o, "contact", contact(j, w, r));
	return put(j->o->report, o);
}
