/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_plan_bounds.c - what motion.h, box.h and apart.h of edm-plan promise:
 * for how long two bodies stay apart.  Each pair is followed through that time
 * and looked at.
 *
 * EDM_SEED repeats a run, EDM_RUNS makes it longer.
 */
#include "apart.h"
#include "plan_scene.h"

/* -- The bounds of a block ------------------------------------------------ */

static double draw_size(double lo, double hi)
{
	return pow(10, draw(log10(lo), log10(hi)));
}

/* How a point moves at time @t, against small differences. */
static void follow_point(const struct block *b, double t, const double v[3],
			 bool corner)
{
	const double h = 1e-4;
	double at[3][3], bend[3], go[3], x[3];
	struct pose_rate rate;

	for (int n = 0; n < 3; n++) {
		struct pose pose;

		block_pose(b, t + (n - 1) * h, &pose, n == 1 ? &rate : NULL);
		rot_apply(&pose.r, v, at[n]);
		v_add(at[n], pose.t, at[n]);
	}
	v_cross(rate.w, at[1], x);
	for (int n = 0; n < 3; n++) {
		bend[n] = (at[2][n] - 2 * at[1][n] + at[0][n]) / h / h;
		go[n] = (at[2][n] - at[0][n]) / 2 / h;
		assert_true(fabs(go[n] - rate.v[n] - x[n]) < 1e-3);
	}
	assert_true(v_length(go) <= (corner ? b->corner_way_mm : b->way_mm) +
				    1e-6);
	assert_true(corner || v_length(bend) <= b->accel_mm + 1e-3);
}

/* Large turns and small ones: in those it is the shifts that bend a way. */
static void no_point_moves_more_than_bounded(void **state)
{
	(void)state;
	for (int i = 0; i < 30 * runs; i++) {
		const double small = i % 2 ? 1 : draw_size(1e-4, 1);
		double from[INTERP_NAXES], to[INTERP_NAXES];
		struct scene s;
		struct block b;

		make_scene(&s, i / 2);
		draw_axes(from, 100);
		draw_axes(to, 100);
		for (int k = INTERP_A; k <= INTERP_C; k++)
			to[k] = from[k] + small * (to[k] - from[k]);
		block_init(&b, &s.motion, from, to);
		for (int k = 0; k < 20; k++)
			follow_point(&b, draw(1e-4, 1 - 1e-4),
				     s.tool.m.vert[k * 5 %
						   (int)s.tool.m.nverts],
				     false);
		for (int k = 0; k < 16; k++) {
			const struct mesh *m = &s.tool.m;
			const double corner[3] = {
				k & 1 ? m->max[0] : m->min[0],
				k & 2 ? m->max[1] : m->min[1],
				k & 4 ? m->max[2] : m->min[2],
			};

			follow_point(&b, draw(1e-4, 1 - 1e-4), corner, true);
		}
		drop_scene(&s);
	}
}

/* A point of the box, often on its faces, edges and corners. */
static void draw_in(const struct box *b, double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = b->centre[k];
	for (int i = 0; i < 3; i++) {
		const double s = (double)b->half[i] * fmin(fmax(draw(-2, 2),
								-1), 1);

		for (int k = 0; k < 3; k++)
			ret[k] += s * (double)b->axis[k][i];
	}
}

/* Far from the origin as well, where single precision has little left. */
static void boxes_stay_apart_as_long_as_they_say(void **state)
{
	int apart = 0, held = 0;

	(void)state;
	for (int i = 0; i < 40 * runs; i++) {
		const double far = i % 2 ? 0 : 4e4;
		double from[INTERP_NAXES], to[INTERP_NAXES];
		struct box_keep keep = { .mm = 0.3f, .enough = 1 };
		struct box_placed now;
		struct box_pose at;
		struct pose_rate rate;
		struct pose pose;
		struct scene s;
		struct block b;
		float x;

		make_scene(&s, i);
		draw_axes(from, 100);
		draw_axes(to, 100);
		from[INTERP_X] += far;
		to[INTERP_X] += far;
		block_init(&b, &s.motion, from, to);
		block_pose(&b, 0, &pose, &rate);
		near_pose(&pose, &rate, &at);
		keep.accel = (float)b.accel_mm;
		for (int k = 0; k < 60; k++) {
			struct box part = s.part.t.node[k];
			const struct box *tool = &s.tool.t.node[k * 7 % 60];
			double d;

			part.centre[0] += far;
			box_move(tool, &at, &now);
			d = (double)box_distance(&part, &now.at);
			x = box_time(&part, &now, &keep);
			apart += d > 0;
			held += x > 0;
			for (int n = 0; n < 30; n++) {
				double p[3], q[3], moved[3];
				struct pose then;

				draw_in(&part, p);
				draw_in(tool, q);
				rot_apply(&pose.r, q, moved);
				v_add(moved, pose.t, moved);
				assert_true(v_distance(p, moved) >= d);
				block_pose(&b, (double)x * draw(0, 1), &then,
					   NULL);
				rot_apply(&then.r, q, moved);
				v_add(moved, then.t, moved);
				assert_true(x <= 0 ||
					    v_distance(p, moved) >= 0.3);
			}
		}
		drop_scene(&s);
	}
	assert_true(apart > 500 && held > 500);
}

