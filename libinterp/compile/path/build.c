/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build.c - puts a program together
 *
 * Tables grow by doubling.  A node gets a column for an axis when the axis
 * first moves.
 */
#include "path/builder.h"
#include "path/build_arc.h"
#include "path/build_bits.h"
#include "path/build_pair.h"
#include "path/build_rule.h"
#include "pulse/pulse.h"
#include "interp/smaller.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/*
 * A table that a short program does not fill is small.  Its next size is that
 * of some thousand lines, so that what is in it is hardly ever copied; pages
 * that nobody writes to take no memory.
 */
#define FIRST_ROOM	64		/* elements */
#define NEXT_BYTES	(1u << 20)

/* More than glibc has in its heap, whatever was freed before: so it grows
 * without a copy. */
#define APART_BYTES	(33u << 20)
/* Memory of somebody else is taken as it grows, whether it is written to or
 * not. */
#define MORE_BYTES	(16u << 20)
/* If there is not so much, it is taken in pieces of this, to the last one. */
#define LEAST_BYTES	(64u << 10)

#define ORIGINS_BACK	32		/* so many are looked at for an equal
					 * one */

static size_t next_bytes(const struct table *t)
{
	const size_t bytes = t->room * t->size;

	if (bytes < NEXT_BYTES / 2)
		return NEXT_BYTES;
	if (t->memory)
		return bytes + (bytes < MORE_BYTES ? bytes : MORE_BYTES);
	return bytes < APART_BYTES / 2 ? APART_BYTES : 2 * bytes;
}

static size_t next_room(const struct table *t)
{
	return t->room ? next_bytes(t) / t->size : FIRST_ROOM;
}

static char *memory_of(const struct table *t)
{
	return t->at ? (char *)t->at - t->lead : NULL;
}

int build_table_size(struct table *t, size_t bytes)
{
	char *at = memory_of(t);

	at = t->memory ? t->memory->grow(t->memory->arg, at, bytes) :
			 realloc(at, bytes);
	if (!at)
		return -ENOMEM;
	t->at = at + t->lead;
	return 0;
}

static int table_grow(struct table *t, size_t room)
{
	const int err = build_table_size(t, t->lead + room * t->size);

	if (err == 0)
		t->room = room;
	return err;
}

int build_table_room(struct table *t, size_t n)
{
	while (t->room < t->n + n) {
		const size_t most = next_room(t);
		const size_t least = t->room + LEAST_BYTES / t->size;

		if (table_grow(t, most) < 0 &&
		    (least >= most || table_grow(t, least) < 0))
			return -ENOMEM;
	}
	return 0;
}

void build_table_free(struct table *t)
{
	if (!t->memory)
		free(memory_of(t));
	t->at = NULL;
	t->n = t->room = 0;
}

static int64_t *nodes_of(const struct interp_build *b)
{
	return b->nodes.at;
}

static inline int seg_room(struct interp_build *b)
{
	return b->segs.n == b->segs.room ? build_segs_room(b) : 0;
}

/* There is room. */
static inline struct interp_seg *seg_add(struct interp_build *b)
{
	return (struct interp_seg *)b->segs.at + b->segs.n++;
}

/* Append the place where the path stands as a node. */
static int node_add(struct interp_build *b)
{
	struct table *t = &b->nodes;
	const uint32_t naxes = b->naxes;
	const size_t n = t->n;
	int64_t *at;

	if (t->room - n < naxes && build_table_room(t, naxes) < 0)
		return -ENOMEM;
	/* There may be no axis yet, and then no table either. */
	at = nodes_of(b);
	for (uint32_t j = 0; j < naxes; j++)
		at[n + j] = b->here[b->column[j]];
	t->n = n + naxes;
	return 0;
}

/* Give axis @axis a column.  Every node so far gets the axis's start place. */
static int column_add(struct interp_build *b, uint32_t axis)
{
	const size_t rows = b->segs.n + 1;
	const uint32_t from = b->naxes, to = b->naxes + 1;
	int64_t *at;

	if (build_table_room(&b->nodes, rows * to - b->nodes.n) < 0)
		return -ENOMEM;
	at = nodes_of(b);
	for (size_t i = rows; i-- > 0; ) {
		memmove(at + i * to, at + i * from, from * sizeof(*at));
		at[i * to + from] = b->first[axis];
	}
	b->nodes.n = rows * to;
	b->column[from] = (uint8_t)axis;
	b->naxes = to;
	b->columns |= 1u << axis;
	return 0;
}

