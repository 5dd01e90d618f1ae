/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wayout.c - a way out of a cavity, from the end pose alone
 *
 * All that is random in it has a fixed seed: the same bodies give the same way.
 */
#include "wayout.h"

#include "check.h"
#include "clocks.h"
#include "contact.h"
#include "free.h"
#include "mouth.h"
#include "grow.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROOM_MM		2.0		/* of a step */
#define ROOM_LEAST_MM	0.02
#define STEPS_MAX	400		/* of a slide */
#define PROGRESS	0.03		/* less of the room along: it rests */
#define LED_STEPS	12		/* that the air may lead without coming
					 * nearer to the open */
#define LED_MM		0.05
#define FOLLOWS		0.4		/* how much of its last step the
					 * direction of a slide takes on */
#define EVERY_MM	6.0		/* so often on a slide others begin */
#define SAME_MM		2.0		/* states nearer than that are one */
#define RANDOM_MAX	400
#define POINTS_MAX	60000

enum kind {
	BY_AIR,
	BY_WALLS,
	BY_AXIS,
	BY_CHANCE,
};

struct point {
	double q[INTERP_NAXES];
	uint32_t up;			/* toward the end pose; UINT32_MAX */
};

struct state {
	uint32_t point;
	uint32_t depth;			/* slides from the end pose */
	uint32_t begun;			/* slides from here */
	double left_mm;
};

/* One that was not tried yet. */
struct slide {
	uint32_t state;
	enum kind kind;
	uint32_t k;			/* which direction of its kind */
	double sign;
	double rank;			/* smaller is tried first */
};

struct wayout {
	const struct wayout_asked *asked;
	struct wayout_tried *tried;
	struct contact at;
	struct point *point;
	struct state *state;
	struct slide *slide;
	uint32_t npoints, nstates, nslides;
	size_t points_room, states_room, slides_room;
	uint32_t out;			/* a point; UINT32_MAX: not yet */
	uint32_t turn;
	uint64_t random;
	double until_s;
	bool no_memory;
};

/* -- Points and states ---------------------------------------------------- */

static uint32_t add_point(struct wayout *t, const double q[INTERP_NAXES],
			  uint32_t up)
{
	if (t->npoints == t->points_room &&
	    grow_array(&t->point, &t->points_room, sizeof(*t->point))) {
		t->no_memory = true;
		return UINT32_MAX;
	}
	memcpy(t->point[t->npoints].q, q, sizeof(t->point->q));
	t->point[t->npoints].up = up;
	return t->npoints++;
}

static const double *state_q(const struct wayout *t, uint32_t state)
{
	return t->point[t->state[state].point].q;
}

/* In the order in which they are worth trying. */
static void add_slide(struct wayout *t, enum kind kind, uint32_t k, double sign)
{
	static const double first[] = { 0, 1, 3 }, each[] = { 0, 1.5, 0.5 };
	const uint32_t state = t->nstates - 1;

	if (t->nslides == t->slides_room &&
	    grow_array(&t->slide, &t->slides_room, sizeof(*t->slide))) {
		t->no_memory = true;
		return;
	}
	t->slide[t->nslides++] = (struct slide) {
		.state = state, .kind = kind, .k = k, .sign = sign,
		.rank = 6 * t->state[state].depth + first[kind] +
			k * each[kind],
	};
}

static bool is_known(const struct wayout *t, const double q[INTERP_NAXES])
{
	for (uint32_t i = 0; i < t->nstates; i++)
		if (contact_apart_mm(&t->at, state_q(t, i), q) < SAME_MM)
			return true;
	return false;
}

static void note_farthest(struct wayout *t, const struct state *s)
{
	struct wayout_tried *f = t->tried;
	struct pose pose;

	if (f->states > 1 && s->left_mm >= f->left_mm)
		return;
	f->left_mm = s->left_mm;
	memcpy(f->q, t->point[s->point].q, sizeof(f->q));
	motion_pose(&t->asked->j->motion, f->q, &pose);
	near_distance(&t->asked->j->bodies, &pose, &f->nearest);
}

