/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpio_open.c - the lines as the machine file wants them, or why not
 */
#include "chips.h"
#include "gpio_own.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNTERS	"/sys/bus/counter/devices"
#define REFRESH_S	1e-3
#define DEAD_S		0.02		/* the edge thread plays nothing */
#define QUIET_S		0.1		/* power is on and no comparator is, or
					 * no sample of the converter came */

static int refuse(struct interp_diag *d, int err, const char *line,
		  const char *found, const char *wanted)
{
	interp_diag_say(d, "gpio.%s: %s; %s", line, found, wanted);
	return err;
}

static int refuse_chip(struct interp_diag *d, int err, const char *line,
		       const char *chip)
{
	char key[48];

	snprintf(key, sizeof(key), "gpio.%s", line);
	return lines_chip_refuse(d, err, key, chip);
}

/* The number of chip @name, opened if it is a new one. */
static int chip_find(struct gpio *g, const char *name, const char *line,
		     struct interp_diag *d)
{
	struct chip *c = &g->chip[g->nchips];
	int err;

	for (int i = 0; i < g->nchips; i++)
		if (strcmp(g->chip[i].name, name) == 0)
			return i;
	if (g->nchips == NCHIPS)
		return refuse(d, -E2BIG, line, "a fifth chip",
			      "lines on at most four chips");
	err = lines_chip_named(&c->chip, name);
	if (err < 0)
		return refuse_chip(d, err, line, name);
	snprintf(c->name, sizeof(c->name), "%s", name);
	return g->nchips++;
}

static int line_check(const struct chip *c, unsigned int offset,
		      const char *line, struct interp_diag *d)
{
	char key[48];

	snprintf(key, sizeof(key), "gpio.%s", line);
	return lines_chip_offers(c->chip, c->name, &(struct lines_use) {
		.offset = offset, .key = key,
	}, d);
}

/* The slot of line @offset; inputs may share a line. */
static uint8_t slot_find(struct bulk *b, unsigned int offset)
{
	size_t i = 0;

	while (i < b->n && b->offset[i] != offset)
		i++;
	assert(i < LINES_MAX);
	b->offset[i] = offset;
	if (i == b->n)
		b->n++;
	return (uint8_t)i;
}

static bool has_edges(const struct config_gpio *k)
{
	return k->edges_per_period > 1;
}

static int line_place(struct gpio *g, const struct config_gpio *k, int line,
		      struct interp_diag *d)
{
	const char *name = config_line_name(line);
	struct config_line_at at;
	struct chip *c;
	int i, err;

	const enum bulk_kind kind = line >= CONFIG_NOUTPUTS ? BULK_IN :
				    line < LINE_SPARK && has_edges(k) ?
				    BULK_EDGES : BULK_OUT;

	g->at[line].chip = -1;
	config_line_read(k->line[line], &at);
	if (!at.wired)
		return 0;
	i = chip_find(g, *at.chip ? at.chip : k->chip, name, d);
	if (i < 0)
		return i;
	c = &g->chip[i];
	err = line_check(c, at.offset, name, d);
	if (err < 0)
		return err;
	g->at[line] = (struct place) {
		.chip = (int8_t)i,
		.bulk = (uint8_t)kind,
		.slot = slot_find(&c->bulk[kind], at.offset),
		.inverted = at.inverted,
	};
	return 0;
}

/* The name of one line of this bulk, for a message about all of them. */
static const char *line_of(const struct gpio *g, int chip, int kind)
{
	int l = 0;

	while (g->at[l].chip != chip || g->at[l].bulk != kind)
		l++;
	return config_line_name(l);
}

static int bulk_request(struct gpio *g, int chip, int kind,
			struct lines_wanted *w, struct interp_diag *d)
{
	struct bulk *b = &g->chip[chip].bulk[kind];
	int err;

	if (b->n == 0)
		return 0;
	w->offset = b->offset;
	w->value = b->value;
	w->n = b->n;
	w->output = kind != BULK_IN;
	err = lines_request(&b->lines, g->chip[chip].chip, w);
	return err < 0 ? refuse_chip(d, err, line_of(g, chip, kind),
				     g->chip[chip].name) : 0;
}

