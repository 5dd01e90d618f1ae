/* SPDX-License-Identifier: Apache-2.0 */
/* program.c - reads a block as a program, and does not trust it */
#include "interp/program.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* Is a table of @n entries of @size bytes at @at completely inside the
 * block? */
static bool table_ok(const struct interp_program_head *h, uint64_t at,
		     uint64_t n, uint64_t size)
{
	return at % 8 == 0 && at >= sizeof(*h) && at <= h->bytes &&
	       n <= (h->bytes - at) / size;
}

static bool is_place(int64_t pulses)
{
	return pulses <= INTERP_PULSES_MAX && pulses >= -INTERP_PULSES_MAX;
}

static bool depth_ok(const struct interp_depth *d)
{
	for (int k = 0; k < 3; k++)
		if (!isfinite(d->way[k]) || !is_place(d->from[k]))
			return false;
	return isfinite(d->far_mm) && isfinite(d->known_mm);
}

static bool axes_ok(const struct interp_program_head *h)
{
	uint32_t columns = 0;

	for (uint32_t i = 0; i < INTERP_NAXES; i++) {
		if (!(h->pulse_mm[i] > 0 && isfinite(h->pulse_mm[i])))
			return false;
		if (!is_place(h->start_pulses[i]))
			return false;
		if (!is_place(h->probed.shift[i]) ||
		    !is_place((int64_t)h->start_pulses[i] +
			      h->probed.shift[i]))
			return false;
		if (i >= h->naxes)
			continue;
		/* An axis has one column: two would move it twice. */
		if (h->column[i] >= INTERP_NAXES ||
		    columns & 1u << h->column[i])
			return false;
		columns |= 1u << h->column[i];
	}
	return true;
}

static bool head_ok(const struct interp_program_head *h, size_t bytes)
{
	if (memcmp(h->magic, INTERP_PROGRAM_MAGIC, sizeof(h->magic)) != 0 ||
	    h->version != INTERP_PROGRAM_VERSION ||
	    h->head_bytes != sizeof(*h) || h->bytes > bytes)
		return false;
	if (h->nsegs < 2 || h->nconds < 1 || h->nescapes < 1 ||
	    h->naxes > INTERP_NAXES || h->strategy >= INTERP_NSTRATEGIES ||
	    !isfinite(h->length_mm))
		return false;
	if (h->tolerance_milli > INTERP_TOLERANCE_MAX ||
	    h->perpendicular > 1 || h->coupling >= INTERP_NCOUPLINGS)
		return false;
	return depth_ok(&h->depth) && axes_ok(h);
}

int interp_program_map(struct interp_program *p, const void *block,
		       size_t bytes)
{
	const struct interp_program_head *h = block;
	const char *base = block;

	if (bytes < sizeof(*h) || !head_ok(h, bytes))
		return -EBADMSG;
	if (!table_ok(h, h->segs_at, h->nsegs, sizeof(*p->segs)) ||
	    !table_ok(h, h->nodes_at, ((uint64_t)h->nsegs + 1) * h->naxes,
		      sizeof(*p->nodes)) ||
	    !table_ok(h, h->arcs_at, h->narcs, sizeof(*p->arcs)) ||
	    !table_ok(h, h->conds_at, h->nconds, sizeof(*p->conds)) ||
	    !table_ok(h, h->escapes_at, h->nescapes, sizeof(*p->escapes)) ||
	    !table_ok(h, h->runs_at, h->nruns, sizeof(*p->runs)) ||
	    !table_ok(h, h->couples_at, h->ncouples, sizeof(*p->couples)) ||
	    !table_ok(h, h->bits_at, h->nbits, sizeof(*p->bits)) ||
	    !table_ok(h, h->curves_at, h->ncurves, sizeof(*p->curves)) ||
	    !table_ok(h, h->pieces_at, h->npieces, sizeof(*p->pieces)) ||
	    !table_ok(h, h->stops_at, h->nstops, sizeof(*p->stops)) ||
	    !table_ok(h, h->numbers_at, h->nnumbers, sizeof(*p->numbers)) ||
	    !table_ok(h, h->origins_at, h->norigins, sizeof(*p->origins)))
		return -EBADMSG;

	p->head = h;
	p->segs = (const void *)(base + h->segs_at);
	p->nodes = (const void *)(base + h->nodes_at);
	p->arcs = (const void *)(base + h->arcs_at);
	p->conds = (const void *)(base + h->conds_at);
	p->escapes = (const void *)(base + h->escapes_at);
	p->runs = (const void *)(base + h->runs_at);
	p->couples = (const void *)(base + h->couples_at);
	p->bits = (const void *)(base + h->bits_at);
	p->curves = (const void *)(base + h->curves_at);
	p->pieces = (const void *)(base + h->pieces_at);
	p->stops = (const void *)(base + h->stops_at);
	p->numbers = (const void *)(base + h->numbers_at);
	p->origins = (const void *)(base + h->origins_at);
	for (uint32_t i = 0; i < h->nconds; i++) {
		if (!interp_tech_ok(&p->conds[i].tech))
			return -EBADMSG;
	}
	if (p->segs[0].kind != INTERP_BEGIN ||
	    p->segs[h->nsegs - 1].kind != INTERP_END)
		return -EBADMSG;
	return 0;
}

