/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpiod1.c - lines.h on libgpiod 1.6
 */
#include "lines.h"

#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>

#define CONSUMER	"edmd"
#define KEPT		16		/* edges of a line, by the kernel */

struct lines_chip {
	struct gpiod_chip *gpiod;
	unsigned int users;		/* the opener, and each request */
};

/* Lines of libgpiod 1.6 live no longer than their chip. */
struct lines {
	struct gpiod_line_bulk bulk;
	struct lines_chip *chip;
};

int lines_chip_open(struct lines_chip **ret, const char *path)
{
	struct lines_chip *c = calloc(1, sizeof(*c));
	int err;

	if (!c)
		return -ENOMEM;
	c->gpiod = gpiod_chip_open(path);
	if (!c->gpiod) {
		err = -errno;
		free(c);
		return err;
	}
	c->users = 1;
	*ret = c;
	return 0;
}

void lines_chip_close(struct lines_chip *chip)
{
	if (--chip->users > 0)
		return;
	gpiod_chip_close(chip->gpiod);
	free(chip);
}

unsigned int lines_chip_count(struct lines_chip *chip)
{
	return gpiod_chip_num_lines(chip->gpiod);
}

void lines_chip_label(struct lines_chip *chip, char *buf, size_t size)
{
	const char *label = gpiod_chip_label(chip->gpiod);

	snprintf(buf, size, "%s", label ? label : "");
}

bool lines_chip_user(struct lines_chip *chip, unsigned int offset, char *buf,
		     size_t size)
{
	struct gpiod_line *line = gpiod_chip_get_line(chip->gpiod, offset);
	const char *user = line ? gpiod_line_consumer(line) : NULL;

	snprintf(buf, size, "%s", user ? user : "the kernel");
	return line && gpiod_line_is_used(line);
}

static int flags_of(enum lines_pull pull)
{
	switch (pull) {
	case LINES_PULL_UP:
		return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
	case LINES_PULL_DOWN:
		return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
	case LINES_NO_PULL:
		return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
	default:
		return 0;
	}
}

/* A line that is watched is a file of its own. */
static int never_wait(struct lines *l)
{
	for (unsigned int i = 0; i < gpiod_line_bulk_num_lines(&l->bulk); i++) {
		const int fd = gpiod_line_event_get_fd(
			gpiod_line_bulk_get_line(&l->bulk, i));

		if (fd < 0 || fcntl(fd, F_SETFL, O_NONBLOCK) < 0)
			return -errno;
	}
	return 0;
}

static int request(struct lines *l, const struct lines_wanted *w)
{
	const struct gpiod_line_request_config config = {
		.consumer = CONSUMER,
		.request_type = w->output ?
				GPIOD_LINE_REQUEST_DIRECTION_OUTPUT :
				w->watched ?
				GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES :
				GPIOD_LINE_REQUEST_DIRECTION_INPUT,
		.flags = w->output ? 0 : flags_of(w->pull),
	};
	int value[LINES_MAX] = { 0 };

	gpiod_line_bulk_init(&l->bulk);
	for (size_t i = 0; i < w->n; i++) {
		struct gpiod_line *line =
			gpiod_chip_get_line(l->chip->gpiod, w->offset[i]);

		if (!line)
			return -errno;
		gpiod_line_bulk_add(&l->bulk, line);
		value[i] = w->output && w->value[i];
	}
	if (gpiod_line_request_bulk(&l->bulk, &config, value) < 0)
		return -errno;
	return w->watched ? never_wait(l) : 0;
}

int lines_request(struct lines **ret, struct lines_chip *chip,
		  const struct lines_wanted *w)
{
	struct lines *l = calloc(1, sizeof(*l));
	int err;

	if (!l)
		return -ENOMEM;
	l->chip = chip;
	err = request(l, w);
	if (err < 0) {
		free(l);
		return err;
	}
	chip->users++;
	*ret = l;
	return 0;
}

int lines_set(struct lines *l, const uint8_t *value)
{
	int level[LINES_MAX];

	for (unsigned int i = 0; i < gpiod_line_bulk_num_lines(&l->bulk); i++)
		level[i] = value[i];
	return gpiod_line_set_value_bulk(&l->bulk, level) < 0 ? -errno : 0;
}

int lines_get(struct lines *l, uint8_t *value)
{
	int level[LINES_MAX];

	if (gpiod_line_get_value_bulk(&l->bulk, level) < 0)
		return -errno;
	for (unsigned int i = 0; i < gpiod_line_bulk_num_lines(&l->bulk); i++)
		value[i] = level[i] != 0;
	return 0;
}

static uint64_t ns_of(const struct timespec *t)
{
	return (uint64_t)t->tv_sec * 1000000000 + (uint64_t)t->tv_nsec;
}

int lines_events(struct lines *l, struct lines_event *ret, int room)
{
	struct gpiod_line_event e[KEPT];
	int n = 0;

	for (unsigned int i = 0; i < gpiod_line_bulk_num_lines(&l->bulk); i++) {
		const int fd = gpiod_line_event_get_fd(
			gpiod_line_bulk_get_line(&l->bulk, i));
		const int got = gpiod_line_event_read_fd_multiple(fd, e, KEPT);

		if (got == KEPT || (got < 0 && errno != EAGAIN) ||
		    n + got > room)
			return -EOVERFLOW;
		for (int k = 0; k < got; k++)
			ret[n++] = (struct lines_event) {
				.ns = ns_of(&e[k].ts), .slot = (uint8_t)i,
				.high = e[k].event_type ==
					GPIOD_LINE_EVENT_RISING_EDGE,
			};
	}
	return n;
}

void lines_release(struct lines *l)
{
	if (!l)
		return;
	gpiod_line_release_bulk(&l->bulk);
	lines_chip_close(l->chip);
	free(l);
}
