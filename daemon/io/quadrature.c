/* SPDX-License-Identifier: Apache-2.0 */
/*
 * quadrature.c - count an encoder by edges, or read a counter
 */
#include "quadrature.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROUND_DEFAULT	(UINT64_C(1) << 32)

/* -- Edges ---------------------------------------------------------------- */

int quadrature_edges(struct quadrature *q, struct lines *lines)
{
	*q = (struct quadrature) { .lines = lines, .fd = -1 };
	return lines_get(lines, q->level);
}

/* A leads B in the positive direction. */
static void take(struct quadrature *q, const struct lines_event *e)
{
	const int line = e->slot & 1;

	if (q->level[line] == e->high) {
		q->missed = true;
		return;
	}
	q->level[line] = e->high;
	q->count += (q->level[0] ^ q->level[1]) == (line == 0) ? 1 : -1;
}

static void sort(struct quadrature *q)
{
	for (int i = 1; i < q->nkept; i++) {
		const struct lines_event e = q->kept[i];
		int j = i;

		for (; j > 0 && q->kept[j - 1].ns > e.ns; j--)
			q->kept[j] = q->kept[j - 1];
		q->kept[j] = e;
	}
}

static void read_edges(struct quadrature *q, uint64_t now_ns)
{
	const int room = QUADRATURE_KEPT - q->nkept;
	const int n = room >= LINES_EVENTS ?
		      lines_events(q->lines, q->kept + q->nkept, room) :
		      -EOVERFLOW;
	int used = 0;

	if (n < 0)
		q->missed = true;
	else
		q->nkept += n;
	sort(q);
	while (used < q->nkept && q->kept[used].ns <= q->read_ns)
		take(q, &q->kept[used++]);
	q->nkept -= used;
	memmove(q->kept, q->kept + used,
		(size_t)q->nkept * sizeof(q->kept[0]));
	q->read_ns = now_ns;
}

/* -- A counter ------------------------------------------------------------ */

static bool number_read(int fd, uint64_t *ret)
{
	char text[32];
	const ssize_t n = pread(fd, text, sizeof(text) - 1, 0);
	char *end;

	if (n <= 0)
		return false;
	text[n] = '\0';
	*ret = strtoull(text, &end, 10);
	return end != text;
}

static bool number_of(const char *folder, const char *name, const char *file,
		      uint64_t *ret)
{
	char path[256];
	bool ok;
	int fd;

	snprintf(path, sizeof(path), "%.96s/%.63s/%s", folder, name, file);
	fd = open(path, O_RDONLY | O_CLOEXEC);
	ok = fd >= 0 && number_read(fd, ret);
	if (fd >= 0)
		close(fd);
	return ok;
}

int quadrature_counter(struct quadrature *q, const char *folder,
		       const char *name, struct interp_diag *diag)
{
	char path[256];
	uint64_t ceiling, enabled;
	int err;

	*q = (struct quadrature) { .fd = -1, .round = ROUND_DEFAULT };
	snprintf(path, sizeof(path), "%.96s/%.63s/count", folder, name);
	q->fd = open(path, O_RDONLY | O_CLOEXEC);
	err = -errno;
	if (q->fd < 0 || !number_read(q->fd, &q->raw)) {
		interp_diag_say(diag, "%s: %s; a counter of the kernel, as "
				"counter0/count0: ls %s", path,
				q->fd < 0 ? strerror(-err) : "has no number",
				folder);
		return q->fd < 0 ? err : -EIO;
	}
	if (number_of(folder, name, "enable", &enabled) && enabled == 0) {
		interp_diag_say(diag, "counter %s does not count; echo "
				"'quadrature x4' > %s/%s/function; echo 1 > "
				"%s/%s/enable", name, folder, name, folder,
				name);
		return -ENODATA;
	}
	if (number_of(folder, name, "ceiling", &ceiling) && ceiling > 0 &&
	    ceiling < ROUND_DEFAULT)
		q->round = ceiling + 1;
	return 0;
}

/* The counter goes round: take the shorter way. */
static void read_counter(struct quadrature *q)
{
	uint64_t raw, up;

	if (!number_read(q->fd, &raw) || raw >= q->round) {
		q->missed = true;
		return;
	}
	up = (raw + q->round - q->raw) % q->round;
	q->raw = raw;
	q->count += up <= q->round / 2 ? (int64_t)up :
					 (int64_t)up - (int64_t)q->round;
}

/* -- Both ----------------------------------------------------------------- */

bool quadrature_read(struct quadrature *q, uint64_t now_ns)
{
	if (q->lines)
		read_edges(q, now_ns);
	else
		read_counter(q);
	return !q->missed;
}

void quadrature_again(struct quadrature *q)
{
	if (!q->missed)
		return;
	q->missed = false;
	if (q->lines) {
		q->nkept = 0;
		lines_get(q->lines, q->level);
	}
}

void quadrature_close(struct quadrature *q)
{
	if (q->fd >= 0)
		close(q->fd);
	lines_release(q->lines);
	q->lines = NULL;
	q->fd = -1;
}
