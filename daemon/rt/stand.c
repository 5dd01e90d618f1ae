/* SPDX-License-Identifier: Apache-2.0 */
/* stand.c - why a job stands, and whether what it asks for was done */
#include "stand.h"

#include "cycle.h"

void stand_begin(struct cycle *c, enum stand_reason why, uint32_t of)
{
	if (c->stand.why == STAND_NONE)
		c->stand = (struct stand) { .why = why, .of = of,
					    .n = c->stand.n + 1 };
}

void stand_end(struct cycle *c)
{
	c->stand = (struct stand) { .why = STAND_NONE, .n = c->stand.n };
}

bool stand_is(const struct cycle *c, uint32_t n)
{
	return n == 0 || (n == c->stand.n && c->stand.why != STAND_NONE);
}

bool stand_asks(const struct cycle *c)
{
	return stand_row(c->stand.why)->ends == STAND_BY_CONFIRM &&
	       !c->stand.confirmed;
}

bool stand_confirm(struct cycle *c, double of)
{
	struct stand *s = &c->stand;
	const double asked = s->why == STAND_ELECTRODE ? (double)s->of : 0;

	if (stand_row(s->why)->ends != STAND_BY_CONFIRM || of != asked)
		return false;
	s->confirmed = true;
	return true;
}

/* What keeps a job that runs from moving. */
static struct stand_now waits_for(const struct cycle *c)
{
	if (c->mcode.waits)
		return (struct stand_now) { STAND_MCODE, c->mcode.number };
	if (asking_waits(c))
		return (struct stand_now) { STAND_GENERATOR, 0 };
	if (c->override == 0 && c->state == STATE_TRAVEL)
		return (struct stand_now) { STAND_OVERRIDE, 0 };
	return (struct stand_now) { STAND_NONE, 0 };
}

struct stand_now stand_now(const struct cycle *c)
{
	if (!c->loaded || c->state == STATE_FAULT)
		return (struct stand_now) { STAND_NONE, 0 };
	if (axes_awaits(&c->axes))
		return (struct stand_now) { STAND_POWER, 0 };
	if (c->state != STATE_HOLD)
		return waits_for(c);
	return (struct stand_now) { c->stand.why, c->stand.of };
}
