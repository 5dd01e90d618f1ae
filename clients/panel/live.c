/* SPDX-License-Identifier: Apache-2.0 */
/* live.c - follow the shared memory of edmd */
#include "live.h"
#include "clocks.h"
#include "values.h"

#include "config.h"
#include "faults.h"
#include "stands.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define STAND_MS	1000		/* after so long without a cycle, edmd
					 * is lost */
#define TRACES_MAX	SHM_TRACE_SLOTS	/* of one look */

struct live {
	const struct machine_config *config;
	const struct shm_status *status;
	uint32_t instance;
	struct shm_snapshot snap;
	bool heard, alive;
	int64_t moved_ms;		/* when it last saw a new cycle */
	struct shm_follow follow;
	struct values *values;
	/* The point that is being filled. */
	int64_t begun_ms;
	unsigned int n;
	double gap_sum, feed_sum;
	struct live_point filling;
	bool is_new;
	uint64_t next;			/* points written so far */
	struct live_point point[LIVE_POINTS];
};

int live_create(struct live **ret, const struct machine_config *config)
{
	struct live *l = calloc(1, sizeof(*l));

	if (!l)
		return -ENOMEM;
	l->config = config;
	l->values = values_create(config);
	if (!l->values) {
		free(l);
		return -ENOMEM;
	}
	*ret = l;
	return 0;
}

void live_destroy(struct live *l)
{
	if (!l)
		return;
	shm_close(l->status, sizeof(*l->status));
	values_destroy(l->values);
	free(l);
}

static void reopen(struct live *l)
{
	shm_close(l->status, sizeof(*l->status));
	l->status = NULL;
	if (shm_status_open(&l->status, l->config->name) < 0) {
		l->status = NULL;
		return;
	}
	l->follow = (struct shm_follow) { .next = l->status->trace_next };
}

static void begin_point(struct live *l, int64_t at_ms)
{
	l->begun_ms = at_ms;
	l->n = 0;
	l->gap_sum = l->feed_sum = 0;
}

static void spread(float range[3], double x, bool first)
{
	range[0] = first ? (float)x : fminf(range[0], (float)x);
	range[2] = first ? (float)x : fmaxf(range[2], (float)x);
}

static void add_sample(struct live *l, double gap_v, double feed_mm_s)
{
	/* A motion of rotary axes alone has no gap; JSON has no NAN. */
	gap_v = isfinite(gap_v) ? gap_v : 0;
	feed_mm_s = isfinite(feed_mm_s) ? feed_mm_s : 0;
	spread(l->filling.gap_v, gap_v, l->n == 0);
	spread(l->filling.feed_mm_s, feed_mm_s, l->n == 0);
	l->gap_sum += gap_v;
	l->feed_sum += feed_mm_s;
	l->n++;
}

static void take_traces(struct live *l)
{
	struct shm_trace t;

	for (int i = 0; i < TRACES_MAX &&
			shm_trace_next(l->status, &l->follow, &t); i++)
		add_sample(l, t.gap_v, t.feed_mm_s);
}

static void take_snapshot(struct live *l, int64_t at_ms)
{
	const uint32_t instance = l->status->head.instance;
	struct shm_snapshot s;

	if (!shm_snapshot(l->status, &s))
		return;
	if (!l->heard || instance != l->instance || s.cycle != l->snap.cycle)
		l->moved_ms = at_ms;
	l->instance = instance;
	l->snap = s;
	l->heard = true;
}

static void end_point(struct live *l)
{
	struct live_point *p = &l->filling;

	if (l->n == 0) {
		add_sample(l, 0, 0);
		l->n = 1;
	}
	p->utime_ms = clock_ms(CLOCK_REALTIME);
	p->gap_v[1] = (float)(l->gap_sum / l->n);
	p->feed_mm_s[1] = (float)(l->feed_sum / l->n);
	p->depth_mm = (float)l->snap.depth_mm;
	p->state = strcmp(live_daemon(l), "ok") == 0 ? l->snap.state : 0;
	l->point[l->next++ % LIVE_POINTS] = *p;
	l->is_new = true;
}