static enum lines_pull pull_of(const struct config_gpio *k)
{
	static const enum lines_pull pulls[] = {
		LINES_AS_IS, LINES_PULL_UP, LINES_PULL_DOWN, LINES_NO_PULL
	};

	return pulls[k->pull];
}

static int lines_open(struct gpio *g, const struct machine_config *c,
		      struct interp_diag *d)
{
	struct lines_wanted w = { .pull = pull_of(&c->gpio) };

	for (int l = 0; l < CONFIG_NLINES; l++)
		g->at[l].chip = -1;
	for (int l = 0; l < CONFIG_NLINES; l++) {
		const int err = line_place(g, &c->gpio, l, d);

		if (err < 0)
			return err;
	}
	gpio_levels(g, 0, UINT64_MAX);
	for (int i = 0; i < g->nchips * NBULKS; i++) {
		const int err = bulk_request(g, i / NBULKS, i % NBULKS, &w, d);

		if (err < 0)
			return err;
	}
	return 0;
}

static bool is_wired(const struct gpio *g, int first, int n)
{
	for (int l = first; l < first + n; l++)
		if (g->at[l].chip >= 0)
			return true;
	return false;
}

static void encoder_configure(struct gpio *g, const struct machine_config *c,
			      int axis)
{
	const struct config_gpio *k = &c->gpio;
	const double mm = c->axes.axis[axis].pulse_mm;
	const double period_s = (double)config_period_ns(c) * 1e-9;
	const struct encoder_config e = {
		.counts = (int64_t)c->drive[axis].encoder_counts,
		.pulses = (int64_t)c->drive[axis].encoder_pulses,
		.following_max = (int32_t)(k->following_mm / mm + 0.5),
		.lag_cycles = k->following_s / period_s,
	};

	encoder_init(&g->encoder[axis], &e);
	g->encoders |= 1u << axis;
}

/* A and B must be lines of one chip. */
static int encoder_lines(struct gpio *g, const struct machine_config *c,
			 int axis, const struct config_encoder_at *at,
			 struct interp_diag *d)
{
	const unsigned int offset[2] = { at->a.offset, at->b.offset };
	const struct lines_wanted w = {
		.offset = offset, .n = 2, .watched = true,
		.pull = pull_of(&c->gpio),
	};
	char name[16];
	struct lines *l;
	int chip, err;

	snprintf(name, sizeof(name), "encoder_%c", INTERP_AXIS_LETTERS[axis]);
	chip = chip_find(g, *at->a.chip ? at->a.chip : c->gpio.chip, name, d);
	err = chip < 0 ? chip : 0;
	for (int i = 0; i < 2 && err == 0; i++)
		err = line_check(&g->chip[chip], offset[i], name, d);
	if (err < 0)
		return err;
	err = lines_request(&l, g->chip[chip].chip, &w);
	if (err == 0)
		err = quadrature_edges(&g->quadrature[axis], l);
	return err < 0 ? refuse_chip(d, err, name, g->chip[chip].name) : 0;
}

static int encoders_open(struct gpio *g, const struct machine_config *c,
			 struct interp_diag *d)
{
	for (int i = 0; i < IO_NAXES; i++) {
		struct config_encoder_at at;
		int err;

		config_encoder_read(c->gpio.encoder[i], &at);
		if (!at.present)
			continue;
		encoder_configure(g, c, i);
		err = at.lines ? encoder_lines(g, c, i, &at, d) :
		      quadrature_counter(&g->quadrature[i], COUNTERS,
					 at.counter, d);
		if (err < 0)
			return err;
	}
	return 0;
}

static int adc_begin(struct gpio *g, const struct machine_config *c,
		     struct interp_diag *d)
{
	const struct adc_config a = {
		.sysfs = "/sys/bus/iio/devices", .dev = "/dev",
		.device = c->gpio.adc, .trigger = c->gpio.adc_trigger,
		.channel = (uint32_t)c->gpio.adc_channel,
		.ratio = c->gpio.adc_ratio, .stale_periods = g->adc_max,
	};

