/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpio.c - a machine on the lines of GPIO chips: pulses out, switches in
 *
 * All outputs of a chip are one request and one write a period, all inputs one
 * request and one read.  A write that would change nothing is left out, but
 * not longer than REFRESH_S: a chip that is gone is to be noticed.
 *
 * A chip that does not answer is lost for good: no pulses, no sparks, no
 * watchdog wave, whatever the chips that still answer.
 */
#include "config.h"
#include "io.h"
#include "lines.h"
#include "pulser.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define NCHIPS		4
#define REFRESH_S	1e-3
#define QUIET_S		0.1		/* no comparator on, with the power on */

/* Lines of one chip, one direction. */
struct bulk {
	struct lines *lines;		/* NULL: none */
	unsigned int offset[LINES_MAX];
	uint8_t value[LINES_MAX];	/* levels */
	size_t n;
};

struct chip {
	char name[CONFIG_LINE_MAX + 32];
	struct lines_chip *chip;
	struct bulk out, in;
};

/* Where a line of the machine file is found; chip < 0: nowhere. */
struct place {
	int8_t chip;
	uint8_t slot;
	bool inverted;
};

struct gpio {
	struct chip chip[NCHIPS];
	int nchips;
	struct place at[CONFIG_NLINES];
	struct pulser pulser;
	uint64_t in, out;		/* a bit per line: on */
	uint32_t path;			/* program the pulser counts in */
	bool placed;			/* a first target came */
	bool lost;
	uint32_t watchdog_left, watchdog_periods;
	uint32_t refresh_left, refresh_periods;
	uint32_t quiet, quiet_max;	/* periods without a comparator */
	struct io_shares shares;	/* as told last */
	bool has_gap;
};

static bool is_on(const struct gpio *g, int line)
{
	return g->in >> line & 1;
}

/* -- Inputs ------------------------------------------------------------------ */

static void inputs_read(struct gpio *g)
{
	for (int i = 0; i < g->nchips && !g->lost; i++) {
		struct bulk *b = &g->chip[i].in;

		if (b->lines && lines_get(b->lines, b->value) < 0)
			g->lost = true;
	}
	g->in = 0;
	for (int l = CONFIG_NOUTPUTS; l < CONFIG_NLINES; l++) {
		const struct place *p = &g->at[l];

		if (p->chip >= 0 &&
		    g->chip[p->chip].in.value[p->slot] != p->inverted)
			g->in |= UINT64_C(1) << l;
	}
}

/* The worse one counts if several are on; none on is what it was. */
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

static void gpio_read(void *self, struct io_inputs *in)
{
	struct gpio *g = self;

	inputs_read(g);
	if (g->has_gap)
		gap_read(g);
	*in = (struct io_inputs) {
		.shares = g->shares,
		.shares_valid = g->has_gap && g->quiet <= g->quiet_max,
		.wire_broken = is_on(g, LINE_WIRE),
		.estop = is_on(g, LINE_ESTOP),
		.door_open = is_on(g, LINE_DOOR),
		.dielectric_low = is_on(g, LINE_DIELECTRIC),
		.limit = axes_on(g, LINE_LIMIT),
		.home = axes_on(g, LINE_HOME),
		.lost = g->lost,
		.busy = pulser_busy(&g->pulser),
	};
	memcpy(in->actual, g->pulser.put, sizeof(in->actual));
}

/* -- Outputs ----------------------------------------------------------------- */

static bool levels_take(struct gpio *g)
{
	bool changed = false;

	for (int l = 0; l < CONFIG_NOUTPUTS; l++) {
		const struct place *p = &g->at[l];
		uint8_t level, *was;

		if (p->chip < 0)
			continue;
		level = (uint8_t)((g->out >> l & 1) != p->inverted);
		was = &g->chip[p->chip].out.value[p->slot];
		changed = changed || *was != level;
		*was = level;
	}
	return changed;
}

static void outputs_write(struct gpio *g)
{
	if (!levels_take(g) && g->refresh_left > 0) {
		g->refresh_left--;
		return;
	}
	g->refresh_left = g->refresh_periods;
	for (int i = 0; i < g->nchips; i++) {
		struct bulk *b = &g->chip[i].out;

		if (b->lines && lines_set(b->lines, b->value) < 0)
			g->lost = true;
	}
}