struct interp_build *interp_build_create(const struct interp_build_options *o)
{
	struct interp_build *b = calloc(1, sizeof(*b));
	struct interp_seg *begin;
	struct interp_cond *none;
	struct interp_escape *path;

	if (!b)
		return NULL;
	b->o = *o;
	if (b->o.walked_max == 0)
		b->o.walked_max = INTERP_BUILD_WALKED_MAX;
	b->how = pulse_strategy(o->strategy);
	b->segs.size = sizeof(struct interp_seg);
	b->segs.lead = BUILD_SEGS_AT;
	b->segs.memory = o->memory;
	b->nodes.size = sizeof(int64_t);
	b->arcs.size = sizeof(struct interp_arc);
	b->conds.size = sizeof(struct interp_cond);
	b->escapes.size = sizeof(struct interp_escape);
	b->couples.size = sizeof(struct interp_couple);
	b->bits.size = sizeof(uint64_t);
	b->curves.size = sizeof(struct interp_curve);
	b->pieces.size = sizeof(struct interp_piece);
	b->stops.size = sizeof(struct interp_nurbs_stop);
	b->numbers.size = sizeof(double);
	b->runs.size = sizeof(int32_t);
	b->origins.size = b->known.size = sizeof(struct interp_origin);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &o->machine->axis[i];

		b->sub_mm[i] = INTERP_SUB / l->pulse_mm;
		b->v_max_mm_s[i] = l->v_max_mm_s;
		b->above_mm[i] = o->machine->present & 1u << i ?
				 l->travel_min_mm + l->pulse_mm : INFINITY;
		b->below_mm[i] = l->travel_max_mm - l->pulse_mm;
		b->here_mm[i] = o->start_mm[i];
		b->here[i] = b->first[i] =
			llround(o->start_mm[i] * b->sub_mm[i]);
	}
	b->lift_axis = -1;
	b->descent.axis = -1;
	begin = seg_room(b) < 0 ? NULL : seg_add(b);
	none = build_table_add(&b->conds);
	path = build_table_add(&b->escapes);
	if (!begin || !none || !path) {
		interp_build_destroy(b);
		return NULL;
	}
	*begin = (struct interp_seg) { .kind = INTERP_BEGIN };
	*none = (struct interp_cond) { .letter = 0 };
	interp_tech_clear(&none->tech);
	*path = (struct interp_escape) { 0 };
	return b;
}

void interp_build_destroy(struct interp_build *b)
{
	if (!b)
		return;
	build_table_free(&b->segs);
	free(b->nodes.at);
	free(b->arcs.at);
	free(b->conds.at);
	free(b->escapes.at);
	free(b->couples.at);
	free(b->bits.at);
	free(b->curves.at);
	free(b->pieces.at);
	free(b->stops.at);
	free(b->numbers.at);
	free(b->fit.end_mm);
	free(b->fit.lines);
	free(b->runs.at);
	free(b->origins.at);
	free(b->known.at);
	free(b);
}

const double *interp_build_here(const struct interp_build *b)
{
	return b->fit.n ? b->fit.end_mm + (b->fit.n - 1) * INTERP_NAXES :
			  b->here_mm;
}

/* -- Checks ------------------------------------------------------------- */

/* Where what comes counts from along @axis alone; NULL: places of the machine,
 * or the axes of the work are not those of the machine. */
static const struct interp_origin *counts_from(const struct interp_build *b,
					       int axis)
{
	const struct interp_origin *o = b->known.at;

	if (!b->counts || b->counts > b->known.n)
		return NULL;
	o += b->counts - 1;
	return o->mm[axis] != 0 && o->turn_deg == 0 && !o->mirrored ? o : NULL;
}

int build_refuse_travel(const struct interp_build *b, int axis, double at_mm,
			struct interp_diag *diag)
{
	const struct interp_axis_limits *l = &b->o.machine->axis[axis];
	const struct interp_origin *o = counts_from(b, axis);
	const char letter = INTERP_AXIS_LETTERS[axis];
	const double from_mm = o ? o->mm[axis] : 0;

