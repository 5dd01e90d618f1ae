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

#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

#define POSES		10		/* of a block */
#define PAIRS		14		/* of triangles at each */
#define BAND_MM		0.2		/* over the least distance */
#define NEAR_MM		2.0		/* farther pairs do not matter */
#define ROOM_FIRST_MM	1.5		/* of a step, at first */
#define ROOM_LEAST_MM	0.01
#define WORTH_MM	0.0005		/* a step that gains less is none */

struct lp {
	glp_prob *p;
	const struct free_way *w;
	struct job_axes axes;
	int least;			/* column of the least distance */
};

static int col(const struct lp *l, uint32_t node, uint32_t a)
{
	return 1 + (int)((node - 1) * l->axes.n + a);
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
	return w->c->zone_mm > 0 ? w->end_mm[0] :
				   fmin(w->end_mm[0], w->end_mm[1]);
}

/* How many poses of block @i are looked at, beside its first. */
static int poses(const struct free_way *w, uint32_t i)
{
	return i + 2 == w->n ? POSES - 1 : POSES;
}

/* The least distance over poses of all blocks; gives up below @stop. */
static double try_way(struct free_way *w, double stop)
{
	double least = ends_mm(w);

	for (uint32_t i = 0; i + 1 < w->n; i++) {
		struct near_pair pair = { 0 };
		struct block b;

		block_init(&b, &w->j->motion, w->q[i], w->q[i + 1]);
		for (int k = 1; k <= poses(w, i) && least >= stop; k++) {
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
	const uint32_t inner = l->w->n - 2;

	glp_add_cols(l->p, (int)(inner * l->axes.n) + 1);
	l->least = (int)(inner * l->axes.n) + 1;
	glp_set_col_bnds(l->p, l->least, GLP_UP, 0, ends_mm(l->w));
	glp_set_obj_dir(l->p, GLP_MAX);
	glp_set_obj_coef(l->p, l->least, 1);
}

/* How far the nodes may go. */
static void set_room(struct lp *l, double room_mm)
{
	const struct machine_config *c = &l->w->j->config;

	for (uint32_t node = 1; node + 1 < l->w->n; node++) {
		for (uint32_t a = 0; a < l->axes.n; a++) {
			const uint32_t axis = l->axes.axis[a];
			const double room = room_mm / l->axes.reach_mm[axis];
			const double at = l->w->q[node][axis];
			const double low = fmax(-room,
				c->axes.axis[axis].travel_min_mm - at);
			const double high = fmin(room,
				c->axes.axis[axis].travel_max_mm - at);

			glp_set_col_bnds(l->p, col(l, node, a),
					 low < high ? GLP_DB : GLP_FX,
					 low < high ? low : 0, high);
		}
	}
}

struct row {
	int n, index[2 * INTERP_NAXES + 2];
	double value[2 * INTERP_NAXES + 2];
};

static void row_add(struct row *r, int index, double value)
{
	r->n++;
	r->index[r->n] = index;
	r->value[r->n] = value;
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
	struct row r = { 0 };
	int at;

	if (!(x->mm > 1e-9))
		return;
	v_sub(x->q, x->p, n);
	motion_jacobian(&l->w->j->motion, m->q, x->q, jac);
	for (uint32_t a = 0; a < l->axes.n; a++) {
		const double g = v_dot(n, jac[l->axes.axis[a]]) / x->mm;

		if (i > 0 && t < 1)
			row_add(&r, col(l, i, a), (1 - t) * g);
		if (i + 2 < l->w->n && t > 0)
			row_add(&r, col(l, i + 1, a), t * g);
	}
	row_add(&r, l->least, -1);
	at = glp_add_rows(l->p, 1);
	glp_set_row_bnds(l->p, at, GLP_LO, -x->mm - m->falls_mm, 0);
	glp_set_mat_row(l->p, at, r.n, r.index, r.value);
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
		for (int k = 1; k <= poses(w, i); k++) {
			struct moment m = { .block = i,
					    .t = (double)k / POSES };
			struct pose pose;

			block_at(&b, m.t, m.q);
			block_pose(&b, m.t, &pose, NULL);
			add_moment(l, w, &m, &pose);
		}
	}
}

static void begin(struct lp *l, struct free_way *w)
{
	*l = (struct lp) { .p = glp_create_prob(), .w = w };
	job_axes_find(w->j, w->q[0], w->q[w->n - 1], &l->axes);
	add_columns(l);
	add_pairs(l, w);
}

/* -- More clearance ------------------------------------------------------- */

static void move_nodes(const struct lp *l, struct free_way *w)
{
	for (uint32_t node = 1; node + 1 < w->n; node++)
		for (uint32_t a = 0; a < l->axes.n; a++)
			w->q[node][l->axes.axis[a]] +=
				glp_get_col_prim(l->p, col(l, node, a));
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
	for (int i = 0; i < rounds && room > ROOM_LEAST_MM && w->n > 2 &&
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