/* An axis that is off by less than @off: the pulses of the machine. */
static void pulses_stray_no_farther_than_bounded(void **state)
{
	double nearly = 0;

	(void)state;
	for (int i = 0; i < 40 * runs; i++) {
		double from[INTERP_NAXES], to[INTERP_NAXES];
		double off[INTERP_NAXES] = { 0 };
		struct scene s;
		struct block b;
		double most;

		make_scene(&s, i);
		draw_axes(from, 100);
		draw_axes(to, 100);
		for (int k = 0; k <= INTERP_C; k++)
			off[k] = draw(0, 1) < 0.5 ? 0 : pow(10, draw(-4, -1));
		block_init(&b, &s.motion, from, to);
		most = motion_strays_mm(&b, off);
		for (int k = 0; k < 60; k++) {
			const double *v = s.tool.m.vert[k];
			double q[INTERP_NAXES], at[2][3];
			struct pose pose[2];

			block_at(&b, draw(0, 1), q);
			motion_pose(&s.motion, q, &pose[0]);
			for (int n = 0; n <= INTERP_C; n++)
				q[n] += draw(0, 1) < 0.5 ? off[n] : -off[n];
			motion_pose(&s.motion, q, &pose[1]);
			for (int n = 0; n < 2; n++) {
				rot_apply(&pose[n].r, v, at[n]);
				v_add(at[n], pose[n].t, at[n]);
			}
			assert_true(v_distance(at[0], at[1]) <= most + 1e-12);
			nearly = fmax(nearly, v_distance(at[0], at[1]) / most);
		}
		drop_scene(&s);
	}
	assert_true(nearly > 0.5);
}

/* -- A motion of its own -------------------------------------------------- */

/* A turn at a constant rate about any line, which may pass through what is
 * turned, and a shift. */
struct turn {
	double dir[3], at[3], rate;	/* of the line, radian a unit of time */
	double shift[3];
};

static void draw_unit(double ret[3])
{
	double n;

	do {
		for (int k = 0; k < 3; k++)
			ret[k] = draw(-1, 1);
		n = v_length(ret);
	} while (n > 1 || n < 0.1);
	for (int k = 0; k < 3; k++)
		ret[k] /= n;
}

/* About @p, or not far from there. */
static void draw_turn(const double p[3], struct turn *ret)
{
	double away[3];

	draw_unit(ret->dir);
	draw_unit(away);
	v_madd(p, draw(0, 1) < 0.3 ? 0 : draw_size(0.001, 100), away, ret->at);
	ret->rate = draw_size(1e-4, 2);
	draw_unit(ret->shift);
	for (int k = 0; k < 3; k++)
		ret->shift[k] *= draw(0, 1) < 0.5 ? 0 : draw_size(1e-3, 10);
}

static void turned_to(const struct turn *m, double t, const double p[3],
		      double ret[3])
{
	const struct rot r = rot_about(m->dir, m->rate * t);
	double arm[3];

	v_sub(p, m->at, arm);
	rot_apply(&r, arm, ret);
	v_add(ret, m->at, ret);
	v_madd(ret, t, m->shift, ret);
}

/* At time 0, of points no farther than @r from @p. */
static void rate_of(const struct turn *m, const double p[3], double r,
		    struct pose_rate *ret)
{
	double arm[3], x[3];

	for (int k = 0; k < 3; k++)
		ret->w[k] = m->rate * m->dir[k];
	v_cross(ret->w, m->at, x);
	v_sub(m->shift, x, ret->v);
	v_sub(p, m->at, arm);
	v_cross(m->dir, arm, x);
	ret->accel = m->rate * m->rate * (v_length(x) + r);
}

/* -- Boxes ---------------------------------------------------------------- */

