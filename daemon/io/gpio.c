/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpio.c - a machine on the lines of GPIO chips: pulses out, switches in
 *
 * All outputs of a chip are one request and one write in a period, all inputs
 * one request and one read.  A write that would change nothing is left out, but
 * at least one is made each REFRESH_S, so that a lost chip is noticed.
 *
 * When one chip does not answer, the machine is lost until edmd is started
 * again: no pulses, no sparks, no watchdog wave, also on the other chips.
 */
#include "gpio_own.h"
#include "clocks.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static bool is_on(const struct gpio *g, int line)
{
	return g->in >> line & 1;
}

/* -- Inputs --------------------------------------------------------------- */

static void inputs_read(struct gpio *g)
{
	for (int i = 0; i < g->nchips && !g->lost; i++) {
		struct bulk *b = &g->chip[i].bulk[BULK_IN];

		if (b->lines && lines_get(b->lines, b->value) < 0)
			g->lost = true;
	}
	g->in = 0;
	for (int l = CONFIG_NOUTPUTS; l < CONFIG_NLINES; l++) {
		const struct place *p = &g->at[l];

		if (p->chip >= 0 &&
		    g->chip[p->chip].bulk[BULK_IN].value[p->slot] !=
		    p->inverted)
			g->in |= UINT64_C(1) << l;
	}
}

/* If several are on, the worst one counts; if none is on, nothing changed. */
static void gap_read(struct gpio *g)
{
	const bool power = g->out >> LINE_SPARK & 1;

	if (is_on(g, LINE_GAP_SHORT)) {
		g->shares = (struct io_shares) { .shorted = 1 };
	} else if (is_on(g, LINE_GAP_SPARK)) {
		g->shares = (struct io_shares) { .spark = 1 };
	} else if (is_on(g, LINE_GAP_OPEN) || !power) {
		g->shares = (struct io_shares) { .open = 1 };
	} else {
		g->quiet++;
		return;
	}
	g->quiet = 0;
}

static uint32_t axes_on(const struct gpio *g, int line)
{
	return (uint32_t)(g->in >> line) & ((UINT32_C(1) << IO_NAXES) - 1);
}

/* An edge thread that plays nothing any more counts as a lost chip. */
static void edges_look(struct gpio *g)
{
	const uint32_t periods = g->shown.periods;

	edges_ask(g->edges, &g->shown);
	g->dead = !g->placed || g->shown.periods != periods ? 0 : g->dead + 1;
	if (g->shown.lost || g->dead > g->dead_max)
		g->lost = true;
}

void gpio_read(void *self, struct io_inputs *in)
{
	struct gpio *g = self;

	inputs_read(g);
	if (g->has_gap)
		gap_read(g);
	double gap_v = 0;
	const bool read = g->adc.fd >= 0 && adc_read(&g->adc, &gap_v);

	if (g->edges)
		edges_look(g);
	*in = (struct io_inputs) {
		.gap_v = gap_v,
		.gap_valid = read,
		.shares = g->shares,
		.shares_valid = g->has_gap && g->quiet <= g->quiet_max,
		.wire_broken = is_on(g, LINE_WIRE),
		.estop = is_on(g, LINE_ESTOP),
		.door_open = is_on(g, LINE_DOOR),
		.dielectric_low = is_on(g, LINE_DIELECTRIC),
		.limit = axes_on(g, LINE_LIMIT),
		.home = axes_on(g, LINE_HOME),
		.lost = g->lost,
		.steers = !g->lost,
		.busy = g->edges ? g->shown.busy : pulser_busy(&g->pulser),
	};
	gpio_axes_read(g, in);
}

/* -- Outputs -------------------------------------------------------------- */

bool gpio_levels(struct gpio *g, uint64_t on, uint64_t lines)
{
	bool changed = false;

	for (int l = 0; l < CONFIG_NOUTPUTS; l++) {
		const struct place *p = &g->at[l];
		uint8_t level, *was;

		if (p->chip < 0 || !(lines >> l & 1))
			continue;
		level = (uint8_t)((on >> l & 1) != p->inverted);
		was = &g->chip[p->chip].bulk[p->bulk].value[p->slot];
		changed = changed || *was != level;
		*was = level;
	}
	return changed;
}

#define PULSE_LINES	((UINT64_C(1) << (LINE_DIR + IO_NAXES)) - 1)
#define AXES_LINES	(((UINT64_C(1) << (1 + IO_NAXES)) - 1) << LINE_ENABLE)

_Static_assert(LINE_STEP == 0 && LINE_DIR == IO_NAXES, "the first lines");
_Static_assert(LINE_BRAKE == LINE_ENABLE + 1, "the lines of power in a row");
_Static_assert(CONFIG_NLINES <= 64, "a bit for each");

/* Write this kind of lines on each chip; false: a chip did not answer. */
static bool bulk_write(struct gpio *g, enum bulk_kind kind)
{
	bool all = true;

	for (int i = 0; i < g->nchips; i++) {
		struct bulk *b = &g->chip[i].bulk[kind];

		if (b->lines && lines_set(b->lines, b->value) < 0)
			all = false;
	}
	return all;
}

