/* SPDX-License-Identifier: Apache-2.0 */
/*
 * free.c - inner nodes off the path, by sequential linear programs
 *
 * If node k is moved by d_k, the axes at time t of block k move by d = (1 - t)
 * d_k + t d_(k+1).  Two triangles at the distance g, with n from the part to
 * the electrode, are then at g + n .  J d, to the first order.  A linear
 * program makes the least of all these distances as large as possible.
 */
#include "free.h"

#include "lp.h"
#include "near_set.h"
#include "outward.h"

#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

#define POSES		10		/* of a block */
#define PAIRS		14		/* of triangles at each */
#define BAND_MM		0.2		/* over the least distance */
#define NEAR_MM		2.0		/* farther pairs do not matter */
#define FAR_MM		100.0		/* a clearance that no way has */
#define ROOM_FIRST_MM	1.5		/* of a step, at first */
#define ROOM_LEAST_MM	0.01
/* A bend is taken away where the way without it is nearly wide enough: then it
 * is widened, and proved. */
#define STRAIGHT_ROOM_MM	2.0
#define STRAIGHT_LEAST_MM	0.05
#define WORTH_BEND_MM	0.002
#define SLACK_MM	0.01
#define DROP_MM		0.04
#define WORTH_MM	0.0005		/* a step that gains less is none */

/* Columns: how far each axis of each node moves that may, mm. */
struct lp {
	glp_prob *p;
	const struct free_way *w;	/* lent */
	struct job_axes axes;
	int least;			/* column of the least distance */
};

/* The first node that moves. */
static uint32_t first(const struct free_way *w)
{
	return w->mouth ? 0 : 1;
}

static int col(const struct lp *l, uint32_t node, uint32_t a)
{
	return 1 + (int)((node - first(l->w)) * l->axes.n + a);
}

static bool moves(const struct free_way *w, uint32_t node)
{
	return node >= first(w) && node + 1 < w->n;
}

int free_init(struct free_way *w, const struct job *j,
	      const struct clearance *c, double (*q)[INTERP_NAXES], uint32_t n)
{
	*w = (struct free_way) { .j = j, .c = c, .n = n, .enough_mm = DBL_MAX };
	if (n > FREE_NODES_MAX)
		return -E2BIG;
	memcpy(w->q, q, n * sizeof(*w->q));
	for (int k = 0; k < 2; k++) {
		struct near_pair pair = { 0 };
		struct pose pose;

		motion_pose(&j->motion, q[k ? n - 1 : 0], &pose);
		w->end_mm[k] = near_distance(&j->bodies, &pose, &pair);
	}
	return 0;
}

void free_round(const struct machine_config *c, double q[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double pulse = c->axes.axis[i].pulse_mm;

		q[i] = round(q[i] / pulse) * pulse;
	}
}

/* -- Trying --------------------------------------------------------------- */

/* How much less than outside of the end zone is wanted at @pose. */
static double falls_mm(const struct free_way *w, const struct pose *pose)
{
	return w->c->mm - clearance_at(w->c, pose);
}

/* The end pose counts only where the clearance does not fall toward it: no node
 * can make it better. */
static double ends_mm(const struct free_way *w)
{
	const double begin = w->mouth ? FAR_MM : w->end_mm[0];

	return w->c->zone_mm > 0 ? begin : fmin(begin, w->end_mm[1]);
}

/* The poses of block @i that are looked at: not those of nodes that stay. */
static int first_pose(const struct free_way *w, uint32_t i)
{
	return w->mouth && i == 0 ? 0 : 1;
}

static int last_pose(const struct free_way *w, uint32_t i)
{
	return i + 2 == w->n ? POSES - 1 : POSES;
}

