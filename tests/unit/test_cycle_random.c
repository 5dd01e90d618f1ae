/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_cycle_random.c - what holds in every cycle, whatever happens
 *
 * Ten million cycles of random programs with ways out, planetary cycles, texts
 * of every dialect with curves, tapers and rotary axes, by every strategy,
 * sensors, gaps that wander, stick, scatter or are no number, conditions,
 * values in force, commands, broken wires, losses and e-stops, maps, backlash,
 * leads and drives that lag; a million where a sanitizer watches.  `make
 * invariants` runs it alone; the seed is printed.
 */
#include "random_world.h"
#include "random_drives.h"
#include "random_compile.h"
#include "guard.h"
#include "seed.h"
#include "path/pace.h"
#include "path/place.h"

#define CYCLES		SEED_ROUNDS(10000000)
#define CYCLES_PER_JOB	10000

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

static bool on_path(const struct points *set, const int32_t *pos)
{
	struct point here = { 0 };

	memcpy(here.pos, pos, sizeof(here.pos));
	return bsearch(&here, set->at, set->n, sizeof(here), by_place) != NULL;
}

/* -- The way out that a segment allows ------------------------------------ */

/*
 * On the straight line between two places, in pulses: its ends, its points and
 * where along it they are counted are each rounded by half a pulse at most.
 */
static bool on_leg(const double *from, const double *to, const int32_t *pos)
{
	int longest = 0;
	double t;

	for (int i = 0; i < INTERP_NAXES; i++)
		if (fabs(to[i] - from[i]) > fabs(to[longest] - from[longest]))
			longest = i;
	t = (pos[longest] - from[longest]) / (to[longest] - from[longest]);
	/* A leg of no length: the point. */
	t = isfinite(t) ? fmin(fmax(t, 0), 1) : 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		if (fabs(from[i] + t * (to[i] - from[i]) - pos[i]) > 1.51)
			return false;
	return true;
}

static void aim(double *to, const double *from, uint32_t axes,
		const double *mm, double share)
{
	for (int i = 0; i < INTERP_NAXES; i++)
		to[i] = axes & 1u << i ?
			from[i] + share * (mm[i] / PULSE_MM - from[i]) :
			from[i];
}

/* Told from the program alone, not from what the cycle made of it. */
static bool on_way_out(const struct cycle *c, const int32_t *pos)
{
	const struct interp_escape *e =
		&c->cursor.p.escapes[c->cursor.seg.escape];
	const uint32_t rotary = 1u << INTERP_A | 1u << INTERP_B |
				1u << INTERP_C;
	double at[4][INTERP_NAXES], sum = 0, share = 1;

	for (int i = 0; i < INTERP_NAXES; i++) {
		at[0][i] = c->cursor.pos[i];
		if (e->out & ~rotary & 1u << i)
			sum += pow(e->out_mm[i] - at[0][i] * PULSE_MM, 2);
	}
	if (e->rise_mm < sqrt(sum))
		share = e->rise_mm / sqrt(sum);
	aim(at[1], at[0], e->rise_mm > 0 ? e->out : 0, e->out_mm, share);
	aim(at[2], at[1], e->home, e->home_mm, 1);
	aim(at[3], at[2], e->out, e->out_mm, 1);
	return on_leg(at[0], at[1], pos) || on_leg(at[1], at[2], pos) ||
	       on_leg(at[2], at[3], pos);
}

/* On the path, or beside it where the segment says. */
static void check_place(const struct cycle *c, const struct points *set,
			const int32_t *pos)
{
	assert_true(on_path(set, c->cursor.pos));
	if (escape_is_out(&c->escape))
		assert_true(on_way_out(c, pos));
	else
		assert_true(on_path(set, pos));
}

static void check_point(void *arg, const struct cycle *c)
{
	check_place(c, arg, place_pos(c));
}

/* -- What must hold ------------------------------------------------------ */

static uint64_t seen[CYCLE_NSTATES];	/* cycles in each state */
static uint64_t faults[CYCLE_NFAULTS];
static uint64_t powered, beside, beside_retract;	/* cycles */
static uint64_t led, settled;
static enum cycle_state last;