	if (!(b->o.machine->present & 1u << axis)) {
		return interp_diag_say(diag, "the machine has no axis %c; a "
				       "program for the axes it has", letter);
	}
	if (!o)
		return interp_diag_say(diag, "%c %.4f is beyond the travel; %c "
				       "from %g to %g in machine coordinates",
				       letter, at_mm, letter, l->travel_min_mm,
				       l->travel_max_mm);
	return interp_diag_say(diag, "%c %.4f, which is %.4f in machine "
			       "coordinates, is beyond the travel; %c from %g "
			       "to %g as the work counts, %g to %g in machine "
			       "coordinates", letter, at_mm - from_mm, at_mm,
			       letter, l->travel_min_mm - from_mm,
			       l->travel_max_mm - from_mm, l->travel_min_mm,
			       l->travel_max_mm);
}

static inline bool is_inside(const struct interp_build *b, int axis,
			     double at_mm)
{
	return at_mm > b->above_mm[axis] && at_mm < b->below_mm[axis];
}

static inline int64_t sub_of(const struct interp_build *b, int axis,
			     double at_mm)
{
	const double s = at_mm * b->sub_mm[axis];

	return (int64_t)(s + copysign(0.5, s));
}

void build_travel(const struct interp_build *b, int axis, double ret[2])
{
	const struct interp_axis_limits *l = &b->o.machine->axis[axis];
	const bool loose = b->loose & 1u << axis;

	ret[0] = loose ? -INFINITY :
			 ceil(l->travel_min_mm / l->pulse_mm - 1e-6);
	ret[1] = loose ? INFINITY :
			 floor(l->travel_max_mm / l->pulse_mm + 1e-6);
}

/* Checked in pulses, as the cycle does it: the last pulses inside the
 * limits. */
bool build_axis_ok(const struct interp_build *b, int axis, double at_mm)
{
	const struct interp_machine *m = b->o.machine;
	double at, ends[2];

	if (is_inside(b, axis, at_mm))
		return true;
	at = at_mm / m->axis[axis].pulse_mm;
	if (!(fabs(at) < INTERP_PULSES_MAX))
		return false;
	at = interp_round_sub(sub_of(b, axis, at_mm));
	build_travel(b, axis, ends);
	return m->present & 1u << axis && at >= ends[0] && at <= ends[1];
}

/* -- Segments ------------------------------------------------------------ */

/* The number of the condition of @w; it is added if it is new. */
static int cond_of(struct interp_build *b, const struct interp_build_word *w)
{
	struct interp_cond *c = b->conds.at;
	struct interp_tech tech;

	interp_tech_clear(&tech);
	if (w->tech)
		tech = *w->tech;
	for (size_t i = 0; i < b->conds.n; i++) {
		if (c[i].letter == w->cond_letter &&
		    c[i].number == w->cond_number &&
		    memcmp(&c[i].tech, &tech, sizeof(tech)) == 0)
			return (int)i;
	}
	if (b->conds.n > UINT16_MAX)
		return -ENOSPC;
	c = build_table_add(&b->conds);
	if (!c)
		return -ENOMEM;
	*c = (struct interp_cond) { .letter = w->cond_letter,
				    .number = w->cond_number,
				    .tech = tech };
	return (int)b->conds.n - 1;
}

/* From here on, that of @w is in force. */
static int change_cond(struct interp_build *b,
		       const struct interp_build_word *w,
		       struct interp_diag *diag)
{
	const int cond = cond_of(b, w);

	if (cond == -ENOSPC) {
		return interp_diag_say(diag, "more than %d different "
				       "conditions; fewer of them", UINT16_MAX);
	}
	if (cond < 0)
		return cond;
	b->cond = (uint16_t)cond;
	b->cond_letter = w->cond_letter;
	b->cond_number = w->cond_number;
	b->tech = w->tech;
	return 0;
}

/* From this segment on, that of @w counts. */
static int change_origin(struct interp_build *b,
			 const struct interp_build_word *w)
{
	const struct interp_origin *known = b->known.at;
	struct interp_origin *o;

	if (!w->origin || w->origin > b->known.n)
		return 0;
	o = build_table_add(&b->origins);
	if (!o)
		return -ENOMEM;
	*o = known[w->origin - 1];
	o->seg = (uint32_t)b->segs.n;
	b->origin = w->origin;
	return 0;
}

uint32_t interp_build_origin(struct interp_build *b,
			     const struct interp_origin *o)
{
	struct interp_origin is = *o, *known = b->known.at;
	const size_t n = b->known.n;

	is.seg = 0;
	for (size_t i = n; i-- > 0 && i + ORIGINS_BACK >= n;)
		if (memcmp(&known[i], &is, sizeof(is)) == 0)
			return b->counts = (uint32_t)i + 1;
	if (n >= INTERP_ORIGINS_MAX)
		return INTERP_ORIGINS_MAX;
	if (n == INTERP_ORIGINS_MAX - 1)
		is.work = INTERP_ORIGIN_UNTOLD;
	known = build_table_add(&b->known);
	if (!known)
		return 0;
	*known = is;
	return b->counts = (uint32_t)b->known.n;
}