/* The least distance over poses of all blocks; gives up below @stop. */
static double try_way(struct free_way *w, double stop)
{
	double least = ends_mm(w);

	if (w->mouth && !outward_is_out(w->j, w->q[0]))
		return 0;
	for (uint32_t i = 0; i + 1 < w->n; i++) {
		struct near_pair pair = { 0 };
		struct block b;

		block_init(&b, &w->j->motion, w->q[i], w->q[i + 1]);
		for (int k = first_pose(w, i);
		     k <= last_pose(w, i) && least >= stop; k++) {
			struct pose pose;
			double falls;

			block_pose(&b, (double)k / POSES, &pose, NULL);
			falls = falls_mm(w, &pose);
			w->queries++;
			if (near_less(&w->j->bodies, &pose, least - falls,
				      &pair))
				least = pair.mm + falls;
		}
	}
	return least;
}

/* -- The linear program --------------------------------------------------- */

static void add_columns(struct lp *l)
{
	l->least = col(l, l->w->n - 1, 0);
	glp_add_cols(l->p, l->least);
	glp_set_col_bnds(l->p, l->least, GLP_UP, 0, ends_mm(l->w));
	glp_set_obj_coef(l->p, l->least, 1);
}

/* How far the nodes may go. */
static void set_room(struct lp *l, double room_mm)
{
	const struct machine_config *c = &l->w->j->config;

	for (uint32_t node = first(l->w); node + 1 < l->w->n; node++) {
		for (uint32_t a = 0; a < l->axes.n; a++) {
			const uint32_t k = l->axes.axis[a];
			const struct interp_axis_limits *x = &c->axes.axis[k];
			const double mm = l->axes.reach_mm[k];
			const double at = l->w->q[node][k];

			lp_bound(l->p, col(l, node, a),
				 fmax(-room_mm, (x->travel_min_mm - at) * mm),
				 fmin(room_mm, (x->travel_max_mm - at) * mm));
		}
	}
}

struct moment {
	uint32_t block;
	double t;			/* 0..1 on it */
	double q[INTERP_NAXES];
	double falls_mm;
};

/* One pair at a moment: g + n . J d + what the clearance falls - least >= 0. */
static void add_pair(struct lp *l, const struct moment *m,
		     const struct near_pair *x)
{
	const uint32_t i = m->block;
	const double t = m->t;
	double jac[INTERP_NAXES][3], n[3];
	struct lp_row r = { 0 };

	if (!(x->mm > 1e-9))
		return;
	v_sub(x->q, x->p, n);
	motion_jacobian(&l->w->j->motion, m->q, x->q, jac);
	for (uint32_t a = 0; a < l->axes.n; a++) {
		const uint32_t k = l->axes.axis[a];
		const double g = v_dot(n, jac[k]) / x->mm / l->axes.reach_mm[k];

		if (moves(l->w, i) && t < 1)
			lp_put(&r, col(l, i, a), (1 - t) * g);
		if (moves(l->w, i + 1) && t > 0)
			lp_put(&r, col(l, i + 1, a), t * g);
	}
	lp_put(&r, l->least, -1);
	lp_at_least(l->p, &r, -x->mm - m->falls_mm);
}

static void add_moment(struct lp *l, struct free_way *w, struct moment *m,
		       const struct pose *pose)
{
	static struct near_set set = { .max = PAIRS };
	const struct near_asked near = { NEAR_MM, NEAR_SET_SLACK_MM };
	const struct near_patch all = { 0 };
	struct near_pair pair = { .mm = NEAR_MM };

	m->falls_mm = falls_mm(w, pose);
	near_between(&w->j->bodies, pose, &all, &near, &pair);
	near_set_collect(&w->j->bodies, pose, pair.mm + BAND_MM, &set);
	w->queries += 2;
	for (uint32_t x = 0; x < set.n; x++)
		add_pair(l, m, &set.pair[x]);
}

static void add_pairs(struct lp *l, struct free_way *w)
{
	for (uint32_t i = 0; i + 1 < w->n; i++) {
		struct block b;

		block_init(&b, &w->j->motion, w->q[i], w->q[i + 1]);
		for (int k = first_pose(w, i); k <= last_pose(w, i); k++) {
			struct moment m = { .block = i,
					    .t = (double)k / POSES };
			struct pose pose;

			block_at(&b, m.t, m.q);
			block_pose(&b, m.t, &pose, NULL);
			add_moment(l, w, &m, &pose);
		}
	}
}

