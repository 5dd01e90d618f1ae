/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build.c - put a program together
 *
 * Tables grow by doubling; a node gets a column when its axis first moves.
 */
#include "interp/build.h"
#include "path/build_arc.h"
#include "path/build_pair.h"
#include "path/build_rule.h"
#include "pulse/walk.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct table {
	void *at;
	size_t n, room, size;
};

struct interp_build {
	struct interp_build_options o;
	double here_mm[INTERP_NAXES];
	int64_t here[INTERP_NAXES];	/* the same in subpulses */
	int64_t first[INTERP_NAXES];
	double sub_mm[INTERP_NAXES];	/* subpulses per mm */
	uint8_t column[INTERP_NAXES];
	uint32_t naxes, columns;	/* columns: mask of axes */
	double length_mm;
	struct table segs, nodes, arcs, conds, runs;	/* nodes: n counts
							 * columns */
	struct table couples, bits;
	char cond_letter;
	uint32_t cond_number;
	uint16_t cond;
};

static void *table_add(struct table *t)
{
	if (t->n == t->room) {
		const size_t room = t->room ? 2 * t->room : 64;
		void *at = realloc(t->at, room * t->size);

		if (!at)
			return NULL;
		t->at = at;
		t->room = room;
	}
	return (char *)t->at + t->size * t->n++;
}

static int64_t *nodes_of(const struct interp_build *b)
{
	return b->nodes.at;
}

static struct interp_seg *seg_add(struct interp_build *b)
{
	return table_add(&b->segs);
}

/* Append where the path stands as a node. */
static int node_add(struct interp_build *b)
{
	for (uint32_t j = 0; j < b->naxes; j++) {
		int64_t *n = table_add(&b->nodes);

		if (!n)
			return -ENOMEM;
		*n = b->here[b->column[j]];
	}
	return 0;
}

/* Give axis @axis a column: every node so far has it where it started. */
static int column_add(struct interp_build *b, uint32_t axis)
{
	const size_t rows = b->segs.n + 1;
	const uint32_t from = b->naxes, to = b->naxes + 1;
	int64_t *at;

	while (b->nodes.room < rows * to + 64) {
		const size_t room = b->nodes.room ? 2 * b->nodes.room : 64;

		at = realloc(b->nodes.at, room * b->nodes.size);
		if (!at)
			return -ENOMEM;
		b->nodes.at = at;
		b->nodes.room = room;
	}
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

	if (!b)
		return NULL;
	b->o = *o;
	b->segs.size = sizeof(struct interp_seg);
	b->nodes.size = sizeof(int64_t);
	b->arcs.size = sizeof(struct interp_arc);
	b->conds.size = sizeof(struct interp_cond);
	b->couples.size = sizeof(struct interp_couple);
	b->bits.size = sizeof(uint64_t);
	b->runs.size = sizeof(int32_t);
	for (int i = 0; i < INTERP_NAXES; i++) {
		b->sub_mm[i] = INTERP_SUB / o->machine->axis[i].pulse_mm;
		b->here_mm[i] = o->start_mm[i];
		b->here[i] = b->first[i] =
			llround(o->start_mm[i] * b->sub_mm[i]);
	}
	begin = seg_add(b);
	none = table_add(&b->conds);
	if (!begin || !none) {
		interp_build_destroy(b);
		return NULL;
	}
	*begin = (struct interp_seg) { .kind = INTERP_BEGIN };
	*none = (struct interp_cond) { .letter = 0 };
	return b;
}

void interp_build_destroy(struct interp_build *b)
{
	if (!b)
		return;
	free(b->segs.at);
	free(b->nodes.at);
	free(b->arcs.at);
	free(b->conds.at);
	free(b->couples.at);
	free(b->bits.at);
	free(b->runs.at);
	free(b);
}

const double *interp_build_here(const struct interp_build *b)
{
	return b->here_mm;
}

/* -- Checks ------------------------------------------------------------- */

int build_refuse_travel(const struct interp_machine *m, int axis,
			double at_mm, struct interp_diag *diag)
{
	const struct interp_axis_limits *l = &m->axis[axis];
	const char letter = INTERP_AXIS_LETTERS[axis];

	if (!(m->present & 1u << axis)) {
		snprintf(diag->found, sizeof(diag->found),
			 "the machine has no axis %c", letter);
		snprintf(diag->wanted, sizeof(diag->wanted),
			 "a program for the axes it has");
		return -EINVAL;
	}
	snprintf(diag->found, sizeof(diag->found),
		 "%c %.4f is beyond the travel", letter, at_mm);
	snprintf(diag->wanted, sizeof(diag->wanted),
		 "%c from %g to %g in machine coordinates", letter,
		 l->travel_min_mm, l->travel_max_mm);
	return -EINVAL;
}