static void draw_box(struct box *b, double far)
{
	double dir[3];
	struct rot r;

	*b = (struct box) { 0 };
	draw_unit(dir);
	r = rot_about(dir, draw(-3, 3));
	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 3; i++)
			b->axis[k][i] = (float)r.m[i][k];
		b->half[k] = (float)draw_size(0.02, 20);
		b->half[3] += b->half[k];
		b->centre[k] = far + draw(-25, 25);
	}
}

/* How far a point is from a box. */
static double from_box(const struct box *b, const double p[3])
{
	double sum = 0, d[3];

	v_sub(p, b->centre, d);
	for (int i = 0; i < 3; i++) {
		const double out = fmax(fabs(along(b, i, d)) -
					(double)b->half[i], 0);

		sum += out * out;
	}
	return sqrt(sum);
}

/* Corner @i, or from 8 on any point. */
static void point_of(const struct box *b, int i, double ret[3])
{
	if (i >= 8) {
		draw_in(b, ret);
		return;
	}
	for (int k = 0; k < 3; k++)
		ret[k] = b->centre[k];
	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			ret[x] += (double)b->axis[x][k] * (double)b->half[k] *
				  (i >> k & 1 ? 1 : -1);
}

static void follow_box(const struct box *part, const struct box *tool,
		       const struct turn *m, const struct box_keep *keep,
		       double time)
{
	for (int i = 0; i < 24; i++) {
		double p[3], at[3];

		point_of(tool, i, p);
		for (int k = 1; k <= 4; k++) {
			const double t = k < 4 ? draw(0, time) : time;
			const double wanted = (double)keep->mm +
					      (double)keep->rises * t;

			turned_to(m, t, p, at);
			assert_true(from_box(part, at) >= wanted);
		}
	}
}

/* What is to be kept is mostly just less than what there is, so that the speed
 * counts rather than how it changes. */
static void a_box_that_turns_comes_no_nearer_than_it_says(void **state)
{
	static const struct rot still = { { { 1, 0, 0 }, { 0, 1, 0 },
					    { 0, 0, 1 } } };
	static const double zero[3];
	const struct pose pose = { .r = still };
	int held = 0, about_itself = 0;

	(void)state;
	for (int i = 0; i < 3000 * runs; i++) {
		const double far = i % 4 ? 0 : 3e4;
		struct box_keep keep = { .enough = 1 };
		struct box part, tool;
		struct box_placed now;
		struct pose_rate rate;
		struct box_pose at;
		struct turn m;
		double gap, x;

		draw_box(&part, far);
		draw_box(&tool, far);
		gap = (double)box_distance(&part, &tool);
		if (gap < 0.05)
			continue;
		draw_turn(tool.centre, &m);
		rate_of(&m, tool.centre, (double)tool.half[3], &rate);
		near_pose(&pose, &rate, &at);
		keep.mm = (float)(gap * (1 - draw_size(1e-3, 1)));
		keep.rises = draw(0, 1) < 0.5 ? 0 : (float)draw_size(0.001, 1);
		keep.accel = (float)(rate.accel * (1 + 1e-6));
		box_move(&tool, &at, &now);
		x = (double)box_time(&part, &now, &keep);
		assert_true(x <= 1);
		held += x > 0 && x < 1;
		about_itself += x > 0 && x < 1 &&
				v_distance(m.at, tool.centre) < 0.01 &&
				v_distance(m.shift, zero) < 0.01;
		follow_box(&part, &tool, &m, &keep, x);
	}
	assert_true(held > 300 * runs && about_itself > 30 * runs);
}

/* The end of an arm goes along a plate that stands on the arm's side: it has no
 * speed toward it, and comes nearer by its bend alone. */
static void a_box_that_only_bends_comes_no_nearer_than_it_says(void **state)
{
	static const struct rot still = { { { 1, 0, 0 }, { 0, 1, 0 },
					    { 0, 0, 1 } } };
	const struct turn m = { .dir = { 0, 0, 1 }, .rate = 1 };
	const struct pose pose = { .r = still };
	struct box plate = { .half = { 1, 60, 60, 121 } };
	struct box end = { .half = { 1e-3f, 1e-3f, 1e-3f, 3e-3f } };

	(void)state;
	for (int k = 0; k < 3; k++)
		plate.axis[k][k] = end.axis[k][k] = 1;
	for (int i = 0; i < 200; i++) {
		const double r = draw_size(2, 50);
		const double less = draw_size(0.01, 0.1) * (r - 1);
		struct box_keep keep = { .mm = (float)(r - 1 - less),
					 .enough = 1 };
		struct box_placed now;
		struct pose_rate rate;
		struct box_pose at;
		double x;

		end.centre[0] = r;
		rate_of(&m, end.centre, 3e-3, &rate);
		near_pose(&pose, &rate, &at);
		keep.accel = (float)(rate.accel * (1 + 1e-6));
		box_move(&end, &at, &now);
		x = (double)box_time(&plate, &now, &keep);
		assert_true(x > 0.9 * sqrt(2 * less / r));
		follow_box(&plate, &end, &m, &keep, x);
	}
}