/* The mouth goes aside or outward: inside the way has to be eroded. */
static void hold_mouth(struct lp *l)
{
	const double (*q)[INTERP_NAXES] = l->w->q;
	struct lp_row r = { 0 };

	for (uint32_t a = 0; a < l->axes.n; a++) {
		const uint32_t k = l->axes.axis[a];

		lp_put(&r, col(l, 0, a), (q[0][k] - q[1][k]) *
					 l->axes.reach_mm[k]);
	}
	lp_at_least(l->p, &r, 0);
}

static void begin(struct lp *l, struct free_way *w)
{
	*l = (struct lp) { .p = lp_new(), .w = w };
	job_axes_find(w->j, w->q[0], w->q[w->n - 1], &l->axes);
	add_columns(l);
	add_pairs(l, w);
	if (w->mouth)
		hold_mouth(l);
}

/* -- More clearance ------------------------------------------------------- */

static void move_nodes(const struct lp *l, struct free_way *w)
{
	for (uint32_t node = first(w); node + 1 < w->n; node++)
		for (uint32_t a = 0; a < l->axes.n; a++)
			w->q[node][l->axes.axis[a]] +=
				glp_get_col_prim(l->p, col(l, node, a)) /
				l->axes.reach_mm[l->axes.axis[a]];
}

/* A step of at most @room_mm. Return: by how much it made the way wider; if by
 * too little, the way stays as it was. */
static double step(struct lp *l, struct free_way *w, double room_mm)
{
	const struct free_way was = *w;
	double wider;

	set_room(l, room_mm);
	w->programs++;
	if (!lp_solve(l->p, bar_interrupted))
		return 0;
	move_nodes(l, w);
	w->least_mm = try_way(w, was.least_mm);
	wider = w->least_mm - was.least_mm;
	if (wider > WORTH_MM)
		return wider;
	memcpy(w->q, was.q, sizeof(w->q));
	w->least_mm = was.least_mm;
	return 0;
}

static void show(const struct free_way *w, double share)
{
	char text[100];

	snprintf(text, sizeof(text), "free nodes: %u blocks, %.3f mm",
		 w->n - 1, w->least_mm);
	bar_show(w->j, share, text);
}

void free_widen(struct free_way *w, int rounds)
{
	double room = ROOM_FIRST_MM;
	struct lp l = { 0 };

	w->least_mm = try_way(w, 0);
	for (int i = 0; i < rounds && room > ROOM_LEAST_MM &&
	     moves(w, w->n - 2) &&
	     w->least_mm < w->enough_mm && !bar_interrupted(); i++) {
		double wider;

		show(w, (double)i / rounds);
		if (!l.p)
			begin(&l, w);
		wider = step(&l, w, room);
		if (wider < 0.01)
			room /= wider > 0 ? 2 : 3;
		if (!(wider > 0))
			continue;	/* the program is as it was */
		glp_delete_prob(l.p);
		l.p = NULL;
	}
	if (l.p)
		glp_delete_prob(l.p);
}

/* -- Fewer blocks --------------------------------------------------------- */

/* The bend at an inner node: how far each axis is off the straight line from
 * the node before it to the one behind it. */
struct bend {
	uint32_t node;
	double tau;			/* where on that line, 0..1 */
	double mm;			/* sum over the axes */
};

static double off_line_mm(const struct lp *l, const struct bend *b, uint32_t a)
{
	const uint32_t k = l->axes.axis[a];
	const double (*q)[INTERP_NAXES] = l->w->q + b->node;

	return (q[0][k] - (1 - b->tau) * q[-1][k] - b->tau * q[1][k]) *
	       l->axes.reach_mm[k];
}