/* Another program begins where the machine stands: no pulses to there. */
static void pulses_make(struct gpio *g, const struct io_outputs *out)
{
	if (!g->placed || out->path != g->path)
		pulser_stand_at(&g->pulser, out->target);
	g->placed = true;
	g->path = out->path;
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

static void gpio_write(void *self, const struct io_outputs *out)
{
	struct gpio *g = self;

	if (g->lost) {
		g->out &= ~(UINT64_C(1) << LINE_SPARK);
	} else {
		const bool dog = watchdog_level(g);

		pulses_make(g, out);
		g->out = (uint64_t)g->pulser.step << LINE_STEP |
			 (uint64_t)g->pulser.dir << LINE_DIR |
			 (uint64_t)out->power << LINE_SPARK |
			 (uint64_t)out->pump << LINE_PUMP |
			 (uint64_t)dog << LINE_WATCHDOG;
	}
	outputs_write(g);
}

/* -- Open and close ------------------------------------------------------------ */

static void gpio_close(void *self)
{
	struct gpio *g = self;

	g->out = 0;
	g->refresh_left = 0;
	outputs_write(g);
	for (int i = 0; i < g->nchips; i++) {
		lines_release(g->chip[i].out.lines);
		lines_release(g->chip[i].in.lines);
		if (g->chip[i].chip)
			lines_chip_close(g->chip[i].chip);
	}
	free(g);
}

static int refuse(struct interp_diag *d, int err, const char *line,
		  const char *found, const char *wanted)
{
	interp_diag_say(d, "gpio.%s: %s; %s", line, found, wanted);
	return err;
}

static int refuse_chip(struct interp_diag *d, int err, const char *line,
		       const char *chip)
{
	char found[128];

	snprintf(found, sizeof(found), "chip %s: %s", chip, strerror(-err));
	if (err == -EACCES || err == -EPERM)
		return refuse(d, err, line, found, "a user of group gpio: "
			      "usermod -aG gpio USER, and 60-edmd.rules in "
			      "/usr/lib/udev/rules.d");
	return refuse(d, err, line, found, "[gpio] chip = a name or label "
		      "that gpiodetect lists");
}

/*
 * By label, for boards that number their chips anew at each start.  A chip that
 * may not be opened may be the one.
 */
static int chip_by_label(struct lines_chip **ret, const char *label)
{
	char path[32], has[64];
	int err = -ENOENT;

	for (int i = 0; i < 64; i++) {
		int e;

		snprintf(path, sizeof(path), "/dev/gpiochip%d", i);
		e = lines_chip_open(ret, path);
		if (e == -EACCES || e == -EPERM)
			err = e;
		if (e < 0)
			continue;
		lines_chip_label(*ret, has, sizeof(has));
		if (strcmp(has, label) == 0)
			return 0;
		lines_chip_close(*ret);
	}
	return err;
}

static int chip_open(struct lines_chip **ret, const char *name)
{
	char path[96];
	int err;

	snprintf(path, sizeof(path), "%s%s", *name == '/' ? "" : "/dev/", name);
	err = lines_chip_open(ret, path);
	return err == -ENOENT && *name != '/' ? chip_by_label(ret, name) : err;
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
	err = chip_open(&c->chip, name);
	if (err < 0)
		return refuse_chip(d, err, line, name);
	snprintf(c->name, sizeof(c->name), "%s", name);
	return g->nchips++;
}

static int line_check(const struct chip *c, unsigned int offset,
		      const char *line, struct interp_diag *d)
{
	const unsigned int n = lines_chip_count(c->chip);
	char found[128], wanted[128], user[32];

	if (offset >= n) {
		snprintf(found, sizeof(found), "line %u of %s, which has %u",
			 offset, c->name, n);
		snprintf(wanted, sizeof(wanted), "0 to %u; gpioinfo %s", n - 1,
			 c->name);
		return refuse(d, -ERANGE, line, found, wanted);
	}
	if (lines_chip_user(c->chip, offset, user, sizeof(user))) {
		snprintf(found, sizeof(found), "line %u of %s is in use by %s",
			 offset, c->name, user);
		snprintf(wanted, sizeof(wanted), "a free line; gpioinfo %s "
			 "lists them; or end %s", c->name, user);
		return refuse(d, -EBUSY, line, found, wanted);
	}
	return 0;
}

/* Inputs may share a line. */
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

static int line_place(struct gpio *g, const struct config_gpio *k, int line,
		      struct interp_diag *d)
{
	const char *name = config_line_name(line);
	struct config_line_at at;
	struct chip *c;
	int i, err;

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
		.slot = slot_find(line < CONFIG_NOUTPUTS ? &c->out : &c->in,
				  at.offset),
		.inverted = at.inverted,
	};
	return 0;
}

