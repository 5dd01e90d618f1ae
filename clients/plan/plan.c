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
#include "clocks.h"
#include "mouth.h"
#include "pullout.h"
#include "repair.h"
#include "spread.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>

#define WIDEN_ROUNDS	12
#define STRAIGHTEN_ROUNDS	25
#define STRAIGHT_SPARE_MM	0.005
#define TOUCH_MM	0.01		/* nearer is as good as contact */

static void say_contact(const struct plan *p, const struct check_result *r)
{
	const struct route_node *n = &p->dense.node[r->block + 1];

	fprintf(stderr, "%s:%u: the program is not free itself: ",
		p->j->o->program ? p->j->o->program : "the way found",
		n->line);
	check_say_left(r, stderr);
	fprintf(stderr, ", %.1f %% along %s\n", 100 * r->t,
		r->lift ? "its leg" : "the block");
	job_say_pair(p->j, &r->pair, stderr);
}

/* Meshes in inches are so far from the place where the program takes them. */
static int refuse_apart(const struct plan *p)
{
	fprintf(stderr, "edm-plan: end pose: %.4g mm are left between part and "
		"electrode, more than one of them is long; meshes in the unit "
		"and the frame of the machine: --unit, --part-at, "
		"--electrode-at; or --any-size if it is meant\n", p->end_mm);
	return EX_DATAERR;
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
	if (!p->j->o->any_size && job_are_apart(p->j, p->end_mm))
		return refuse_apart(p);
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

struct proving {
	const struct job *j;
	struct plan_way *w;
	double lattice[INTERP_NAXES];
	uint64_t queries[FEWEST_NODES_MAX];
};

static bool prove_one(void *arg, uint32_t i)
{
	struct proving *x = arg;
	const struct job *j = x->j;
	struct plan_way *w = x->w;
	struct proof p = { 0 };
	struct block b;

	block_init(&b, &j->motion, w->q[i], w->q[i + 1]);
	w->strays_mm[i] = motion_strays_mm(&b, x->lattice);
	w->proved_mm[i] = prove_least(&j->bodies, &b, w->within_mm, &p) -
			  w->strays_mm[i] - j->chord_mm;
	w->t[i] = p.t;
	w->pair[i] = p.pair;
	x->queries[i] = p.queries;
	return false;
}

void plan_prove(const struct job *j, struct plan_way *w, double within_mm,
		uint64_t *queries)
{
	struct proving x = { .j = j, .w = w };

	route_lattice(&j->config, x.lattice);
	w->least_mm = DBL_MAX;
	w->within_mm = within_mm;
	spread_first(w->n - 1, prove_one, &x);
	for (uint32_t i = 0; i + 1 < w->n; i++) {
		w->least_mm = fmin(w->least_mm, w->proved_mm[i]);
		*queries += x.queries[i];
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
	w->n = f->n;
	memcpy(w->q, f->q, f->n * sizeof(*w->q));
	for (uint32_t i = f->mouth ? 0 : 1; i + 1 < w->n; i++)
		free_round(&j->config, w->q[i]);
}

static void raise_to(struct plan_way *w, const double *proved_mm)
{
	w->least_mm = DBL_MAX;
	for (uint32_t i = 0; i + 1 < w->n; i++) {
		w->proved_mm[i] = fmax(w->proved_mm[i], proved_mm[i]);
		w->least_mm = fmin(w->least_mm, w->proved_mm[i]);
	}
}

/* Over nodes.  The search has proved some clearance of each block, which may be
 * more than a proof within @within_mm comes to. */
static void prove_nodes(struct plan *p, const struct fewest *f,
			const uint32_t *at, struct plan_way *w,
			double within_mm)
{
	double known[FEWEST_NODES_MAX];

	plan_prove(f->j, w, within_mm, &p->queries);
	for (uint32_t i = 0; i + 1 < w->n; i++)
		known[i] = f->proved[(size_t)at[i] * f->n + at[i + 1]];
	if (!(p->c.zone_mm > 0))
		raise_to(w, known);
}

/* What is written is proved finely; the others have been compared only. */
static void prove_best(struct plan *p)
{
	struct plan_way *others[] = { &p->greedy, &p->fewest };
	double known[FEWEST_NODES_MAX];

	memcpy(known, p->best.proved_mm, sizeof(known));
	if (p->best.within_mm > PROVE_FINE_MM)
		plan_prove(p->j, &p->best, PROVE_FINE_MM, &p->queries);
	raise_to(&p->best, known);
	for (int i = 0; i < 2; i++)
		if (others[i]->how == p->best.how)
			*others[i] = p->best;
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

/* A way that was found from the end pose has no mouth that was asked for. */
static bool mouth_moves(const struct plan *p)
{
	return p->j->o->end_given && !p->trial;
}

/* Is it better, and does the machine come to its mouth?  Then it is taken. */
static bool take_moved(struct plan *p, const struct plan_way *w)
{
	struct mouth_lead in;

	if (!is_better(p, w))
		return false;
	if (mouth_moves(p)) {
		if (!mouth_find(p->j, &p->c, w->q[0], &in))
			return false;
		mouth_put(&in, &p->dense);
	}
	take_best(p, w);
	return true;
}

static bool is_same(const struct plan_way *a, const struct plan_way *b)
{
	return a->how && a->n == b->n &&
	       memcmp(a->q, b->q, a->n * sizeof(*a->q)) == 0;
}

/* Widen @w, prove it as @how. Return: is it to be written? */
static bool widen(struct plan *p, const struct job *j, struct free_way *w,
		  const char *how)
{
	static struct plan_way way;

	free_widen(w, w->mouth ? 2 * WIDEN_ROUNDS : WIDEN_ROUNDS);
	p->queries += w->queries;
	from_free(&way, w, j);
	way.how = how;
	if (is_same(&p->best, &way))
		return false;
	plan_prove(j, &way, PROVE_COARSE_MM, &p->queries);
	return take_moved(p, &way);
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
	w.mouth = mouth_moves(p);
	return widen(p, f->j, &w, "free nodes");
}

/* Is there a node of the best way that can be taken away? */
static bool straighten_one(struct plan *p, const struct job *j)
{
	const double keep_mm = p->c.mm + j->chord_mm + STRAIGHT_SPARE_MM;

	for (uint32_t i = 1; i + 1 < p->best.n && !bar_interrupted(); i++) {
		struct free_way w;

		if (free_init(&w, j, &p->c, p->best.q, p->best.n))
			return false;
		w.mouth = mouth_moves(p);
		if (free_straighten(&w, i, keep_mm, STRAIGHTEN_ROUNDS)) {
			if (widen(p, j, &w, "straightened"))
				return true;
		} else {
			p->queries += w.queries;
		}
	}
	return false;
}

static void plan_straighten(struct plan *p, const struct job *j)
{
	while (p->best.n > 2 && straighten_one(p, j))
		;
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

static void take_fewest(struct plan *p, const struct fewest *f,
			const uint32_t *at, uint32_t blocks)
{
	take_way(&p->fewest, "fewest over nodes", f, at, blocks);
	if (is_same(&p->greedy, &p->fewest)) {
		p->fewest = p->greedy;
		return;
	}
	prove_nodes(p, f, at, &p->fewest, f->j->o->on_path ?
		    PROVE_FINE_MM : PROVE_COARSE_MM);
	if (is_better(p, &p->fewest))
		take_best(p, &p->fewest);
}

int plan_over(struct plan *p, const struct job *j,
	      double (*q)[INTERP_NAXES], uint32_t n)
{
	uint32_t at[FEWEST_NODES_MAX], blocks, most = n - 1;
	struct fewest f;

	if (fewest_init(&f, j, q, n))
		return -ENOMEM;
	f.c = &p->c;
	blocks = fewest_greedy(&f, j->clear_mm, at);
	if (blocks && blocks != UINT32_MAX) {
		most = blocks;
		take_way(&p->greedy, "greedy", &f, at, blocks);
		prove_nodes(p, &f, at, &p->greedy, PROVE_COARSE_MM);
		take_best(p, &p->greedy);
	}
	blocks = bar_interrupted() ? 0 :
		 fewest_search(&f, j->clear_mm, most, at);
	if (blocks) {
		fewest_widest(&f, j->clear_mm, blocks, at);
		take_fewest(p, &f, at, blocks);
	}
	if (blocks && !j->o->on_path)
		plan_free(p, &f, at);
	if (p->best.how && !j->o->on_path && !p->trial)
		plan_straighten(p, j);
	p->queries += f.queries;
	fewest_free(&f);
	return p->best.how ? 0 : 1;
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
		plan_describe(p);
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
	prove_best(p);
	/* Elsewhere there may be fewer blocks, but not fewer than one. */
	if (!p->j->o->no_pivot && p->best.n > 2 && !bar_interrupted())
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
	p.seconds = clock_s(CLOCK_MONOTONIC);
	err = load_way(&p);
	if (err == 0)
		err = check_clearance(j, p.dense.node[p.last].q, &p.c);
	if (err == 0)
		err = plan_check_end(&p, p.dense.node[p.last].q);
	/* A way that was found is proved, or is to be widened. */
	if (err == 0 && !j->o->end_given)
		err = check_dense(&p);
	if (err == 0)
		err = plan_nodes(&p);
	p.stopped = bar_interrupted();
	p.planned_s = clock_s(CLOCK_MONOTONIC) - p.seconds;
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
