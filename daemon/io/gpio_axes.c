/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpio_axes.c - axes on lines: their encoders, power and brakes
 *
 * Power comes first, then the brakes open.  A brake needs brake_ms to open, and
 * nothing moves before that.  In a stop the brakes close first, and power goes
 * away brake_ms later.
 */
#include "gpio_own.h"
#include "clocks.h"

#include <string.h>
#include <time.h>

#define BIT(line)	(UINT64_C(1) << (line))
#define ALL_AXES	((UINT64_C(1) << IO_NAXES) - 1)

int32_t gpio_put(const struct gpio *g, int i)
{
	return g->edges ? (int32_t)((uint32_t)g->shown.put[i] +
				    (uint32_t)g->shift[i]) :
			  g->pulser.put[i];
}

static void tell(struct gpio *g, enum gpio_tell what, int axis)
{
	atomic_fetch_or_explicit(&g->tell[what], 1u << axis,
				 memory_order_relaxed);
}

/* -- Encoders ------------------------------------------------------------- */

static void look(struct gpio *g, int i, uint64_t ns)
{
	struct encoder *e = &g->encoder[i];
	struct quadrature *q = &g->quadrature[i];
	const bool was = e->too_far;
	const bool ok = quadrature_read(q, ns);

	encoder_look(e, q->count, ok, gpio_put(g, i), g->joined);
	if (e->too_far && !was)
		tell(g, e->ill ? GPIO_TELL_MISSED : GPIO_TELL_OFF, i);
}

/* Without an encoder and without lines of power nobody could tell. */
static bool has_power(const struct gpio *g)
{
	if (!g->has_power)
		return g->wanted || !g->encoders;
	return g->out >> LINE_ENABLE & 1 && g->open_left == 0 &&
	       g->close_left > 0;
}

void gpio_axes_read(struct gpio *g, struct io_inputs *in)
{
	const int64_t ns = g->encoders ? clock_ns(CLOCK_MONOTONIC) : 0;

	g->joined = has_power(g);
	in->axes_off = !g->joined;
	in->unplaced = g->unplaced;
	in->slips = g->encoders;
	g->unplaced = 0;
	for (int i = 0; i < IO_NAXES; i++) {
		in->actual[i] = gpio_put(g, i);
		if (g->encoders >> i & 1) {
			look(g, i, (uint64_t)ns);
			in->actual[i] = g->encoder[i].at;
			if (g->encoder[i].too_far)
				in->trouble = IO_FOLLOWING;
		}
		in->stands_at[i] = in->actual[i];
	}
}

static void reset(struct gpio *g)
{
	for (int i = 0; i < IO_NAXES; i++) {
		if (!(g->encoders >> i & 1) || !encoder_reset(&g->encoder[i]))
			continue;
		quadrature_again(&g->quadrature[i]);
		g->unplaced |= 1u << i;
		tell(g, GPIO_TELL_LOST, i);
	}
}

void gpio_axes_counted(struct gpio *g, const int32_t *before)
{
	for (int i = 0; i < IO_NAXES; i++)
		encoder_shift(&g->encoder[i],
			      (int32_t)((uint32_t)gpio_put(g, i) -
					(uint32_t)before[i]));
}

/* -- Power ---------------------------------------------------------------- */

/* Lines that are on. */
static uint64_t power(struct gpio *g, bool on)
{
	if (on) {
		g->open_left -= g->open_left > 0;
		g->close_left = g->brake_periods + 1;
		return BIT(LINE_ENABLE) | ALL_AXES << LINE_BRAKE;
	}
	g->open_left = g->brake_periods + 1;
	g->close_left -= g->close_left > 0;
	return g->close_left > 0 ? BIT(LINE_ENABLE) : 0;
}

uint64_t gpio_axes_write(struct gpio *g, const struct io_outputs *out)
{
	if (out->reset)
		reset(g);
	g->wanted = out->enable && !g->lost;
	return power(g, g->wanted);
}

void gpio_axes_close(struct gpio *g)
{
	const struct timespec brakes = {
		.tv_sec = g->brake_ns / 1000000000,
		.tv_nsec = g->brake_ns % 1000000000,
	};

	for (int i = 0; i < IO_NAXES; i++)
		quadrature_close(&g->quadrature[i]);
	if (!(g->out >> LINE_ENABLE & 1))
		return;
	g->out = BIT(LINE_ENABLE);
	gpio_outputs_write(g);
	nanosleep(&brakes, NULL);
}

/* -- What to say of them -------------------------------------------------- */

bool gpio_note(void *self, char *buf, size_t size)
{
	static const char *const text[GPIO_NTELLS] = {
		[GPIO_TELL_OFF] = "by its encoder it is not where its pulses "
				  "went",
		[GPIO_TELL_MISSED] = "counts of its encoder were missed; a "
				     "slower axis, or a counter of the kernel",
		[GPIO_TELL_LOST] = "its place is lost; end the job, then "
				   "edmctl home",
	};
	struct gpio *g = self;

	if (adc_note(&g->adc, buf, size) || edges_note(g->edges, buf, size))
		return true;
	for (int i = 0; i < GPIO_NTELLS * IO_NAXES; i++) {
		const int what = i / IO_NAXES, axis = i % IO_NAXES;

		if (!(atomic_fetch_and_explicit(&g->tell[what],
						~(1u << axis),
						memory_order_relaxed) >>
		      axis & 1))
			continue;
		snprintf(buf, size, "axis %c: %s", "XYZABCUV"[axis],
			 text[what]);
		return true;
	}
	return false;
}