/* In pulses, as the cycle guards them: the last ones inside the limits. */
static bool axis_ok(const struct interp_machine *m, int axis, double at_mm)
{
	const struct interp_axis_limits *l = &m->axis[axis];
	const double at = floor(at_mm / l->pulse_mm + 0.5);

	return m->present & 1u << axis &&
	       at >= ceil(l->travel_min_mm / l->pulse_mm - 1e-6) &&
	       at <= floor(l->travel_max_mm / l->pulse_mm + 1e-6);
}

/* -- Segments ------------------------------------------------------------ */

/* The number of the condition in force, added if it is new. */
static int cond_of(struct interp_build *b, const struct interp_build_word *w)
{
	struct interp_cond *c = b->conds.at;

	if (w->cond_letter == b->cond_letter &&
	    w->cond_number == b->cond_number)
		return b->cond;
	for (size_t i = 0; i < b->conds.n; i++) {
		if (c[i].letter == w->cond_letter &&
		    c[i].number == w->cond_number)
			return (int)i;
	}
	if (b->conds.n > UINT16_MAX)
		return -ENOSPC;
	c = table_add(&b->conds);
	if (!c)
		return -ENOMEM;
	*c = (struct interp_cond) { .letter = w->cond_letter,
				    .number = w->cond_number };
	return (int)b->conds.n - 1;
}

/* What is the same for every segment: line, condition, place, end node. */
static int seg_finish(struct interp_build *b, struct interp_seg *seg,
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	const int cond = cond_of(b, w);
	struct interp_seg *s;

	if (cond == -ENOSPC) {
		snprintf(diag->found, sizeof(diag->found),
			 "more than %d different conditions", UINT16_MAX);
		snprintf(diag->wanted, sizeof(diag->wanted), "fewer of them");
		return -EINVAL;
	}
	if (cond < 0)
		return cond;
	b->cond = (uint16_t)cond;
	b->cond_letter = w->cond_letter;
	b->cond_number = w->cond_number;
	seg->cond = b->cond;
	seg->line = w->line;
	seg->s_mm = b->length_mm;
	if (node_add(b) < 0)
		return -ENOMEM;
	s = seg_add(b);
	if (!s)
		return -ENOMEM;
	*s = *seg;
	b->length_mm += seg->length_mm;
	return 0;
}

/* First node, and a column for each axis in @moved. */
static int columns_for(struct interp_build *b, uint32_t moved)
{
	moved &= ~b->columns;
	for (uint32_t i = 0; moved; i++, moved >>= 1) {
		if (moved & 1 && column_add(b, i) < 0)
			return -ENOMEM;
	}
	return 0;
}

/* Feed words: as programmed, and the fastest its axes allow. */
static void seg_feed(struct interp_seg *seg, const struct interp_build_word *w,
		     double feed_max_mm_s)
{
	seg->flags = w->rapid ? INTERP_SEG_RAPID : 0;
	seg->feed_max_mm_s = (float)feed_max_mm_s;
	seg->feed_mm_s = w->rapid ? seg->feed_max_mm_s : (float)w->feed_mm_s;
}

struct measure {
	uint32_t moved;			/* mask of axes */
	double length_mm;
	double seconds;			/* at every axis's own v_max */
	int64_t longest;		/* subpulses */
};

static double length_of(const double d[INTERP_NAXES], uint32_t moved)
{
	const uint32_t xyz = 1u << INTERP_X | 1u << INTERP_Y | 1u << INTERP_Z;

	if (moved & xyz)
		return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	if (moved & (1u << INTERP_U | 1u << INTERP_V))
		return sqrt(d[INTERP_U] * d[INTERP_U] +
			    d[INTERP_V] * d[INTERP_V]);
	return sqrt(d[INTERP_A] * d[INTERP_A] + d[INTERP_B] * d[INTERP_B] +
		    d[INTERP_C] * d[INTERP_C]);
}

/*
 * How far every axis goes to @end_mm; -1 and @ret_axis if one leaves the
 * travel.  @to gets the end in subpulses.
 */
static int measure(const struct interp_build *b,
		   const double end_mm[INTERP_NAXES], int64_t to[INTERP_NAXES],
		   struct measure *ret)
{
	const struct interp_machine *m = b->o.machine;
	double d[INTERP_NAXES] = { 0 };