/* Return: is it a new one? */
static bool add_state(struct wayout *t, uint32_t point, uint32_t depth)
{
	const double *q = t->point[point].q;
	struct state s = { .point = point, .depth = depth };
	double lead[INTERP_NAXES];

	if (is_known(t, q))
		return false;
	if (t->nstates == t->states_room &&
	    grow_array(&t->state, &t->states_room, sizeof(*t->state))) {
		t->no_memory = true;
		return false;
	}
	s.left_mm = outward_at(t->asked->outward, q, lead);
	t->state[t->nstates++] = s;
	t->tried->states++;
	note_farthest(t, &s);
	add_slide(t, BY_AIR, 0, 1);
	for (uint32_t k = 0; k < t->at.axes.n; k++) {
		add_slide(t, BY_WALLS, k, 1);
		add_slide(t, BY_WALLS, k, -1);
		add_slide(t, BY_AXIS, k, 1);
		add_slide(t, BY_AXIS, k, -1);
	}
	return true;
}

/* Proved inward, as the machine goes. */
static bool is_free(const struct wayout *t, const double from[INTERP_NAXES],
		    const double to[INTERP_NAXES])
{
	struct near_pair pair = t->at.nearest;

	return check_block(t->asked->j, to, from, t->asked->c, &pair);
}

/* It is out at @q; does the machine come there from where it stands?  A bore
 * may have a second end, below. */
static bool is_mouth(const struct wayout *t, const double q[INTERP_NAXES])
{
	struct mouth_lead in;

	if (mouth_find(t->asked->j, t->asked->in, q, &in))
		return true;
	t->tried->unreached++;
	return false;
}

/* -- Straight out --------------------------------------------------------- */

/* The least way along @axis after which the electrode is out, to a mm. */
static bool lift(const struct wayout *t, uint32_t axis, double sign,
		 double q[INTERP_NAXES])
{
	const struct interp_axis_limits *l =
		&t->asked->j->config.axes.axis[axis];
	const double was = q[axis];
	double low = 0, high = fmin(1000, sign > 0 ? l->travel_max_mm - was :
						     was - l->travel_min_mm);

	q[axis] = was + sign * high;
	if (!(high > 0) || !outward_is_out(t->asked->j, q))
		return false;
	while (high - low > 1) {
		const double mid = (low + high) / 2;

		q[axis] = was + sign * mid;
		if (outward_is_out(t->asked->j, q))
			high = mid;
		else
			low = mid;
	}
	q[axis] = was + sign * high;
	free_round(&t->asked->j->config, q);
	return true;
}

/* The machine may stand in the part, in a bowl: it comes from there. */
static void try_start(struct wayout *t, uint32_t point)
{
	const double *start = t->asked->j->config.start_mm;

	if (t->out == UINT32_MAX && !outward_is_out(t->asked->j, start) &&
	    is_free(t, t->point[point].q, start))
		t->out = add_point(t, start, point);
}

static void try_lifts(struct wayout *t, uint32_t point)
{
	for (uint32_t i = 0; i < 2 * t->at.axes.n; i++) {
		/* The last of X Y Z first: a plain cavity is open upward. */
		const uint32_t axis = t->at.axes.axis[t->at.axes.n - 1 - i / 2];
		double q[INTERP_NAXES];

		if (interp_axis_is_rotary(axis))
			continue;
		memcpy(q, t->point[point].q, sizeof(q));
		if (!lift(t, axis, i % 2 ? -1 : 1, q) ||
		    !is_free(t, t->point[point].q, q) || !is_mouth(t, q))
			continue;
		t->out = add_point(t, q, point);
		return;
	}
}

/* -- One slide ------------------------------------------------------------ */

struct sliding {
	double toward[INTERP_NAXES];	/* of length 1 */
	double q[INTERP_NAXES];
	double room_mm;
	double since_mm;		/* since the last state on it */
	double least_left_mm;
	int led;			/* steps by the air, without progress */
	uint32_t point;
};

static double to_unit(double *v, uint32_t n)
{
	double sum = 0;

	for (uint32_t a = 0; a < n; a++)
		sum += v[a] * v[a];
	sum = sqrt(sum);
	for (uint32_t a = 0; a < n && sum > 0; a++)
		v[a] /= sum;
	return sum;
}

