/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission_move.c - an axis moves as long as a person holds a key
 *
 * The key is the space bar.  A terminal repeats a key that is held, and tells
 * nothing when it is let go; so it is let go when it is not repeated.  edmd
 * stops the axis by itself when this program ends (press.c).
 */
#include "commission.h"

#include "grow.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define FIRST_S		0.7		/* until a key is repeated at first */
#define REPEAT_S	0.15		/* ... and then */
#define STAND_S		10.0		/* until an axis stands */
#define SETTLE_S	0.3		/* ... and what lags is there too */
#define GAP_S		1.0
#define PAUSE_NS	10000000
#define SAMPLES_MAX	(1 << 20)

/* -- What edmd says -------------------------------------------------------- */

const struct talk_status *tour_state(struct tour *w, const char *state,
				     double seconds)
{
	/* A service that begins anew is silent at first. */
	static const struct talk_status silent = { .utime = 0 };
	const double until_s = talk_now_s() + seconds;
	const struct talk_status *s;
	uint64_t heard;

	do {
		talk_wait(w->ctl->talk, 20);
		s = talk_status(w->ctl->talk, &heard);
	} while (!talk_interrupted() && talk_now_s() < until_s &&
		 (!s || strcmp(s->state, state) != 0));
	return s ? s : &silent;
}

static bool ask(struct tour *w, const char *verb, const char *text)
{
	struct talk_answer a;
	const int err = ctl_ask(w->ctl, &(struct talk_question) {
				.verb = verb, .text = text }, &a);

	if (err == 0)
		talk_answer_free(&a);
	return err == 0;
}

bool tour_reset(struct tour *w)
{
	return ask(w, "reset", NULL) &&
	       !strcmp(tour_state(w, "idle", 3)->state, "idle");
}

double tour_place(struct tour *w)
{
	struct shm_snapshot s;

	return shm_snapshot(w->status, &s) ?
	       s.pos[w->axis] * s.pulse_mm[w->axis] : NAN;
}

/* -- The key --------------------------------------------------------------- */

struct held {
	struct termios was;
	double last_s;			/* it came; 0: not yet */
	bool repeats, ended;
};