/* Make room for a segment, and append its last node. */
static inline int seg_begin(struct interp_build *b,
			    const struct interp_build_word *w,
			    struct interp_diag *diag)
{
	const bool same = w->cond_letter == b->cond_letter &&
			  w->cond_number == b->cond_number &&
			  w->tech == b->tech;
	int err = same ? 0 : change_cond(b, w, diag);

	if (w->origin != b->origin && err == 0)
		err = change_origin(b, w);
	if (err < 0)
		return err;
	return seg_room(b) < 0 || node_add(b) < 0 ? -ENOMEM : 0;
}

/* What all segments have; only then the path is longer. */
static inline void seg_end(struct interp_build *b, struct interp_seg *seg,
			   const struct interp_build_word *w)
{
	seg->cond = b->cond;
	seg->line = w->line;
	seg->s_mm = b->length_mm;
	seg->escape = b->stand_escape;
	if (b->off && seg->kind < INTERP_BEGIN)
		seg->flags |= INTERP_SEG_OFF;
	b->length_mm += seg->length_mm;
}

int build_seg_finish(struct interp_build *b, struct interp_seg *seg,
		     const struct interp_build_word *w,
		     struct interp_diag *diag)
{
	const int err = seg_begin(b, w, diag);

	if (err < 0)
		return err;
	seg_end(b, seg, w);
	*seg_add(b) = *seg;
	return 0;
}

int build_columns(struct interp_build *b, uint32_t moved)
{
	moved &= ~b->columns;
	for (uint32_t i = 0; moved; i++, moved >>= 1) {
		if (moved & 1 && column_add(b, i) < 0)
			return -ENOMEM;
	}
	return 0;
}

void build_seg_feed(struct interp_seg *seg, const struct interp_build_word *w,
		    double feed_max_mm_s)
{
	seg->flags = (w->rapid ? INTERP_SEG_RAPID : 0) |
		     (w->out ? INTERP_SEG_OUT : 0) | w->ends;
	seg->feed_max_mm_s = (float)feed_max_mm_s;
	seg->feed_mm_s = w->rapid ? seg->feed_max_mm_s : (float)w->feed_mm_s;
}

/* As program.h says; and what F is along. */
static inline double length_of(const double d[INTERP_NAXES], uint32_t moved,
			       double *ret_fed_mm)
{
	const uint32_t xyz = 1u << INTERP_X | 1u << INTERP_Y | 1u << INTERP_Z;
	const double xyz2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
	double uv2, abc2;

	*ret_fed_mm = sqrt(xyz2);
	if (!(moved & ~xyz))
		return *ret_fed_mm;
	uv2 = d[INTERP_U] * d[INTERP_U] + d[INTERP_V] * d[INTERP_V];
	abc2 = d[INTERP_A] * d[INTERP_A] + d[INTERP_B] * d[INTERP_B] +
	       d[INTERP_C] * d[INTERP_C];
	if (!(moved & xyz))
		*ret_fed_mm = sqrt(uv2 > 0 ? uv2 : abc2);
	if (build_counts(xyz2, larger(uv2, abc2)))
		return sqrt(xyz2);
	return sqrt(build_counts(uv2, abc2) ? uv2 : abc2);
}

/* Two numbers, and what a comparison says of each: all bits, or none. */
typedef double two __attribute__((vector_size(16)));
typedef int64_t two_bits __attribute__((vector_size(16)));

/* A bit for each axis whose places differ. */
static inline uint32_t other_axes(const double a_mm[INTERP_NAXES],
				  const double b_mm[INTERP_NAXES])
{
	two_bits axes = { 0 };

	for (int i = 0; i < INTERP_NAXES; i += 2) {
		const two_bits bit = { 1 << i, 2 << i };
		two a, b;

		memcpy(&a, a_mm + i, sizeof(a));
		memcpy(&b, b_mm + i, sizeof(b));
		axes |= (a != b) & bit;
	}
	return (uint32_t)(axes[0] | axes[1]);
}

