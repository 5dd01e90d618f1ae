/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_way_out_turns.c - an axis is blocked while its path turns to and fro at
 * the obstacle; then it is retracted
 *
 * Random worlds: drives that follow late, or lines; an orbit or a zigzag whose
 * turns lead beyond the obstacle, on either side; a stop by a following error,
 * an e-stop or a restart, wherever the path is then.
 */
#include "way_out_help.h"

#include "seed.h"

#define WALL		1000
#define TURNS		6
#define CHORDS		24		/* of an orbit */
#define WORLDS		150
#define NEAR		6		/* pulses; nearer is not off */

enum stopped { BY_FOLLOWING, BY_ESTOP, BY_KILL, NSTOPS };

static const char *const stop_names[NSTOPS] = {
	"following error", "e-stop", "restart"
};

struct turns {
	bool lines, zigzag;
	int side;			/* of X: where the obstacle is */
	double high_mm;			/* from the inner to the outer turn */
	double beyond_mm;		/* the outer turn is beyond the wall */
	double feed_mm_s, following_s;
	int delay;
	double tau;
	enum stopped by;
	double wait_s;			/* from contact to the e-stop */
};

static uint64_t state;

static double random_between(double low, double high)
{
	state = state * UINT64_C(6364136223846793005) + 1442695040888963407u;
	return low + (high - low) * (double)(state >> 11) * 0x1p-53;
}

static struct turns turns_make(void)
{
	static const double following_s[] = { 0, 0.005, 0.05 };
	struct turns t = {
		.lines = random_between(0, 1) < 0.4,
		.zigzag = random_between(0, 1) < 0.4,
		.side = random_between(0, 1) < 0.5 ? -1 : 1,
		.high_mm = exp(random_between(log(0.04), log(0.4))),
		.feed_mm_s = exp(random_between(log(0.5), log(16))),
		.following_s = following_s[(int)random_between(0, 3)],
		.delay = (int)random_between(0, 12),
		.tau = random_between(0, 1) < 0.5 ? 0 : random_between(0, 4),
		.by = (enum stopped)random_between(0, NSTOPS),
		.wait_s = random_between(0, 0.3),
	};

	/* As somebody measures it who sets a machine up. */
	t.following_s = fmax(t.following_s, 2 * (t.delay + t.tau) *
			     PERIOD_S);
	t.beyond_mm = random_between(0.05, 1) * t.high_mm;
	if (t.lines && t.by == BY_KILL)
		t.by = BY_ESTOP;
	return t;
}

static void turns_print(const struct turns *t, int n)
{
	print_message("%d: %s, %s, side %d, %.3f high, %.3f beyond, feed %.2f, "
		      "following_s %g, delay %d, tau %.1f, %s, %.3f s\n", n,
		      t->lines ? "lines" : "drives", t->zigzag ? "zigzag" :
		      "orbit", t->side, t->high_mm, t->beyond_mm, t->feed_mm_s,
		      t->following_s, t->delay, t->tau, stop_names[t->by],
		      t->wait_s);
}

static void line_to(struct interp_build *b, const struct turns *t, double x,
		    double y)
{
	const double at[INTERP_NAXES] = { t->side * x, y };

	line(b, at);
}

static struct made turns_path(const struct turns *t)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const double out = WALL * PULSE_MM + t->beyond_mm, r = t->high_mm / 2;

	help_word.feed_mm_s = t->feed_mm_s;
	line_to(b, t, out - t->high_mm, 0.5);
	for (int i = 0; i < TURNS; i++) {
		if (t->zigzag) {
			line_to(b, t, out, 0.5 + i * r);
			line_to(b, t, out - t->high_mm, 0.5 + (i + 0.5) * r);
			continue;
		}
		for (int k = 1; k <= CHORDS; k++)
			line_to(b, t, out - r - r * cos(2 * M_PI * k / CHORDS),
				0.5 + r * sin(2 * M_PI * k / CHORDS));
	}
	line_to(b, t, 0, 1.5);
	return finish(b);
}

