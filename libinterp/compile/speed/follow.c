/* SPDX-License-Identifier: Apache-2.0 */
/* follow.c - the thread that walks behind the builder */
#include "speed/follow.h"
#include "speed/pass.h"

#include "thread.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Who wants to move a table waits for no more than these. */
#define AT_ONCE		4096

struct follow {
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t more, stands;
	/* Under the lock: */
	uint32_t known;			/* segments that are whole */
	bool walks, held;
	bool all;			/* no more will come */
	bool over;			/* no more is wanted */
	/* The thread's own, while it walks: */
	struct pass pass;
	bool joined;			/* by the owner */
};

/* The walk lowers it, and would have to know it to begin anew.  Hops are
 * written at the very end, so there is room in them until then. */
static void keep_most(struct interp_seg *s)
{
	uint32_t bits;

	memcpy(&bits, &s->feed_max_mm_s, sizeof(bits));
	s->slower_ahead = (uint16_t)bits;
	s->slower_behind = (uint16_t)(bits >> 16);
}

static void restore_most(struct interp_seg *s)
{
	const uint32_t bits = s->slower_ahead |
			      (uint32_t)s->slower_behind << 16;

	memcpy(&s->feed_max_mm_s, &bits, sizeof(bits));
	if (s->flags & INTERP_SEG_RAPID)
		s->feed_mm_s = s->feed_max_mm_s;
}

static void restore(struct pass *w)
{
	for (uint32_t i = 1; i < w->at; i++)
		restore_most(&w->segs[i]);
}

/* Up to segment @to at most. */
static void walk(struct pass *w, uint32_t known, uint32_t to)
{
	if (to > w->at + AT_ONCE)
		to = w->at + AT_ONCE;
	for (uint32_t i = w->at; i < to; i++)
		keep_most(&w->segs[i]);
	pass_walk(w, known, to);
}

static void *follow(void *arg)
{
	struct follow *f = arg;
	struct pass *w = &f->pass;

	pthread_mutex_lock(&f->lock);
	for (;;) {
		const uint32_t known = f->known;
		const uint32_t to = f->held ? 0 : pass_seen(w, known);

		if (f->over || (f->all && to <= w->at))
			break;
		if (to <= w->at) {
			pthread_cond_wait(&f->more, &f->lock);
			continue;
		}
		f->walks = true;
		pthread_mutex_unlock(&f->lock);
		walk(w, known, to);
		pthread_mutex_lock(&f->lock);
		f->walks = false;
		pthread_cond_signal(&f->stands);
	}
	pthread_mutex_unlock(&f->lock);
	return NULL;
}

struct follow *follow_begin(const struct interp_limits *l,
			    const struct interp_program *p,
			    struct interp_seg *segs)
{
	struct follow *f = calloc(1, sizeof(*f));

	if (!f)
		return NULL;
	pass_begin(&f->pass, l, p, segs);
	pthread_mutex_init(&f->lock, NULL);
	pthread_cond_init(&f->more, NULL);
	pthread_cond_init(&f->stands, NULL);
	if (thread_start(&f->thread, &(struct thread) {
			.name = "edm-follow", .run = follow, .arg = f }) == 0)
		return f;
	f->joined = true;
	follow_stop(f);
	return NULL;
}

void follow_known(struct follow *f, uint32_t n)
{
	pthread_mutex_lock(&f->lock);
	f->known = n;
	if (!f->walks)
		pthread_cond_signal(&f->more);
	pthread_mutex_unlock(&f->lock);
}

void follow_hold(struct follow *f)
{
	pthread_mutex_lock(&f->lock);
	f->held = true;
	while (f->walks)
		pthread_cond_wait(&f->stands, &f->lock);
	pthread_mutex_unlock(&f->lock);
}

void follow_go_on(struct follow *f, struct interp_seg *segs)
{
	pthread_mutex_lock(&f->lock);
	f->held = false;
	f->pass.segs = segs;
	pthread_cond_signal(&f->more);
	pthread_mutex_unlock(&f->lock);
}

static void set(struct follow *f, bool *flag)
{
	pthread_mutex_lock(&f->lock);
	*flag = true;
	pthread_cond_signal(&f->more);
	pthread_mutex_unlock(&f->lock);
}

static void join(struct follow *f)
{
	pthread_join(f->thread, NULL);
	f->joined = true;
}

void follow_await(struct follow *f)
{
	set(f, &f->all);
	join(f);
}

static void forget(struct follow *f)
{
	pass_forget(&f->pass);
	pthread_cond_destroy(&f->stands);
	pthread_cond_destroy(&f->more);
	pthread_mutex_destroy(&f->lock);
	free(f);
}

void follow_write(struct follow *f, const struct interp_program *p,
		  struct interp_seg *segs, struct interp_bends *bends)
{
	pass_move(&f->pass, p, segs);
	pass_finish(&f->pass, bends);
	forget(f);
}

void follow_stop(struct follow *f)
{
	if (!f)
		return;
	if (!f->joined) {
		set(f, &f->over);
		join(f);
		restore(&f->pass);
	}
	forget(f);
}