static void measure_bend(const struct lp *l, struct bend *b)
{
	const double (*q)[INTERP_NAXES] = l->w->q + b->node;
	double along = 0, all = 0;

	for (uint32_t a = 0; a < l->axes.n; a++) {
		const uint32_t k = l->axes.axis[a];
		const double mm = l->axes.reach_mm[k];
		const double d = (q[1][k] - q[-1][k]) * mm;

		along += d * (q[0][k] - q[-1][k]) * mm;
		all += d * d;
	}
	b->tau = all > 0 ? fmin(fmax(along / all, 0.05), 0.95) : 0.5;
	b->mm = 0;
	for (uint32_t a = 0; a < l->axes.n; a++)
		b->mm += fabs(off_line_mm(l, b, a));
}

/* One column for each axis is at least as large as the bend on both sides; as
 * little of it as possible, and the clearance @keep_mm. */
static void ask_straight(struct lp *l, const struct bend *b, double keep_mm)
{
	const int base = glp_add_cols(l->p, (int)l->axes.n);

	glp_set_obj_coef(l->p, l->least, 0.02);
	glp_set_col_bnds(l->p, l->least, GLP_DB, keep_mm,
			 fmax(keep_mm + 1e-6, ends_mm(l->w)));
	for (uint32_t a = 0; a < l->axes.n; a++) {
		const double off = off_line_mm(l, b, a);

		glp_set_col_bnds(l->p, base + (int)a, GLP_LO, 0, 0);
		glp_set_obj_coef(l->p, base + (int)a, -1);
		for (int sign = -1; sign <= 1; sign += 2) {
			struct lp_row r = { 0 };

			lp_put(&r, base + (int)a, 1);
			lp_put(&r, col(l, b->node, a), -sign);
			if (moves(l->w, b->node - 1))
				lp_put(&r, col(l, b->node - 1, a),
				       sign * (1 - b->tau));
			if (moves(l->w, b->node + 1))
				lp_put(&r, col(l, b->node + 1, a),
				       sign * b->tau);
			lp_at_least(l->p, &r, sign * off);
		}
	}
}

static bool try_without(struct free_way *w, uint32_t node, double keep_mm)
{
	struct free_way without = *w;

	without.n--;
	memmove(without.q[node], without.q[node + 1],
		(without.n - node) * sizeof(*without.q));
	without.least_mm = try_way(&without, keep_mm);
	w->queries = without.queries;
	if (without.least_mm < keep_mm)
		return false;
	*w = without;
	return true;
}

/* One step toward a straight way. Return: is it one? */
static bool straighten_step(struct free_way *w, uint32_t node, double room_mm,
			    double keep_mm)
{
	const struct free_way was = *w;
	struct bend before = { .node = node }, after = before;
	struct lp l;
	bool ok;

	begin(&l, w);
	measure_bend(&l, &before);
	ask_straight(&l, &before, keep_mm);
	set_room(&l, room_mm);
	w->programs++;
	ok = lp_solve(l.p, bar_interrupted);
	if (ok) {
		move_nodes(&l, w);
		after = before;
		measure_bend(&l, &after);
		w->least_mm = after.mm < before.mm - WORTH_BEND_MM ?
			      try_way(w, keep_mm - SLACK_MM) : 0;
		ok = w->least_mm >= keep_mm - SLACK_MM;
	}
	glp_delete_prob(l.p);
	if (!ok) {
		const uint64_t queries = w->queries;

		*w = was;
		w->queries = queries;
	}
	return ok;
}

bool free_straighten(struct free_way *w, uint32_t node, double keep_mm,
		     int rounds)
{
	const struct free_way was = *w;
	double room = STRAIGHT_ROOM_MM;

	w->least_mm = try_way(w, 0);
	keep_mm = fmin(keep_mm, w->least_mm);
	for (int i = 0; i < rounds && room > STRAIGHT_LEAST_MM &&
	     !bar_interrupted(); i++) {
		if (try_without(w, node, keep_mm - fmin(DROP_MM, keep_mm / 3)))
			return true;
		show(w, (double)i / rounds);
		room *= straighten_step(w, node, room, keep_mm) ? 1.3 : 0.4;
		room = fmin(room, 2 * STRAIGHT_ROOM_MM);
	}
	*w = was;
	return false;
}