void live_look(struct live *l)
{
	const int64_t at_ms = clock_ms(CLOCK_MONOTONIC);

	l->is_new = false;
	l->alive = l->status && shm_alive(l->status);
	if (!l->alive) {
		reopen(l);
		l->alive = l->status && shm_alive(l->status);
	}
	if (l->status) {
		take_snapshot(l, at_ms);
		take_traces(l);
	}
	if (at_ms - l->begun_ms < LIVE_POINT_MS)
		return;
	end_point(l);
	/* Ten points a second, however late each look is; missed points are not
	 * made up for. */
	begin_point(l, at_ms - l->begun_ms < 2 * LIVE_POINT_MS ?
		    l->begun_ms + LIVE_POINT_MS : at_ms);
}

bool live_is_new_point(const struct live *l)
{
	return l->is_new;
}

const struct shm_snapshot *live_snapshot(const struct live *l)
{
	return l->heard ? &l->snap : NULL;
}

const char *live_daemon(const struct live *l)
{
	if (l->status && l->alive && l->heard)
		return clock_ms(CLOCK_MONOTONIC) - l->moved_ms > STAND_MS ?
		       "lost" : "ok";
	return l->status && l->heard ? "lost" : "absent";
}

const uint32_t *live_latency(const struct live *l)
{
	return l->status ? l->status->latency_us : NULL;
}

/* A number for people. JSON has no word for a NAN or an infinity. */
static json_t *number(double x, double step)
{
	return json_real(isfinite(x) ? round(x / step) * step : 0);
}

static void fill_places(const struct live *l, json_t *to)
{
	const struct shm_snapshot *s = &l->snap;
	json_t *pos = json_array();

	for (int i = 0; i < SHM_NAXES; i++)
		json_array_append_new(pos, number(s->pos[i] * s->pulse_mm[i],
						  1e-6));
	json_object_set_new(to, "pos", pos);
	json_object_set_new(to, "place", number(s->place_mm, 1e-5));
	json_object_set_new(to, "far", number(s->far_mm, 1e-5));
	json_object_set_new(to, "length", number(s->length_mm, 1e-5));
	json_object_set_new(to, "depth", number(s->depth_mm, 1e-5));
	json_object_set_new(to, "depthFar", number(s->depth_far_mm, 1e-5));
	json_object_set_new(to, "line", json_integer(s->line));
	json_object_set_new(to, "seg", json_integer(s->seg));
	json_object_set_new(to, "program", json_integer(s->program));
	json_object_set_new(to, "unhomed", json_integer(s->unhomed));
	json_object_set_new(to, "limit", json_integer(s->limit));
}

static void fill_sums(const struct live *l, json_t *to)
{
	const struct shm_snapshot *s = &l->snap;

	json_object_set_new(to, "jumps", json_integer(s->jumps));
	json_object_set_new(to, "retracts", json_integer(s->retracts));
	json_object_set_new(to, "shorts", json_integer(s->shorts));
	json_object_set_new(to, "overruns", json_integer(s->overruns));
	json_object_set_new(to, "lateMaxUs",
			    json_integer(s->wake_late_max_ns / 1000));
	json_object_set_new(to, "tookMaxUs",
			    json_integer(s->took_max_ns / 1000));
	json_object_set_new(to, "periodUs", json_integer(s->period_ns / 1000));
	json_object_set_new(to, "jobS",
			    number((double)s->job_cycles *
				   (double)s->period_ns / 1e9, 0.1));
}

static void fill_stand(const struct shm_snapshot *s, bool ok, json_t *to)
{
	const struct stand_row *row = stand_row(ok ? s->stand : STAND_NONE);

	json_object_set_new(to, "stand", json_string(row->name));
	json_object_set_new(to, "standOf", json_integer(s->stand_of));
	json_object_set_new(to, "standN", json_integer(s->stand_n));
	json_object_set_new(to, "asks",
			    json_boolean(row->ends == STAND_BY_CONFIRM &&
					 !s->confirmed));
}

