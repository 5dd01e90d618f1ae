/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_lines.c - drives on a bus, whose brakes are on lines of a GPIO chip
 *
 * This is a file of its own because edmsim uses the rest of the master and has
 * no lines.
 */
#include "can402_bus.h"
#include "gpio_own.h"

static bool open_brakes(void *arg, uint32_t axes)
{
	struct gpio *g = arg;

	g->out = (uint64_t)axes << LINE_BRAKE;
	gpio_outputs_write(g);
	return !g->lost;
}

static void close_both(void *self)
{
	struct can402 *s = self;
	struct gpio *g = s->brake_arg;

	can402_brake_close(s);
	can402_close(s);
	gpio_close(g);
}

int io_can402_open(struct io_machine *m, const struct machine_config *c,
		   struct interp_diag *diag)
{
	struct can402 *s;
	struct gpio *g;
	int err = can402_open(m, c, diag);

	if (err < 0)
		return err;
	s = m->self;
	if (!s->braked)
		return 0;
	err = gpio_open_outputs(&g, c, diag);
	if (err < 0) {
		can402_close(s);
		return err;
	}
	s->brake = open_brakes;
	s->brake_arg = g;
	m->close = close_both;
	return 0;
}
