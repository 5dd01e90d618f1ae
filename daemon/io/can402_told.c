/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_told.c - what is known of the drives, for who looks at them
 */
#include "can402_bus.h"

#include <string.h>

static void tell(const struct can402 *s, uint32_t i, struct cia402_drive *ret)
{
	const struct drive *d = &s->drive[i];

	*ret = (struct cia402_drive) {
		.axis = s->axis[i], .node = d->c.node,
		.phase = (uint8_t)d->phase, .state = (uint8_t)d->state,
		.trouble = (uint8_t)d->trouble, .mode = (int8_t)d->mode,
		.shows_mode = d->shows_mode, .heard = d->heard,
		.lost = d->lost, .status = d->status, .actual = d->actual,
		.emergencies = d->came,
	};
	memcpy(ret->emergency, d->history, sizeof(ret->emergency));
}

void can402_drives(void *self, struct cia402_told *ret)
{
	const struct can402 *s = self;

	*ret = (struct cia402_told) { .at = s->drive[0].periods, .n = s->n,
				      .answer = s->drive[s->asked].object };
	for (uint32_t i = 0; i < s->n; i++)
		tell(s, i, &ret->drive[i]);
}

bool can402_object(void *self, const struct cia402_request *r)
{
	struct can402 *s = self;

	if (s->drive[s->asked].object.end == CIA402_UNDER_WAY)
		return false;
	for (uint32_t i = 0; i < s->n; i++) {
		if (s->axis[i] != r->axis)
			continue;
		s->asked = i;
		drive_object_ask(&s->drive[i], r);
		return true;
	}
	return false;
}
