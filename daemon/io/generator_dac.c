/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_dac.c - a generator's values as outputs of converters of the
 * kernel's industrial I/O
 *
 * A channel is written by its file, and the bus behind it takes as long as it
 * takes.  So a thread of its own writes.  What the cycle asks for goes to it as
 * records of a version; it answers with the version that is there.
 */
#include "generator_own.h"
#include "iio.h"
#include "stamped.h"
#include "thread.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SLOTS		4		/* a power of two */
#define TRIES		8
#define PATH		192
#define ROUNDING	1e-6		/* counts */

/* What the cycle asks for; again: write all of it anew. */
struct wish {
	_Alignas(uint64_t) uint32_t version;
	uint32_t again;
	double value[INTERP_NGENERATOR];	/* NAN: not given */
};

/* What came of it. */
struct word {
	_Alignas(uint64_t) uint32_t version;
	uint32_t again;
	int32_t field, err;		/* errno; 0: all of it is there */
};

struct channel {
	int fd;				/* of its file; -1: none */
	char path[PATH];
	double scale, offset;		/* V or mA a count, counts */
	double least, most;		/* counts that it takes */
	int64_t count;			/* as written last */
	bool there;			/* it was taken */
	bool ours;			/* it is at zero at the end */
};

struct generator_dac {
	struct config_way way[INTERP_NGENERATOR];
	struct channel channel[INTERP_NGENERATOR];
	STAMPED_ROW(struct wish, wishes, wish_next, SLOTS);
	STAMPED_ROW(struct word, words, word_next, SLOTS);
	_Atomic bool quit;
	bool runs;			/* the thread does */
	sem_t wake;
	pthread_t thread;
	/* The cycle's. */
	struct wish last;
	struct word word;
	uint64_t seen;			/* word_next */
	uint32_t since;			/* periods since it is there */
};

/* -- The thread ------------------------------------------------------------ */

/* No current above what was asked for; all else as near as it can be. */
static int64_t count_of(const struct generator_dac *d, int field, double value)
{
	const struct config_way *w = &d->way[field];
	const struct channel *c = &d->channel[field];
	const double at = w->zero + (isnan(value) ? 0 : value / w->scale);
	const double count = at / c->scale - c->offset;
	const double whole = field != INTERP_TECH_PEAK_A ? round(count) :
			     c->scale > 0 ? floor(count + ROUNDING) :
					    ceil(count - ROUNDING);

	return (int64_t)fmin(fmax(whole, c->least), c->most);
}

static int channel_put(struct channel *c, int64_t count)
{
	char text[24];
	const int n = snprintf(text, sizeof(text), "%lld\n",
			       (long long)count);
	const ssize_t put = pwrite(c->fd, text, (size_t)n, 0);

	c->count = count;
	c->there = put == n;
	return c->there ? 0 : put < 0 ? errno : EIO;
}

static void carry_out(struct generator_dac *d, const struct wish *w)
{
	const struct stamped words = STAMPED(d->words, d->word_next);
	struct word word = { .version = w->version, .again = w->again };

	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		struct channel *c = &d->channel[i];
		const int64_t count = c->fd < 0 ? 0 :
				      count_of(d, i, w->value[i]);
		int err;

		if (c->fd < 0 || (c->there && c->count == count))
			continue;
		err = channel_put(c, count);
		if (err && !word.err) {
			word.err = err;
			word.field = i;
		}
	}
	stamped_put(&words, &word);
}

static void *run(void *arg)
{
	struct generator_dac *d = arg;
	const struct stamped wishes = STAMPED(d->wishes, d->wish_next);
	uint32_t again = 0;
	struct wish w;

	while (!atomic_load(&d->quit)) {
		while (sem_wait(&d->wake) < 0)
			;
		if (!stamped_last(&wishes, TRIES, &w))
			continue;
		for (int i = 0; w.again != again && i < INTERP_NGENERATOR; i++)
			d->channel[i].there = false;
		again = w.again;
		carry_out(d, &w);
	}
	return NULL;
}

