/* SPDX-License-Identifier: Apache-2.0 */
/*
 * checkpoint.c - when a checkpoint is due, and the thread that writes it
 */
#include "checkpoint.h"

#include "clocks.h"
#include "jobs_log.h"
#include "regular.h"
#include "thread.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define DAY_S		86400.0
#define BURST_BYTES	1e6		/* may be saved up in quiet times */

struct checkpoint_file {
	int fd;
	bool direct;			/* sectors go to the disk alone */
	char machine[SHM_NAME_MAX];
	uint64_t sequence, count;	/* of the last base and of the last
					 * place */
	/* Only for the event loop: what was written, or is being written. */
	bool any;
	struct checkpoint_base last;
	double budget_bytes;
	int64_t budget_us;
	/* Shared by the two threads. */
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	bool running, ends;
	bool due[2];			/* by enum checkpoint_kind */
	union checkpoint_block next[2];
	struct checkpoint_stats stats;
};

/* -- The thread ----------------------------------------------------------- */

static size_t bytes_written(const struct checkpoint_file *f,
			    enum checkpoint_kind kind)
{
	return kind == CHECKPOINT_PLACE && f->direct ? CHECKPOINT_SECTOR :
						       CHECKPOINT_BLOCK;
}

/* Write to the older of the two blocks of its kind. */
static int block_write(struct checkpoint_file *f, union checkpoint_block *b)
{
	const enum checkpoint_kind kind = (enum checkpoint_kind)b->head.kind;
	const uint64_t n = kind == CHECKPOINT_BASE ? b->head.sequence :
						     b->head.count;
	const off_t at = (off_t)(2 * (uint64_t)kind + (n & 1)) *
			 CHECKPOINT_BLOCK;
	const size_t bytes = bytes_written(f, kind);
	ssize_t put;

	checkpoint_seal(b);
	put = pwrite(f->fd, b, bytes, at);
	if (put < 0 || fdatasync(f->fd) < 0)
		return -errno;
	return (size_t)put == bytes ? 0 : -EIO;
}

static void note_written(struct checkpoint_file *f, int err, size_t bytes,
			 int64_t took_us)
{
	if (err && err != f->stats.err)
		log_error("checkpoint: %s; the place is not on the disk",
			  strerror(-err));
	else if (!err && f->stats.err)
		log_notice("checkpoint: it can be written again");
	f->stats.err = err;
	f->stats.writes++;
	f->stats.bytes += bytes;
	if (took_us > f->stats.slowest_us)
		f->stats.slowest_us = took_us;
}

static void *writer(void *arg)
{
	struct checkpoint_file *f = arg;
	_Alignas(CHECKPOINT_BLOCK) static union checkpoint_block block;

	pthread_mutex_lock(&f->lock);
	for (;;) {
		int kind = f->due[CHECKPOINT_BASE] ? CHECKPOINT_BASE :
						     CHECKPOINT_PLACE;
		int64_t began_us;
		int err;

		if (!f->due[kind]) {
			if (f->ends)
				break;
			pthread_cond_wait(&f->wake, &f->lock);
			continue;
		}
		block = f->next[kind];
		f->due[kind] = false;
		pthread_mutex_unlock(&f->lock);
		began_us = clock_us(CLOCK_MONOTONIC);
		err = block_write(f, &block);
		pthread_mutex_lock(&f->lock);
		note_written(f, err,
			     bytes_written(f, (enum checkpoint_kind)kind),
			     clock_us(CLOCK_MONOTONIC) - began_us);
	}
	pthread_mutex_unlock(&f->lock);
	return NULL;
}

static int writer_start(struct checkpoint_file *f)
{
	int err;

	pthread_mutex_init(&f->lock, NULL);
	pthread_cond_init(&f->wake, NULL);
	err = thread_start(&f->thread, &(struct thread) {
		.name = "jobs-checkpoint", .run = writer, .arg = f });
	f->running = err == 0;
	return err;
}

/* -- The file ------------------------------------------------------------- */

static int file_read(int fd, union checkpoint_block block[4])
{
	memset(block, 0, 4 * sizeof(*block));
	return pread(fd, block, 4 * sizeof(*block), 0) < 0 ? -errno : 0;
}

/* All of the file is written once, so that its space on the disk is
 * reserved. */