double interp_build_fed_mm(const struct interp_build *b,
			   const double from_mm[INTERP_NAXES],
			   const double to_mm[INTERP_NAXES])
{
	double d[INTERP_NAXES], fed;
	uint32_t moved = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const int64_t len = sub_of(b, i, to_mm[i]) -
				    sub_of(b, i, from_mm[i]);

		d[i] = (double)len / b->sub_mm[i];
		moved |= (uint32_t)(len != 0) << i;
	}
	length_of(d, moved, &fed);
	return fed;
}

static inline int measure(const struct interp_build *b,
			  const double end_mm[INTERP_NAXES],
			  int64_t to[INTERP_NAXES], struct build_measure *ret,
			  struct interp_diag *diag)
{
	double d[INTERP_NAXES] = { 0 }, seconds = 0;
	uint32_t moved = other_axes(end_mm, b->here_mm);
	int64_t longest = 0;

	memcpy(to, b->here, sizeof(b->here));
	for (uint32_t left = moved; left; left &= left - 1) {
		const int i = __builtin_ctz(left);
		const double at = end_mm[i];
		int64_t len;

		if (!is_inside(b, i, at) && !build_axis_ok(b, i, at)) {
			build_refuse_travel(b, i, at, diag);
			return -EINVAL;
		}
		to[i] = sub_of(b, i, at);
		len = to[i] - b->here[i];
		if (len == 0) {
			moved &= ~(1u << i);
			continue;
		}
		d[i] = (double)len / b->sub_mm[i];
		seconds = larger(fabs(d[i]) / b->v_max_mm_s[i], seconds);
		len = len < 0 ? -len : len;
		longest = len > longest ? len : longest;
	}
	*ret = (struct build_measure) {
		.moved = moved, .seconds = seconds, .longest = longest,
	};
	ret->length_mm = length_of(d, moved, &ret->fed_mm);
	return 0;
}

int build_measure(const struct interp_build *b,
		  const double end_mm[INTERP_NAXES], int64_t to[INTERP_NAXES],
		  struct build_measure *ret, struct interp_diag *diag)
{
	return measure(b, end_mm, to, ret, diag);
}

int build_measure_next(struct interp_build *b,
		       const double end_mm[INTERP_NAXES],
		       int64_t to[INTERP_NAXES], struct build_measure *ret,
		       struct interp_diag *diag)
{
	const int err = interp_build_flush(b, diag);

	return err < 0 ? err : build_measure(b, end_mm, to, ret, diag);
}

void build_mm(const struct interp_build *b, uint32_t axes,
	      const int64_t at[INTERP_NAXES], double ret_mm[INTERP_NAXES])
{
	for (; axes; axes &= axes - 1) {
		const int i = __builtin_ctz(axes);

		ret_mm[i] = (double)at[i] / b->sub_mm[i];
	}
}

void build_stand_at(struct interp_build *b, const double end_mm[INTERP_NAXES],
		    const int64_t to[INTERP_NAXES])
{
	memcpy(b->here_mm, end_mm, sizeof(b->here_mm));
	memcpy(b->here, to, sizeof(b->here));
}

static int refuse_long(struct interp_diag *diag, double length_mm)
{
	return interp_diag_say(diag, "%.3g mm are too many pulses for one "
			       "segment; a shorter segment", length_mm);
}

struct build_way build_way_to(const struct interp_build *b,
			      const int64_t to[INTERP_NAXES],
			      const struct build_measure *m)
{
	struct build_way w = { .longest_sub = m->longest };
	uint32_t n = b->naxes;

	memcpy(w.order, b->column, n);
	for (int i = 0; i < INTERP_NAXES; i++) {
		w.from[i] = interp_round_sub(b->here[i]);
		w.to[i] = interp_round_sub(to[i]);
		/* Axes without a column get one in this order. */
		if (!(b->columns & 1u << i))
			w.order[n++] = (uint8_t)i;
	}
	return w;
}

/* A line that ends where the machine says does not lead to a known place, so
 * that place cannot be checked. */
static void loosen(struct interp_build *b, const double end_mm[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (end_mm[i] != b->here_mm[i])
			b->loose |= 1u << i;
	}
}

/* A stop, so that the machine does not come to it at speed. */
static int sensed_begin(struct interp_build *b, uint32_t moved,
			const struct interp_build_word *w,
			struct interp_diag *diag)
{
	if (moved & (moved - 1)) {
		return interp_diag_say(diag, "a probing motion, half or limit "
					     "along several axes; one axis");
	}
	return interp_build_action(b, INTERP_DWELL, 0, w, diag);
}

int build_walk_may(struct interp_build *b, double points,
		   struct interp_diag *diag)
{
	const double most = b->o.walked_max;