/* xorshift64; sum of twelve: as good as normal. */
static double draw(struct wayout *t)
{
	double sum = -6;

	for (int i = 0; i < 12; i++) {
		t->random ^= t->random << 13;
		t->random ^= t->random >> 7;
		t->random ^= t->random << 17;
		sum += (double)(t->random >> 11) / (double)(1ull << 53);
	}
	return sum;
}

/* Return: what is left. */
static double ask_air(const struct wayout *t, struct sliding *s)
{
	double lead[INTERP_NAXES];
	const double left = outward_at(t->asked->outward, s->q, lead);

	for (uint32_t a = 0; a < t->at.axes.n; a++)
		s->toward[a] = lead[t->at.axes.axis[a]] /
			       t->at.axes.reach_mm[t->at.axes.axis[a]];
	return left;
}

static void choose(struct wayout *t, const struct slide *x, struct sliding *s)
{
	double by_walls[INTERP_NAXES][INTERP_NAXES];

	memset(s->toward, 0, sizeof(s->toward));
	if (x->kind == BY_AIR) {
		s->least_left_mm = ask_air(t, s);
	} else if (x->kind == BY_AXIS) {
		s->toward[x->k] = x->sign;
	} else if (x->kind == BY_CHANCE) {
		for (uint32_t a = 0; a < t->at.axes.n; a++)
			s->toward[a] = draw(t);
	} else {
		contact_look(&t->at, s->q, s->room_mm);
		contact_directions(&t->at, by_walls);
		for (uint32_t a = 0; a < t->at.axes.n; a++)
			s->toward[a] = x->sign * by_walls[x->k][a];
	}
	to_unit(s->toward, t->at.axes.n);
}

/* The longest step that is proved. @by: gets it, mm. Return: is there one that
 * leads on? */
static bool step(struct wayout *t, struct sliding *s, double by[INTERP_NAXES])
{
	contact_look(&t->at, s->q, s->room_mm);
	for (; s->room_mm >= ROOM_LEAST_MM; s->room_mm /= 2) {
		double to[INTERP_NAXES], along = 0;

		if (!contact_step(&t->at, s->toward, s->room_mm, by))
			return false;
		for (uint32_t a = 0; a < t->at.axes.n; a++)
			along += s->toward[a] * by[a];
		if (along < PROGRESS * s->room_mm)
			return false;
		contact_to(&t->at, by, to);
		if (!is_free(t, s->q, to))
			continue;
		s->point = add_point(t, to, s->point);
		memcpy(s->q, to, sizeof(s->q));
		return s->point != UINT32_MAX;
	}
	return false;
}

/* Where the next step is to lead. Return: is it worth one? */
static bool turn(struct wayout *t, const struct slide *x, struct sliding *s,
		 double by[INTERP_NAXES])
{
	s->since_mm += to_unit(by, t->at.axes.n);
	s->room_mm = fmin(s->room_mm * 1.5, ROOM_MM);
	if (x->kind == BY_AIR) {
		const double left = ask_air(t, s);

		s->led++;
		if (left < s->least_left_mm - LED_MM) {
			s->least_left_mm = left;
			s->led = 0;
		}
		if (s->led > LED_STEPS)
			return false;
	}
	if (x->kind == BY_WALLS)
		for (uint32_t a = 0; a < t->at.axes.n; a++)
			s->toward[a] = (1 - FOLLOWS) * s->toward[a] +
				       FOLLOWS * by[a];
	return to_unit(s->toward, t->at.axes.n) > 0;
}

/* Return: is it a way that no other slide has gone? */
static bool note_state(struct wayout *t, struct sliding *s, uint32_t depth)
{
	bool is_new;

	if (s->since_mm < EVERY_MM)
		return true;
	is_new = add_state(t, s->point, depth);
	if (is_new)
		s->since_mm = 0;
	return is_new || s->since_mm < 3 * EVERY_MM;
}

static void show(const struct wayout *t)
{
	char text[100];

	snprintf(text, sizeof(text), "looking for a way out: %u slides, %u "
		 "places, %.1f mm left", t->tried->slides, t->nstates,
		 t->tried->left_mm);
	bar_show(t->asked->j, 1 - t->tried->left_mm /
			      fmax(t->state[0].left_mm, 1e-9), text);
}

