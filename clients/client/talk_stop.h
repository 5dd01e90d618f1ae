/* SPDX-License-Identifier: Apache-2.0 */
/*
 * talk_stop.h - acts that end motion go to edmd itself, too
 *
 * On the machine's host edmd has a socket for them (words/stop_act.h), which
 * needs no edmd-jobs, no key and no session.  talk_send() uses it for each such
 * act; what edmd-jobs answers counts, if it answers.
 *
 * Threads: any.
 */
#ifndef CLIENT_TALK_STOP_H
#define CLIENT_TALK_STOP_H

#include "talk.h"

/** talk_stop_is() - does the verb end motion? */
bool talk_stop_is(const char *verb);

/* An act on its way to edmd; all 0: none. */
struct talk_stop {
	char machine[32];
	uint32_t verb;			/* enum stop_act_verb */
	uint64_t id;			/* 0: answered, or none */
	int fd;				/* -1: edmd does not take it now */
	double tried_s;
};

/**
 * talk_stop_begin() - give the act to edmd; it does not wait.
 * @verb: one for which talk_stop_is() is true.
 */
void talk_stop_begin(struct talk_stop *s, const char *machine,
		     const char *verb, uint64_t id);

/**
 * talk_stop_turn() - the answer, if it is there.  An act that edmd did not take
 * because many others asked at that moment or because it was just starting, is
 * given to it again; by its id it is done once.  Call it every few ms.
 * Return: has it been answered?  Then @ret_code is filled, 0: done.
 */
bool talk_stop_turn(struct talk_stop *s, int *ret_code);

/** talk_stop_end() - wait for the answer no more. */
void talk_stop_end(struct talk_stop *s);

/* What to tell of an act that only edmd has answered. */
#define TALK_STOP_DONE "done by edmd itself; edmd-jobs does not answer: " \
	"systemctl status edmd-jobs"

/**
 * talk_stop_ask() - the same without a struct talk, and wait for the answer.
 * Return: 0: done; -ECANCELED: nothing moves that it would end; -ETIMEDOUT;
 * -EINTR; -ENOMEM.
 */
int talk_stop_ask(const char *machine, const char *verb, double timeout_s,
		  struct talk_answer *ret);

/** talk_stop_listens() - is there an edmd to which such an act can go? */
bool talk_stop_listens(const char *machine);

#endif /* CLIENT_TALK_STOP_H */
