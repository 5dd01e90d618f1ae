/* SPDX-License-Identifier: Apache-2.0 */
/*
 * adc.c - read samples of the kernel's industrial I/O from its files
 */
#include "adc.h"
#include "iio.h"

#include "interp/diag.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* -- A sample ------------------------------------------------------------- */

bool adc_format_read(const char *text, struct adc_format *ret)
{
	char end[3], sign;
	unsigned int bits, room, shift = 0;
	const int n = sscanf(text, "%2[bel]:%c%u/%u>>%u", end, &sign, &bits,
			     &room, &shift);

	/* X: a sample is several numbers. */
	if (n < 4 || strchr(text, 'X') ||
	    (strcmp(end, "le") != 0 && strcmp(end, "be") != 0) ||
	    (sign != 's' && sign != 'u') || bits == 0 || bits > 32 ||
	    (room != 8 && room != 16 && room != 32) || bits + shift > room)
		return false;
	*ret = (struct adc_format) {
		.big_endian = end[0] == 'b', .is_signed = sign == 's',
		.bits = bits, .bytes = room / 8, .shift = shift,
	};
	return true;
}

int64_t adc_count(const struct adc_format *f, const uint8_t *at)
{
	uint64_t x = 0;

	for (uint32_t i = 0; i < f->bytes; i++)
		x |= (uint64_t)at[f->big_endian ? f->bytes - 1 - i : i] <<
		     8 * i;
	x = x >> f->shift & ((UINT64_C(1) << f->bits) - 1);
	if (f->is_signed && x >> (f->bits - 1))
		return (int64_t)x - (INT64_C(1) << f->bits);
	return (int64_t)x;
}

/* -- What came in a period ------------------------------------------------ */

static void tell(struct adc *a, enum adc_tell what)
{
	atomic_fetch_or_explicit(&a->tell, what, memory_order_relaxed);
}

static int64_t sample(const struct adc *a, uint32_t i)
{
	return adc_count(&a->format, a->bytes + i * a->format.bytes);
}

static bool all_at_top(const struct adc *a, uint32_t n)
{
	uint32_t i = 0;

	while (i < n && sample(a, i) == a->top)
		i++;
	return i == n;
}

/* Each of these is told when it begins. */
static void watch(struct adc *a, uint32_t n, bool gone)
{
	const bool full = n == a->samples;
	const bool high = n > 0 && all_at_top(a, n);

	if (high && !a->high)
		tell(a, ADC_TELL_TOP);
	if (gone && !a->gone)
		tell(a, ADC_TELL_GONE);
	if (full && !a->full)
		tell(a, ADC_TELL_FULL);
	a->gone = gone;
	a->full = full;
	a->high = high;
	a->empty += n == 0;
	if (++a->periods < ADC_WINDOW)
		return;
	/* None at all is not slow: the gap is lost then. */
	if (a->empty > ADC_WINDOW / 2 && a->empty < ADC_WINDOW && !a->slow)
		tell(a, ADC_TELL_SLOW);
	a->slow = a->empty > ADC_WINDOW / 2;
	a->periods = a->empty = 0;
}

static double mean(const struct adc *a, uint32_t n)
{
	double sum = 0;

	for (uint32_t i = 0; i < n; i++)
		sum += (double)sample(a, i);
	return sum / n;
}

bool adc_read(struct adc *a, double *ret_v)
{
	const ssize_t got = read(a->fd, a->bytes,
				 (size_t)a->samples * a->format.bytes);
	const bool gone = got < 0 && errno != EAGAIN && errno != EINTR;
	const uint32_t n = got > 0 ? (uint32_t)got / a->format.bytes : 0;

	watch(a, n, gone);
	if (n > 0 && !a->full && !a->high) {
		a->v = (mean(a, n) + a->offset) * a->scale_v;
		a->age = 0;
	} else if (gone) {
		a->age = a->stale_periods;
	} else if (a->age < a->stale_periods) {
		a->age++;
	}
	*ret_v = a->v;
	return a->age < a->stale_periods;
}

