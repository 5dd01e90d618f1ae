/* SPDX-License-Identifier: Apache-2.0 */
/*
 * values.c - the condition in force
 */
#include "values.h"

#include "compiling.h"
#include "interp/program.h"
#include "interp/tech_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct values {
	const char *machine, *fault_words;
	struct interp_tech base;
	/* About the program that is loaded. */
	uint32_t n;			/* 0: none */
	uint16_t *cond_of_seg;		/* NULL: the block of the program could
					 * not be read */
	uint32_t nsegs, nconds;
	struct interp_tech *cond;
};

struct values *values_create(const struct machine_config *config)
{
	struct values *v = calloc(1, sizeof(*v));

	if (!v)
		return NULL;
	v->machine = config->name;
	v->fault_words = config->generator.fault_words;
	config_tech_base(config, &v->base);
	return v;
}

static void leave_program(struct values *v)
{
	free(v->cond_of_seg);
	free(v->cond);
	v->cond_of_seg = NULL;
	v->cond = NULL;
	v->n = 0;
}

void values_destroy(struct values *v)
{
	if (!v)
		return;
	leave_program(v);
	free(v);
}

/* Two megabytes are kept of a program of a million segments, and not all of
 * it. */
static void copy_program(struct values *v, const struct interp_program *p)
{
	v->nsegs = p->head->nsegs;
	v->nconds = p->head->nconds;
	v->cond_of_seg = calloc(v->nsegs, sizeof(*v->cond_of_seg));
	v->cond = calloc(v->nconds, sizeof(*v->cond));
	if (!v->cond_of_seg || !v->cond) {
		leave_program(v);
		return;
	}
	for (uint32_t i = 0; i < v->nsegs; i++)
		v->cond_of_seg[i] = p->segs[i].cond;
	for (uint32_t i = 0; i < v->nconds; i++)
		v->cond[i] = p->conds[i].tech;
}

static void take_program(struct values *v, uint32_t n)
{
	struct interp_program p;
	const void *block;
	size_t bytes;

	if (n == v->n)
		return;
	leave_program(v);
	if (n == 0 || shm_program_read(&block, &bytes, v->machine, n) < 0)
		return;
	if (interp_program_map(&p, block, bytes) == 0)
		copy_program(v, &p);
	shm_program_unmap(block, bytes);
	v->n = n;
}

/* The number of the condition in force; 0: the program has called none. */
static uint32_t cond_of(const struct values *v, const struct shm_snapshot *s)
{
	uint32_t cond;

	if (!v->cond_of_seg || s->seg >= v->nsegs)
		return 0;
	cond = v->cond_of_seg[s->seg];
	return cond < v->nconds ? cond : 0;
}

static void apply_sets(struct interp_tech *t, const struct shm_sets *sets,
		       uint32_t cond, bool own[INTERP_NTECH])
{
	for (uint64_t i = 0; i < sets->n && i < SHM_SETS_MAX; i++) {
		const struct shm_set *set = &sets->set[i];

		if (set->cond != cond || set->field >= INTERP_NTECH ||
		    isnan(set->value))
			continue;
		t->v[set->field] = set->value;
		own[set->field] = true;
	}
}

json_t *values_json(const struct interp_tech *t)
{
	json_t *o = json_object();

	for (int i = 0; i < INTERP_NTECH; i++)
		if (isfinite(t->v[i]))
			json_object_set_new(o, interp_tech_field[i].name,
					    json_real(t->v[i]));
	return o;
}

static json_t *as_names(const bool own[INTERP_NTECH])
{
	json_t *a = json_array();

	for (int i = 0; i < INTERP_NTECH; i++)
		if (own[i])
			json_array_append_new(a,
				json_string(interp_tech_field[i].name));
	return a;
}

/* What the generator tells, if it tells something. */
static json_t *told_of(const struct shm_snapshot *s)
{
	json_t *o = json_object();

	for (int i = 0; i < SHM_NTOLD; i++)
		if (s->tells >> i & 1 && isfinite(s->told[i]))
			json_object_set_new(o, process_name(i),
					    json_real(s->told[i]));
	return o;
}

static void put_fault(const struct values *v, const struct shm_snapshot *s,
		      json_t *to)
{
	const bool tells = s->tells >> PROCESS_FAULT & 1;
	char text[CONFIG_FAULT_MAX];

	config_fault_text(v->fault_words, tells ? s->told[PROCESS_FAULT] : 0,
			  text, sizeof(text));
	json_object_set_new(to, "generator_fault", json_string(text));
}

void values_fill(struct values *v, const struct shm_status *status,
		 const struct shm_snapshot *s, json_t *to)
{
	struct interp_tech t = v->base;
	bool own[INTERP_NTECH] = { false };
	struct shm_sets sets;
	char name[16] = "";
	uint32_t cond;

	take_program(v, s->loaded ? s->program : 0);
	cond = cond_of(v, s);
	if (v->cond)
		interp_tech_over(&t, &v->cond[cond]);
	if (status && s->loaded && shm_sets(status, &sets) &&
	    sets.program_key == s->program_key)
		apply_sets(&t, &sets, cond, own);
	if (s->loaded && s->cond_letter)
		interp_tech_name(s->cond_letter, s->cond_number, name,
				 sizeof(name));
	json_object_set_new(to, "condition", json_string(name));
	json_object_set_new(to, "values", values_json(&t));
	json_object_set_new(to, "set", as_names(own));
	json_object_set_new(to, "told", told_of(s));
	put_fault(v, s, to);
}

json_t *values_fields(void)
{
	json_t *all = json_array();

	for (int i = 0; i < INTERP_NTECH; i++) {
		const struct interp_tech_field *f = &interp_tech_field[i];
		const bool live = interp_tech_is_live((enum interp_tech_id)i);

		json_array_append_new(all, json_pack(
			"{s:s,s:s,s:f,s:f,s:b,s:b,s:s}", "name", f->name,
			"unit", f->unit, "min", f->min, "max", f->max, "whole",
			f->whole, "live", live, "help", f->help));
	}
	return all;
}