/* -- The cycle ------------------------------------------------------------- */

void generator_dac_write(struct generator *g)
{
	struct generator_dac *d = g->dac;
	const struct stamped wishes = STAMPED(d->wishes, d->wish_next);
	struct wish w = { .version = g->asked, .again = d->last.again };

	w.again += g->anew;
	memcpy(w.value, g->value, sizeof(w.value));
	if (d->wish_next && memcmp(&w, &d->last, sizeof(w)) == 0)
		return;
	d->last = w;
	d->since = 0;
	stamped_put(&wishes, &w);
	sem_post(&d->wake);
}

void generator_dac_read(struct generator *g)
{
	struct generator_dac *d = g->dac;
	const struct stamped words = STAMPED(d->words, d->word_next);
	const uint64_t next = __atomic_load_n(&d->word_next, __ATOMIC_ACQUIRE);

	if (next != d->seen && stamped_last(&words, TRIES, &d->word))
		d->seen = next;
	if (!d->seen || d->word.version != d->last.version ||
	    d->word.again != d->last.again)
		return;
	if (d->word.err)
		generator_trouble(g, &(struct generator_note) {
			.kind = GENERATOR_DAC, .field = d->word.field,
			.code = d->word.err });
	else if (d->since <= g->settle)
		d->since++;
}

bool generator_dac_waits(const struct generator *g)
{
	return g->dac->since <= g->settle;
}

double generator_dac_step(const struct generator *g, int field)
{
	return fabs(g->dac->channel[field].scale) * g->way[field].scale *
	       (g->way[field].kind == WAY_DAC);
}

/* -- Open and close -------------------------------------------------------- */

static int refuse(struct interp_diag *diag, int err, int field,
		  const char *what, const char *wanted)
{
	interp_diag_say(diag, "generator.%s: %s: %s; %s", process_name(field),
			what, strerror(err), wanted);
	return -err;
}

/* As "[0 1 4095]": the least, the step, the most.  Few devices say it. */
static void range_of(struct channel *c, const char *dir, const char *kind,
		     const struct config_way *w)
{
	char path[PATH], text[64];

	c->least = (double)INT32_MIN;
	c->most = (double)INT32_MAX;
	snprintf(path, sizeof(path), "%s/%s%u_raw_available", dir, kind, w->id);
	if (!iio_line(path, text, sizeof(text)))
		return;
	if (sscanf(text, "[%lf %*f %lf]", &c->least, &c->most) != 2) {
		c->least = (double)INT32_MIN;
		c->most = (double)INT32_MAX;
	}
}

/* Both ends must be counts that it takes. */
static int check_range(const struct config_way *w, const struct channel *c,
		       int field, struct interp_diag *diag)
{
	const double low = w->zero / c->scale - c->offset;
	const double high = w->most / c->scale - c->offset;
	const double slack = 0.5 + fabs(high - low) * 1e-4;
	const char *unit = w->current ? "mA" : "V";

	if (fmin(low, high) >= c->least - slack &&
	    fmax(low, high) <= c->most + slack)
		return 0;
	interp_diag_say(diag, "generator.%s: %s gives no %g %s to %g %s; "
			"between %.6g %s and %.6g %s", process_name(field),
			c->path, w->zero, unit, w->most, unit,
			(c->least + c->offset) * c->scale, unit,
			(c->most + c->offset) * c->scale, unit);
	return -EINVAL;
}

/* A count is so many mV, or mA. */
static int scale_of(struct channel *c, const struct config_way *w,
		    const char *dir, struct interp_diag *diag)
{
	const char *kind = w->current ? "out_current" : "out_voltage";
	const double milli = iio_number(dir, kind, w->id, "scale", 1);

	c->scale = w->current ? milli : milli * 1e-3;
	c->offset = iio_number(dir, kind, w->id, "offset", 0);
	range_of(c, dir, kind, w);
	if (isfinite(c->scale) && c->scale != 0 && isfinite(c->offset))
		return 0;
	interp_diag_say(diag, "%s: its scale is %g a count, its offset %g "
			"counts; numbers, and a scale that is not 0", c->path,
			milli, c->offset);
	return -EINVAL;
}