static bool is_over(const struct wayout *t)
{
	return bar_interrupted() || t->no_memory || t->npoints > POINTS_MAX ||
	       clock_s(CLOCK_PROCESS_CPUTIME_ID) > t->until_s;
}

static void go(struct wayout *t, const struct slide *x)
{
	const uint32_t begin = t->state[x->state].point;
	const uint32_t depth = t->state[x->state].depth + 1;
	struct sliding s = { .room_mm = ROOM_MM, .point = begin };
	double way[INTERP_NAXES];

	t->tried->slides++;
	memcpy(s.q, t->point[begin].q, sizeof(s.q));
	choose(t, x, &s);
	for (int i = 0; i < STEPS_MAX && !is_over(t); i++) {
		if (!step(t, &s, way))
			break;
		show(t);
		if (outward_is_out(t->asked->j, s.q)) {
			if (is_mouth(t, s.q))
				t->out = s.point;
			return;
		}
		if (!turn(t, x, &s, way) || !note_state(t, &s, depth))
			break;
	}
	if (s.point != begin && s.point != UINT32_MAX &&
	    add_state(t, s.point, depth)) {
		try_lifts(t, s.point);
		try_start(t, s.point);
	}
}

/* -- The tree ------------------------------------------------------------- */

/* In turns the one of the least rank, and one from where least is left. */
static double worth(const struct wayout *t, const struct slide *x)
{
	const struct state *s = &t->state[x->state];

	return t->turn % 2 ? x->rank : s->left_mm + 2 * s->begun;
}

static struct slide next(struct wayout *t)
{
	uint32_t best = 0;
	struct slide ret;

	t->turn++;
	for (uint32_t i = 1; i < t->nslides; i++)
		if (worth(t, &t->slide[i]) < worth(t, &t->slide[best]))
			best = i;
	ret = t->slide[best];
	t->nslides--;
	memmove(t->slide + best, t->slide + best + 1,
		(t->nslides - best) * sizeof(*t->slide));
	t->state[ret.state].begun++;
	return ret;
}

static struct slide by_chance(struct wayout *t)
{
	draw(t);
	return (struct slide) { .kind = BY_CHANCE,
				.state = (uint32_t)(t->random % t->nstates) };
}

static void grow(struct wayout *t)
{
	uint32_t random = 0;

	while (t->out == UINT32_MAX && !is_over(t)) {
		struct slide x;

		if (t->nslides == 0 && random++ == RANDOM_MAX)
			return;
		x = t->nslides ? next(t) : by_chance(t);
		go(t, &x);
	}
}

static int put_way(struct wayout *t, struct route *out)
{
	uint32_t n = 0;

	/* From the end pose outward. */
	for (uint32_t i = t->out, up = UINT32_MAX; i != UINT32_MAX;) {
		const uint32_t next_up = t->point[i].up;

		t->point[i].up = up;
		up = i;
		i = next_up;
		n++;
	}
	for (uint32_t i = 0, k = 0; k < n; k++, i = t->point[i].up) {
		struct route_node node = { .feed_mm_s = 0.5 };

		memcpy(node.q, t->point[i].q, sizeof(node.q));
		if (route_add(out, &node))
			return -ENOMEM;
	}
	return 0;
}

int wayout_find(const struct wayout_asked *asked, struct route *out,
		struct wayout_tried *tried)
{
	struct wayout t = { .asked = asked, .tried = tried, .out = UINT32_MAX,
			  .random = 88172645463325252ull };
	int rc = 1;

	*tried = (struct wayout_tried) { 0 };
	t.until_s = clock_s(CLOCK_PROCESS_CPUTIME_ID) + asked->seconds;
	contact_init(&t.at, asked->j, asked->end, asked->c->mm);
	if (add_point(&t, asked->end, UINT32_MAX) == 0 && add_state(&t, 0, 0)) {
		try_lifts(&t, 0);
		try_start(&t, 0);
		grow(&t);
	}
	if (t.no_memory)
		rc = -ENOMEM;
	else if (t.out != UINT32_MAX)
		rc = put_way(&t, out);
	free(t.point);
	free(t.state);
	free(t.slide);
	return rc;
}
