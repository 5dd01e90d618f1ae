/* SPDX-License-Identifier: Apache-2.0 */
/*
 * walk_help.h - build small programs and collect the points of a walk
 */
#ifndef WALK_HELP_H
#define WALK_HELP_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "arc_turn.h"
#include "interp/build.h"
#include "interp/cursor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct made {
	void *block;
	size_t bytes;
	struct interp_program p;
};

struct point {
	int32_t pos[INTERP_NAXES];
	uint8_t kind;
};

struct points {
	struct point *at;
	size_t n, room;
};

static struct interp_machine help_machine;

/* What the lines and arcs below carry. */
#define HELP_WORD ((struct interp_build_word) { .line = 1, .feed_mm_s = 1 })
static struct interp_build_word help_word = { .line = 1, .feed_mm_s = 1 };

static inline struct interp_build *begin(enum interp_strategy s)
{
	struct interp_build_options o = {
		.machine = &help_machine, .strategy = s,
	};

	for (int i = 0; i < INTERP_NAXES; i++)
		help_machine.axis[i] = (struct interp_axis_limits) {
			0.001, -200, 200, 80, 1000, 20000
		};
	help_machine.present = 0xff;
	return interp_build_create(&o);
}

static inline void line(struct interp_build *b, const double *end)
{
	struct interp_diag d = { 0 };

	if (interp_build_line(b, end, &help_word, &d) != 0)
		fail_msg("%s; %s", d.found, d.wanted);
}

/* Of a few pulses, a rounding may make it a spiral, which is refused: then
 * there is none. */
static inline void arc(struct interp_build *b, const double *end, double ca,
		       double cb, bool clockwise)
{
	struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = ca, .centre_b_mm = cb,
	};
	struct interp_diag d = { 0 };

	arc_turn(&a, b, end, clockwise);
	if (interp_build_arc(b, end, &a, &help_word, &d) != 0 &&
	    !strstr(d.found, "spiral"))
		fail_msg("%s; %s", d.found, d.wanted);
}

static inline struct made finish(struct interp_build *b)
{
	const struct interp_build_about about = { .lines = 1 };
	struct made m;

	m.block = interp_build_take(b, &about, &m.bytes);
	interp_build_destroy(b);
	assert_int_equal(interp_program_map(&m.p, m.block, m.bytes), 0);
	return m;
}

static inline void unmake(struct made *m)
{
	free(m->block);
}

static inline void points_add(struct points *p, const struct interp_cursor *c)
{
	if (!p)
		return;
	if (p->n == p->room) {
		p->room = p->room ? 2 * p->room : 256;
		p->at = realloc(p->at, p->room * sizeof(*p->at));
	}
	memcpy(p->at[p->n].pos, c->pos, sizeof(c->pos));
	p->at[p->n++].kind = c->seg.kind;
}

static inline void points_free(struct points *p)
{
	free(p->at);
}

/* Walk on by @ds_mm at a time until the end. */
static inline void run(struct interp_cursor *c, double ds_mm, struct points *p)
{
	enum interp_step s;

	do {
		interp_cursor_aim(c, ds_mm);
		while ((s = interp_cursor_step(c)) == INTERP_MOVED)
			points_add(p, c);
	} while (s == INTERP_ARRIVED);
	assert_int_equal(s, INTERP_AT_END);
}

static inline struct points walk_all(const struct made *m, double ds_mm)
{
	struct points p = { 0 };
	struct interp_cursor c;

	assert_int_equal(interp_cursor_init(&c, &m->p), 0);
	points_add(&p, &c);
	run(&c, ds_mm, &p);
	return p;
}

static inline bool points_equal(const struct points *a, const struct points *b)
{
	if (a->n != b->n)
		return false;
	for (size_t i = 0; i < a->n; i++) {
		if (memcmp(a->at[i].pos, b->at[i].pos, sizeof(a->at[i].pos)))
			return false;
	}
	return true;
}