/* -- Triangles ------------------------------------------------------------ */

static void draw_corners(struct triangle *t, double far)
{
	double at[3];

	for (int k = 0; k < 3; k++)
		at[k] = far + draw(-6, 6);
	for (int i = 0; i < 3; i++) {
		double d[3];

		draw_unit(d);
		v_madd(at, draw_size(0.02, 8), d, t->at[i]);
	}
	if (draw(0, 1) < 0.1)
		memcpy(t->at[1], t->at[0], sizeof(t->at[1]));
}

static void plane_of(const struct triangle *t, double ret[4])
{
	double u[3], v[3], n[3];

	v_sub(t->at[1], t->at[0], u);
	v_sub(t->at[2], t->at[0], v);
	v_cross(u, v, n);
	memset(ret, 0, 4 * sizeof(*ret));
	if (!(v_length(n) > 1e-9 * v_length(u) * v_length(v)))
		return;
	for (int k = 0; k < 3; k++)
		ret[k] = n[k] / v_length(n);
	ret[3] = v_dot(ret, t->at[0]);
}

static void follow_triangle(const struct triangle *part,
			    const struct triangle *tool, const struct turn *m,
			    const struct apart *a, double time)
{
	for (int k = 1; k <= 8; k++) {
		const double t = time * k / 8;
		struct triangle at;
		double p[3], q[3];

		for (int i = 0; i < 3; i++)
			turned_to(m, t, tool->at[i], at.at[i]);
		assert_true(tri_distance(part, &at, p, q) >=
			    a->keep_mm + a->rises * t - 1e-9);
	}
}

static void a_triangle_that_turns_comes_no_nearer_than_it_says(void **state)
{
	int seen = 0, held = 0, far_seen = 0;

	(void)state;
	for (int i = 0; i < 6000 * runs; i++) {
		const double far = i % 4 ? 0 : 3e3;
		struct triangle part, tool;
		double plane[4], p[3], q[3], d, x, r = 0;
		struct pose_rate rate;
		struct apart a = { 0 };
		struct turn m;

		draw_corners(&part, far);
		draw_corners(&tool, far);
		plane_of(&part, plane);
		d = tri_distance(&part, &tool, p, q);
		a.least_mm = d * (1 + draw(-0.3, 0.3));
		if (apart_seen(&a, &part, plane, &tool)) {
			assert_true(d >= a.least_mm - 1e-9);
			far_seen++;
		}
		if (d < 0.05)
			continue;
		draw_turn(tool.at[0], &m);
		for (int k = 0; k < 3; k++)
			r = fmax(r, v_distance(tool.at[0], tool.at[k]));
		rate_of(&m, tool.at[0], r, &rate);
		a.rate = &rate;
		a.keep_mm = d * (1 - draw_size(1e-3, 1));
		a.least_mm = a.keep_mm * (1 + 1e-6);
		a.rises = draw(0, 1) < 0.5 ? 0 : draw_size(0.001, 1);
		x = apart_time(&a, &tool, d, p, q);
		held += x < 1;
		follow_triangle(&part, &tool, &m, &a, fmin(x, 1));
		a.time = fmin(x, 1) * draw(0.3, 1.5);
		if (!apart_seen(&a, &part, plane, &tool))
			continue;
		seen++;
		follow_triangle(&part, &tool, &m, &a, a.time);
	}
	assert_true(held > 300 * runs && seen > 100 * runs &&
		    far_seen > 300 * runs);
}

/* -- Blocks --------------------------------------------------------------- */

static void stretch(struct body *b, double x, double y, double z)
{
	for (uint32_t i = 0; i < b->m.nverts; i++) {
		b->m.vert[i][0] *= x;
		b->m.vert[i][1] *= y;
		b->m.vert[i][2] *= z;
	}
	mesh_bounds(&b->m);
	tree_free(&b->t);
	assert_int_equal(tree_build(&b->t, &b->m), 0);
}

