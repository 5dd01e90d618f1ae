/* SPDX-License-Identifier: Apache-2.0 */
/* hops.c - which segment comes next that is slower, or softer */
#include "speed/pass.h"

#include <string.h>

#define HOP_MAX		UINT16_MAX

/* -- The next slower ------------------------------------------------------- */

/*
 * A hop leads from a segment to the next one that is slower.  What is between
 * was skipped by the hops of faster ones.  Most segments are as fast as their
 * neighbour: then its hop leads to the same place.
 */
static inline uint16_t hop_of(uint32_t hops)
{
	return (uint16_t)(hops < HOP_MAX ? hops : HOP_MAX);
}

/* From the neighbour of one with this hop. */
static inline uint16_t hop_on(uint16_t hop)
{
	return (uint16_t)(hop + (hop < HOP_MAX));
}

/* Actions stop the way.  So may a cut after what is positioned, and, for the
 * gap servo, what is positioned after a cut. */
static bool may_stop(const struct interp_seg *s)
{
	return s->kind >= INTERP_BEGIN ||
	       (s[-1].kind < INTERP_BEGIN &&
		(s->flags ^ s[-1].flags) & INTERP_SEG_UNCUT);
}

/* Entered over the node before it. */
static inline float into(const struct interp_seg *s)
{
	return pass_least(s[-1].node_mm_s, s->feed_max_mm_s);
}

static inline float feed_of(const struct interp_seg *s)
{
	return s->kind >= INTERP_BEGIN || s->flags & INTERP_SEG_RAPID ?
	       INFINITY : s->feed_mm_s;
}

/* @m: no segment before that one is slower. */
static inline uint16_t hop_ahead(const struct interp_seg *s, float v,
				 uint32_t m)
{
	while (m < HOP_MAX && !may_stop(s + m) && into(s + m) >= v)
		m += s[m].slower_ahead;
	return hop_of(m);
}

/* @left: segments up to the last one. */
static inline uint16_t hop_feed(const struct interp_seg *s, uint32_t left)
{
	const float v = feed_of(s);
	uint32_t m = 1;

	while (m < HOP_MAX && m < left && feed_of(s + m) >= v)
		m = s[m].slower_feed ? m + s[m].slower_feed : left;
	return m >= left ? 0 : hop_of(m);
}

static inline float back_into(const struct interp_seg *s)
{
	return s->kind >= INTERP_BEGIN ? INFINITY :
	       pass_least(s->node_mm_s, s->feed_max_mm_s);
}

/* @i: segments before it; the first two have hops already. */
static inline uint16_t hop_behind(const struct interp_seg *s, uint32_t i,
				  float v, float before)
{
	uint32_t m = 1u + s[-1].slower_behind;

	if (before < v)
		return 1;
	if (before == v)
		return hop_of(m);
	while (m < HOP_MAX && m < i && back_into(s - m) >= v)
		m += s[-(int64_t)m].slower_behind;
	return hop_of(m);
}

/* -- The next softer ------------------------------------------------------- */

static inline bool is_softer(const struct interp_seg *s,
			     const struct interp_seg *than)
{
	return s->a_mm_s2 < than->a_mm_s2 || s->j_mm_s3 < than->j_mm_s3;
}

static inline bool is_as_soft(const struct interp_seg *s,
			      const struct interp_seg *as)
{
	/* Both numbers at once: equal ones have equal bits. */
	return memcmp(&s->a_mm_s2, &as->a_mm_s2, 2 * sizeof(float)) == 0;
}

static inline bool stands(const struct interp_seg *s)
{
	return s->flags & INTERP_SEG_STAND;
}

static inline uint16_t softer_ahead(const struct interp_seg *s, uint32_t left)
{
	uint32_t m = 1;

	if (s->kind >= INTERP_BEGIN)
		return 1;
	if (s[1].kind < INTERP_BEGIN && !stands(s) &&
	    is_as_soft(s + 1, s))
		return hop_on(s[1].softer_ahead);
	while (m < left && m < HOP_MAX && s[m].kind < INTERP_BEGIN &&
	       !stands(s + m - 1) && !is_softer(s + m, s))
		m += s[m].softer_ahead;
	return hop_of(m);
}

static inline uint16_t softer_behind(const struct interp_seg *s, uint32_t i)
{
	uint32_t m = 1;

	if (!stands(s - 1) && is_as_soft(s - 1, s))
		return s[-1].softer_behind ?
		       hop_on(s[-1].softer_behind) : 0;
	while (m < i && m < HOP_MAX && !stands(s - m) && !is_softer(s - m, s))
		m = s[-(int64_t)m].softer_behind ?
		    m + s[-(int64_t)m].softer_behind : i;
	return m == i ? 0 : hop_of(m);
}

/* Are they moved over in the same way, one cut as fast as the other?  Equal
 * feeds have equal bits, too. */
static inline bool is_alike(const struct interp_seg *s,
			    const struct interp_seg *as)
{
	return s->kind < INTERP_BEGIN && as->kind < INTERP_BEGIN &&
	       s->flags == as->flags &&
	       memcmp(&s->feed_mm_s, &as->feed_mm_s, sizeof(float)) == 0;
}

/* One that is like the next one: mostly its hops lead to the same places. */
static inline void chain_alike(struct interp_seg *s, float v, float next)
{
	const uint16_t hop = s[1].slower_ahead, feed = s[1].slower_feed;

	s->slower_ahead = next < v ? 1 : next == v ? hop_on(hop) :
					 hop_ahead(s, v, 1u + hop);
	s->slower_feed = feed ? hop_on(feed) : 0;
}

static void chain_ahead(const struct pass *w)
{
	struct interp_seg *s = w->segs;
	const uint32_t end = w->end;
	float next = 0;

	s[end].slower_ahead = s[end].slower_feed = s[end].softer_ahead = 0;
	for (uint32_t i = end; i-- > 0; ) {
		const bool moves = s[i].kind < INTERP_BEGIN;
		const float v = moves ? into(s + i) : 0;

		if (is_alike(s + i, s + i + 1)) {
			chain_alike(s + i, v, next);
		} else {
			s[i].slower_ahead = moves ? hop_ahead(s + i, v, 1) : 1;
			s[i].slower_feed = hop_feed(s + i, end - i);
		}
		s[i].softer_ahead = softer_ahead(s + i, end - i);
		next = v;
	}
}

static void chain_behind(const struct pass *w)
{
	struct interp_seg *s = w->segs;
	const uint32_t end = w->end;
	float before = back_into(s + 1);

	/* The first one is entered by none. */
	s[0].slower_behind = s[0].softer_behind = s[1].softer_behind = 0;
	s[1].slower_behind = 1;
	for (uint32_t i = 2; i <= end; i++) {
		const float v = back_into(s + i);

		s[i].slower_behind = hop_behind(s + i, i, v, before);
		s[i].softer_behind = softer_behind(s + i, i);
		before = v;
	}
}

void pass_hops(struct pass *w)
{
	chain_ahead(w);
	chain_behind(w);
}