	*ret = (struct measure) { 0 };
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double s = end_mm[i] * b->sub_mm[i];
		int64_t len;
		double t;

		to[i] = b->here[i];
		if (end_mm[i] == b->here_mm[i])
			continue;
		if (!axis_ok(m, i, end_mm[i]))
			return -1 - i;
		to[i] = (int64_t)(s < 0 ? s - 0.5 : s + 0.5);
		len = to[i] - b->here[i];
		if (len == 0)
			continue;
		d[i] = (double)len / b->sub_mm[i];
		ret->moved |= 1u << i;
		t = fabs(d[i]) / m->axis[i].v_max_mm_s;
		ret->seconds = t > ret->seconds ? t : ret->seconds;
		len = len < 0 ? -len : len;
		ret->longest = len > ret->longest ? len : ret->longest;
	}
	ret->length_mm = length_of(d, ret->moved);
	return 0;
}

static void stand_at(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const int64_t to[INTERP_NAXES])
{
	memcpy(b->here_mm, end_mm, sizeof(b->here_mm));
	memcpy(b->here, to, sizeof(b->here));
}

static int refuse_long(struct interp_diag *diag, double length_mm)
{
	snprintf(diag->found, sizeof(diag->found),
		 "%.3g mm are too many pulses for one segment", length_mm);
	snprintf(diag->wanted, sizeof(diag->wanted), "a shorter segment");
	return -EINVAL;
}

/* From here to @to, as the strategies see it. */
static struct build_way way_to(const struct interp_build *b,
			       const int64_t to[INTERP_NAXES],
			       const struct measure *m)
{
	struct build_way w = { .longest_sub = m->longest };

	for (int i = 0; i < INTERP_NAXES; i++) {
		w.from[i] = interp_round_sub(b->here[i]);
		w.to[i] = interp_round_sub(to[i]);
	}
	return w;
}

int interp_build_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = INTERP_LINE };
	int64_t to[INTERP_NAXES];
	struct measure m;
	const int bad = measure(b, end_mm, to, &m);
	struct build_way way;
	uint64_t ticks;
	int r;

	if (bad < 0)
		return build_refuse_travel(b->o.machine, -bad - 1,
					   end_mm[-bad - 1], diag);
	if (!m.moved) {
		stand_at(b, end_mm, to);
		return 0;
	}
	way = way_to(b, to, &m);
	ticks = build_rule_ticks(b->o.strategy, &way);
	if (ticks > INTERP_PULSES_MAX)
		return refuse_long(diag, m.length_mm);
	r = build_rule_check(&b->o, &way, diag);
	if (r < 0)
		return r;
	seg.ticks = (uint32_t)ticks;
	seg.length_mm = m.length_mm;
	seg_feed(&seg, w, m.length_mm / m.seconds);
	if (m.moved & ~b->columns && columns_for(b, m.moved) < 0)
		return -ENOMEM;
	stand_at(b, end_mm, to);
	return seg_finish(b, &seg, w, diag);
}

int interp_build_action(struct interp_build *b, enum interp_kind kind,
			uint32_t arg, const struct interp_build_word *w,
			struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = (uint8_t)kind, .arg = arg };

	return seg_finish(b, &seg, w, diag);
}

/* -- Arcs ------------------------------------------------------------------ */

/* The runs of an arc that keeps them. */
static int runs_add(struct interp_build *b, const struct build_arc *plan,
		    struct interp_arc *arc)
{
	struct table *t = &b->runs;

	arc->run_at = (uint32_t)t->n;
	if (arc->nruns == 0)
		return 0;
	if (t->n + arc->nruns > t->room) {
		const size_t room = 2 * t->room + arc->nruns;
		void *at = realloc(t->at, room * t->size);

		if (!at)
			return -ENOMEM;
		t->at = at;
		t->room = room;
	}
	build_arc_runs(plan, arc, (int32_t *)t->at + t->n);
	t->n += arc->nruns;
	return t->n > UINT32_MAX ? -ENOMEM : 0;
}