static void keys_raw(struct held *h)
{
	struct termios raw;

	tcgetattr(STDIN_FILENO, &h->was);
	raw = h->was;
	raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
	raw.c_cc[VMIN] = raw.c_cc[VTIME] = 0;
	tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

static bool is_held(struct held *h)
{
	char key[64];
	const ssize_t n = read(STDIN_FILENO, key, sizeof(key));
	const double now_s = talk_now_s();

	for (ssize_t i = 0; i < n; i++) {
		h->ended = h->ended || key[i] != ' ';
		h->repeats = h->last_s > 0;
		h->last_s = now_s;
	}
	return !h->ended && h->last_s > 0 &&
	       now_s - h->last_s < (h->repeats ? REPEAT_S : FIRST_S);
}

/* -- A motion -------------------------------------------------------------- */

struct motion {
	struct tour *walk;
	struct held held;
	double from_mm, mm_s;
	const struct tour_way *way;
	double begun_s;			/* 0: not yet */
	struct shm_follow follow;
	struct tour_trace *trace;
	double pulse_mm;
};

static bool keep(struct tour_trace *t, double sent, double actual)
{
	if (t->n == SAMPLES_MAX ||
	    (t->n == t->room && grow_array(&t->sent, &t->room,
					   sizeof(*t->sent))) ||
	    (t->n == t->room_actual && grow_array(&t->actual, &t->room_actual,
						  sizeof(*t->actual))))
		return false;
	t->sent[t->n] = sent;
	t->actual[t->n++] = actual;
	return true;
}

static void drain(struct motion *m)
{
	struct shm_trace r;

	while (m->trace && shm_trace_next(m->walk->status, &m->follow, &r))
		if (!keep(m->trace, r.sent[m->walk->axis] * m->pulse_mm,
			  r.actual[m->walk->axis] * m->pulse_mm))
			return;
}

static double speed(void *arg)
{
	struct motion *m = arg;
	const double now_s = talk_now_s();

	drain(m);
	m->begun_s = m->begun_s > 0 ? m->begun_s : now_s;
	if (!(fabs(tour_place(m->walk) - m->from_mm) < fabs(m->way->mm)) ||
	    (m->walk->by_hand && !is_held(&m->held)))
		return NAN;
	return m->mm_s * (1 + WAVE * sin(2 * M_PI * m->way->hz *
					 (now_s - m->begun_s)));
}

static bool say_go(struct tour *w, double mm, double mm_s)
{
	char word[WORD_MAX];

	if (!w->by_hand)
		return tour_choose(w, "no go", word, "%c moves by %+g at %.3g "
				   "a second", tour_letter(w), mm, mm_s) &&
		       strcmp(word, "go") == 0;
	fprintf(stderr, "%c moves by %+g at %.3g a second as long as you hold "
		"the space bar; another key: not\n", tour_letter(w), mm, mm_s);
	return true;
}

static void wait_key(struct motion *m)
{
	const struct timespec pause = { .tv_nsec = PAUSE_NS };

	while (!talk_interrupted() && !m->held.ended && !is_held(&m->held))
		nanosleep(&pause, NULL);
}

static double stand(struct motion *m)
{
	const double until_s = talk_now_s() + STAND_S;
	const struct timespec pause = { .tv_nsec = PAUSE_NS };
	double moved_s = talk_now_s();
	struct shm_snapshot s;

	do {
		nanosleep(&pause, NULL);
		drain(m);
		if (!shm_snapshot(m->walk->status, &s))
			break;
		if (s.state != SHM_IDLE && s.state != SHM_FAULT)
			moved_s = talk_now_s();
	} while (talk_now_s() < fmin(until_s, moved_s +
				     (m->trace ? SETTLE_S : 0)));
	return tour_place(m->walk) - m->from_mm;
}

static void begin(struct motion *m)
{
	struct shm_snapshot s;

	if (!shm_snapshot(m->walk->status, &s))
		return;
	m->from_mm = tour_place(m->walk);
	m->pulse_mm = s.pulse_mm[m->walk->axis];
	m->follow.next = __atomic_load_n(&m->walk->status->trace_next,
					 __ATOMIC_ACQUIRE);
	if (m->trace)
		m->trace->period_s = (double)s.period_ns * 1e-9;
}

double tour_go(struct tour *w, const struct tour_way *way,
	       struct tour_trace *t)
{
	const char axis[2] = { tour_letter(w), '\0' };
	const double v = w->config.axes.axis[w->axis].v_max_mm_s * way->share;
	struct motion m = { .walk = w, .way = way, .trace = t,
			    .mm_s = copysign(v, way->mm) };
	char said[200] = "";
	char ill[SAID_CHARS];
	const struct talk_status *s;
	double mm;
	int err;

	if (!say_go(w, way->mm, v))
		return NAN;
	begin(&m);
	if (w->by_hand) {
		keys_raw(&m.held);
		wait_key(&m);
	}
	err = m.held.ended ? 0 : ctl_press(w->ctl, &(struct ctl_press) {
		.axis = axis, .mm_s = speed, .arg = &m }, said, sizeof(said));
	mm = stand(&m);
	if (w->by_hand)
		tcsetattr(STDIN_FILENO, TCSAFLUSH, &m.held.was);
	s = tour_state(w, "idle", 1);
	if (strcmp(s->state, "fault") == 0) {
		tour_ill(w, ill);
		if (!w->fault_wanted || strcmp(s->fault, "limit-switch") != 0)
			tour_wrong(w, "%c moved by %.3f, then fault %s%s%s",
				   *axis, mm, s->fault, *ill ? "; " : "", ill);
	} else if (err) {
		tour_wrong(w, "%c does not move: %s", *axis, said);
	}
	return err || strcmp(s->state, "fault") == 0 ? NAN : mm;
}

double tour_move(struct tour *w, double mm, double share,
		 struct tour_trace *t)
{
	return tour_go(w, &(struct tour_way) { mm, share, 0 }, t);
}

/* It is in the state home from the answer on. */
static bool homes_held(struct motion *m, const char *axis)
{
	bool held = ask(m->walk, "home", axis);
	struct shm_snapshot s;

	talk_wait(m->walk->ctl->talk, 50);
	while (held && shm_snapshot(m->walk->status, &s) &&
	       s.state == SHM_HOME) {
		talk_wait(m->walk->ctl->talk, 10);
		held = is_held(&m->held) && !talk_interrupted();
	}
	if (!held)
		ask(m->walk, "hold", NULL);
	stand(m);
	return held && shm_snapshot(m->walk->status, &s) &&
	       s.state == SHM_IDLE;
}

bool tour_home_held(struct tour *w)
{
	const char axis[2] = { tour_letter(w), '\0' };
	struct motion m = { .walk = w };
	bool done;

	fprintf(stderr, "%s homes as long as you hold the space bar; another "
		"key: not\n", axis);
	keys_raw(&m.held);
	wait_key(&m);
	done = !m.held.ended && homes_held(&m, axis);
	tcsetattr(STDIN_FILENO, TCSAFLUSH, &m.held.was);
	return done;
}

/* -- The gap --------------------------------------------------------------- */

bool tour_gap(struct tour *w, double *ret_v, double *ret_sigma_v)
{
	const struct timespec pause = { .tv_nsec = PAUSE_NS };
	const double until_s = talk_now_s() + GAP_S;
	struct shm_follow f = { .next = __atomic_load_n(
		&w->status->trace_next, __ATOMIC_ACQUIRE) };
	double sum = 0, square = 0;
	struct shm_trace r;
	size_t n = 0;

	while (talk_now_s() < until_s) {
		nanosleep(&pause, NULL);
		for (; shm_trace_next(w->status, &f, &r); n++) {
			sum += r.gap_v;
			square += r.gap_v * r.gap_v;
		}
	}
	if (n == 0)
		return false;
	*ret_v = sum / (double)n;
	*ret_sigma_v = sqrt(fmax(0, square / (double)n - *ret_v * *ret_v));
	return true;
}
