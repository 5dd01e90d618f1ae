/* SPDX-License-Identifier: Apache-2.0 */
/* moved.c - how the motion ended that was asked for last */
#include "cycle.h"

void moved_begin(struct cycle *c)
{
	c->moved = (struct moved) { .how = MOVED_GOES_ON };
}

void moved_watch(struct cycle *c)
{
	struct moved *m = &c->moved;

	if (m->how != MOVED_GOES_ON || (cycle_moves(c) && !c->fault.latched))
		return;
	m->how = c->fault.latched ? MOVED_FAULT :
		 m->there ? MOVED_THERE : MOVED_SHORT;
}
