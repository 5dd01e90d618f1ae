/* SPDX-License-Identifier: Apache-2.0 */
/*
 * adc.c - read samples of the kernel's industrial I/O from its files
 */
#include "adc.h"

#include "interp/diag.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BUFFER_SAMPLES	"1024"

/* -- A sample ------------------------------------------------------------- */

bool adc_format_read(const char *text, struct adc_format *ret)
{
	char end[3], sign;
	unsigned int bits, room, shift = 0;
	const int n = sscanf(text, "%2[bel]:%c%u/%u>>%u", end, &sign, &bits,
			     &room, &shift);

	if (n < 4 || (strcmp(end, "le") != 0 && strcmp(end, "be") != 0) ||
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

bool adc_read(struct adc *a, double *ret_v)
{
	uint8_t bytes[ADC_SAMPLES * 4];
	double sum = 0;
	uint32_t n = 0;

	for (int i = 0; i < ADC_READS; i++) {
		const ssize_t got = read(a->fd, bytes,
					 ADC_SAMPLES * a->format.bytes);

		for (ssize_t at = 0; at + a->format.bytes <= got;
		     at += a->format.bytes, n++)
			sum += (double)adc_count(&a->format, bytes + at);
		if (got < (ssize_t)(ADC_SAMPLES * a->format.bytes))
			break;
	}
	if (n > 0) {
		a->v = (sum / n + a->offset) * a->scale_v;
		a->age = 0;
	} else if (a->age < a->stale_periods) {
		a->age++;
	}
	*ret_v = a->v;
	return a->age < a->stale_periods;
}

/* -- Its files ------------------------------------------------------------ */

static bool line_of(const char *path, char *ret, size_t size)
{
	FILE *f = fopen(path, "re");
	bool ok;

	if (!f)
		return false;
	ok = fgets(ret, (int)size, f) != NULL;
	fclose(f);
	if (ok)
		ret[strcspn(ret, "\n")] = '\0';
	return ok;
}

static bool put(const char *path, const char *text)
{
	const int fd = open(path, O_WRONLY | O_CLOEXEC);
	bool ok;

	if (fd < 0)
		return false;
	ok = write(fd, text, strlen(text)) == (ssize_t)strlen(text);
	return close(fd) == 0 && ok;
}

/* "iio:device0" itself, or the one that has this name. */
static bool find(const struct adc_config *c, char *ret, size_t size)
{
	char path[160], name[64];
	struct dirent *e;
	bool found = false;
	DIR *d = opendir(c->sysfs);

	while (d && !found && (e = readdir(d))) {
		if (strncmp(e->d_name, "iio:device", 10) != 0)
			continue;
		snprintf(path, sizeof(path), "%s/%.60s/name", c->sysfs,
			 e->d_name);
		found = strcmp(e->d_name, c->device) == 0 ||
			(line_of(path, name, sizeof(name)) &&
			 strcmp(name, c->device) == 0);
		if (found)
			snprintf(ret, size, "%.60s", e->d_name);
	}
	if (d)
		closedir(d);
	return found;
}

/* Of the channel, or of all voltages; mV a count. */
static double number_of(const char *dir, uint32_t channel, const char *what,
			double otherwise)
{
	char path[160], text[64];

	snprintf(path, sizeof(path), "%s/in_voltage%u_%s", dir, channel, what);
	if (line_of(path, text, sizeof(text)))
		return strtod(text, NULL);
	snprintf(path, sizeof(path), "%s/in_voltage_%s", dir, what);
	return line_of(path, text, sizeof(text)) ? strtod(text, NULL) :
						   otherwise;
}

static int refuse(struct interp_diag *d, int err, const char *what,
		  const char *wanted)
{
	interp_diag_say(d, "gpio.adc: %s: %s; %s", what, strerror(err), wanted);
	return -err;
}

/* Enable only this channel, so that its samples follow each other directly. */
static bool only_channel(const char *dir, uint32_t channel)
{
	char path[192], own[32];
	struct dirent *e;
	bool ok = false;
	DIR *d;

	snprintf(path, sizeof(path), "%s/scan_elements", dir);
	snprintf(own, sizeof(own), "in_voltage%u_en", channel);
	d = opendir(path);
	while (d && (e = readdir(d))) {
		const size_t n = strlen(e->d_name);
		char file[256];

		if (n < 3 || strcmp(e->d_name + n - 3, "_en") != 0)
			continue;
		snprintf(file, sizeof(file), "%s/%.40s", path, e->d_name);
		if (strcmp(e->d_name, own) == 0)
			ok = put(file, "1");
		else
			put(file, "0");
	}
	if (d)
		closedir(d);
	return ok;
}

static bool format_of(const char *dir, uint32_t channel, struct adc_format *ret)
{
	char path[192], text[32];

	snprintf(path, sizeof(path), "%s/scan_elements/in_voltage%u_type", dir,
		 channel);
	return line_of(path, text, sizeof(text)) && adc_format_read(text, ret);
}

static int begin(struct adc *a, const struct adc_config *c, const char *dir,
		 struct interp_diag *diag)
{
	char path[192];

	put(a->enable, "0");
	snprintf(path, sizeof(path), "%s/trigger/current_trigger", dir);
	if (strcmp(c->trigger, "none") != 0 && !put(path, c->trigger))
		return refuse(diag, errno, path, "the name of a trigger, as in "
			      "/sys/bus/iio/devices/trigger*/name");
	if (!only_channel(dir, c->channel) ||
	    !format_of(dir, c->channel, &a->format))
		return refuse(diag, ENXIO, dir, "a device with a buffer, and "
			      "adc_channel one of its in_voltageN");
	snprintf(path, sizeof(path), "%s/buffer/length", dir);
	put(path, BUFFER_SAMPLES);
	if (!put(a->enable, "1"))
		return refuse(diag, errno, a->enable, "a device that is not in "
			      "use, and its trigger");
	return 0;
}

int adc_open(struct adc *a, const struct adc_config *c,
	     struct interp_diag *diag)
{
	char name[64], dir[128], path[128];
	int err;

	*a = (struct adc) { .fd = -1, .stale_periods = c->stale_periods,
			    .age = c->stale_periods };
	if (!find(c, name, sizeof(name)))
		return refuse(diag, ENODEV, c->device, "iio:deviceN, or a name "
			      "that cat /sys/bus/iio/devices/*/name lists");
	snprintf(dir, sizeof(dir), "%s/%s", c->sysfs, name);
	snprintf(a->enable, sizeof(a->enable), "%s/buffer/enable", dir);
	err = begin(a, c, dir, diag);
	if (err < 0)
		return err;
	a->scale_v = number_of(dir, c->channel, "scale", 1) * 1e-3 * c->ratio;
	a->offset = number_of(dir, c->channel, "offset", 0);
	snprintf(path, sizeof(path), "%s/%s", c->dev, name);
	a->fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (a->fd < 0)
		return refuse(diag, errno, path, "the right to it: a rule of "
			      "udev for its group");
	return 0;
}

void adc_close(struct adc *a)
{
	if (a->enable[0])
		put(a->enable, "0");
	if (a->fd >= 0)
		close(a->fd);
	a->fd = -1;
}
