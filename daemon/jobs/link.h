/* SPDX-License-Identifier: Apache-2.0 */
/*
 * link.h - edmd as edmd-jobs sees it: whether it runs, its snapshot, its
 * answers
 *
 * It is looked at every 20 ms. edmd is there while its process lives and its
 * cycle counter moves. It is lost 0.5 s after the counter stopped, or at once
 * if the process has ended. An edmd that was started again is another instance,
 * even if nobody saw it missing.
 *
 * Units: in every name; now_us is monotonic.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_LINK_H
#define JOBS_LINK_H

#include "shm.h"

#define LINK_PENDING	32		/* commands under way */

enum link_state { LINK_ABSENT, LINK_OK, LINK_LOST };

/* @code: enum shm_answer; SHM_TAKEN edmd has it and does not answer;
 * -ETIMEDOUT it was not taken in time and will not be; -ENOTCONN edmd went
 * away before it took it. */
typedef void (*link_answer_fn)(void *arg, int code);

struct link_handlers {
	/* Events may come again after edmd or this service was restarted. */
	void (*event)(void *arg, const struct shm_event *e);
	/* state has changed; on LINK_OK, instance is the one in force. */
	void (*changed)(void *arg);
	void *arg;
};

struct link_pending {
	uint64_t id;			/* 0: free */
	int64_t until_us;
	link_answer_fn answer;
	void *arg;
	uint64_t refused;		/* by the state; told with the snapshot
					 * of this cycle; 0: not refused */
};

/* Placed by the caller; read, do not write. */
struct link {
	enum link_state state;
	uint32_t instance;
	struct shm_snapshot snap;	/* the last one seen */
	/* Private. */
	char machine[SHM_NAME_MAX];
	struct link_handlers handlers;
	const struct shm_status *status;
	int commands;			/* a socket; -1: none */
	struct shm_follow events;
	uint64_t events_before;		/* written before it was opened */
	int64_t moved_us, looked_us;
	int wrong;			/* -errno of the last try to open it */
	bool moved;			/* a new cycle was seen since opening */
	bool ended;			/* its process has */
	uint64_t next_id;
	struct link_pending pending[LINK_PENDING];
};

/* What to tell edmd. */
struct link_command {
	uint64_t id;			/* 0: one is drawn */
	uint32_t verb;			/* enum shm_verb */
	uint32_t arg;
	double arg_mm;			/* or in the unit of the field set */
	int64_t take_us;		/* edmd does not take it later than
					 * this; 0: the usual time */
	int64_t answer_us;		/* it may need so long to answer; 0: the
					 * usual time */
	link_answer_fn answer;		/* it is called once, and never from
					 * link_send() */
	void *answer_arg;
};

void link_init(struct link *l, const char *machine,
	       const struct link_handlers *h);
void link_fini(struct link *l);

/** link_poll() - look at edmd and call the handlers. */
void link_poll(struct link *l, int64_t now_us);

/**
 * link_send() - send a command.  Return: 0; -ENOTCONN: there is no edmd;
 * -EAGAIN: too many commands are under way.
 */
int link_send(struct link *l, const struct link_command *c, int64_t now_us);

/**
 * link_await() - wait for the answer to command @id, which was handed over
 * before this service was restarted. Return: 0; -EAGAIN: too many commands are
 * under way.
 */
int link_await(struct link *l, const struct link_command *c, int64_t now_us);

/**
 * link_ended() - call @each with every job that edmd knows to have ended, the
 * oldest first.
 */
void link_ended(struct link *l,
		void (*each)(void *arg, const struct shm_ended *e), void *arg);

/** link_is_repeat() - may the event that is being handed over have been handed
 *  over before? */
bool link_is_repeat(const struct link *l);

/** link_state_name() - "ok", "lost", "absent". */
const char *link_state_name(enum link_state s);

#endif /* JOBS_LINK_H */