bool gpio_edges_write(void *self, uint32_t step, uint32_t dir)
{
	struct gpio *g = self;

	gpio_levels(g, (uint64_t)step << LINE_STEP | (uint64_t)dir << LINE_DIR,
		    PULSE_LINES);
	return bulk_write(g, BULK_EDGES);
}

void gpio_outputs_write(struct gpio *g)
{
	const uint64_t ours = g->edges ? ~PULSE_LINES : UINT64_MAX;

	if (!gpio_levels(g, g->out, ours) && g->refresh_left > 0) {
		g->refresh_left--;
		return;
	}
	g->refresh_left = g->refresh_periods;
	if (!bulk_write(g, BULK_OUT))
		g->lost = true;
}

static int32_t minus(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a - (uint32_t)b);
}

/*
 * An e-stop and a limit switch end the pulses at once, not with the period.
 * Axes that have not joined make no pulses, and what was left is forgotten.
 */
static void pulses_order(struct gpio *g, const int32_t *target, bool stands)
{
	const uint32_t ends = axes_on(g, LINE_LIMIT);

	for (int i = 0; i < IO_NAXES; i++) {
		if (!g->joined)
			g->told.target[i] = g->shown.put[i];
		if (stands)
			g->shift[i] = minus(target[i], g->told.target[i]);
		g->told.target[i] = minus(target[i], g->shift[i]);
	}
	g->told.stop = is_on(g, LINE_ESTOP) || (ends & ~g->ends) || !g->joined;
	g->ends = ends;
	edges_tell(g->edges, &g->told);
}

/* The period before was written late: an edge now would be too near. */
static bool edge_is_early(const struct gpio *g)
{
	const int64_t least = pulser_level_ns(&g->pulser);

	return least > 0 && g->pulser.left <= 1 &&
	       clock_ns(CLOCK_MONOTONIC) - g->changed_ns < least;
}

/* A new program begins where the machine stands, so it makes no pulses, and the
 * place there gets another number.  Axes that have not joined make none. */
static void pulses_make(struct gpio *g, const struct io_outputs *out)
{
	const bool first = !g->placed, anew = first || out->path != g->path;
	const bool stands = anew || !g->joined;
	int32_t before[IO_NAXES];

	for (int i = 0; i < IO_NAXES; i++)
		before[i] = gpio_put(g, i);
	g->placed = true;
	g->path = out->path;
	if (g->edges)
		pulses_order(g, out->target, stands);
	else if (stands)
		pulser_stand_at(&g->pulser, out->target);
	if (first || (anew && g->joined))
		gpio_axes_counted(g, before);
	if (g->edges)
		return;
	if (edge_is_early(g))
		pulser_wait(&g->pulser, out->target);
	else
		pulser_period(&g->pulser, out->target);
}

static bool watchdog_level(struct gpio *g)
{
	const bool level = g->out >> LINE_WATCHDOG & 1;

	if (g->watchdog_left > 0) {
		g->watchdog_left--;
		return level;
	}
	g->watchdog_left = g->watchdog_periods - 1;
	return !level;
}

void gpio_write(void *self, const struct io_outputs *out)
{
	struct gpio *g = self;
	const uint64_t axes = gpio_axes_write(g, out), was = g->out;

	if (g->lost) {
		g->told.stop = true;
		if (g->edges)
			edges_tell(g->edges, &g->told);
		g->out &= ~((UINT64_C(1) << LINE_SPARK) | AXES_LINES);
		g->out |= axes;
	} else {
		const bool dog = watchdog_level(g);

		pulses_make(g, out);
		g->out = (uint64_t)g->pulser.step << LINE_STEP |
			 (uint64_t)g->pulser.dir << LINE_DIR |
			 (uint64_t)out->power << LINE_SPARK |
			 (uint64_t)out->pump << LINE_PUMP |
			 (uint64_t)dog << LINE_WATCHDOG | axes;
	}
	gpio_outputs_write(g);
	if (!g->edges && (was ^ g->out) & PULSE_LINES)
		g->changed_ns = clock_ns(CLOCK_MONOTONIC);
}

/* -- Close ---------------------------------------------------------------- */

void gpio_close(void *self)
{
	struct gpio *g = self;

	edges_end(g->edges);
	adc_close(&g->adc);
	g->edges = NULL;
	gpio_axes_close(g);
	g->out = 0;
	gpio_levels(g, 0, UINT64_MAX);
	bulk_write(g, BULK_EDGES);
	bulk_write(g, BULK_OUT);
	for (int i = 0; i < g->nchips; i++) {
		for (int k = 0; k < NBULKS; k++)
			lines_release(g->chip[i].bulk[k].lines);
		if (g->chip[i].chip)
			lines_chip_close(g->chip[i].chip);
	}
	free(g);
}
