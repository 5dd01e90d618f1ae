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

/**
 * talk_stop_send() - give the act to edmd; it does not wait.
 * Return: a descriptor for talk_stop_take(); -EINVAL: not such a verb; else
 * -errno: edmd does not take it.
 */
int talk_stop_send(const char *machine, const char *verb, uint64_t id);

/**
 * talk_stop_take() - the answer, if it is there; then @fd is closed.
 * Return: 1 with @ret_code filled, 0: done; 0: not yet; -ENOTCONN: it was not
 * answered.
 */
int talk_stop_take(int fd, int *ret_code);

/* What to tell of an act that only edmd has answered. */
#define TALK_STOP_DONE "done by edmd itself; edmd-jobs does not answer: " \
	"systemctl status edmd-jobs"

/**
 * talk_stop_ask() - the same without a struct talk, and wait for the answer.
 * Return: 0: done; -ECANCELED: nothing moves that it would end; -ETIMEDOUT; as
 * talk_stop_send(); -ENOMEM.
 */
int talk_stop_ask(const char *machine, const char *verb, double timeout_s,
		  struct talk_answer *ret);

/** talk_stop_listens() - is there an edmd to which such an act can go? */
bool talk_stop_listens(const char *machine);

#endif /* CLIENT_TALK_STOP_H */