	return strcmp(c->gpio.adc, "none") == 0 ? 0 : adc_open(&g->adc, &a, d);
}

static uint32_t periods(const struct machine_config *c, double s)
{
	const double n = s * 1e9 / (double)config_period_ns(c);

	return n < 1 ? 1 : (uint32_t)(n + 0.5);
}

static struct pulser_config pulser_of(const struct config_gpio *k)
{
	return (struct pulser_config) {
		.high = (uint32_t)k->high_cycles,
		.low = (uint32_t)k->low_cycles,
		.dir_setup = (uint32_t)k->dir_setup_cycles,
		.dir_hold = (uint32_t)k->dir_hold_cycles,
		.quadrature = k->signal == 1,
		.high_ns = (int64_t)(k->high_us * 1e3),
		.low_ns = (int64_t)(k->low_us * 1e3),
		.setup_ns = (int64_t)(k->setup_us * 1e3),
	};
}

/* Its priority is below the cycle's, should they share a processor. */
static int edges_open(struct gpio *g, const struct machine_config *c,
		      struct interp_diag *d)
{
	const struct edges_config e = {
		.pulser = pulser_of(&c->gpio),
		.period_ns = config_period_ns(c),
		.slots = (uint32_t)c->gpio.edges_per_period,
		.cpu = (int)c->gpio.edges_cpu,
		.priority = (int)c->priority - 1,
		.write = gpio_edges_write, .arg = g,
	};
	const int err = has_edges(&c->gpio) ? edges_start(&g->edges, &e) : 0;

	return err < 0 ? refuse(d, err, "edges_per_period", strerror(-err),
				"room for another thread") : 0;
}

static void configure(struct gpio *g, const struct machine_config *c)
{
	const struct config_gpio *k = &c->gpio;
	const struct pulser_config p = pulser_of(k);

	pulser_init(&g->pulser, &p);
	g->watchdog_periods = periods(c, k->watchdog_us * 1e-6);
	g->refresh_periods = periods(c, REFRESH_S);
	g->dead_max = 1 + periods(c, DEAD_S);
	g->adc_max = 1 + periods(c, QUIET_S);
	g->quiet_max = periods(c, QUIET_S);
	g->has_gap = config_gpio_has_lines(c);
	g->brake_ns = (int64_t)(k->brake_ms * 1e6);
	g->brake_periods = periods(c, k->brake_ms * 1e-3);
	g->open_left = g->brake_periods + 1;
	for (int i = 0; i < IO_NAXES; i++)
		g->quadrature[i].fd = -1;
}

int gpio_open_outputs(struct gpio **ret, const struct machine_config *c,
		      struct interp_diag *diag)
{
	struct gpio *g = calloc(1, sizeof(*g));
	int err;

	*diag = (struct interp_diag) { .line = 0 };
	if (!g)
		return refuse(diag, -ENOMEM, "chip", strerror(ENOMEM),
			      "memory");
	g->adc.fd = -1;
	configure(g, c);
	err = lines_open(g, c, diag);
	if (err < 0)
		gpio_close(g);
	else
		*ret = g;
	return err;
}

int io_gpio_open(struct io_machine *m, const struct machine_config *c,
		 struct interp_diag *diag)
{
	struct gpio *g;
	int err = gpio_open_outputs(&g, c, diag);

	if (err < 0)
		return err;
	g->has_power = is_wired(g, LINE_ENABLE, 1 + IO_NAXES);
	err = encoders_open(g, c, diag);
	if (err == 0)
		err = adc_begin(g, c, diag);
	if (err == 0)
		err = edges_open(g, c, diag);
	if (err < 0) {
		gpio_close(g);
		return err;
	}
	*m = (struct io_machine) {
		.name = "gpio", .self = g, .read = gpio_read,
		.write = gpio_write, .close = gpio_close, .note = gpio_note,
		.edges_per_cycle = has_edges(&c->gpio) ?
			(uint32_t)c->gpio.edges_per_period /
			pulser_periods(&g->pulser.c) : 1,
	};
	return 0;
}