static int file_make(int fd)
{
	static const union checkpoint_block zeros[4];
	struct stat st;

	if (fstat(fd, &st) < 0)
		return -errno;
	if (st.st_size >= (off_t)sizeof(zeros))
		return 0;
	if (pwrite(fd, zeros, sizeof(zeros), 0) != (ssize_t)sizeof(zeros))
		return errno ? -errno : -EIO;
	return fsync(fd) < 0 ? -errno : 0;
}

/* Some file systems do not take single sectors; there a whole page is
 * written. */
static bool takes_sectors(const char *path)
{
	_Alignas(CHECKPOINT_BLOCK) static uint8_t sector[CHECKPOINT_SECTOR];
	const int fd = regular_open(path, O_RDONLY | O_DIRECT, 0);
	bool takes = false;

	if (fd >= 0) {
		takes = pread(fd, sector, sizeof(sector), 0) ==
			(ssize_t)sizeof(sector);
		close(fd);
	}
	return takes;
}

/* A file that cannot be written may still be read. */
static void look_only(const char *path, const char *machine,
		      struct checkpoint *ret)
{
	_Alignas(CHECKPOINT_BLOCK) static union checkpoint_block block[4];
	const int fd = regular_open(path, O_RDONLY, 0);
	struct checkpoint_head head;

	if (fd < 0)
		return;
	if (file_read(fd, block) == 0)
		checkpoint_choose(block, machine, ret, &head);
	close(fd);
}

static int file_open(struct checkpoint_file *f, const char *path)
{
	const int fd = regular_open(path, O_RDWR | O_CREAT, 0600);
	int err;

	if (fd < 0)
		return fd;
	/* Who may read a file may lock it.  A file of an earlier version may be
	 * open to the group. */
	err = fchmod(fd, 0600) < 0 ? -errno : file_make(fd);
	f->direct = takes_sectors(path);
	if (err == 0 && f->direct) {
		f->fd = regular_open(path, O_RDWR | O_DIRECT, 0);
		err = f->fd < 0 ? f->fd : 0;
		close(fd);
	} else {
		f->fd = fd;
	}
	return err;
}

int checkpoint_open(struct checkpoint_file **ret, const char *dir,
		    const char *machine, struct checkpoint *ret_last)
{
	_Alignas(CHECKPOINT_BLOCK) static union checkpoint_block block[4];
	struct checkpoint_file *f = aligned_alloc(CHECKPOINT_BLOCK,
		(sizeof(*f) + CHECKPOINT_BLOCK - 1) / CHECKPOINT_BLOCK *
		CHECKPOINT_BLOCK);
	struct checkpoint_head head = { .sequence = 0 };
	char path[512];
	int err;

	if (!f)
		return -ENOMEM;
	memset(f, 0, sizeof(*f));
	*ret_last = (struct checkpoint) { .there = false };
	f->budget_bytes = BURST_BYTES;
	snprintf(f->machine, sizeof(f->machine), "%s", machine);
	snprintf(path, sizeof(path), "%s/%s.place", dir, machine);
	err = file_open(f, path);
	if (err == 0)
		err = file_read(f->fd, block);
	if (err == 0) {
		checkpoint_choose(block, machine, ret_last, &head);
		f->sequence = head.sequence;
		f->count = head.count;
		err = writer_start(f);
	}
	if (err < 0) {
		look_only(path, machine, ret_last);
		checkpoint_close(f);
		return err;
	}
	*ret = f;
	return 0;
}

void checkpoint_close(struct checkpoint_file *f)
{
	if (!f)
		return;
	if (f->running) {
		pthread_mutex_lock(&f->lock);
		f->ends = true;
		pthread_cond_signal(&f->wake);
		pthread_mutex_unlock(&f->lock);
		pthread_join(f->thread, NULL);
	}
	if (f->fd > 0)
		close(f->fd);
	free(f);
}

void checkpoint_stats(struct checkpoint_file *f, struct checkpoint_stats *ret)
{
	pthread_mutex_lock(&f->lock);
	*ret = f->stats;
	pthread_mutex_unlock(&f->lock);
}

/* -- When ----------------------------------------------------------------- */

/* A state belongs to a phase.  Between states of one phase a resumed job would
 * not differ. */
static int phase(uint32_t state)
{
	switch (state) {
	case SHM_APPROACH:
	case SHM_ERODE:
	case SHM_RETRACT:
	case SHM_JUMP:
		return SHM_ERODE;
	default:
		return (int)state;
	}
}