int interp_build_arc(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const struct interp_build_arc *a,
		     const struct interp_build_word *w,
		     struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = INTERP_ARC };
	struct build_arc plan = { .o = &b->o, .word = a };
	const uint32_t plane = 1u << a->axis_a | 1u << a->axis_b;
	int64_t to[INTERP_NAXES];
	struct interp_arc *arc;
	struct measure m;
	const int bad = measure(b, end_mm, to, &m);
	int r;

	if (bad < 0)
		return build_refuse_travel(b->o.machine, -bad - 1,
					   end_mm[-bad - 1], diag);
	for (int i = 0; i < INTERP_NAXES; i++) {
		plan.from_mm[i] = (double)b->here[i] / b->sub_mm[i];
		plan.to_mm[i] = (double)to[i] / b->sub_mm[i];
	}
	plan.way = way_to(b, to, &m);
	plan.way.except = plane;
	r = build_arc_plan(&plan, diag);
	if (r < 0)
		return r;
	if (plan.straight)
		return interp_build_line(b, end_mm, w, diag);
	seg.ticks = plan.ticks;
	seg.length_mm = plan.length_mm;
	seg_feed(&seg, w, plan.feed_max_mm_s);
	if (columns_for(b, m.moved | plane) < 0)
		return -ENOMEM;
	seg.arg = (uint32_t)b->arcs.n;
	arc = table_add(&b->arcs);
	if (!arc)
		return -ENOMEM;
	*arc = plan.arc;
	if (runs_add(b, &plan, arc) < 0)
		return -ENOMEM;
	stand_at(b, end_mm, to);
	return seg_finish(b, &seg, w, diag);
}

/* -- Pairs ----------------------------------------------------------------- */

/* The couple and its bits, into the tables. */
static int couple_add(struct interp_build *b, struct build_pair *p)
{
	const size_t words = p->bits ? ((size_t)p->ticks + 63) / 64 : 0;
	struct interp_couple *c = table_add(&b->couples);

	if (!c)
		return -ENOMEM;
	*c = p->couple;
	c->bits_at = b->bits.n;
	for (size_t i = 0; i < words; i++) {
		uint64_t *w = table_add(&b->bits);

		if (!w)
			return -ENOMEM;
		*w = p->bits[i];
	}
	return 0;
}

static int pair_finish(struct interp_build *b, struct build_pair *p,
		       const struct interp_build_word *w,
		       struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = INTERP_PAIR, .ticks = p->ticks,
				  .length_mm = p->length_mm,
				  .arg = (uint32_t)b->couples.n };

	seg_feed(&seg, w, p->feed_max_mm_s);
	if (columns_for(b, 1u << INTERP_X | 1u << INTERP_Y | 1u << INTERP_U |
			   1u << INTERP_V) < 0 || couple_add(b, p) < 0)
		return -ENOMEM;
	return seg_finish(b, &seg, w, diag);
}

static int refuse_others(struct interp_diag *diag)
{
	snprintf(diag->found, sizeof(diag->found),
		 "another axis beside two contours");
	snprintf(diag->wanted, sizeof(diag->wanted), "X Y U V alone");
	return -EINVAL;
}

/* One contour alone, the other stands: -ENOENT if both have a way to go. */
static int pair_alone(struct interp_build *b, const struct build_pair *p,
		      const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	const uint32_t xy = 1u << INTERP_X | 1u << INTERP_Y;
	const struct interp_build_contour *c = p->contour;
	const int i = p->moved & xy || c[0].arc ? 0 : 1;
	const struct interp_build_arc arc = {
		.axis_a = i ? INTERP_U : INTERP_X,
		.axis_b = i ? INTERP_V : INTERP_Y,
		.centre_a_mm = c[i].centre_mm[0],
		.centre_b_mm = c[i].centre_mm[1], .clockwise = c[i].clockwise,
	};
	const bool other = i == 0 && (p->moved & ~xy || c[1].arc);

	if (other && (c[0].arc || c[1].arc ||
		      b->o.strategy != INTERP_SIMULTANEOUS))
		return -ENOENT;
	return c[i].arc ? interp_build_arc(b, end_mm, &arc, w, diag) :
			  interp_build_line(b, end_mm, w, diag);
}

int interp_build_pair(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_contour contour[2],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	struct build_pair plan = { .machine = b->o.machine, .contour = contour,
				   .strategy = b->o.strategy };
	int64_t to[INTERP_NAXES];
	struct measure m;
	const int bad = measure(b, end_mm, to, &m);
	int r;

	if (bad < 0)
		return build_refuse_travel(b->o.machine, -bad - 1,
					   end_mm[-bad - 1], diag);
	if (m.moved & ~(1u << INTERP_X | 1u << INTERP_Y | 1u << INTERP_U |
			1u << INTERP_V))
		return refuse_others(diag);
	plan.moved = m.moved;
	r = pair_alone(b, &plan, end_mm, w, diag);
	if (r != -ENOENT)
		return r;
	for (int i = 0; i < INTERP_NAXES; i++) {
		plan.from_mm[i] = (double)b->here[i] / b->sub_mm[i];
		plan.to_mm[i] = (double)to[i] / b->sub_mm[i];
		plan.from[i] = interp_round_sub(b->here[i]);
		plan.to[i] = interp_round_sub(to[i]);
	}
	plan.longest_sub = m.longest;
	r = build_pair_plan(&plan, diag);
	if (r == 0) {
		stand_at(b, end_mm, to);
		r = pair_finish(b, &plan, w, diag);
	}
	free(plan.bits);
	return r;
}

