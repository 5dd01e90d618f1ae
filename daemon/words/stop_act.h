/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stop_act.h - what goes over edmd's own socket for acts that end motion
 *
 * The socket is places.h, "stop": SOCK_SEQPACKET, for edmd's user and group.  A
 * client connects, sends a struct stop_act, gets a struct stop_answer, closes.
 * There is nothing else to say there: no session, no question, no verb that
 * begins anything.  The numbers are of the host's byte order.
 *
 * Threads: any; plain data.
 */
#ifndef WORDS_STOP_ACT_H
#define WORDS_STOP_ACT_H

#include <stdint.h>

#define STOP_ACT_MAGIC	0x65737470u	/* "estp" */

/* The verb of words/verbs.h, and its name. */
#define STOP_ACT_ROWS(V) \
	V(HOLD, "hold") \
	V(STOP, "stop") \
	V(ESTOP, "estop")

#define STOP_ACT_VERB(verb, name)	STOP_ACT_##verb,

enum stop_act_verb { STOP_ACT_ROWS(STOP_ACT_VERB) STOP_ACT_NVERBS };

#undef STOP_ACT_VERB

struct stop_act {
	uint32_t magic;
	uint32_t verb;			/* enum stop_act_verb */
	uint64_t id;			/* seal_act_id(), or drawn; not 0 */
};

struct stop_answer {
	uint32_t magic;
	int32_t code;			/* 0: done; else refused by the state
					 * of the machine: enum shm_answer */
	uint64_t id;
};

#endif /* WORDS_STOP_ACT_H */
