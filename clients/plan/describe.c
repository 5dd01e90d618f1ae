/* SPDX-License-Identifier: Apache-2.0 */
/*
 * describe.c - what was planned, in words
 */
#include "plan.h"

#include <math.h>

static void say_way(const char *name, const struct plan_way *w)
{
	if (!w->how)
		return;
	if (w->within_mm > PROVE_FINE_MM)
		printf("%-10s %u blocks, proved %.2f mm (%s)\n", name,
		       w->n - 1, floor(w->least_mm * 100) / 100, w->how);
	else
		printf("%-10s %u blocks, proved %.4f mm (%s)\n", name,
		       w->n - 1, w->least_mm, w->how);
	if (w->time_pass_s > 0)
		printf("           %.1f min, %.1f min with a stop at each "
		       "node\n",
		       w->time_pass_s / 60, w->time_stop_s / 60);
}

static void say_pivot(const struct plan_pivot *v)
{
	if (!v->way.how) {
		if (v->why[0])
			printf("pivot      %s\n", v->why);
		return;
	}
	printf("pivot      %u blocks, proved %.4f mm, with the work moved by "
	       "%.3f %.3f %.3f mm\n           and the electrode in its holder "
	       "by %.3f %.3f %.3f mm%s\n", v->way.n - 1, v->way.least_mm,
	       v->part_mm[0], v->part_mm[1], v->part_mm[2], v->tool_mm[0],
	       v->tool_mm[1], v->tool_mm[2],
	       v->outside ? "; beyond this machine's travel" : "");
}

/* Words that the dense program has between its blocks have no place among fewer
 * blocks. */
static void say_left_out(const struct plan *p)
{
	const struct route_node *n = p->dense.node;
	uint32_t said = 0;

	if (p->written_dialect != p->j->o->dialect)
		printf("note       %s is in the dialect generic; the other one "
		       "does not have its words\n", p->j->o->output);
	if (!p->j->o->program)
		return;
	if (!p->carried) {
		printf("note       only positioning and blocks are written; "
		       "conditions and other words of\n           %s are not\n",
		       p->j->o->program);
		return;
	}
	for (uint32_t i = p->first + 2; i <= p->last && said < 5; i++) {
		if (!n[i].act_line && n[i].cond == n[i - 1].cond)
			continue;
		printf("note       line %u: what it calls within the way in is "
		       "left out\n", n[i].act_line ? n[i].act_line : n[i].line);
		said++;
	}
}

void plan_describe(const struct plan *p)
{
	job_describe(p->j, stdout);
	printf("end pose   %.4f mm are left\n", p->end_mm);
	printf("dense      %u blocks, least seen %.4f mm\n", p->last - p->first,
	       p->dense_least_mm);
	if (p->dense_pass_s > 0)
		printf("           %.1f min, %.1f min with a stop at each "
		       "node\n",
		       p->dense_pass_s / 60, p->dense_stop_s / 60);
	if (p->repaired)
		printf("repaired   %u nodes of the dense way are others now\n",
		       p->repaired);
	say_way("greedy", &p->greedy);
	say_way("fewest", &p->fewest);
	say_way("written", &p->best);
	say_pivot(&p->pivot);
	say_left_out(p);
	printf("%-10s %llu queries, %.1f s\n",
	       p->stopped ? "stopped" : "planned",
	       (unsigned long long)p->queries, p->planned_s);
}
