/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_cycle_random.c - what holds in every cycle, whatever happens
 *
 * A million cycles of random programs, gap voltages, commands, losses of the
 * gap and e-stops.  The seed is printed; test_cycle_random SEED repeats it.
 */
#include "cycle_help.h"

#include <time.h>

#define CYCLES		1000000
#define CYCLES_PER_JOB	10000
#define SEGMENTS	30
#define POINTS_MAX	150

static uint64_t seed;

/* -- The lattice points of the forward walk ------------------------------ */

static int by_place(const void *a, const void *b)
{
	const struct point *p = a, *q = b;

	return memcmp(p->pos, q->pos, sizeof(p->pos));
}

static struct points points_of(const struct made *m)
{
	struct points p = { 0 };
	enum interp_step what;
	struct interp_cursor c;

	assert_int_equal(interp_cursor_init(&c, &m->p), 0);
	points_add(&p, &c);
	do {
		interp_cursor_aim(&c, 1.0);
		while ((what = interp_cursor_step(&c)) == INTERP_MOVED)
			points_add(&p, &c);
		if (what == INTERP_AT_ACTION)
			what = interp_cursor_pass(&c);
	} while (what == INTERP_ARRIVED);
	assert_int_equal(what, INTERP_AT_END);
	qsort(p.at, p.n, sizeof(*p.at), by_place);
	return p;
}

static void check_point(void *arg, const struct cycle *c)
{
	const struct points *set = arg;
	struct point here = { 0 };

	memcpy(here.pos, c->cursor.pos, sizeof(here.pos));
	assert_non_null(bsearch(&here, set->at, set->n, sizeof(here),
				by_place));
}

static void check_target(const struct rig *r, const struct points *set)
{
	struct point here = { 0 };

	memcpy(here.pos, r->out.target, sizeof(here.pos));
	assert_non_null(bsearch(&here, set->at, set->n, sizeof(here),
				by_place));
}

/* -- A random world ------------------------------------------------------ */

static void random_action(struct interp_build *b, uint64_t *s)
{
	static const enum interp_kind kinds[] = {
		INTERP_DWELL, INTERP_STOP, INTERP_OPTIONAL_STOP, INTERP_AUX,
	};
	const enum interp_kind k = kinds[rnd(s) % 4];

	action(b, k, k == INTERP_AUX ? (uint32_t)(rnd(s) % INTERP_NAUX) :
				       (uint32_t)(rnd(s) % 20));
}

static void random_rapid(struct interp_build *b, uint64_t *s)
{
	rapid_to(b, uniform(s, -0.5, 0.5));
}

static struct interp_build *random_program(uint64_t *s)
{
	const enum interp_strategy how = rnd(s) % 2 ? INTERP_POINT_BY_POINT :
						      INTERP_SIMULTANEOUS;
	struct interp_build *b = begin(how);

	random_segment(b, s, how);
	for (int i = 0; i < SEGMENTS; i++) {
		if (rnd(s) % 5 == 0)
			random_action(b, s);
		else if (rnd(s) % 4 == 0)
			random_rapid(b, s);
		else
			random_segment(b, s, how);
	}
	return b;
}

static struct cycle_config random_config(uint64_t *s)
{
	struct cycle_config k = usual_config();

	k.points_max = POINTS_MAX;
	k.optional_stop = rnd(s) % 2;
	k.dry_run = rnd(s) % 8 == 0;
	k.jump.height_mm = rnd(s) % 3 ? uniform(s, 0, 1) : 0;
	k.gap.retract_limit_mm = uniform(s, 0.05, 1);
	k.gap.gain_mm_s_v = uniform(s, 0.01, 1);
	for (int i = 0; i < INTERP_NAXES && rnd(s) % 4 == 0; i++) {
		k.travel_min[i] = -(int32_t)(rnd(s) % 500);
		k.travel_max[i] = (int32_t)(rnd(s) % 500);
	}
	return k;
}

/* Wanders through the zones, with sudden shorts and odd readings. */
static double random_gap(double v, uint64_t *s)
{
	const uint64_t pick = rnd(s) % 200;

	if (pick == 0)
		return 0;
	if (pick == 1)
		return OPEN_V;
	if (pick == 2)
		return rnd(s) % 2 ? NAN : -INFINITY;
	if (!isfinite(v))
		v = SPARKING_V;
	return fmin(120, fmax(0, v + uniform(s, -4, 4.2)));
}