bool adc_note(struct adc *a, char *buf, size_t size)
{
	static const char *const text[] = {
		"it cannot be read any more; connect it, then start edmd "
		"again",
		"most periods have no sample of it; at least one in each: its "
		"sampling_frequency, or that of its trigger",
		"its buffer is full, and samples were lost; a lower "
		"sampling_frequency, or the cycle stood still",
		"it is at the end of its range; the gap's highest voltage must "
		"be within it: another range, or a divider in front of it",
	};

	for (uint32_t i = 0; i < sizeof(text) / sizeof(text[0]); i++) {
		if (!(atomic_fetch_and_explicit(&a->tell, ~(1u << i),
						memory_order_relaxed) >>
		      i & 1))
			continue;
		snprintf(buf, size, "converter %s: %s", a->device, text[i]);
		return true;
	}
	return false;
}

/* -- Its files ------------------------------------------------------------ */

static int refuse(struct interp_diag *d, int err, const char *what,
		  const char *wanted)
{
	interp_diag_say(d, "gpio.adc: %s: %s; %s", what, strerror(err), wanted);
	return -err;
}

/* The highest count, or the lowest one where that is the highest voltage. */
static int64_t top_of(const struct adc *a)
{
	const struct adc_format *f = &a->format;
	const int64_t span = INT64_C(1) << f->bits;
	const int64_t low = f->is_signed ? -span / 2 : 0;

	return a->scale_v > 0 ? low + span - 1 : low;
}

/* mV a count; a device that does not say it counts in mV. */
static int scale_of(struct adc *a, const struct adc_config *c, const char *dir,
		    struct interp_diag *d)
{
	const double mv = iio_number(dir, "in_voltage", c->channel, "scale",
				     1);

	a->offset = iio_number(dir, "in_voltage", c->channel, "offset", 0);
	a->scale_v = mv * 1e-3 * c->ratio;
	a->top = top_of(a);
	if (isfinite(a->scale_v) && a->scale_v != 0 && isfinite(a->offset))
		return 0;
	interp_diag_say(d, "gpio.adc: %s: its scale is %g mV a count, its "
			"offset %g counts; numbers, and a scale that is not 0",
			dir, mv, a->offset);
	return -EINVAL;
}

/* -- Its scan ------------------------------------------------------------- */

/* Call @f with the path of each file that enables a channel. */
static int each_enable(const char *dir, const char *own,
		       int (*f)(const char *path, bool own,
				struct interp_diag *d),
		       struct interp_diag *diag)
{
	char path[192], file[256];
	struct dirent *e;
	int err = 0;
	DIR *d;

	snprintf(path, sizeof(path), "%s/scan_elements", dir);
	d = opendir(path);
	if (!d)
		return refuse(diag, errno, path, "a device with a buffer");
	while (err == 0 && (e = readdir(d))) {
		const size_t n = strlen(e->d_name);

		if (n < 3 || strcmp(e->d_name + n - 3, "_en") != 0)
			continue;
		snprintf(file, sizeof(file), "%s/%.60s", path, e->d_name);
		err = f(file, strcmp(e->d_name, own) == 0, diag);
	}
	closedir(d);
	return err;
}

static int enable_one(const char *path, bool own, struct interp_diag *d)
{
	(void)d;
	iio_put(path, own ? "1" : "0");
	return 0;
}

/* A channel that stays on would stand between our samples. */
static int enabled_one(const char *path, bool own, struct interp_diag *d)
{
	char text[32];

	if (iio_line(path, text, sizeof(text)) &&
	    (strtol(text, NULL, 10) != 0) == own)
		return 0;
	return refuse(d, EINVAL, path, own ? "a channel that can be enabled" :
		      "a device that gives one channel alone");
}

static int only_channel(const char *dir, uint32_t channel,
			struct interp_diag *d)
{
	char own[32];
	int err;

	snprintf(own, sizeof(own), "in_voltage%u_en", channel);
	err = each_enable(dir, own, enable_one, d);
	return err < 0 ? err : each_enable(dir, own, enabled_one, d);
}

