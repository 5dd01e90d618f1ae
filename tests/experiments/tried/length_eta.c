/* SPDX-License-Identifier: Apache-2.0 */
/* length_eta.c - the time left, by the way that is cut */
#include "length_eta.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

void length_eta_fini(struct length_eta *l)
{
	free(l->part);
	*l = (struct length_eta) { .nparts = 0 };
}

static bool is_cut(const struct interp_seg *s)
{
	return !(s->flags & INTERP_SEG_UNCUT);
}

/* Find the places where cutting and positioning change, among the segments that
 * have a length. */
static size_t parts(const struct interp_program *p, struct length_part *to)
{
	struct length_part at = { .s_mm = 0 };
	size_t n = 0;

	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		const struct interp_seg *s = &p->segs[i];

		if (!(s->length_mm > 0))
			continue;
		if (n == 0 || is_cut(s) != at.cut) {
			at.cut = is_cut(s);
			at.s_mm = s->s_mm;
			if (to)
				to[n] = at;
			n++;
		}
		at.cut_mm += at.cut ? s->length_mm : 0;
	}
	if (to)
		to[n] = (struct length_part) { INFINITY, at.cut_mm, false };
	return n;
}

int length_eta_measure(struct length_eta *l, const struct interp_program *p)
{
	const size_t n = parts(p, NULL);

	length_eta_fini(l);
	l->part = calloc(n + 1, sizeof(*l->part));
	if (!l->part)
		return -ENOMEM;
	l->nparts = parts(p, l->part);
	l->cut_mm = l->part[n].cut_mm;
	return 0;
}

/* How much of the first @far_mm is cut. */
static double cut_to(const struct length_eta *l, double far_mm)
{
	size_t low = 0, high = l->nparts;

	while (high - low > 1) {
		const size_t mid = low + (high - low) / 2;

		if (l->part[mid].s_mm <= far_mm)
			low = mid;
		else
			high = mid;
	}
	if (!l->part[low].cut)
		return l->part[low].cut_mm;
	return fmin(l->part[low].cut_mm + fmax(0, far_mm - l->part[low].s_mm),
		    l->part[low + 1].cut_mm);
}

double length_eta_s(const struct length_eta *l, double far_mm, double job_s)
{
	const double done = l->nparts ? cut_to(l, far_mm) : 0;

	if (!(done > 0) || !(job_s > 0))
		return -1;
	return job_s * (l->cut_mm - done) / done;
}