static void random_command(struct rig *r, uint64_t *s)
{
	const struct cycle_command m = {
		.verb = (uint32_t)(rnd(s) % (CYCLE_NVERBS + 1)),
		.arg_mm = rnd(s) % 10 ? uniform(s, -0.1, 2) : NAN,
	};

	/* A stop ends the job: rarely. */
	if (m.verb != CYCLE_STOP || rnd(s) % 8 == 0)
		assert_true(cycle_command(&r->c, &m) < CYCLE_NANSWERS);
}

static void random_world(struct rig *r, uint64_t *s)
{
	r->in.estop = rnd(s) % 3000 == 0;
	r->in.lost = rnd(s) % 5000 == 0;
	r->in.gap_valid = rnd(s) % 2000 != 0;
	if (rnd(s) % 1000 == 0)
		cycle_overrun(&r->c, (uint32_t)(rnd(s) % 12));
	if (rnd(s) % 100 == 0)
		random_command(r, s);
	/* An operator who goes on. */
	if (r->c.state == STATE_FAULT && rnd(s) % 20 == 0)
		tell(r, CYCLE_RESET);
	if (r->c.state == STATE_HOLD && rnd(s) % 20 == 0)
		tell(r, CYCLE_START);
}

/* -- What must hold ------------------------------------------------------ */

static uint64_t seen[CYCLE_NSTATES];	/* cycles in each state */
static uint64_t faults[CYCLE_NFAULTS];
static enum cycle_state last;

static void check_cycle(const struct rig *r, const struct points *set)
{
	check_target(r, set);
	assert_true(isfinite(r->c.feed_mm_s) && isfinite(place(r)));
	assert_true(place(r) >= 0);
	assert_true(place(r) <= r->m.p.head->length_mm + 1e-6);
	assert_true(r->c.far_mm <= r->m.p.head->length_mm + 1e-6);
	if (r->c.state == STATE_FAULT)
		assert_int_not_equal(r->c.fault, FAULT_NONE);
	if (r->c.state == STATE_IDLE)
		assert_int_equal(r->c.fault, FAULT_NONE);
	if (r->c.config.dry_run)
		assert_false(r->out.power);
	seen[r->c.state]++;
	if (r->c.state == STATE_FAULT && last != STATE_FAULT)
		faults[r->c.fault]++;
	last = r->c.state;
}

static int run_job(uint64_t *s)
{
	const struct cycle_config k = random_config(s);
	double v = OPEN_V;
	struct points set;
	struct rig r;
	int n = 0;

	rig_load(&r, random_program(s), &k);
	set = points_of(&r.m);
	r.c.on_point = check_point;
	r.c.on_point_arg = &set;
	tell(&r, CYCLE_START);
	for (; n < CYCLES_PER_JOB; n++) {
		random_world(&r, s);
		v = random_gap(v, s);
		step(&r, v);
		check_cycle(&r, &set);
		if (r.c.state == STATE_IDLE)
			break;
	}
	points_free(&set);
	rig_free(&r);
	return n + 1;
}

static void a_million_random_cycles_keep_every_promise(void **st)
{
	uint64_t s = seed;
	int jobs = 0;

	(void)st;
	for (int n = 0; n < CYCLES; jobs++)
		n += run_job(&s);
	print_message("    %d jobs\n", jobs);
	for (int i = STATE_IDLE; i < CYCLE_NSTATES; i++) {
		print_message("    %-10s %8llu cycles\n", state_duty[i].name,
			      (unsigned long long)seen[i]);
		assert_true(seen[i] > 0);
	}
	for (int i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++)
		print_message("    %-18s %llu\n",
			      cycle_fault_name((enum cycle_fault)i),
			      (unsigned long long)faults[i]);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_million_random_cycles_keep_every_promise),
	};

	seed = argc > 1 ? strtoull(argv[1], NULL, 0) : (uint64_t)time(NULL);
	print_message("seed %llu; test_cycle_random SEED repeats it\n",
		      (unsigned long long)seed);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
