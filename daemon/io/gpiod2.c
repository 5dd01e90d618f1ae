/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpiod2.c - lines.h on libgpiod 2.x
 */
#include "lines.h"

#include <errno.h>
#include <fcntl.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>

#define CONSUMER	"edmd"

struct lines_chip {
	struct gpiod_chip *gpiod;
};

struct lines {
	struct gpiod_line_request *request;
	size_t n;

	/* Of watched lines. */
	struct gpiod_edge_event_buffer *events;
	unsigned int offset[LINES_MAX];
	unsigned long seen[LINES_MAX];	/* number of the last edge */
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
	*ret = c;
	return 0;
}

void lines_chip_close(struct lines_chip *chip)
{
	gpiod_chip_close(chip->gpiod);
	free(chip);
}

unsigned int lines_chip_count(struct lines_chip *chip)
{
	struct gpiod_chip_info *info = gpiod_chip_get_info(chip->gpiod);
	size_t n = info ? gpiod_chip_info_get_num_lines(info) : 0;

	gpiod_chip_info_free(info);
	return (unsigned int)n;
}

void lines_chip_label(struct lines_chip *chip, char *buf, size_t size)
{
	struct gpiod_chip_info *info = gpiod_chip_get_info(chip->gpiod);

	snprintf(buf, size, "%s", info ? gpiod_chip_info_get_label(info) : "");
	gpiod_chip_info_free(info);
}

bool lines_chip_user(struct lines_chip *chip, unsigned int offset, char *buf,
		     size_t size)
{
	struct gpiod_line_info *info =
		gpiod_chip_get_line_info(chip->gpiod, offset);
	const char *user = info ? gpiod_line_info_get_consumer(info) : NULL;
	const bool used = info && gpiod_line_info_is_used(info);

	snprintf(buf, size, "%s", user ? user : "the kernel");
	gpiod_line_info_free(info);
	return used;
}

static enum gpiod_line_bias bias_of(enum lines_pull pull)
{
	switch (pull) {
	case LINES_PULL_UP:
		return GPIOD_LINE_BIAS_PULL_UP;
	case LINES_PULL_DOWN:
		return GPIOD_LINE_BIAS_PULL_DOWN;
	case LINES_NO_PULL:
		return GPIOD_LINE_BIAS_DISABLED;
	default:
		return GPIOD_LINE_BIAS_AS_IS;
	}
}

/* Each line on its own: outputs begin at values of their own. */
static int configure(struct gpiod_line_config *config,
		     struct gpiod_line_settings *s,
		     const struct lines_wanted *w)
{
	int err = 0;

	gpiod_line_settings_set_direction(s, w->output ?
					     GPIOD_LINE_DIRECTION_OUTPUT :
					     GPIOD_LINE_DIRECTION_INPUT);
	if (!w->output)
		gpiod_line_settings_set_bias(s, bias_of(w->pull));
	if (w->watched)
		gpiod_line_settings_set_edge_detection(s,
						       GPIOD_LINE_EDGE_BOTH);
	for (size_t i = 0; i < w->n && err == 0; i++) {
		gpiod_line_settings_set_output_value(
			s, w->output && w->value[i] ?
			   GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE);
		err = gpiod_line_config_add_line_settings(
			config, &w->offset[i], 1, s);
	}
	return err;
}

static int request(struct lines *l, struct lines_chip *chip,
		   const struct lines_wanted *w)
{
	struct gpiod_line_settings *s = gpiod_line_settings_new();
	struct gpiod_line_config *config = gpiod_line_config_new();
	struct gpiod_request_config *who = gpiod_request_config_new();
	int err = -ENOMEM;

	if (s && config && who) {
		gpiod_request_config_set_consumer(who, CONSUMER);
		if (configure(config, s, w) == 0)
			l->request = gpiod_chip_request_lines(chip->gpiod, who,
							      config);
		err = l->request ? 0 : -errno;
	}
	gpiod_request_config_free(who);
	gpiod_line_config_free(config);
	gpiod_line_settings_free(s);
	return err;
}

static int watch(struct lines *l, const struct lines_wanted *w)
{
	for (size_t i = 0; i < w->n; i++)
		l->offset[i] = w->offset[i];
	l->events = gpiod_edge_event_buffer_new(LINES_EVENTS);
	if (!l->events)
		return -ENOMEM;
	return fcntl(gpiod_line_request_get_fd(l->request), F_SETFL,
		     O_NONBLOCK) < 0 ? -errno : 0;
}

int lines_request(struct lines **ret, struct lines_chip *chip,
		  const struct lines_wanted *w)
{
	struct lines *l = calloc(1, sizeof(*l));
	int err;

	if (!l)
		return -ENOMEM;
	l->n = w->n;
	err = request(l, chip, w);
	if (err == 0 && w->watched)
		err = watch(l, w);
	if (err < 0) {
		lines_release(l);
		return err;
	}
	*ret = l;
	return 0;
}

int lines_set(struct lines *l, const uint8_t *value)
{
	enum gpiod_line_value level[LINES_MAX];

	for (size_t i = 0; i < l->n; i++)
		level[i] = value[i] ? GPIOD_LINE_VALUE_ACTIVE :
				      GPIOD_LINE_VALUE_INACTIVE;
	return gpiod_line_request_set_values(l->request, level) < 0 ? -errno :
								      0;
}

int lines_get(struct lines *l, uint8_t *value)
{
	enum gpiod_line_value level[LINES_MAX];

	if (gpiod_line_request_get_values(l->request, level) < 0)
		return -errno;
	for (size_t i = 0; i < l->n; i++)
		value[i] = level[i] == GPIOD_LINE_VALUE_ACTIVE;
	return 0;
}

/* Each edge of a line has a number; false: some before it were dropped. */
static bool event_of(struct lines *l, struct gpiod_edge_event *e,
		     struct lines_event *ret)
{
	const unsigned int offset = gpiod_edge_event_get_line_offset(e);
	const unsigned long number = gpiod_edge_event_get_line_seqno(e);
	bool all;

	*ret = (struct lines_event) {
		.ns = gpiod_edge_event_get_timestamp_ns(e),
		.high = gpiod_edge_event_get_event_type(e) ==
			GPIOD_EDGE_EVENT_RISING_EDGE,
	};
	while (ret->slot + 1u < l->n && l->offset[ret->slot] != offset)
		ret->slot++;
	all = number == l->seen[ret->slot] + 1;
	l->seen[ret->slot] = number;
	return all;
}

int lines_events(struct lines *l, struct lines_event *ret, int room)
{
	const int got = gpiod_line_request_read_edge_events(
		l->request, l->events, LINES_EVENTS);
	bool all = true;

	if (got < 0)
		return errno == EAGAIN ? 0 : -EOVERFLOW;
	for (int i = 0; i < got && i < room; i++)
		all &= event_of(l, gpiod_edge_event_buffer_get_event(
					l->events, (unsigned long)i), &ret[i]);
	return all ? got : -EOVERFLOW;
}

void lines_release(struct lines *l)
{
	if (!l)
		return;
	gpiod_edge_event_buffer_free(l->events);
	gpiod_line_request_release(l->request);
	free(l);
}