static double v_before, dv_before;	/* speed asked for, a cycle ago, and
					 * what the axes could change it by */
static uint16_t cond_before;

/* The servo's own acceleration may be another one by then. */
static double axes_dv_mm_s(struct cycle *c)
{
	const double own = c->gap.feed_a_mm_s2;
	double dv;

	c->gap.feed_a_mm_s2 = 0;
	dv = pace_dv_mm_s(c);
	c->gap.feed_a_mm_s2 = own;
	return dv;
}

static double dv_of(const struct cycle *c)
{
	return c->gap.feed_a_mm_s2 > 0 ?
	       fmin(dv_before, c->gap.feed_a_mm_s2 * PERIOD_S) : dv_before;
}

/*
 * Asked for no more than @limit, or slowing down as fast as it can.  What is
 * walked may differ where a cycle has not points enough for the way.
 */
static bool at_most(const struct cycle *c, double limit)
{
	return c->mover.v_mm_s <= limit + 1e-6 ||
	       c->mover.v_mm_s <= v_before - dv_of(c) + 1e-6;
}

static bool at_least(const struct cycle *c, double limit)
{
	return c->mover.v_mm_s >= limit - 1e-6 ||
	       c->mover.v_mm_s >= v_before + dv_of(c) - 1e-6;
}

static void check_erode(const struct cycle *c)
{
	assert_true(at_most(c, c->gap.feed_max_mm_s));
	assert_true(at_least(c, -c->gap.creep_mm_s));
	if (c->sensed.contact || c->sensed.signal_v <= gap_window_high_v(c))
		assert_true(at_most(c, 0));
	if (!c->sensed.contact && c->sensed.signal_v >= gap_window_low_v(c))
		assert_true(at_least(c, 0));
}

/* The servo goes the way the gap asks for, and no faster than it may. */
static void check_feed(const struct rig *r)
{
	const struct cycle *c = &r->c;

	/* The speed was chosen by the values in force where it stood before. */
	if (c->state != r->was || c->conditions.cond != cond_before)
		return;
	if (c->state == STATE_APPROACH) {
		assert_true(at_least(c, 0));
		assert_true(at_most(c, c->sensed.contact ? 0 :
						c->gap.approach_mm_s));
	}
	if (c->state == STATE_RETRACT) {
		assert_true(at_most(c, 0));
		assert_true(at_least(c, -c->gap.retract_mm_s));
		/* Beyond it only what it came in with, braking. */
		assert_true(place_mm(c) >= c->retract.floor_mm - 1e-8 ||
			    at_least(c, 0));
	}
	if (c->state == STATE_ERODE)
		check_erode(c);
}

/* Nothing sparks, begins or goes too far back against the PLC. */
static void check_plc(const struct rig *r)
{
	assert_true(interp_cursor_place_mm(&r->c.cursor) >=
		    r->c.back_mm - 1e-6);
	if (!guard_forbids(&r->c))
		return;
	assert_false(r->out.power);
	assert_false(state_duty[r->c.state].running);
}

/* The motion at @i, or the next one that way, past what is done on the spot. */
static bool is_cut(const struct interp_program *p, uint32_t i, uint32_t way)
{
	while (i > 0 && i + 1 < p->head->nsegs &&
	       p->segs[i].kind >= INTERP_BEGIN)
		i += way;
	return p->segs[i].kind < INTERP_BEGIN &&
	       !(p->segs[i].flags & INTERP_SEG_UNCUT);
}

/* Within a cut, or at an end of one. */
static bool is_at_cut(const struct interp_cursor *at)
{
	const bool begins = at->s_mm < 2e-9;
	const bool ends = at->s_mm > at->seg.length_mm - 2e-9;

	return is_cut(&at->p, at->index - (begins && at->index > 0), -1u) ||
	       is_cut(&at->p, at->index + ends, 1);
}