/* A line of this bulk, for a message about all of them. */
static const char *line_of(const struct gpio *g, int chip, bool output)
{
	int l = output ? 0 : CONFIG_NOUTPUTS;

	while (g->at[l].chip != chip)
		l++;
	return config_line_name(l);
}

static int bulk_request(struct gpio *g, int chip, bool output,
			struct lines_wanted *w, struct interp_diag *d)
{
	struct bulk *b = output ? &g->chip[chip].out : &g->chip[chip].in;
	int err;

	if (b->n == 0)
		return 0;
	w->offset = b->offset;
	w->value = b->value;
	w->n = b->n;
	w->output = output;
	err = lines_request(&b->lines, g->chip[chip].chip, w);
	return err < 0 ? refuse_chip(d, err, line_of(g, chip, output),
				     g->chip[chip].name) : 0;
}

static int lines_open(struct gpio *g, const struct machine_config *c,
		      struct interp_diag *d)
{
	static const enum lines_pull pulls[] = {
		LINES_AS_IS, LINES_PULL_UP, LINES_PULL_DOWN, LINES_NO_PULL
	};
	struct lines_wanted w = { .pull = pulls[c->gpio.pull] };

	for (int l = 0; l < CONFIG_NLINES; l++)
		g->at[l].chip = -1;
	for (int l = 0; l < CONFIG_NLINES; l++) {
		const int err = line_place(g, &c->gpio, l, d);

		if (err < 0)
			return err;
	}
	levels_take(g);
	for (int i = 0; i < g->nchips; i++) {
		int err = bulk_request(g, i, true, &w, d);

		if (err == 0)
			err = bulk_request(g, i, false, &w, d);
		if (err < 0)
			return err;
	}
	return 0;
}

static uint32_t periods(const struct machine_config *c, double s)
{
	const double n = s * 1e9 / (double)config_period_ns(c);

	return n < 1 ? 1 : (uint32_t)(n + 0.5);
}

static void configure(struct gpio *g, const struct machine_config *c)
{
	const struct config_gpio *k = &c->gpio;
	const struct pulser_config p = {
		.high = (uint32_t)k->high_cycles,
		.low = (uint32_t)k->low_cycles,
		.dir_setup = (uint32_t)k->dir_setup_cycles,
		.dir_hold = (uint32_t)k->dir_hold_cycles,
		.quadrature = k->signal == 1,
	};

	pulser_init(&g->pulser, &p);
	g->watchdog_periods = periods(c, k->watchdog_us * 1e-6);
	g->refresh_periods = periods(c, REFRESH_S);
	g->quiet_max = periods(c, QUIET_S);
	g->has_gap = config_gpio_has_gap(c);
}

int io_gpio_open(struct io_machine *m, const struct machine_config *c,
		 struct interp_diag *diag)
{
	struct gpio *g = calloc(1, sizeof(*g));
	int err;

	*diag = (struct interp_diag) { .line = 0 };
	if (!g)
		return refuse(diag, -ENOMEM, "chip", strerror(ENOMEM),
			      "memory");
	configure(g, c);
	err = lines_open(g, c, diag);
	if (err < 0) {
		gpio_close(g);
		return err;
	}
	*m = (struct io_machine) {
		.name = "gpio", .self = g, .read = gpio_read,
		.write = gpio_write, .close = gpio_close,
		.edges_per_cycle = 1,
	};
	return 0;
}
