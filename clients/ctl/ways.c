/* SPDX-License-Identifier: Apache-2.0 */
/* ways.c - which ways lead to the machine while edmd-jobs is silent */
#include "ctl.h"

#include "shm.h"
#include "talk_stop.h"

#include <poll.h>
#include <stdio.h>

#define LOOK_MS	100

/* Does its cycle go on? */
static bool moves_on(const struct shm_status *s)
{
	struct shm_snapshot before, now;

	if (!shm_alive(s) || !shm_snapshot(s, &before))
		return false;
	for (int ms = 0; ms < LOOK_MS; ms += 10) {
		poll(NULL, 0, 10);
		if (shm_snapshot(s, &now) && now.cycle != before.cycle)
			return true;
	}
	return false;
}

void ctl_ways_print(const struct ctl *c)
{
	const struct shm_status *s;
	bool works;

	/* A machine of another host, or none. */
	if (c->url || shm_status_open(&s, c->machine) < 0)
		return;
	works = moves_on(s) && talk_stop_listens(c->machine);
	shm_close(s, sizeof(*s));
	fprintf(stderr, "edmctl: %s\n", works ?
		"edmd-jobs does not answer; hold, stop and estop go to edmd "
		"itself, nothing else works; beside them use the machine's "
		"own emergency stop" :
		"no command reaches the machine: use its own emergency stop");
}