/* No sparks but in a cut, and none that somebody or something forbids. */
static void check_power(const struct rig *r)
{
	const struct cycle *c = &r->c;

	if (!r->out.power)
		return;
	assert_true(c->state == STATE_APPROACH || c->state == STATE_ERODE);
	assert_false(c->hold.moving);
	assert_false(r->in.estop || r->in.lost || c->config.dry_run);
	assert_false(c->job.power_off);
	assert_false(stand_asks(c));
	assert_true(is_at_cut(&c->cursor));
	assert_int_equal(c->fault.first, FAULT_NONE);
	powered++;
}

/* No motion in a fault; a cycle that says stop, or is not answered, has none
 * either.  Other faults may be found where the cycle's way has led to. */
static void check_stand(const struct rig *r)
{
	if (r->c.state != STATE_FAULT)
		return;
	assert_int_not_equal(r->c.fault.first, FAULT_NONE);
	if (r->was != STATE_FAULT && !r->in.estop && !r->in.lost)
		return;
	assert_memory_equal(r->c.out.target, r->path_before,
			    sizeof(r->path_before));
	assert_true(r->c.feed_mm_s == 0);
}

static void count_states(const struct cycle *c)
{
	seen[c->state]++;
	beside += escape_is_out(&c->escape);
	beside_retract += escape_is_out(&c->escape) &&
			  c->state == STATE_RETRACT;
	if (c->state == STATE_FAULT && last != STATE_FAULT)
		faults[c->fault.first]++;
	last = c->state;
}

static void check_cycle(struct rig *r, const struct points *set)
{
	check_feed(r);
	check_plc(r);
	v_before = r->c.mover.v_mm_s;
	dv_before = axes_dv_mm_s(&r->c);
	cond_before = r->c.conditions.cond;
	/* Stopped beside the path the job is over, and it stands there. */
	if (r->c.loaded || memcmp(r->c.out.target, r->path_before,
				  sizeof(r->path_before)))
		check_place(&r->c, set, r->c.out.target);
	check_power(r);
	check_stand(r);
	assert_true(isfinite(r->c.feed_mm_s) && isfinite(place(r)));
	assert_true(place(r) >= 0);
	assert_true(place(r) <= r->m.p.head->length_mm + 1e-6);
	assert_true(r->c.far_mm <= r->m.p.head->length_mm + 1e-6);
	if (r->c.state == STATE_IDLE)
		assert_int_equal(r->c.fault.first, FAULT_NONE);
	if (r->c.config.dry_run)
		assert_false(r->out.power);
	if (r->in.axes_off) {
		/* Those that follow may still brake. */
		assert_false(r->out.power);
		assert_true(r->c.fault.latched || !r->c.mover.v_mm_s);
	}
	if (r->in.axes_off && !(r->in.steers && r->c.fault.latched)) {
		assert_memory_equal(r->c.out.target, r->path_before,
				    sizeof(r->path_before));
	}
	count_states(&r->c);
}

/* Kinds of segments, and rotary axes, that were met in texts. */
static uint64_t met[INTERP_NKINDS], turning;

/* Touches shift what follows: no place of theirs is in the program.  A long
 * program takes longer to be listed than to be walked. */
static bool fits(const struct made *m)
{
	const struct interp_program_head *h = m->p.head;
	uint64_t ticks = 0;

	for (uint32_t i = 0; i < h->nsegs; i++) {
		ticks += m->p.segs[i].ticks;
		if (m->p.segs[i].flags & INTERP_SEG_SENSED)
			return false;
	}
	return h->length_mm > 0 && ticks < 20000;
}

/* Curves, tapers, orbits, rotary axes, records: a text of any dialect. */
static struct made random_text_program(uint64_t *s)
{
	static struct script text;
	struct interp_build_options o = {
		.machine = &help_machine, .tolerance_milli = 2000,
	};
	struct made m;

	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	for (;;) {
		const char *dialect = random_text(&text, s);

		o.strategy = (enum interp_strategy)
			(rnd(s) % INTERP_NSTRATEGIES);
		o.perpendicular = rnd(s) % 2;
		if (!random_compile(&text, dialect, &o, &m))
			continue;
		if (fits(&m))
			break;
		unmake(&m);
	}
	for (uint32_t i = 0; i < m.p.head->nsegs; i++)
		met[m.p.segs[i].kind]++;
	for (uint32_t j = 0; j < m.p.head->naxes; j++)
		turning += interp_axis_is_rotary(m.p.head->column[j]);
	return m;
}

