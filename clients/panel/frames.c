/* SPDX-License-Identifier: Apache-2.0 */
/* frames.c - refuses frames of a browser that are not masked */
#include "frames.h"

#include <errno.h>
#include <openssl/ssl.h>
#include <string.h>
#include <sys/socket.h>

#define FDS_MAX		1024		/* LimitNOFILE of the unit */
#define MASKED		0x80u
#define LENGTH		0x7fu
#define HEAD_END	0x0d0a0d0au	/* two ends of lines */

static struct {
	bool begun;
	struct frames frames;
	/* Before that: */
	uint32_t last;			/* four bytes that were read */
	unsigned int heads;		/* ends of a request's head in them */
} of[FDS_MAX];

/* -- The bytes ------------------------------------------------------------ */

/* One byte of the head: opcode, length, more of the length, mask. */
static void take_head(struct frames *f, unsigned char c)
{
	const unsigned int n = f->head++;

	if (n == 1) {
		f->bad = !(c & MASKED);
		f->length = c & LENGTH;
		f->payload = f->length < 126 ? f->length : 0;
		f->head_bytes = f->length == 126 ? 8 :
				f->length == 127 ? 14 : 6;
	} else if (n > 1 && n < f->head_bytes - 4) {
		f->payload = f->payload << 8 | c;
	}
}

bool frames_look(struct frames *f, const unsigned char *at, size_t n)
{
	while (n > 0 && !f->bad) {
		if (!f->head_bytes || f->head < f->head_bytes) {
			take_head(f, *at);
			at++;
			n--;
		} else {
			const size_t skip = f->payload < n ?
					    (size_t)f->payload : n;

			at += skip;
			n -= skip;
			f->payload -= skip;
		}
		if (f->head_bytes && f->head == f->head_bytes && !f->payload)
			f->head = f->head_bytes = 0;
	}
	return !f->bad;
}

bool frames_begin(int fd)
{
	if (fd < 0 || fd >= FDS_MAX || of[fd].heads != 1 ||
	    of[fd].last != HEAD_END)
		return false;
	of[fd].begun = true;
	of[fd].frames = (struct frames) { .head = 0 };
	return true;
}

void frames_none(int fd)
{
	if (fd < 0 || fd >= FDS_MAX)
		return;
	of[fd].begun = false;
	of[fd].last = 0;
	of[fd].heads = 0;
}

static void count_heads(int fd, const unsigned char *at, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		of[fd].last = of[fd].last << 8 | at[i];
		of[fd].heads += of[fd].last == HEAD_END;
	}
}

/* -- Where libwebsockets reads -------------------------------------------- */

static bool is_masked(int fd, const void *at, size_t n)
{
	if (fd < 0 || fd >= FDS_MAX)
		return true;
	if (of[fd].begun)
		return frames_look(&of[fd].frames, at, n);
	count_heads(fd, at, n);
	return true;
}

/* It ends a connection that cannot be read. */
ssize_t recv(int fd, void *to, size_t size, int flags)
{
	const ssize_t n = recvfrom(fd, to, size, flags, NULL, NULL);

	if (n <= 0 || is_masked(fd, to, (size_t)n))
		return n;
	errno = ECONNRESET;
	return -1;
}

int SSL_read(SSL *ssl, void *to, int size)
{
	size_t n = 0;

	if (size < 0 || !SSL_read_ex(ssl, to, (size_t)size, &n))
		return -1;
	if (is_masked(SSL_get_fd(ssl), to, n))
		return (int)n;
	SSL_set_shutdown(ssl, SSL_RECEIVED_SHUTDOWN);
	errno = ECONNRESET;
	return -1;
}
