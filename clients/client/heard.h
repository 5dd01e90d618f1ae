/* SPDX-License-Identifier: Apache-2.0 */
/*
 * heard.h - which machines send their STATUS now
 *
 * To tell somebody who asked for a machine that is not there.  Anybody may send
 * such packets, and nobody has checked who did: the names are a hint, and
 * nothing may be decided by them.
 *
 * Threads: any.
 */
#ifndef CLIENT_HEARD_H
#define CLIENT_HEARD_H

#include "keyfile.h"

struct heard {
	char name[8][KEYFILE_NAME_MAX];	/* plain: A-Z a-z 0-9 . _ - */
	int n;
};

/**
 * heard_listen() - listen at @url for @ms; a service sends ten STATUS a second.
 * NULL: at TALK_URL, and look for the sockets of this host.
 * Return: 0; -EINVAL: no such URL; -errno.
 */
int heard_listen(struct heard *ret, const char *url, int ms);

#endif /* CLIENT_HEARD_H */
