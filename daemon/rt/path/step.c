/* SPDX-License-Identifier: Apache-2.0 */
/* step.c - go from node to node of the path, while held */
#include "path/step.h"
#include "path/laws.h"
#include "path/place.h"

#include <math.h>

#define SEGMENTS_MAX	512		/* segments, looked at in one command */

/* The first node of a segment; after the last segment, the end of the
 * program. */
static double node_mm(const struct interp_program *p, uint32_t i)
{
	return i < p->head->nsegs ? p->segs[i].s_mm : p->head->length_mm;
}

static int count_nodes(const struct interp_cursor *at, int toward, int n,
		       double *ret_mm)
{
	const uint32_t nsegs = at->p.head->nsegs;
	double from = interp_cursor_place_mm(at);
	uint32_t i = toward > 0 ? at->index + 1 : at->index;

	for (int seen = 0; seen < SEGMENTS_MAX && i <= nsegs; seen++) {
		const double to = node_mm(&at->p, i);

		if (toward * (to - from) > MOVER_ONTO_MM) {
			from = to;
			n--;
		}
		if (n == 0) {
			*ret_mm = to;
			return ANSWER_DONE;
		}
		if (toward < 0 && i == 0)
			break;
		i += (uint32_t)toward;
	}
	return ANSWER_NO_NODE;
}

int step_to(const struct cycle *c, double n, double *ret_mm)
{
	const int toward = n < 0 ? -1 : 1;
	int answer;

	if (!(fabs(n) >= 1 && fabs(n) <= STEP_NODES_MAX) || n != floor(n))
		return ANSWER_BAD_ARGUMENT;
	answer = count_nodes(&c->cursor, toward, (int)fabs(n), ret_mm);
	if (answer != ANSWER_DONE)
		return answer;
	if (toward > 0 && *ret_mm > c->far_mm + MOVER_ONTO_MM &&
	    !c->config.dry_run)
		return ANSWER_NOT_PASSED;
	if (toward < 0 && *ret_mm < c->back_mm - MOVER_ONTO_MM)
		return ANSWER_NO_NODE;
	return ANSWER_DONE;
}

void step_watch(struct cycle *c)
{
	if (c->state == STATE_HOLD && c->hold.moving && c->sensed.contact &&
	    c->hold.to_mm > place_mm(c) && !c->config.dry_run)
		c->hold.moving = false;
}