/* -- The block ------------------------------------------------------------- */

static bool ends(const struct interp_build *b)
{
	const struct interp_seg *s = b->segs.at;

	return s[b->segs.n - 1].kind == INTERP_END;
}

static struct interp_program_head layout(const struct interp_build *b)
{
	const size_t nsegs = b->segs.n + !ends(b);
	struct interp_program_head h = {
		.magic = INTERP_PROGRAM_MAGIC,
		.version = INTERP_PROGRAM_VERSION,
		.head_bytes = sizeof(h),
		.nsegs = (uint32_t)nsegs,
		.narcs = (uint32_t)b->arcs.n,
		.nconds = (uint32_t)b->conds.n,
		.ncouples = b->couples.n,
		.nbits = b->bits.n,
		.naxes = b->naxes,
		.strategy = b->o.strategy,
		.tolerance_milli = b->o.tolerance_milli,
		.perpendicular = b->o.perpendicular,
		.coupling = b->o.coupling,
		.nruns = (uint32_t)b->runs.n,
		.length_mm = b->length_mm,
	};

	h.segs_at = (sizeof(h) + 7) & ~7ull;
	h.nodes_at = h.segs_at + nsegs * b->segs.size;
	h.arcs_at = h.nodes_at + (nsegs + 1) * b->naxes * b->nodes.size;
	h.conds_at = h.arcs_at + b->arcs.n * b->arcs.size;
	h.couples_at = h.conds_at + b->conds.n * b->conds.size;
	h.bits_at = h.couples_at + b->couples.n * b->couples.size;
	h.runs_at = h.bits_at + b->bits.n * b->bits.size;
	h.bytes = h.runs_at + b->runs.n * b->runs.size;
	return h;
}

size_t interp_build_bytes(const struct interp_build *b)
{
	return layout(b).bytes;
}

static void write_table(char *to, const struct table *t)
{
	if (t->n > 0)
		memcpy(to, t->at, t->n * t->size);
}

static void write_head(const struct interp_build *b,
		       struct interp_program_head *h,
		       const struct interp_build_about *about)
{
	memcpy(h->column, b->column, sizeof(h->column));
	for (int i = 0; i < INTERP_NAXES; i++) {
		h->pulse_mm[i] = b->o.machine->axis[i].pulse_mm;
		h->start_pulses[i] = interp_round_sub(b->first[i]);
	}
	h->lines = about->lines;
	memcpy(h->hash, about->hash, sizeof(h->hash));
	snprintf(h->name, sizeof(h->name), "%s",
		 about->name ? about->name : "");
}

void interp_build_write(struct interp_build *b,
			const struct interp_build_about *about, void *block)
{
	struct interp_program_head h = layout(b);
	char *base = block;
	struct interp_seg *segs = (void *)(base + h.segs_at);
	int64_t *nodes = (void *)(base + h.nodes_at);
	const size_t rows = b->segs.n + 1;

	write_head(b, &h, about);
	memcpy(base, &h, sizeof(h));
	write_table((char *)segs, &b->segs);
	write_table((char *)nodes, &b->nodes);
	/* Node 0 comes with the first column; the END has one of its own. */
	for (size_t i = rows; i <= h.nsegs; i++) {
		for (uint32_t j = 0; j < b->naxes; j++)
			nodes[i * b->naxes + j] = b->here[b->column[j]];
	}
	if (!ends(b)) {
		segs[b->segs.n] = (struct interp_seg) {
			.kind = INTERP_END, .s_mm = b->length_mm,
			.line = segs[b->segs.n - 1].line,
			.cond = b->cond,
		};
	}
	write_table(base + h.arcs_at, &b->arcs);
	write_table(base + h.conds_at, &b->conds);
	write_table(base + h.couples_at, &b->couples);
	write_table(base + h.bits_at, &b->bits);
	write_table(base + h.runs_at, &b->runs);
}