static int format_of(struct adc *a, const char *dir, uint32_t channel,
		     struct interp_diag *d)
{
	char path[192], text[32];

	snprintf(path, sizeof(path), "%s/scan_elements/in_voltage%u_type", dir,
		 channel);
	if (!iio_line(path, text, sizeof(text)))
		return refuse(d, ENXIO, path, "a device with a buffer, and "
			      "adc_channel one of its in_voltageN");
	if (adc_format_read(text, &a->format))
		return 0;
	interp_diag_say(d, "gpio.adc: %s: a sample is %s; one number of 8, 16 "
			"or 32 bits, as le:s12/16>>4", path, text);
	return -EINVAL;
}

/* -- Its buffer ----------------------------------------------------------- */

/* One read must empty the buffer, or what it says would be late. */
static int length_of(struct adc *a, const char *dir, struct interp_diag *d)
{
	char path[192], text[32];
	unsigned long n;

	snprintf(path, sizeof(path), "%s/buffer/watermark", dir);
	iio_put(path, "1");
	snprintf(path, sizeof(path), "%s/buffer/length", dir);
	snprintf(text, sizeof(text), "%d", ADC_SAMPLES);
	iio_put(path, text);
	if (!iio_line(path, text, sizeof(text)))
		return refuse(d, errno, path, "a device with a buffer");
	n = strtoul(text, NULL, 10);
	if (n < 2 || n > ADC_SAMPLES) {
		interp_diag_say(d, "gpio.adc: %s: %s samples; a buffer that "
				"keeps 2 to %d", path, text, ADC_SAMPLES);
		return -EINVAL;
	}
	a->samples = (uint32_t)n;
	return 0;
}

static int begin(struct adc *a, const struct adc_config *c, const char *dir,
		 struct interp_diag *diag)
{
	char path[192];
	int err;

	iio_put(a->enable, "0");
	snprintf(path, sizeof(path), "%s/trigger/current_trigger", dir);
	if (strcmp(c->trigger, "none") != 0 && !iio_put(path, c->trigger))
		return refuse(diag, errno, path, "the name of a trigger, as in "
			      "/sys/bus/iio/devices/trigger*/name");
	err = format_of(a, dir, c->channel, diag);
	if (err == 0)
		err = only_channel(dir, c->channel, diag);
	if (err == 0)
		err = scale_of(a, c, dir, diag);
	if (err == 0)
		err = length_of(a, dir, diag);
	if (err == 0 && !iio_put(a->enable, "1"))
		return refuse(diag, errno, a->enable, "a device that is not in "
			      "use, and its trigger");
	return err;
}

/* The device is ours once it is open: the kernel lets one program have it. */
int adc_open(struct adc *a, const struct adc_config *c,
	     struct interp_diag *diag)
{
	char name[64], dir[128], path[128];
	int err;

	memset(a, 0, sizeof(*a));
	a->fd = -1;
	a->stale_periods = a->age = c->stale_periods;
	snprintf(a->device, sizeof(a->device), "%.60s", c->device);
	err = iio_find(c->sysfs, c->device, name, sizeof(name));
	if (err < 0)
		return refuse(diag, -err, c->device, IIO_WANTED);
	snprintf(dir, sizeof(dir), "%s/%s", c->sysfs, name);
	snprintf(path, sizeof(path), "%s/%s", c->dev, name);
	a->fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (a->fd < 0 && errno == EBUSY)
		return refuse(diag, EBUSY, path, "a device that no other "
			      "program reads: fuser tells which one does");
	if (a->fd < 0)
		return refuse(diag, errno, path, "the right to it: a rule of "
			      "udev for its group");
	snprintf(a->enable, sizeof(a->enable), "%s/buffer/enable", dir);
	return begin(a, c, dir, diag);
}

void adc_close(struct adc *a)
{
	if (a->enable[0])
		iio_put(a->enable, "0");
	if (a->fd >= 0)
		close(a->fd);
	a->fd = -1;
}
