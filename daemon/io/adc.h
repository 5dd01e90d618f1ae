/* SPDX-License-Identifier: Apache-2.0 */
/*
 * adc.h - the voltage of the gap from an analog-digital converter of the
 * kernel's industrial I/O
 *
 * One channel of one device is read. The kernel puts its samples into a buffer.
 * Each period reads all samples that have come, without waiting, and takes
 * their mean. The files are those of the kernel's documentation,
 * ABI/testing/sysfs-bus-iio.
 *
 * A full buffer keeps its oldest samples and loses the new ones. So what stands
 * in a full buffer may be old, and is not taken for a reading.
 *
 * Threads: adc_open() and adc_close() are startup only.  adc_read() is RT-safe;
 * it makes one system call.  adc_note() may be called by one other thread.
 */
#ifndef IO_ADC_H
#define IO_ADC_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ADC_SAMPLES	4096		/* that the buffer may keep */
#define ADC_WINDOW	1000		/* periods; over so many it is judged
					 * whether samples come too seldom */

struct interp_diag;

struct adc_config {
	const char *sysfs;		/* "/sys/bus/iio/devices" */
	const char *dev;		/* "/dev" */
	const char *device;		/* "iio:device0", or its name */
	uint32_t channel;		/* of in_voltageN */
	const char *trigger;		/* its name; "none": it needs none */
	double ratio;			/* V at the gap for a V at the input */
	uint32_t stale_periods;		/* after so many periods without a
					 * sample there is no reading */
};

/* How a sample stands in the buffer: "le:s12/16>>4". */
struct adc_format {
	bool big_endian, is_signed;
	uint32_t bits, bytes, shift;
};

/* What the log is to say about it: one bit each. */
enum adc_tell {
	ADC_TELL_GONE	= 1,		/* it cannot be read any more */
	ADC_TELL_SLOW	= 2,		/* most periods have no sample */
	ADC_TELL_FULL	= 4,		/* samples were lost */
	ADC_TELL_TOP	= 8,		/* the voltage is beyond its range */
};

struct adc {
	int fd;				/* -1: there is none */
	struct adc_format format;
	double scale_v, offset;		/* V a count, counts */
	int64_t top;			/* the count of the highest voltage */
	uint32_t samples;		/* that its buffer keeps */
	uint32_t stale_periods, age;	/* periods since the last reading */
	double v;			/* mean of the last that came */
	uint32_t periods, empty;	/* of this window */
	bool gone, slow, full, high;
	_Atomic uint32_t tell;
	char device[64];
	char enable[160];		/* file that ends the buffer */
	uint8_t bytes[ADC_SAMPLES * 4];
};

/** adc_open() - Return: 0, or -errno with @diag's found and wanted filled. */
int adc_open(struct adc *a, const struct adc_config *c,
	     struct interp_diag *diag);

/** adc_close() - also for one that was never opened. */
void adc_close(struct adc *a);

/**
 * adc_read() - once a period. Return: true if @ret_v is a reading.
 *
 * A device that was unplugged gives no reading any more.  A device that sends
 * no samples gives none after stale_periods.  If all samples of a period are
 * the highest possible count, the voltage is not known, and there is no
 * reading.
 */
bool adc_read(struct adc *a, double *ret_v);

/** adc_note() - the next line for the log. Return: false if there is none. */
bool adc_note(struct adc *a, char *buf, size_t size);

/**
 * adc_format_read() - Return: false if @text is not a format that can be read.
 */
bool adc_format_read(const char *text, struct adc_format *ret);

/** adc_count() - the number in one sample at @at. */
int64_t adc_count(const struct adc_format *f, const uint8_t *at);

#endif /* IO_ADC_H */
