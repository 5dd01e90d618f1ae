// SPDX-License-Identifier: GPL-2.0
/*
 * adc-sim - a converter of industrial I/O for the test VM: two channels, 12
 * bits signed, and a time stamp.  Channel 0 is what
 * /sys/module/adc_sim/parameters/raw says, with a count of noise; channel 1 is
 * always 777.  There is a sample each .../us, and none while .../still is 1.
 *
 * It has two outputs too, 12 bits of 2.5 mV.  Each value is in the kernel's
 * trace, .../slow_ms after it was written; while .../deaf is 1 none is taken.
 */
#include <linux/delay.h>
#include <linux/hrtimer.h>
#include <linux/iio/buffer.h>
#include <linux/iio/iio.h>
#include <linux/iio/kfifo_buf.h>
#include <linux/module.h>
#include <linux/platform_device.h>

#define TOP		2047

static int us = 200;
module_param(us, int, 0644);
static int raw = 1000;
module_param(raw, int, 0644);
static int still;
module_param(still, int, 0644);
static int slow_ms;
module_param(slow_ms, int, 0644);
static int deaf;
module_param(deaf, int, 0644);

#define OUT_TOP		4095

static int out[2];

struct adc {
	struct iio_dev *dev;
	struct hrtimer timer;
	s16 noise;
	struct {
		s16 v[2];
		s64 at __aligned(8);
	} scan;
};

static ktime_t every(void)
{
	return ns_to_ktime(max(READ_ONCE(us), 20) * (s64)NSEC_PER_USEC);
}

static struct platform_device *platform;

static enum hrtimer_restart sample(struct hrtimer *timer)
{
	struct adc *a = container_of(timer, struct adc, timer);
	int v;

	a->noise = !a->noise;
	v = clamp(READ_ONCE(raw) + a->noise, -TOP - 1, TOP);
	a->scan.v[0] = cpu_to_le16((u16)v << 4);
	a->scan.v[1] = cpu_to_le16(777 << 4);
	if (!READ_ONCE(still))
		iio_push_to_buffers_with_timestamp(a->dev, &a->scan,
						   iio_get_time_ns(a->dev));
	hrtimer_forward_now(timer, every());
	return HRTIMER_RESTART;
}

static int begin(struct iio_dev *dev)
{
	struct adc *a = iio_priv(dev);

	hrtimer_start(&a->timer, every(), HRTIMER_MODE_REL_SOFT);
	return 0;
}

static int end(struct iio_dev *dev)
{
	struct adc *a = iio_priv(dev);

	hrtimer_cancel(&a->timer);
	return 0;
}

static const struct iio_buffer_setup_ops ops = {
	.postenable = begin, .predisable = end
};

static int read_raw(struct iio_dev *dev, struct iio_chan_spec const *chan,
		    int *val, int *val2, long mask)
{
	if (mask == IIO_CHAN_INFO_RAW) {
		*val = chan->output ? out[chan->channel] :
		       chan->channel ? 777 : raw;
		return IIO_VAL_INT;
	}
	*val = chan->output ? 2 : 0;
	*val2 = 500000;			/* 2.5 mV, 0.5 mV a count */
	return IIO_VAL_INT_PLUS_MICRO;
}

static int write_raw(struct iio_dev *dev, struct iio_chan_spec const *chan,
		     int val, int val2, long mask)
{
	if (mask != IIO_CHAN_INFO_RAW || val < 0 || val > OUT_TOP)
		return -EINVAL;
	if (READ_ONCE(slow_ms))
		msleep(READ_ONCE(slow_ms));
	if (READ_ONCE(deaf))
		return -EIO;
	out[chan->channel] = val;
	trace_printk("output %d is %d\n", chan->channel, val);
	return 0;
}

static const struct iio_info info = {
	.read_raw = read_raw, .write_raw = write_raw
};

#define OUTPUT(n) { \
	.type = IIO_VOLTAGE, .indexed = 1, .channel = n, .output = 1, \
	.info_mask_separate = BIT(IIO_CHAN_INFO_RAW), \
	.info_mask_shared_by_type = BIT(IIO_CHAN_INFO_SCALE), \
	.scan_index = -1, \
}

#define CHANNEL(n) { \
	.type = IIO_VOLTAGE, .indexed = 1, .channel = n, \
	.info_mask_separate = BIT(IIO_CHAN_INFO_RAW), \
	.info_mask_shared_by_type = BIT(IIO_CHAN_INFO_SCALE), \
	.scan_index = n, \
	.scan_type = { .sign = 's', .realbits = 12, .storagebits = 16, \
		       .shift = 4, .endianness = IIO_LE }, \
}

static const struct iio_chan_spec channels[] = {
	CHANNEL(0), CHANNEL(1), OUTPUT(0), OUTPUT(1), IIO_CHAN_SOFT_TIMESTAMP(2)
};

/* It converts both always; the kernel gives a reader those it asked for. */
static const unsigned long masks[] = { 3, 0 };

static int probe(struct platform_device *p)
{
	struct iio_dev *dev = devm_iio_device_alloc(&p->dev,
						    sizeof(struct adc));
	struct adc *a;
	int err;

	if (!dev)
		return -ENOMEM;
	a = iio_priv(dev);
	a->dev = dev;
	hrtimer_init(&a->timer, CLOCK_MONOTONIC, HRTIMER_MODE_REL_SOFT);
	a->timer.function = sample;
	dev->name = "adc-sim";
	dev->info = &info;
	dev->channels = channels;
	dev->num_channels = ARRAY_SIZE(channels);
	dev->available_scan_masks = masks;
	dev->modes = INDIO_DIRECT_MODE;
	err = devm_iio_kfifo_buffer_setup(&p->dev, dev, &ops);
	return err ? err : devm_iio_device_register(&p->dev, dev);
}

static struct platform_driver driver = {
	.driver = { .name = "adc-sim" }, .probe = probe
};

static int __init adc_init(void)
{
	int err = platform_driver_register(&driver);

	if (err)
		return err;
	platform = platform_device_register_simple("adc-sim", -1, NULL, 0);
	return PTR_ERR_OR_ZERO(platform);
}

static void __exit adc_exit(void)
{
	platform_device_unregister(platform);
	platform_driver_unregister(&driver);
}

module_init(adc_init);
module_exit(adc_exit);
MODULE_LICENSE("GPL");
MODULE_DESCRIPTION("Simulated converter for tests");
