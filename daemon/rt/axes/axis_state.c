/* SPDX-License-Identifier: Apache-2.0 */
/* axis_state.c - where the axes stand, and how that is known */
#include "axes/axis_state.h"

#include "cycle.h"

#include <string.h>

void axis_state_get(const struct cycle *c, struct axis_state *ret)
{
	memcpy(ret->place, c->out.target, sizeof(ret->place));
	for (int i = 0; i < INTERP_NAXES; i++) {
		ret->drive[i] = comp_pulses(&c->comp.axis[i]);
		ret->off[i] = c->resync.off[i];
		ret->shift[i] = c->comp.axis[i].shift;
		ret->toward[i] = c->comp.axis[i].toward;
	}
	ret->homed = c->manual.homed;
	ret->unplaced = c->manual.unplaced;
	ret->limit = c->limit;
	ret->told_c = c->comp.told_c;
}

/* The difference between place and drive that is not the shift is
 * compensation. */
static int32_t added(const struct axis_state *s, int i)
{
	return (int32_t)((uint32_t)s->drive[i] - (uint32_t)s->place[i] -
			 (uint32_t)s->shift[i]);
}

/* comp has not begun: so its first period does not count as a motion. */
void axis_state_set(struct cycle *c, const struct axis_state *s)
{
	memcpy(c->out.target, s->place, sizeof(c->out.target));
	for (int i = 0; i < INTERP_NAXES; i++) {
		struct comp_axis *a = &c->comp.axis[i];

		a->place = s->place[i];
		a->shift = s->shift[i];
		a->added = added(s, i);
		a->toward = s->toward[i];
	}
	resync_set(&c->resync, s->off);
	c->limit = s->limit;
	c->comp.resting = true;
	/* Without a PLC nobody would ever say another temperature. */
	if (c->plc.present && s->told_c > 0)
		comp_warm(&c->comp, &c->config.comp, s->told_c);
	c->manual.homed = s->homed;
	c->manual.unplaced = s->unplaced;
	c->manual.used = true;
	c->out.path++;
}
