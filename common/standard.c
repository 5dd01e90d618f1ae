/* SPDX-License-Identifier: Apache-2.0 */
/* standard.c - standard input, output and error, from the start to the exit */
#include "standard.h"

#include "plain.h"
#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static const char *name;
static volatile sig_atomic_t interrupted;

void standard_interrupt(void)
{
	interrupted = 1;
}

/* The signal broke off a write, most likely into a pipe that nobody reads.  To
 * find out by another write could block again. */
static void interruption_check(bool failed)
{
	if (!interrupted || !failed)
		return;
	fprintf(stderr, "%s: interrupted; standard output is not complete\n",
		name);
	_exit(EX_TEMPFAIL);
}

static void output_check(void)
{
	int err;

	interruption_check(ferror(stdout));
	err = output_close(stdout);
	if (err == 0)
		return;
	interruption_check(err == -EINTR);
	fprintf(stderr, "%s: standard output: %s; it is not complete\n", name,
		strerror(-err));
	_exit(EX_IOERR);
}

/* -- Plain text ----------------------------------------------------------- */

#define PIECE	4096

/* A stream that prints plain text alone. */
struct plain_stream {
	FILE *raw;			/* as it was before */
	int fd;
	char left[4];			/* the begin of a character */
	size_t nleft;
};

static struct plain_stream out = { .fd = STDOUT_FILENO };
static struct plain_stream err = { .fd = STDERR_FILENO };

static int write_all(int fd, const char *at, size_t n)
{
	while (n > 0) {
		const ssize_t put = write(fd, at, n);

		if (put < 0 && errno == EINTR && !interrupted)
			continue;
		if (put < 0)
			return -1;
		at += put;
		n -= (size_t)put;
	}
	return 0;
}

/* How many of the @n bytes at @at make its first character; 0: not all of them
 * are there. */
static size_t whole(const char *at, size_t n)
{
	const unsigned char c = (unsigned char)*at;
	const size_t bytes = c == '\r' ? 2 : c < 0xc2 ? 1 : c < 0xe0 ? 2 :
			     c < 0xf0 ? 3 : 4;

	for (size_t i = 1; i < bytes && c != '\r'; i++)
		if (i < n && ((unsigned char)at[i] & 0xc0) != 0x80)
			return 1;
	return bytes <= n ? bytes : 0;
}

/* @text ends with a NUL behind its @n bytes.  Return: the bytes in @to. */
static size_t clean(struct plain_stream *s, char *to, const char *text,
		    size_t n)
{
	const char *const end = text + n;
	size_t put = 0;

	s->nleft = 0;
	while (text < end) {
		const size_t bytes = whole(text, (size_t)(end - text));
		size_t good = *text == '\n' || *text == '\t' ? 1 :
			      plain_bytes(text);

		if (bytes == 0) {
			s->nleft = (size_t)(end - text);
			memcpy(s->left, text, s->nleft);
			break;
		}
		if (text[0] == '\r' && text[1] == '\n')
			good = 2;
		if (good == 0)
			to[put++] = '?';
		memcpy(to + put, text, good);
		put += good;
		text += good ? good : 1;
	}
	return put;
}

static ssize_t put_plain(void *cookie, const char *text, size_t n)
{
	struct plain_stream *s = cookie;
	char from[PIECE + sizeof(s->left) + 1], to[sizeof(from)];

	for (size_t done = 0; done < n;) {
		const size_t had = s->nleft;
		const size_t piece = n - done < PIECE ? n - done : PIECE;
		size_t bytes;

		memcpy(from, s->left, had);
		memcpy(from + had, text + done, piece);
		from[had + piece] = '\0';
		bytes = clean(s, to, from, had + piece);
		if (write_all(s->fd, to, bytes) < 0)
			return 0;
		done += piece;
	}
	return (ssize_t)n;
}

static void guard_stream(FILE **f, struct plain_stream *s, int mode)
{
	FILE *plain = fopencookie(s, "w", (cookie_io_functions_t) {
		.write = put_plain,
	});

	if (!plain)
		_exit(EX_OSERR);
	setvbuf(plain, NULL, mode, mode == _IONBF ? 0 : BUFSIZ);
	s->raw = *f;
	*f = plain;
}

void standard_control(FILE *f, const char *sequence)
{
	fflush(f);
	/* If it does not move, the text comes nevertheless. */
	write_all(f == stderr ? STDERR_FILENO : STDOUT_FILENO, sequence,
		  strlen(sequence));
}

void standard_raw(void)
{
	if (!out.raw)
		return;
	fflush(stdout);
	stdout = out.raw;
}

void standard_guard(const char *program)
{
	/* The wrong way round: who reads or prints nevertheless is told. */
	static const int mode[] = { O_WRONLY, O_RDONLY, O_WRONLY };

	for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
		if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", mode[fd]) < 0)
			_exit(EX_OSERR);
	name = program;
	guard_stream(&stdout, &out, isatty(STDOUT_FILENO) ? _IOLBF : _IOFBF);
	guard_stream(&stderr, &err, _IONBF);
	atexit(output_check);
}
