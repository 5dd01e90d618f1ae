/* SPDX-License-Identifier: Apache-2.0 */
/*
 * frames.h - refuses frames of a browser that are not masked
 *
 * RFC 6455, 5.1: a server ends a connection on which a client sent a frame that
 * is not masked.  libwebsockets 4.1 takes such frames, and tells nobody that
 * they were not masked.  So what it reads is looked at while it is read:
 * frames.c has a recv() and an SSL_read() that libwebsockets finds before those
 * of the C library and of OpenSSL.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_FRAMES_H
#define PANEL_FRAMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Where in the frames of a connection the next byte is. */
struct frames {
	unsigned int head;		/* bytes of the frame's head so far */
	unsigned int head_bytes;	/* that it has; 0: not known yet */
	uint64_t payload;		/* bytes of it that are still to come */
	unsigned char length;		/* its first length */
	bool bad;			/* one was not masked */
};

/**
 * frames_begin() - from now on @fd has frames.
 *
 * Return: false: bytes came with the request already, though a client has to
 * wait for the answer.
 */
bool frames_begin(int fd);

/** frames_none() - @fd is a new connection, or a request on it is over. */
void frames_none(int fd);

/** frames_look() - what was read.  Return: is all of it masked? */
bool frames_look(struct frames *f, const unsigned char *at, size_t n);

#endif /* PANEL_FRAMES_H */
