/* SPDX-License-Identifier: Apache-2.0 */
/*
 * adc.h - the voltage of the gap from an analog-digital converter of the
 * kernel's industrial I/O
 *
 * One channel of one device is read. The kernel puts its samples into a buffer.
 * Each period reads the samples that have come, without waiting, and takes
 * their mean. The files are those of the kernel's documentation,
 * ABI/testing/sysfs-bus-iio.
 *
 * Threads: open and close are startup only; adc_read() is RT-safe: it makes at
 * most ADC_READS system calls.
 */
#ifndef IO_ADC_H
#define IO_ADC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ADC_READS	4		/* of ADC_SAMPLES each, in a period */
#define ADC_SAMPLES	64

struct interp_diag;

struct adc_config {
	const char *sysfs;		/* "/sys/bus/iio/devices" */
	const char *dev;		/* "/dev" */
	const char *device;		/* "iio:device0", or its name */
	uint32_t channel;		/* of in_voltageN */
	const char *trigger;		/* its name; "none": it needs none */
	double ratio;			/* V at the gap for a V at the input */
	uint32_t stale_periods;		/* without a sample: no reading */
};

/* How a sample stands in the buffer: "le:s12/16>>4". */
struct adc_format {
	bool big_endian, is_signed;
	uint32_t bits, bytes, shift;
};

struct adc {
	int fd;				/* -1: there is none */
	struct adc_format format;
	double scale_v, offset;		/* V a count, counts */
	uint32_t stale_periods, age;	/* periods since the last sample */
	double v;			/* mean of the last that came */
	char enable[160];		/* file that ends the buffer */
};

/** adc_open() - Return: 0, or -errno with @diag's found and wanted filled. */
int adc_open(struct adc *a, const struct adc_config *c,
	     struct interp_diag *diag);

/** adc_close() - also for one that was never opened. */
void adc_close(struct adc *a);

/** adc_read() - once a period. Return: true if @ret_v is a reading. */
bool adc_read(struct adc *a, double *ret_v);

/**
 * adc_format_read() - Return: false if @text is not a format that can be read.
 */
bool adc_format_read(const char *text, struct adc_format *ret);

/** adc_count() - the number in one sample at @at. */
int64_t adc_count(const struct adc_format *f, const uint8_t *at);

#endif /* IO_ADC_H */
