/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lines_file.c - lines.h without a GPIO chip: it is a file of levels,
 * $EDM_LINES, which a test has in its memory too
 *
 * Each write that changes something is a record in the file beside it: what
 * the lines were, how far the axis had come, and what the generator had just
 * then.  That a process was killed ends nothing: lines stay as they are.
 */
#include "lines.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define NLINES		64
#define NREGISTERS	16

/* As lines_file.py has it. */
struct lines_chip {
	uint8_t level[NLINES];
	int32_t at;			/* pulses */
	uint32_t step;			/* line of the axis; the one behind it
					 * is high on its way to + */
	uint16_t registers[NREGISTERS];	/* of the generator */
};

struct record {
	uint64_t ns;			/* CLOCK_MONOTONIC */
	struct lines_chip chip;
};

struct lines {
	struct lines_chip *chip;
	unsigned int offset[LINES_MAX];
	size_t n;
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int trace = -1;

int lines_chip_open(struct lines_chip **ret, const char *unused)
{
	const char *path = getenv("EDM_LINES");
	const int fd = open(path, O_RDWR | O_CLOEXEC);
	char beside[200];
	void *at;

	(void)unused;
	if (fd < 0)
		return -errno;
	at = mmap(NULL, sizeof(**ret), PROT_READ | PROT_WRITE, MAP_SHARED, fd,
		  0);
	close(fd);
	if (at == MAP_FAILED)
		return -errno;
	snprintf(beside, sizeof(beside), "%s.trace", path);
	if (trace < 0)
		trace = open(beside, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC,
			     0600);
	*ret = at;
	return trace < 0 ? -errno : 0;
}

/* Its lines go on. */
void lines_chip_close(struct lines_chip *chip)
{
	(void)chip;
}

unsigned int lines_chip_count(struct lines_chip *chip)
{
	(void)chip;
	return NLINES;
}

void lines_chip_label(struct lines_chip *chip, char *buf, size_t size)
{
	(void)chip;
	snprintf(buf, size, "file");
}

bool lines_chip_user(struct lines_chip *chip, unsigned int offset, char *buf,
		     size_t size)
{
	(void)chip;
	(void)offset;
	(void)buf;
	(void)size;
	return false;
}

int lines_request(struct lines **ret, struct lines_chip *chip,
		  const struct lines_wanted *w)
{
	struct lines *l = calloc(1, sizeof(*l));

	if (!l)
		return -ENOMEM;
	l->chip = chip;
	l->n = w->n;
	memcpy(l->offset, w->offset, w->n * sizeof(*w->offset));
	*ret = l;
	return w->output ? lines_set(l, w->value) : 0;
}

static void record(const struct lines_chip *chip)
{
	struct record r = { .chip = *chip };
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	r.ns = (uint64_t)t.tv_sec * 1000000000 + (uint64_t)t.tv_nsec;
	if (write(trace, &r, sizeof(r)) < 0)
		abort();
}

int lines_set(struct lines *l, const uint8_t *value)
{
	struct lines_chip *chip = l->chip;
	bool steps = false, changed = false;

	pthread_mutex_lock(&lock);
	for (size_t i = 0; i < l->n; i++) {
		uint8_t *level = &chip->level[l->offset[i]];

		changed = changed || *level != value[i];
		steps = steps || (l->offset[i] == chip->step && value[i] &&
				  !*level);
		*level = value[i];
	}
	if (steps)
		chip->at += chip->level[chip->step + 1] ? 1 : -1;
	if (changed)
		record(chip);
	pthread_mutex_unlock(&lock);
	return 0;
}

int lines_get(struct lines *l, uint8_t *value)
{
	for (size_t i = 0; i < l->n; i++)
		value[i] = l->chip->level[l->offset[i]];
	return 0;
}

int lines_events(struct lines *l, struct lines_event *ret, int room)
{
	(void)l;
	(void)ret;
	(void)room;
	return 0;
}

void lines_release(struct lines *l)
{
	free(l);
}