/* The way of the path along one turn that is in front of the obstacle. */
static double free_mm(const struct turns *t)
{
	const double r = t->high_mm / 2, f = t->high_mm - t->beyond_mm;

	return t->zigzag ? f * hypot(1, 0.25) * 2 : 2 * r * acos(1 - f / r);
}

static void turns_open(struct world *w, const struct turns *t)
{
	struct axis *x = &w->axis[INTERP_X];

	world_init(w, t->lines);
	w->m = turns_path(t);
	w->c.can402.following_s = t->following_s;
	for (int i = 0; i < NAXES; i++) {
		w->axis[i].delay = t->delay;
		w->axis[i].tau = t->tau;
	}
	if (t->side > 0)
		x->wall = WALL;
	else
		x->floor = -WALL;
	world_start(w);
}

static bool is_over(const struct world *w)
{
	return !w->cycle.loaded || w->cycle.state == STATE_FAULT ||
	       w->cycle.state == STATE_IDLE;
}

/* Return: false if the job has ended before. */
static bool turns_stop(struct world *w, const struct turns *t)
{
	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	while (abs(w->axis[INTERP_X].at) < WALL && !is_over(w))
		period(w);
	for (double s = 0; !is_over(w) && (t->by == BY_FOLLOWING ||
	     s < t->wait_s); s += (double)w->k.period_ns * 1e-9)
		period(w);
	if (is_over(w) && w->cycle.state != STATE_FAULT)
		return false;
	if (t->by == BY_KILL && w->cycle.state != STATE_FAULT) {
		killed(w);
		return true;
	}
	w->estop = t->by == BY_ESTOP;
	run_for(w, 0.5);
	w->estop = false;
	run_for(w, 0.3);
	assert_int_equal(ask(w, CYCLE_RESET, 0), ANSWER_DONE);
	run_for(w, 0.3);
	return true;
}

/* It was blocked when it was stopped.  A motor that has lost pulses at one turn
 * is free at the next. */
static bool was_blocked(const struct world *w, const struct turns *t)
{
	const int32_t at = t->side * w->axis[INTERP_X].at;
	const int32_t path = t->side * w->cycle.cursor.pos[INTERP_X];

	return abs(path - at) > NEAR && (t->lines ? path : at) > WALL - 3;
}

static bool turns_pass(const struct turns *t, int n)
{
	bool good = true;
	struct world w;

	turns_open(&w, t);
	if (turns_stop(&w, t) && was_blocked(&w, t)) {
		const int32_t at = w.axis[INTERP_X].at;
		const int32_t path = w.cycle.cursor.pos[INTERP_X];

		look_anew(&w);
		assert_int_equal(ask(&w, CYCLE_RETRACT, free_mm(t) / 2),
				 ANSWER_DONE);
		stands(&w);
		good = w.axis[INTERP_X].pressed <= 2 &&
		       w.axis[INTERP_X].at == w.cycle.out.target[INTERP_X] &&
		       w.cycle.state == STATE_HOLD;
		if (!good) {
			turns_print(t, n);
			print_message("stood at %d, path at %d; pressed %d, at "
				      "%d, target %d, fault %d\n", at, path,
				      w.axis[INTERP_X].pressed,
				      w.axis[INTERP_X].at,
				      w.cycle.out.target[INTERP_X],
				      (int)w.cycle.fault.first);
		}
	}
	world_free(&w);
	return good;
}

static void a_retract_leads_away_from_what_blocked_an_axis(void **st)
{
	int bad = 0;

	(void)st;
	state = seed_take();
	for (int i = 0; i < SEED_ROUNDS(WORLDS); i++) {
		const struct turns t = turns_make();

		bad += !turns_pass(&t, i);
	}
	assert_int_equal(bad, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_retract_leads_away_from_what_blocked_an_axis),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
