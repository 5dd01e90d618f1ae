/* SPDX-License-Identifier: Apache-2.0 */
/*
 * logger.c - lines on stderr that never hold their writer up
 */
#include "logger.h"

#include "plain.h"
#include "thread.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define CAUSES		64
#define STOP_MS		200

struct slot {
	size_t bytes;
	char text[LOGGER_BYTES_MAX];
};

/* How often a cause was told in this second, and how often not. */
struct cause {
	const char *format;
	time_t second;
	unsigned int told, more;
};

static struct {
	pthread_mutex_t lock;
	pthread_cond_t changed;
	pthread_t thread;
	bool started, ending;
	struct slot slot[LOGGER_SLOTS];
	unsigned int first, count;	/* the one being written is the first */
	unsigned long dropped;
	struct cause cause[CAUSES];
} line = {
	.lock = PTHREAD_MUTEX_INITIALIZER,
	.changed = PTHREAD_COND_INITIALIZER,
};

static void write_all(const char *text, size_t bytes)
{
	while (bytes > 0) {
		ssize_t n = write(STDERR_FILENO, text, bytes);

		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return;
		text += n;
		bytes -= (size_t)n;
	}
}

/* With the lock held, if there is a thread. */
static bool put(const char *text)
{
	const size_t bytes = strlen(text);
	struct slot *s;

	if (!line.started) {
		write_all(text, bytes);
		return true;
	}
	if (line.count == LOGGER_SLOTS)
		return false;
	s = &line.slot[(line.first + line.count) % LOGGER_SLOTS];
	memcpy(s->text, text, bytes);
	s->bytes = bytes;
	line.count++;
	pthread_cond_broadcast(&line.changed);
	return true;
}

static void tell_dropped(void)
{
	char text[96];

	if (line.dropped == 0)
		return;
	snprintf(text, sizeof(text), "log: %lu lines were dropped: who reads "
		 "them did not keep up\n", line.dropped);
	if (put(text))
		line.dropped = 0;
}

static void tell_more(struct cause *c)
{
	char text[LOGGER_BYTES_MAX];

	if (c->more == 0)
		return;
	snprintf(text, sizeof(text), "log: %u more lines like '%.80s'\n",
		 c->more, c->format);
	if (!put(text))
		line.dropped++;
	c->more = 0;
}

/* @format's place in the table; another cause may have to leave it. */
static struct cause *cause_of(const char *format, time_t now)
{
	struct cause *oldest = &line.cause[0];

	for (int i = 0; i < CAUSES; i++) {
		struct cause *c = &line.cause[i];

		if (c->format == format)
			return c;
		if (!c->format || c->second < oldest->second)
			oldest = c;
	}
	tell_more(oldest);
	*oldest = (struct cause) { .format = format, .second = now };
	return oldest;
}

static bool may_say(const char *format)
{
	struct timespec now;
	struct cause *c;

	clock_gettime(CLOCK_MONOTONIC, &now);
	c = cause_of(format, now.tv_sec);
	if (c->second != now.tv_sec) {
		tell_more(c);
		c->second = now.tv_sec;
		c->told = 0;
	}
	if (c->told++ < LOGGER_A_SECOND)
		return true;
	c->more++;
	return false;
}

void logger_say(const char *prefix, const char *format, va_list args)
{
	char text[LOGGER_BYTES_MAX];
	/* The prefix may be the journal's own, "<3>". */
	size_t n = (size_t)snprintf(text, sizeof(text) - 1, "%.64s", prefix);

	vsnprintf(text + n, sizeof(text) - 1 - n, format, args);
	plain_copy(text + n, sizeof(text) - 1 - n, text + n);
	n = strlen(text);
	text[n] = '\n';
	text[n + 1] = '\0';

	pthread_mutex_lock(&line.lock);
	tell_dropped();
	if (may_say(format) && !put(text))
		line.dropped++;
	pthread_mutex_unlock(&line.lock);
}

static void *run(void *arg)
{
	(void)arg;
	pthread_mutex_lock(&line.lock);
	while (line.count > 0 || !line.ending) {
		if (line.count == 0) {
			pthread_cond_wait(&line.changed, &line.lock);
			continue;
		}
		pthread_mutex_unlock(&line.lock);
		write_all(line.slot[line.first].text,
			  line.slot[line.first].bytes);
		pthread_mutex_lock(&line.lock);
		line.first = (line.first + 1) % LOGGER_SLOTS;
		line.count--;
		tell_dropped();
		pthread_cond_broadcast(&line.changed);
	}
	pthread_mutex_unlock(&line.lock);
	return NULL;
}

int logger_start(void)
{
	int err;

	pthread_mutex_lock(&line.lock);
	err = thread_start(&line.thread, &(struct thread) {
		.name = "log", .run = run });
	line.started = err == 0;
	pthread_mutex_unlock(&line.lock);
	return err;
}

/* A thread that hangs in a write() is left to the end of the process. */
void logger_stop(void)
{
	struct timespec until;

	if (!line.started)
		return;
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_nsec += STOP_MS * 1000000L;
	until.tv_sec += until.tv_nsec / 1000000000L;
	until.tv_nsec %= 1000000000L;

	pthread_mutex_lock(&line.lock);
	for (int i = 0; i < CAUSES; i++)
		tell_more(&line.cause[i]);
	line.ending = true;
	pthread_cond_broadcast(&line.changed);
	while (line.count > 0 &&
	       pthread_cond_clockwait(&line.changed, &line.lock,
				      CLOCK_MONOTONIC, &until) == 0)
		;
	if (line.count == 0) {
		pthread_mutex_unlock(&line.lock);
		pthread_join(line.thread, NULL);
		line.started = false;
		return;
	}
	pthread_mutex_unlock(&line.lock);
}
