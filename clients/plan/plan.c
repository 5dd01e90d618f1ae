/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.c - from a dense program to the fewest blocks, in the order of trust
 *
 * First the dense way is proved or refused.  Then it looks for the greedy way,
 * for the fewest blocks over the nodes, for nodes beside the path, and for a
 * better pivot.  Ctrl-C ends the search, and the best way so far is written.
 */
#include "plan.h"

#include "check.h"
#include "pullout.h"
#include "repair.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>

#define WIDEN_ROUNDS	12
#define TOUCH_MM	0.01		/* nearer is as good as contact */

static double now_s(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static void say_contact(const struct plan *p, const struct check_result *r)
{
	const struct route_node *n = &p->dense.node[r->block + 1];

	fprintf(stderr, "%s:%u: the program is not free itself: ",
		p->j->o->program ? p->j->o->program : "the way found",
		n->line);
	check_say_left(r, stderr);
	fprintf(stderr, ", %.1f %% along the block\n", 100 * r->t);
	job_say_pair(p->j, &r->pair, stderr);
}

/* If the end pose is too near, the electrode or the program is wrong. */
int plan_check_end(struct plan *p, const double end[INTERP_NAXES])
{
	const double wanted = p->j->clear_mm + p->j->chord_mm;
	struct near_pair pair = { 0 };
	struct pose pose;
	char say[80];

	motion_pose(&p->j->motion, end, &pose);
	p->end_mm = near_distance(&p->j->bodies, &pose, &pair);
	if (p->end_mm > 0 && job_inside(p->j, &pose, say, sizeof(say)) == 1) {
		fprintf(stderr, "edm-plan: end pose: %s; an end pose in the "
			"cavity\n", say);
		return 1;
	}
	if (p->end_mm >= wanted + PROVE_EPS_MM ||
	    (p->end_mm > 0 && p->j->o->end_zone_mm > 0))
		return 0;
	if (p->end_mm > 0)
		fprintf(stderr, "edm-plan: end pose: %.4f mm are left of %.4f; "
			"an electrode thinner all round by %.3f mm, "
			"--clearance, or --end-zone to come nearer at the "
			"end\n", p->end_mm, wanted, wanted - p->end_mm);
	else
		fprintf(stderr, "edm-plan: end pose: the electrode touches the "
			"part; an end pose that leaves %.4f mm, a thinner "
			"electrode, or meshes that stand elsewhere: "
			"--part-at, --electrode-at\n", wanted);
	job_say_pair(p->j, &pair, stderr);
	return 1;
}

/* If only the way in is too near, the search may still find a way round. */
static int check_dense(struct plan *p)
{
	struct check_result r;
	int rc;

	rc = check_way(p->j, &p->dense, &p->c, &r);
	if (rc)
		return rc == -ENOMEM ? EX_OSERR : 1;
	p->queries += r.queries;
	p->dense_least_mm = r.least_mm;
	if (r.ok)
		return 0;
	if (r.inside) {
		fprintf(stderr, "edm-plan: the way begins wrong: %s\n", r.say);
		return 1;
	}
	say_contact(p, &r);
	if (r.block < p->first || r.block >= p->last || r.pair.mm <= 0)
		return 1;
	fprintf(stderr, "edm-plan: looking for a way round that place\n");
	return 0;
}

/* -- Plans ---------------------------------------------------------------- */

void plan_prove(const struct job *j, struct plan_way *w, uint64_t *queries)
{
	double lattice[INTERP_NAXES];

	route_lattice(&j->config, lattice);
	w->least_mm = DBL_MAX;
	for (uint32_t i = 0; i + 1 < w->n; i++) {
		struct proof p = { 0 };
		struct block b;

		block_init(&b, &j->motion, w->q[i], w->q[i + 1]);
		w->strays_mm[i] = motion_strays_mm(&b, lattice);
		w->proved_mm[i] = prove_least(&j->bodies, &b, &p) -
				  w->strays_mm[i] - j->chord_mm;
		w->t[i] = p.t;
		w->pair[i] = p.pair;
		*queries += p.queries;
		w->least_mm = fmin(w->least_mm, w->proved_mm[i]);
	}
}

static void take_way(struct plan_way *w, const char *how,
		     const struct fewest *f, const uint32_t *at, uint32_t n)
{
	w->how = how;
	w->n = n + 1;
	for (uint32_t i = 0; i <= n; i++)
		memcpy(w->q[i], f->q[at[i]], sizeof(w->q[i]));
}

static void from_free(struct plan_way *w, const struct free_way *f,
		      const struct job *j)
{
	w->how = "free nodes";
	w->n = f->n;
	memcpy(w->q, f->q, f->n * sizeof(*w->q));
	for (uint32_t i = 1; i + 1 < w->n; i++)
		free_round(&j->config, w->q[i]);
}

/* In an end zone the least distance does not tell what the rest keeps. */
static bool keeps(const struct plan *p, const struct plan_way *w)
{
	struct near_pair pair = { 0 };

	if (!(p->c.zone_mm > 0))
		return w->least_mm >= p->c.mm;
	for (uint32_t i = 0; i + 1 < w->n; i++)
		if (!check_block(p->j, w->q[i], w->q[i + 1], &p->c, &pair))
			return false;
	return true;
}

/* Is @a to be written rather than the best so far? */
static bool is_better(const struct plan *p, const struct plan_way *a)
{
	const struct plan_way *b = &p->best;

	if (b->how && a->n > b->n)
		return false;
	if (b->how && a->n == b->n && a->least_mm <= b->least_mm)
		return false;
	return keeps(p, a);
}

static void take_best(struct plan *p, const struct plan_way *w)
{
	p->best = *w;
	if (!p->trial)
		bar_best(w->n - 1, w->least_mm);
}

/* Along the nodes @at, then off them. Return: is it to be written? */
static bool try_free(struct plan *p, const struct fewest *f,
		     const uint32_t *at)
{
	static struct plan_way way;
	struct free_way w;
	uint32_t n = 0;

	while (at[n] != f->n - 1)
		n++;
	take_way(&way, NULL, f, at, n);
	if (free_init(&w, f->j, &p->c, way.q, way.n))
		return false;
	free_widen(&w, WIDEN_ROUNDS);
	p->queries += w.queries;
	from_free(&way, &w, f->j);
	plan_prove(f->j, &way, &p->queries);
	if (!is_better(p, &way))
		return false;
	take_best(p, &way);
	return true;
}

/*
 * The search for free nodes begins with a way of fewer blocks that only just
 * does not touch.  Linear programs then find it room.  If that does not come
 * to the clearance, they widen the way that has it.
 */
static void plan_free(struct plan *p, struct fewest *f, const uint32_t *best)
{
	const double touch_mm = TOUCH_MM - f->j->chord_mm;
	const uint32_t most = p->best.n - 1;
	uint32_t at[FEWEST_NODES_MAX];
	uint32_t n = most < 2 ? 0 : fewest_search(f, touch_mm, most - 1, at);

	for (; n && n < most && !bar_interrupted(); n++) {
		fewest_widest(f, touch_mm, n, at);
		if (try_free(p, f, at))
			return;
	}
	if (!bar_interrupted())
		try_free(p, f, best);
}

int plan_over(struct plan *p, const struct job *j,
	      double (*q)[INTERP_NAXES], uint32_t n)
{
	uint32_t at[FEWEST_NODES_MAX], blocks;
	struct fewest f;

	if (fewest_init(&f, j, q, n))
		return -ENOMEM;
	f.c = &p->c;
	blocks = fewest_greedy(&f, j->clear_mm, at);
	if (blocks && blocks != UINT32_MAX) {
		take_way(&p->greedy, "greedy", &f, at, blocks);
		plan_prove(j, &p->greedy, &p->queries);
		take_best(p, &p->greedy);
	}
	blocks = bar_interrupted() ? 0 :
		 fewest_search(&f, j->clear_mm, n - 1, at);
	if (blocks) {
		fewest_widest(&f, j->clear_mm, blocks, at);
		take_way(&p->fewest, "fewest over nodes", &f, at, blocks);
		plan_prove(j, &p->fewest, &p->queries);
		if (is_better(p, &p->fewest))
			take_best(p, &p->fewest);
	}
	if (blocks && !j->o->on_path)
		plan_free(p, &f, at);
	p->queries += f.queries;
	fewest_free(&f);
	return p->best.how ? 0 : 1;
}

/* -- Words ---------------------------------------------------------------- */

static void say_way(const char *name, const struct plan_way *w)
{
	if (!w->how)
		return;
	printf("%-10s %u blocks, proved %.4f mm (%s)\n", name, w->n - 1,
	       w->least_mm, w->how);
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

static void describe(const struct plan *p, FILE *out)
{
	job_describe(p->j, out);
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

/* -- Writing -------------------------------------------------------------- */

/* The text is read back, and that is proved: not what was computed. */
static int prove_text(struct plan *p, const char *text)
{
	const struct route_text from = { .path = p->written_path, .text = text,
					 .dialect = p->written_dialect };
	struct check_result r;
	struct route w;
	int rc = route_read(&w, &p->j->config, &from);

	if (rc)
		return EX_SOFTWARE;
	rc = check_way(p->j, &w, &p->c, &r);
	route_free(&w);
	p->queries += r.queries;
	if (rc == 0 && r.ok)
		return 0;
	if (rc == -EINTR)
		return 1;
	fprintf(stderr, "edm-plan: what would be written is not free: %.4f mm "
		"of %.4f; nothing is written\n", r.pair.mm, r.wanted_mm);
	return EX_SOFTWARE;
}

static int write_all(struct plan *p)
{
	char *text = text_write(p, &p->best);
	int err;

	if (!text)
		return EX_OSERR;
	bar_forget();
	err = prove_text(p, text);
	if (err == 0)
		err = put_text(p->j->o->output, text);
	free(text);
	if (err == 0 && p->j->o->times)
		err = times_ask(p);
	if (err == 0)
		err = report_put(p);
	if (err == 0)
		err = picture_put(p);
	if (err == 0)
		err = view_put(p);
	if (err == 0 && !p->j->o->quiet)
		describe(p, stdout);
	return err;
}

static void say_no_way(const struct plan *p)
{
	if (bar_interrupted())
		return;
	fprintf(stderr, "edm-plan: no way near the program keeps %.3f mm; a "
		"thinner electrode, less --clearance, or another program to "
		"begin with\n", p->j->clear_mm);
	if (p->nearest.mm > 0) {
		fprintf(stderr, "edm-plan: the last that was tried came to "
			"%.3f mm\n", p->nearest.mm);
		job_say_pair(p->j, &p->nearest, stderr);
	}
}

static int plan_nodes(struct plan *p)
{
	static double q[FEWEST_NODES_MAX][INTERP_NAXES];
	uint32_t at[FEWEST_NODES_MAX], n;
	int err;

	n = plan_choose_nodes(p, at);
	if (n == 0)
		return EX_OSERR;
	for (uint32_t i = 0; i < n; i++) {
		memcpy(q[i], p->dense.node[at[i]].q, sizeof(q[i]));
		free_round(&p->j->config, q[i]);
	}
	err = plan_over(p, p->j, q, n);
	if (err == 1 && !bar_interrupted()) {
		err = repair_nodes(p, q, &n);
		if (err == 0)
			err = plan_over(p, p->j, q, n);
	}
	if (err == -ENOMEM)
		return EX_OSERR;
	if (err) {
		say_no_way(p);
		return 1;
	}
	if (!p->j->o->no_pivot && !bar_interrupted())
		err = plan_pivot(p) == -ENOMEM ? EX_OSERR : 0;
	return err;
}

static int load_way(struct plan *p)
{
	const struct route_text from = { .path = p->j->o->program,
				       .dialect = p->j->o->dialect };
	int err;

	if (p->j->o->end_given)
		err = pullout_way(p);
	else
		err = route_read(&p->dense, &p->j->config, &from);
	if (err)
		return err;
	if (!p->j->o->end_given &&
	    !job_moves_known(p->j, &p->dense, p->j->o->program))
		return EX_DATAERR;
	return plan_find_way_in(p);
}

int plan_program(struct job *j)
{
	static struct plan p;
	int err;

	p.j = j;
	p.seconds = now_s();
	err = load_way(&p);
	if (err == 0)
		err = check_clearance(j, p.dense.node[p.last].q, &p.c);
	if (err == 0)
		err = plan_check_end(&p, p.dense.node[p.last].q);
	if (err == 0)
		err = check_dense(&p);
	if (err == 0)
		err = plan_nodes(&p);
	p.stopped = bar_interrupted();
	p.planned_s = now_s() - p.seconds;
	bar_end(j);
	if (err == 0)
		err = write_all(&p);
	if (err == EX_OSERR)
		fprintf(stderr, "edm-plan: out of memory\n");
	if (err && p.stopped)
		fprintf(stderr, "edm-plan: interrupted; nothing is written\n");
	route_free(&p.dense);
	return err;
}