/* Does anything differ that a place block does not hold? */
static bool base_differs(const struct checkpoint_base *a,
			 const struct checkpoint_base *b)
{
	const struct shm_snapshot *s = &a->snap, *t = &b->snap;

	return memcmp(&a->job, &b->job, sizeof(a->job)) != 0 ||
	       memcmp(&a->sets, &b->sets, sizeof(a->sets)) != 0 ||
	       memcmp(s->found, t->found, sizeof(s->found)) != 0 ||
	       memcmp(s->home_shift, t->home_shift,
		      sizeof(s->home_shift)) != 0 ||
	       memcmp(s->origin, t->origin, sizeof(s->origin)) != 0 ||
	       s->program_key != t->program_key || s->faults != t->faults ||
	       s->homed != t->homed || s->unplaced != t->unplaced ||
	       s->pump != t->pump || s->mcode != t->mcode ||
	       s->mcode_at != t->mcode_at || s->loaded != t->loaded ||
	       s->cond_letter != t->cond_letter ||
	       s->cond_number != t->cond_number ||
	       memcmp(&s->override, &t->override, sizeof(s->override)) != 0;
}

static bool place_is_due(const struct checkpoint_base *now,
			 const struct checkpoint_base *last)
{
	const struct shm_snapshot *s = &now->snap, *t = &last->snap;
	const double passed_s = ((double)s->job_cycles -
				 (double)t->job_cycles) *
				(double)s->period_ns / 1e9;

	if (phase(s->state) != phase(t->state) || s->outcome != t->outcome)
		return true;
	/* When the machine stands, nothing more is written after it has come to
	 * rest. */
	if (phase(s->state) != SHM_ERODE && passed_s < CHECKPOINT_S)
		return memcmp(s->pos, t->pos, sizeof(s->pos)) != 0 &&
		       llabs(now->utime - last->utime) > 500000;
	return passed_s >= CHECKPOINT_S ||
	       s->far_mm - t->far_mm >= CHECKPOINT_MM;
}

/* Take @bytes from the budget: it grows evenly over the day, and a part of it
 * may be used at once. */
static bool budget_take(struct checkpoint_file *f, size_t bytes, int64_t at_us)
{
	const double s = (double)(at_us - f->budget_us) / 1e6;

	if (f->budget_us && s > 0)
		f->budget_bytes = fmin(f->budget_bytes +
				       s * CHECKPOINT_DAY_BYTES / DAY_S,
				       BURST_BYTES);
	f->budget_us = at_us;
	if (f->budget_bytes < (double)bytes)
		return false;
	f->budget_bytes -= (double)bytes;
	return true;
}

static void hand_over(struct checkpoint_file *f, enum checkpoint_kind kind,
		      const struct checkpoint_base *now)
{
	union checkpoint_block *b = &f->next[kind];

	pthread_mutex_lock(&f->lock);
	memset(b, 0, sizeof(*b));
	b->head.kind = (uint32_t)kind;
	/* A write that was not begun yet is replaced and keeps its number. */
	if (kind == CHECKPOINT_BASE) {
		f->sequence += !f->due[kind];
		b->base = *now;
		/* A place that belongs to the previous base means nothing any
		 * more. */
		f->due[CHECKPOINT_PLACE] = false;
	} else {
		f->count += !f->due[kind];
		b->place = checkpoint_place_of(now);
	}
	b->head.sequence = f->sequence;
	b->head.count = f->count;
	memcpy(b->head.machine, f->machine, sizeof(b->head.machine));
	f->stats.handed++;
	f->stats.handed_bytes += bytes_written(f, kind);
	f->due[kind] = true;
	pthread_cond_signal(&f->wake);
	pthread_mutex_unlock(&f->lock);
	f->last = *now;
	f->any = true;
}

void checkpoint_look(struct checkpoint_file *f,
		     const struct checkpoint_base *now, int64_t at_us)
{
	enum checkpoint_kind kind;

	if (!f->any || base_differs(now, &f->last))
		kind = CHECKPOINT_BASE;
	else if (place_is_due(now, &f->last))
		kind = CHECKPOINT_PLACE;
	else
		return;
	if (budget_take(f, bytes_written(f, kind), at_us))
		hand_over(f, kind, now);
}
