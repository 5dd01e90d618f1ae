/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scope.c - how far an axis is behind its targets, from the trace
 *
 * It follows the trace in edmd's shared memory, on the machine's own host.  A
 * drive answers with the place that one of its last targets led to, so its
 * following error is the distance to the nearest of them.
 */
#include "ctl.h"
#include "shm.h"

#include "interp/axis.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>

#define TARGETS		3		/* that a place may belong to */
#define PAUSE_NS	20000000
#define LINE_S		1.0

struct sums {
	uint64_t n;
	double most_um, square_um2, most_mm_s;
};

struct scope {
	const struct shm_status *status;
	struct shm_follow trace;
	int axis;
	double pulse_mm, period_s;
	int32_t sent[TARGETS], was;
	uint64_t seen;			/* records */
	double place_mm;
	struct sums line, all;
};

static double behind_um(const struct scope *s, int32_t actual)
{
	double low = INFINITY, high = -INFINITY;

	for (int i = 0; i < TARGETS; i++) {
		const double off = (double)s->sent[i] - actual;

		low = fmin(low, off);
		high = fmax(high, off);
	}
	return 1e3 * s->pulse_mm * (low > 0 ? low : high < 0 ? -high : 0);
}

static void add(struct sums *to, double um, double mm_s)
{
	to->n++;
	to->most_um = fmax(to->most_um, um);
	to->square_um2 += um * um;
	to->most_mm_s = fmax(to->most_mm_s, mm_s);
}

static void take(struct scope *s, const struct shm_trace *t)
{
	const int32_t actual = t->actual[s->axis];
	const double mm_s = fabs((double)actual - s->was) * s->pulse_mm /
			    s->period_s;
	double um;

	memmove(s->sent + 1, s->sent, sizeof(s->sent) - sizeof(*s->sent));
	s->sent[0] = t->sent[s->axis];
	s->place_mm = actual * s->pulse_mm;
	s->was = actual;
	if (s->seen++ < TARGETS)
		return;
	um = behind_um(s, actual);
	add(&s->line, um, mm_s);
	add(&s->all, um, mm_s);
}

static double rms_um(const struct sums *s)
{
	return s->n ? sqrt(s->square_um2 / (double)s->n) : 0;
}

static void print_line(struct scope *s)
{
	printf("%11.4f mm  at most %9.3f mm/s  behind by %8.1f um rms, %8.1f "
	       "um at most\n", s->place_mm, s->line.most_mm_s,
	       rms_um(&s->line), s->line.most_um);
	fflush(stdout);
	s->line = (struct sums) { .n = 0 };
}

static int print_end(const struct ctl *c, struct scope *s)
{
	if (!c->json) {
		s->line = s->all;
		puts("all");
		print_line(s);
		return EX_OK;
	}
	return ctl_put_json(json_pack("{sI sf sf sf sf sI}", "cycles",
				(json_int_t)s->all.n, "place_mm", s->place_mm,
				"most_mm_s", s->all.most_mm_s,
				"rms_um", rms_um(&s->all),
				"most_um", s->all.most_um,
				"lost", (json_int_t)s->trace.lost));
}

static int follow(struct ctl *c, struct scope *s, double until_s)
{
	const struct timespec pause = { .tv_nsec = PAUSE_NS };
	double line_s = talk_now_s() + LINE_S;
	struct shm_trace t;

	while (talk_now_s() < until_s && !talk_interrupted()) {
		while (shm_trace_next(s->status, &s->trace, &t))
			take(s, &t);
		if (talk_now_s() >= line_s && !c->json) {
			print_line(s);
			line_s += LINE_S;
		}
		nanosleep(&pause, NULL);
	}
	return print_end(c, s);
}

int ctl_scope(struct ctl *c, const char *axis, const char *seconds)
{
	const char *at = strlen(axis) == 1 ?
			 strchr(INTERP_AXIS_LETTERS,
				toupper((unsigned char)*axis)) : NULL;
	struct scope s = { .seen = 0 };
	struct shm_snapshot now;
	double wait_s = INFINITY;
	int err;

	if (!at || !*axis) {
		fprintf(stderr, "edmctl: drive scope %s; an axis, one of "
			INTERP_AXIS_LETTERS "\n", axis);
		return EX_USAGE;
	}
	err = seconds ? ctl_number(c, seconds, "seconds", &wait_s) : 0;
	if (err == 0)
		err = ctl_shm_open(c, &s.status);
	if (err)
		return err;
	if (!shm_snapshot(s.status, &now))
		return ctl_unanswered(c, 0);
	s.axis = (int)(at - INTERP_AXIS_LETTERS);
	s.pulse_mm = now.pulse_mm[s.axis];
	s.period_s = (double)now.period_ns * 1e-9;
	s.trace.next = __atomic_load_n(&s.status->trace_next,
				       __ATOMIC_ACQUIRE);
	return follow(c, &s, talk_now_s() + wait_s);
}