	if (points <= most - (double)b->walked)
		return 0;
	b->again.refused = b->again.counts;
	return interp_diag_say(diag, "curves, arcs and lines by min-switch "
			       "that are more than %.0f lattice points "
			       "together; fewer, or shorter ones, or arcs and "
			       "lines by strategy simultaneous", most);
}

int build_walk(struct interp_build *b, double points,
	       struct interp_diag *diag)
{
	const int err = build_walk_may(b, points, diag);

	if (err < 0)
		return err;
	b->walked += (uint64_t)points;
	return build_count_rest(b);
}

/* How a line is walked. */
struct walked {
	uint32_t ticks, arg;		/* as in a segment */
};

/* The axes move one at a time, so it matters how far each goes. */
static int walk_one_by_one(struct interp_build *b, const int64_t *to,
			   struct build_measure m, struct walked *ret,
			   struct interp_diag *diag)
{
	const struct build_way way = build_way_to(b, to, &m);
	const uint64_t ticks = build_rule_pulses(&way);
	int err;

	if (ticks > INTERP_PULSES_MAX)
		return refuse_long(diag, m.length_mm);
	err = build_rule_check(&b->o, &way, diag);
	if (err < 0)
		return err;
	ret->ticks = (uint32_t)ticks;
	if (build_columns(b, m.moved) < 0)
		return -ENOMEM;
	return build_bits_add(b, &way, ret->ticks, &ret->arg, diag);
}

static inline int walk_together(struct interp_build *b,
				const struct build_measure *m,
				struct walked *ret, struct interp_diag *diag)
{
	const int64_t ticks = (m->longest + INTERP_SUB - 1) >> INTERP_SUB_BITS;

	if (ticks > INTERP_PULSES_MAX)
		return refuse_long(diag, m->length_mm);
	ret->ticks = (uint32_t)ticks;
	return m->moved & ~b->columns && build_columns(b, m->moved) < 0 ?
	       -ENOMEM : 0;
}

static inline struct interp_seg line_seg(const struct build_measure *m,
					 const struct walked *walked,
					 const struct interp_build_word *w)
{
	struct interp_seg seg = {
		.kind = INTERP_LINE, .length_mm = m->length_mm,
		.ticks = walked->ticks, .arg = walked->arg,
	};

	build_seg_feed(&seg, w, m->length_mm / m->seconds);
	if (!w->rapid)
		seg.feed_mm_s *= (float)(m->length_mm / m->fed_mm);
	return seg;
}

int build_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
	       const struct interp_build_word *w, struct interp_diag *diag)
{
	struct walked walked = { .arg = 0 };
	int64_t to[INTERP_NAXES];
	struct build_measure m;
	struct interp_seg *seg;
	int err;

	if (w->ends)
		loosen(b, end_mm);
	err = measure(b, end_mm, to, &m, diag);
	if (err < 0)
		return err;
	if (!m.moved) {
		build_stand_at(b, end_mm, to);
		return 0;
	}
	err = b->how->at_once ? walk_together(b, &m, &walked, diag) :
	      walk_one_by_one(b, to, m, &walked, diag);
	if (err == 0 && w->ends)
		err = sensed_begin(b, m.moved, w, diag);
	if (err < 0)
		return err;
	build_descend(b, m.moved, end_mm);
	b->stand_escape = w->ends ? 0 : build_escape_of(b, m.moved, end_mm);
	build_stand_at(b, end_mm, to);
	/* It is also not known how far it came. */
	if (w->ends)
		b->descent.axis = -1;
	err = seg_begin(b, w, diag);
	if (err < 0)
		return err;
	/* In its place: what is stored in parts is slow to copy. */
	seg = seg_add(b);
	*seg = line_seg(&m, &walked, w);
	seg_end(b, seg, w);
	return 0;
}

int build_step(struct interp_build *b, const struct build_step *s,
	       const struct interp_build_word *w, struct interp_diag *diag)
{
	struct interp_seg seg = s->seg;
	int64_t to[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		to[i] = llround(s->end_mm[i] * b->sub_mm[i]);
	build_seg_feed(&seg, w, s->feed_max_mm_s);
	if (build_columns(b, s->moved) < 0)
		return -ENOMEM;
	build_descend(b, s->moved, s->end_mm);
	b->stand_escape = b->escape;
	build_stand_at(b, s->end_mm, to);
	return build_seg_finish(b, &seg, w, diag);
}