static struct made random_job(uint64_t *s)
{
	switch (rnd(s) % 4) {
	case 0:
		return random_orbits(s);
	case 1:
		return random_text_program(s);
	default:
		return random_segments(s);
	}
}

static int run_job(uint64_t *s)
{
	static const int32_t none[INTERP_NAXES];
	struct cycle_config k = random_config(s);
	struct random_drives drives = { .begun = false };
	struct gap_world gap = { .v = OPEN_V };
	struct points set;
	struct rig r;
	int n = 0;

	random_comp(&k.comp, s);
	random_contouring(&k.contouring, s);
	rig_take(&r, random_job(s), &k);
	set = points_of(&r.m);
	r.c.on_point = check_point;
	r.c.on_point_arg = &set;
	r.in.plc.present = rnd(s) % 2;
	tell(&r, CYCLE_START);
	for (; n < CYCLES_PER_JOB; n++) {
		double v;

		random_world(&r, s);
		random_actual(&drives, &r, s);
		v = random_gap(&gap, s);
		random_shares(&r, v, s);
		step(&r, v);
		check_cycle(&r, &set);
		settled += check_drives(&drives, &r);
		led += memcmp(drives.added, none, sizeof(none)) != 0;
		if (r.c.state == STATE_IDLE)
			break;
	}
	points_free(&set);
	rig_free(&r);
	return n + 1;
}

static bool met_all(void)
{
	return met[INTERP_CURVE] > 0 && met[INTERP_PAIR] > 0 &&
	       met[INTERP_ARC] > 0 && turning > 0;
}

/* A few jobs more, until there was one of each kind. */
static void millions_of_random_cycles_keep_every_promise(void **st)
{
	uint64_t s = seed;
	int jobs = 0, cycles = 0;

	(void)st;
	while (cycles < CYCLES || (!met_all() && cycles < 4 * CYCLES)) {
		cycles += run_job(&s);
		jobs++;
	}
	print_message("    %d jobs, %d cycles, %llu with power, %llu beside "
		      "the path, %llu of these in a retract\n", jobs, cycles,
		      (unsigned long long)powered, (unsigned long long)beside,
		      (unsigned long long)beside_retract);
	print_message("    %llu led, %llu settled on their maps\n",
		      (unsigned long long)led, (unsigned long long)settled);
	assert_true(led > 0 && settled > 0);
	print_message("    of texts: %llu curves, %llu pairs of contours, %llu "
		      "arcs, %llu rotary axes\n",
		      (unsigned long long)met[INTERP_CURVE],
		      (unsigned long long)met[INTERP_PAIR],
		      (unsigned long long)met[INTERP_ARC],
		      (unsigned long long)turning);
	assert_true(met_all());
	assert_true(powered > 0 && beside > 0 && beside_retract > 0);
	/* test_manual.c has those of a machine without a job. */
	for (int i = STATE_IDLE; i < STATE_JOG; i++) {
		print_message("    %-10s %8llu cycles\n", state_duty[i].name,
			      (unsigned long long)seen[i]);
		assert_true(seen[i] > 0);
	}
	for (int i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++) {
		print_message("    %-18s %llu\n",
			      fault_name((uint32_t)i),
			      (unsigned long long)faults[i]);
		/* test_cycle_damage.c, test_home.c, test_probe.c and
		 * test_progress.c have the others; no program here may be
		 * stuck. */
		if (i == FAULT_STUCK)
			assert_true(faults[i] == 0);
		if (CYCLES >= 10000000 && i != FAULT_PROGRAM &&
		    i != FAULT_HOME && i != FAULT_NO_CONTACT &&
		    i != FAULT_STUCK)
			assert_true(faults[i] > 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(millions_of_random_cycles_keep_every_promise),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