void live_fill(struct live *l, json_t *to)
{
	const struct shm_snapshot *s = &l->snap;
	const char *daemon = live_daemon(l);
	const bool ok = strcmp(daemon, "ok") == 0;

	json_object_set_new(to, "daemon", json_string(daemon));
	json_object_set_new(to, "state", json_string(ok ?
			    shm_state_name(s->state) : "unknown"));
	json_object_set_new(to, "fault", json_string(fault_name(s->fault)));
	json_object_set_new(to, "outcome",
			    json_string(shm_outcome_name(s->outcome)));
	json_object_set_new(to, "loaded", json_boolean(s->loaded));
	json_object_set_new(to, "power", json_boolean(ok && s->power));
	json_object_set_new(to, "pump", json_boolean(ok && s->pump));
	json_object_set_new(to, "negative", json_boolean(s->negative));
	json_object_set_new(to, "gap", number(ok ? s->gap_v : 0, 1e-3));
	json_object_set_new(to, "feed", number(ok ? s->feed_mm_s : 0, 1e-6));
	json_object_set_new(to, "override", number(s->override, 1e-4));
	fill_stand(s, ok, to);
	fill_places(l, to);
	fill_sums(l, to);
	values_fill(l->values, l->status, s, to);
}

static json_t *row(const struct live_point *p)
{
	return json_pack("[I,f,f,f,f,f,f,f,i]", (json_int_t)p->utime_ms,
			 (double)p->gap_v[0], (double)p->gap_v[1],
			 (double)p->gap_v[2], (double)p->feed_mm_s[0],
			 (double)p->feed_mm_s[1], (double)p->feed_mm_s[2],
			 (double)p->depth_mm, (int)p->state);
}

json_t *live_last_point(const struct live *l)
{
	return l->next ? row(&l->point[(l->next - 1) % LIVE_POINTS]) :
			 json_null();
}

/* Make one point of the points @from up to @to. */
static json_t *draw_together(const struct live *l, uint64_t from, uint64_t to)
{
	struct live_point p = l->point[from % LIVE_POINTS];
	double gap = 0, feed = 0;

	for (uint64_t i = from; i < to; i++) {
		const struct live_point *q = &l->point[i % LIVE_POINTS];

		p.gap_v[0] = fminf(p.gap_v[0], q->gap_v[0]);
		p.gap_v[2] = fmaxf(p.gap_v[2], q->gap_v[2]);
		p.feed_mm_s[0] = fminf(p.feed_mm_s[0], q->feed_mm_s[0]);
		p.feed_mm_s[2] = fmaxf(p.feed_mm_s[2], q->feed_mm_s[2]);
		gap += (double)q->gap_v[1];
		feed += (double)q->feed_mm_s[1];
		p.utime_ms = q->utime_ms;
		p.depth_mm = q->depth_mm;
		p.state = q->state;
	}
	p.gap_v[1] = (float)(gap / (double)(to - from));
	p.feed_mm_s[1] = (float)(feed / (double)(to - from));
	return row(&p);
}

json_t *live_history(const struct live *l, double seconds, int points)
{
	const double asked = seconds * 1000 / LIVE_POINT_MS;
	uint64_t n = l->next < LIVE_POINTS ? l->next : LIVE_POINTS, each;
	json_t *rows = json_array();

	if (asked < (double)n)
		n = asked < 1 ? 1 : (uint64_t)asked;
	each = (n + (uint64_t)points - 1) / (uint64_t)points;
	for (uint64_t i = l->next - n; each && i < l->next; i += each)
		json_array_append_new(rows, draw_together(l, i,
			i + each < l->next ? i + each : l->next));
	return rows;
}
