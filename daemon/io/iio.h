/* SPDX-License-Identifier: Apache-2.0 */
/*
 * iio.h - the files of a device of the kernel's industrial I/O
 *
 * They are those of the kernel's documentation, ABI/testing/sysfs-bus-iio.
 *
 * Threads: any.
 */
#ifndef IO_IIO_H
#define IO_IIO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define IIO_SYSFS	"/sys/bus/iio/devices"
#define IIO_WANTED	"iio:deviceN, or a name that cat " IIO_SYSFS \
			"/*/name lists once"

/** iio_find() - the folder in @sysfs of "iio:device0" itself, or of the device
 *  that has this name.  Return: 0; -ENODEV; -ENOTUNIQ: two have the name. */
int iio_find(const char *sysfs, const char *device, char *ret, size_t size);

/** iio_line() - the first line of a file, without its end. */
bool iio_line(const char *path, char *ret, size_t size);

/** iio_put() - write @text to a file.  Return: false, with errno. */
bool iio_put(const char *path, const char *text);

/**
 * iio_number() - file @what of channel @channel of @kind ("in_voltage"), or of
 * all channels of that kind; @otherwise: there is none.
 * Return: NAN if it is no number.
 */
double iio_number(const char *dir, const char *kind, uint32_t channel,
		  const char *what, double otherwise);

#endif /* IO_IIO_H */
