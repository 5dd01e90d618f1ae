/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_open.c - the generator as the machine file wants it, or why not
 */
#include "generator_own.h"
#include "iio.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static int refuse(struct interp_diag *diag, int err, const char *interface)
{
	interp_diag_say(diag, "generator.can_interface %s: %s; a CAN interface "
			"of this host that is up: ip link set %s up type can "
			"bitrate 500000", interface, strerror(-err), interface);
	return err;
}

/* What it tells; the socket hears nothing else. */
static int bus_open(const struct machine_config *c, struct interp_diag *diag)
{
	struct can_hear hear[PROCESS_NTOLD];
	const char *interface = c->generator.can_interface;
	struct config_way w;
	size_t n = 0;
	int fd;

	for (int i = 0; i < PROCESS_NTOLD; i++) {
		config_way(c, i, true, &w);
		if (w.kind == WAY_CAN)
			hear[n++] = (struct can_hear) { w.id, 0x7ff };
	}
	fd = can_socket_open(interface, hear, n);
	if (fd < 0)
		return refuse(diag, fd, interface);
	can_socket_queue(fd, GENERATOR_FRAMES);
	return fd;
}

static bool has(const struct generator *g, enum config_way_kind kind)
{
	for (int i = 0; i < PROCESS_NFIELDS; i++)
		if (g->way[i].kind == kind)
			return true;
	return false;
}

int io_generator_open(struct io_machine *m, const struct machine_config *c,
		      struct plc *plc, struct interp_diag *diag)
{
	const int interface = config_generator_interface(c);
	const bool bus = config_generator_frames(c,
						 c->generator.can_interface);
	const struct io_machine axes = *m;
	struct generator *g;
	int fd = -1, err = 0;

	if (!config_generator_beside(interface))
		return 0;
	if (bus)
		fd = bus_open(c, diag);
	if (bus && fd < 0)
		return fd;
	g = generator_attach(m, c, fd);
	if (!g)
		return -ENOMEM;
	g->takes = interface == GENERATOR_PLC;
	g->plc = g->takes ? plc : NULL;
	if (has(g, WAY_LINES))
		err = generator_lines_open(g, c, diag);
	if (err == 0 && has(g, WAY_DAC))
		err = generator_dac_open(g, IIO_SYSFS, diag);
	if (err == 0 && interface == GENERATOR_MODBUS)
		err = generator_modbus_open(g, c, diag);
	if (err < 0) {
		generator_dac_close(g);
		if (g->lines)
			g->lines_close(g->lines);
		generator_forget(g);
		*m = axes;
	}
	return err;
}
