/* SPDX-License-Identifier: Apache-2.0 */
/*
 * checked.c - what --check says and writes of a program
 */
#include "check.h"
#include "plan.h"

#include <errno.h>
#include <string.h>
#include <sysexits.h>

static void say_axes(const struct job *j, const double q[INTERP_NAXES])
{
	const uint32_t moves = motion_moves(&j->motion);

	for (int k = 0; k < INTERP_NAXES; k++)
		if (moves & 1u << k)
			printf(" %c%.4f", INTERP_AXIS_LETTERS[k], q[k]);
}

static void say_contact(const struct job *j, const struct route *w,
			const struct check_result *r)
{
	const struct route_node *n = &w->node[r->block + 1];

	if (r->inside) {
		printf("%s: not free: %s at the start, at", j->o->program,
		       r->say);
	} else if (r->given_up) {
		printf("%s:%u: not proved: given up, out of memory or after "
		       "millions of steps; a shorter block, or coarser meshes, "
		       "at", j->o->program, n->line);
	} else {
		printf("%s:%u: not free: ", j->o->program, n->line);
		check_say_left(r, stdout);
		printf(", %.1f %% along %s, at", 100 * r->t,
		       r->lift ? "its leg" : "the block");
	}
	say_axes(j, r->q);
	putchar('\n');
	if (!r->inside && !r->given_up)
		job_say_pair(j, &r->pair, stdout);
}

static int say_result(const struct job *j, const struct route *w,
		      const struct check_result *r)
{
	if (!r->ok) {
		say_contact(j, w, r);
		return 1;
	}
	printf("proved     %u blocks keep %.3f mm%s, and so do jumps and "
	       "retracts\n", w->n - 1, j->clear_mm,
	       j->o->end_zone_mm > 0 ? " but in the end zone" : "");
	if (w->nlifts)
		printf("           along them and beside them, from "
		       "everywhere\n");
	printf("           %.4f mm more are kept for pulses and arcs\n",
	       r->most_added_mm);
	printf("least seen %.4f mm, line %u; %llu queries\n", r->least_mm,
	       w->node[r->least_block + 1].line,
	       (unsigned long long)r->queries);
	if (job_are_apart(j, r->least_mm))
		printf("           That is more than one of the bodies is "
		       "long: are unit and\n           place of the meshes "
		       "right?  --unit, --part-at, --electrode-at\n");
	return 0;
}

/* The picture and the page have no more nodes than a way that is planned. */
static void draw(struct plan *p, const struct route *w,
		 const struct check_result *r)
{
	uint32_t at[FEWEST_NODES_MAX];

	p->dense = *w;
	p->last = w->n - 1;
	p->best.n = plan_choose_nodes(p, at);
	p->best.least_mm = r->least_mm;
	for (uint32_t i = 0; i < p->best.n; i++)
		memcpy(p->best.q[i], w->node[at[i]].q, sizeof(p->best.q[i]));
	p->contact = r->ok ? NULL : r->q;
}

static int put_files(struct job *j, const struct route *w,
		     const struct check_result *r)
{
	static struct plan p;
	int err = report_put_check(j, w, r);

	if (err || (!j->o->picture && !j->o->view))
		return err;
	p.j = j;
	draw(&p, w, r);
	if (p.best.n < 2)
		return EX_OSERR;
	err = picture_put(&p);
	return err ? err : view_put(&p);
}

static int check_read(struct job *j, const struct route *w)
{
	struct check_result result;
	struct clearance c;
	int err, free_rc;

	check_clearance(j, w->node[w->n - 1].q, &c);
	if (!j->o->quiet)
		job_describe(j, stdout);
	err = check_way(j, w, &c, &result);
	if (err == -EINTR)
		fprintf(stderr, "edm-plan: interrupted; nothing is proved\n");
	if (err)
		return err == -ENOMEM ? EX_OSERR : 1;
	free_rc = say_result(j, w, &result);
	err = put_files(j, w, &result);
	return err ? err : free_rc;
}

int check_program(struct job *j)
{
	const struct route_text from = { .path = j->o->program,
				       .dialect = j->o->dialect };
	struct route w;
	int err = route_read(&w, &j->config, &from);

	if (err)
		return err;
	err = job_moves_known(j, &w, j->o->program) ? check_read(j, &w) :
						      EX_DATAERR;
	route_free(&w);
	return err;
}