static inline uint64_t rnd(uint64_t *s)
{
	*s += 0x9e3779b97f4a7c15u;
	uint64_t z = *s;

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

static inline double uniform(uint64_t *s, double lo, double hi)
{
	return lo + (hi - lo) * (double)(rnd(s) >> 11) * 0x1p-53;
}

/* A line in 1 to 8 axes, or an arc, or a helix; ends off the lattice too. */
static inline void random_segment(struct interp_build *b, uint64_t *s,
				  enum interp_strategy strategy)
{
	const double *here = interp_build_here(b);
	double end[INTERP_NAXES];
	const uint64_t pick = rnd(s) % 4;

	memcpy(end, here, sizeof(end));
	if (pick < 2) {
		const uint64_t axes = rnd(s);
		const bool fine = rnd(s) % 2;

		for (int a = 0; a < INTERP_NAXES; a++) {
			if (!(axes & 1u << a))
				continue;
			end[a] += uniform(s, -0.2, 0.2);
			if (!fine)
				end[a] = round(end[a] * 1000) / 1000;
		}
		line(b, end);
	} else {
		const double r = round(uniform(s, 2, 300)) / 1000;
		const double t0 = uniform(s, 0, 6.28), t1 = uniform(s, 0, 6.28);
		const double grain = strategy == INTERP_SIMULTANEOUS &&
						     rnd(s) % 2 ?
					     1e5 :
					     1e3;
		const double ca = round((here[0] - r * cos(t0)) * grain) /
				  grain;
		const double cb = round((here[1] - r * sin(t0)) * grain) /
				  grain;
		const double rr = hypot(here[0] - ca, here[1] - cb);

		end[0] = round((ca + rr * cos(t1)) * grain) / grain;
		end[1] = round((cb + rr * sin(t1)) * grain) / grain;
		if (pick == 3)
			end[2] += uniform(s, -0.3, 0.3);
		arc(b, end, ca, cb, rnd(s) % 2);
	}
}

/* Walk there and back at random; every point met must be the neighbour. */
static inline bool wander(const struct made *m, const struct points *out,
			  uint64_t *seed, int legs)
{
	struct interp_cursor c;
	size_t at = 0;

	assert_int_equal(interp_cursor_init(&c, &m->p), 0);
	for (int i = 0; i < legs; i++) {
		const double ds = uniform(seed, -1, 1.05) *
				  (rnd(seed) % 3 ? 0.02 : 1.0);

		interp_cursor_aim(&c, ds);
		while (interp_cursor_step(&c) == INTERP_MOVED) {
			at += ds < 0 ? (size_t)-1 : 1;
			if (at >= out->n || memcmp(c.pos, out->at[at].pos,
						   sizeof(c.pos)))
				return false;
		}
	}
	return true;
}

/* Overwrite a few bytes anywhere in the block. */
static inline void damage(struct made *m, uint64_t *s)
{
	for (int i = 0; i < 4; i++)
		((uint8_t *)m->block)[rnd(s) % m->bytes] = (uint8_t)rnd(s);
}

/* A bounded walk; no axis may ever jump. */
static inline void walk_some(struct interp_cursor *c, double ds_mm)
{
	int32_t was[INTERP_NAXES];

	interp_cursor_aim(c, ds_mm);
	for (int i = 0; i < 3000; i++) {
		const uint32_t index = c->index;

		memcpy(was, c->pos, sizeof(was));
		if (interp_cursor_step(c) != INTERP_MOVED)
			break;
		/* Damaged nodes may not fit each other; the guard of the
		 * cycle sees to that.  Inside a segment nothing jumps. */
		for (int a = 0; a < INTERP_NAXES && index == c->index; a++)
			if (abs(c->pos[a] - was[a]) > 1)
				fail_msg("axis %d jumps by %d", a,
					 c->pos[a] - was[a]);
	}
}

/* A damaged block is not mapped, or walked to an end either way. */
static inline void walk_damaged(struct made *m)
{
	struct interp_cursor c;

	if (interp_program_map(&m->p, m->block, m->bytes) != 0 ||
	    interp_cursor_init(&c, &m->p) != 0)
		return;
	walk_some(&c, 1e9);
	walk_some(&c, -1e9);
}

static inline bool i32_odd(int i)
{
	return i & 1;
}

static inline void print_on_failure(const char *what, uint64_t n)
{
	static char line[64];

	snprintf(line, sizeof(line), "%s %llu", what, (unsigned long long)n);
	if (n % 500 == 0)
		print_message("    %s\n", line);
}

#endif /* WALK_HELP_H */