const struct interp_origin *
interp_program_origin(const struct interp_program *p, uint32_t i)
{
	const struct interp_origin *of = NULL;

	for (uint64_t k = 0; k < p->head->norigins; k++)
		if (p->origins[k].seg <= i)
			of = &p->origins[k];
	return of;
}

bool interp_program_seg_ok(const struct interp_program *p, uint32_t i,
			   const struct interp_seg *seg)
{
	const uint32_t n = p->head->nsegs;

	if (i >= n || seg->kind >= INTERP_NKINDS ||
	    seg->cond >= p->head->nconds || seg->escape >= p->head->nescapes ||
	    !(seg->node_mm_s > 0))
		return false;
	if ((seg->kind == INTERP_BEGIN) != (i == 0) ||
	    (seg->kind == INTERP_END) != (i == n - 1))
		return false;
	if (seg->kind == INTERP_TIMED && (seg->arg <= i || seg->arg >= n))
		return false;
	if (seg->kind >= INTERP_BEGIN)
		return seg->length_mm == 0 && seg->ticks == 0 &&
		       isfinite(seg->s_mm) &&
		       (seg->kind != INTERP_MCODE ||
			interp_mcode_ok(seg->arg)) &&
		       (seg->kind != INTERP_ELECTRODE ||
			(seg->arg & ~INTERP_ELECTRODE_STOP) <=
			INTERP_ELECTRODE_MAX);
	if (seg->flags & INTERP_SEG_SENSED && seg->kind != INTERP_LINE)
		return false;
	return isfinite(seg->s_mm) && isfinite(seg->length_mm) &&
	       seg->length_mm > 0 && isfinite(seg->feed_mm_s) &&
	       seg->feed_mm_s > 0 && isfinite(seg->feed_max_mm_s) &&
	       seg->feed_max_mm_s > 0 && seg->a_mm_s2 > 0 &&
	       seg->j_mm_s3 > 0 &&
	       (seg->kind != INTERP_ARC || seg->arg < p->head->narcs) &&
	       (seg->kind != INTERP_PAIR || seg->arg < p->head->ncouples) &&
	       (seg->kind != INTERP_CURVE || seg->arg < p->head->npieces);
}

/* Are @n numbers from @at on among those of the program? */
static bool numbers_ok(const struct interp_program *p, uint64_t at, uint64_t n)
{
	return at <= p->head->nnumbers && n <= p->head->nnumbers - at;
}

bool interp_program_curve(const struct interp_program *p, uint32_t i,
			  struct interp_nurbs *ret)
{
	struct interp_curve c;

	if (i >= p->head->ncurves)
		return false;
	c = p->curves[i];
	if (c.degree < 1 || c.degree > INTERP_NURBS_DEGREE_MAX ||
	    c.naxes < 1 || c.naxes > INTERP_NAXES || c.counted < 1 ||
	    c.counted > c.naxes || c.npoints < c.degree + 1 ||
	    c.npoints > INTERP_NURBS_POINTS_MAX ||
	    !numbers_ok(p, c.knots_at, c.npoints + c.degree + 1) ||
	    !numbers_ok(p, c.points_at, (uint64_t)c.npoints * (c.naxes + 1)))
		return false;
	*ret = (struct interp_nurbs) {
		.degree = c.degree, .naxes = c.naxes, .npoints = c.npoints,
		.counted = c.counted, .others = c.others,
		.knots = p->numbers + c.knots_at,
		.points = p->numbers + c.points_at,
	};
	return true;
}

static const char *const couplings[INTERP_NCOUPLINGS] = {
	[INTERP_STAR]	= "star",
	[INTERP_TREE]	= "tree",
};

static const char *const escape_modes[INTERP_NESCAPE_MODES] = {
	[INTERP_ESCAPE_PATH]	= "path",
	[INTERP_ESCAPE_NORMAL]	= "normal",
	[INTERP_ESCAPE_CENTRE]	= "centre",
	[INTERP_ESCAPE_AXIS]	= "axis",
};

static int parse(const char *const *names, int n, const char *name)
{
	for (int i = 0; i < n; i++) {
		if (strcmp(names[i], name) == 0)
			return i;
	}
	return -EINVAL;
}

const char *interp_coupling_name(enum interp_coupling k)
{
	return k < INTERP_NCOUPLINGS ? couplings[k] : NULL;
}

int interp_coupling_parse(const char *name)
{
	return parse(couplings, INTERP_NCOUPLINGS, name);
}

const char *interp_escape_mode_name(enum interp_escape_mode m)
{
	return m < INTERP_NESCAPE_MODES ? escape_modes[m] : NULL;
}