/* Turns and shifts of all sizes, and turns alone. */
static void draw_block(double from[INTERP_NAXES], double to[INTERP_NAXES])
{
	const double size = draw_size(0.05, 50);
	const bool turn_only = draw(0, 1) < 0.5;

	draw_axes(from, 60);
	memcpy(to, from, INTERP_NAXES * sizeof(*to));
	for (int k = INTERP_A; k <= INTERP_C; k++)
		to[k] += draw(0, 1) < 0.4 ? 0 : draw(-size, size);
	for (int k = 0; k < 3 && !turn_only; k++)
		to[k] += draw(-0.3, 0.3) * size;
}

/* What is asked is a little more than a pose has: no proof of it is right. */
static void no_block_is_proved_to_keep_more_than_a_pose_has(void **state)
{
	int tried = 0;

	(void)state;
	for (int i = 0; i < 60 * runs; i++) {
		double from[INTERP_NAXES], to[INTERP_NAXES], least;
		struct proof p = { 0 };
		struct clearance c;
		struct scene s;
		struct block b;

		make_scene(&s, i);
		stretch(&s.tool, draw(0.2, 1), draw(0.2, 1), draw(1, 4));
		motion_init(&s.motion, &s.kin, &s.tool.m);
		draw_block(from, to);
		block_init(&b, &s.motion, from, to);
		least = least_sampled(&s, &b, 60);
		clearance_init(&c, least + 1e-4);
		if (least > 0) {
			assert_false(prove_block(&s.bodies, &b, &c, &p));
			tried++;
		}
		drop_scene(&s);
	}
	assert_true(tried > 20 * runs);
}

#define POSES	80

/* Over all poses of the block, how much more is left than is to be kept. */
static double least_over(const struct block *b, const struct clearance *c,
			 const double mm[POSES + 1])
{
	double least = DBL_MAX;

	for (int k = 0; k <= POSES; k++) {
		struct pose pose;

		block_pose(b, (double)k / POSES, &pose, NULL);
		least = fmin(least, mm[k] - clearance_at(c, &pose));
	}
	return least;
}

/* On a way out of the end pose, what is to be kept rises.  So much is asked
 * outside of the end zone that one pose just does not have what it is to. */
static void no_block_out_of_an_end_zone_keeps_more_than_a_pose_has(void **state)
{
	int tried = 0;

	(void)state;
	for (int i = 0; i < 60 * runs; i++) {
		double from[INTERP_NAXES], to[INTERP_NAXES], mm[POSES + 1];
		double low = 0, high = 50;
		struct near_pair pair = { 0 };
		struct proof p = { 0 };
		struct clearance c;
		struct scene s;
		struct pose pose;
		struct block b;

		make_scene(&s, i);
		draw_block(from, to);
		block_init(&b, &s.motion, from, to);
		for (int k = 0; k <= POSES; k++) {
			block_pose(&b, (double)k / POSES, &pose, NULL);
			mm[k] = near_distance(&s.bodies, &pose, &pair);
		}
		block_pose(&b, 0, &pose, NULL);
		clearance_init(&c, 0);
		clearance_end(&c, &s.tool.m, &pose, draw_size(0.5, 30),
			      mm[0] * draw(0, 0.95));
		while (high - low > 1e-6) {
			c.mm = (low + high) / 2;
			*(least_over(&b, &c, mm) > -1e-4 ? &low : &high) = c.mm;
		}
		c.mm = high;
		if (mm[0] > 0.01 && high < 49 && high > c.end_mm) {
			assert_false(prove_block(&s.bodies, &b, &c, &p));
			tried++;
		}
		drop_scene(&s);
	}
	assert_true(tried > 4 * runs);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_point_moves_more_than_bounded),
		cmocka_unit_test(pulses_stray_no_farther_than_bounded),
		cmocka_unit_test(boxes_stay_apart_as_long_as_they_say),
		cmocka_unit_test(a_box_that_turns_comes_no_nearer_than_it_says),
		cmocka_unit_test(a_box_that_only_bends_comes_no_nearer_than_it_says),
		cmocka_unit_test(a_triangle_that_turns_comes_no_nearer_than_it_says),
		cmocka_unit_test(no_block_is_proved_to_keep_more_than_a_pose_has),
		cmocka_unit_test(no_block_out_of_an_end_zone_keeps_more_than_a_pose_has),
	};

	scene_seed();
	return cmocka_run_group_tests_name("plan/bounds", tests, NULL, NULL);
}