/* Many begin without power: then what is written is not there. */
static void power_up(const struct config_way *w, const char *dir)
{
	char path[PATH];

	snprintf(path, sizeof(path), "%s/out_%s%u_powerdown", dir,
		 w->current ? "current" : "voltage", w->id);
	iio_put(path, "0");
}

static bool is_open_already(const struct generator_dac *d, const char *path)
{
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (d->channel[i].fd >= 0 &&
		    strcmp(d->channel[i].path, path) == 0)
			return true;
	return false;
}

static int channel_open(struct generator_dac *d, int field, const char *sysfs,
			struct interp_diag *diag)
{
	const struct config_way *w = &d->way[field];
	struct channel *c = &d->channel[field];
	char name[64], dir[PATH - 64], path[PATH];
	int err;

	err = iio_find(sysfs, w->device, name, sizeof(name));
	if (err < 0)
		return refuse(diag, -err, field, w->device, IIO_WANTED);
	snprintf(dir, sizeof(dir), "%s/%s", sysfs, name);
	snprintf(path, sizeof(path), "%s/out_%s%u_raw", dir,
		 w->current ? "current" : "voltage", w->id);
	if (is_open_already(d, path))
		return refuse(diag, EBUSY, field, path, "a channel of its own "
			      "for each field");
	snprintf(c->path, sizeof(c->path), "%s", path);
	c->fd = open(path, O_WRONLY | O_CLOEXEC);
	if (c->fd < 0 && errno == ENOENT)
		return refuse(diag, ENOENT, field, path, "a channel that is an "
			      "output: out_voltageN_raw or out_currentN_raw of "
			      "that device");
	if (c->fd < 0)
		return refuse(diag, errno, field, path, "the right to write "
			      "it: a rule of udev for its group");
	err = scale_of(c, w, dir, diag);
	if (err == 0)
		err = check_range(w, c, field, diag);
	if (err < 0)
		return err;
	power_up(w, dir);
	err = channel_put(c, count_of(d, field, (double)NAN));
	c->ours = err == 0;
	return err ? refuse(diag, err, field, path, "a device that takes what "
			    "is written") : 0;
}

static int channels_open(struct generator_dac *d, const char *sysfs,
			 struct interp_diag *diag)
{
	int err = 0;

	for (int i = 0; i < INTERP_NGENERATOR; i++)
		d->channel[i].fd = -1;
	for (int i = 0; i < INTERP_NGENERATOR && err == 0; i++)
		if (d->way[i].kind == WAY_DAC)
			err = channel_open(d, i, sysfs, diag);
	return err;
}

int generator_dac_open(struct generator *g, const char *sysfs,
		       struct interp_diag *diag)
{
	struct generator_dac *d = calloc(1, sizeof(*d));
	int err;

	if (!d)
		return -ENOMEM;
	g->dac = d;
	memcpy(d->way, g->way, sizeof(d->way));
	sem_init(&d->wake, 0, 0);
	err = channels_open(d, sysfs, diag);
	if (err == 0)
		err = thread_start(&d->thread, &(struct thread) {
			.name = "edmd-dac", .run = run, .arg = d });
	d->runs = err == 0;
	return err;
}

/* A thread that hangs in a write is waited for: the device is the kernel's. */
void generator_dac_close(struct generator *g)
{
	struct generator_dac *d = g->dac;

	if (!d)
		return;
	atomic_store(&d->quit, true);
	sem_post(&d->wake);
	if (d->runs)
		pthread_join(d->thread, NULL);
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		struct channel *c = &d->channel[i];

		if (c->fd < 0)
			continue;
		if (c->ours)
			channel_put(c, count_of(d, i, (double)NAN));
		close(c->fd);
	}
	sem_destroy(&d->wake);
	free(d);
	g->dac = NULL;
}
