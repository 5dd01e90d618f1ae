/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator.h - a generator beside the machine that moves the axes
 *
 * It is a device of its own: a machine of any backend can have one that is
 * reached by lines, by CAN frames, by Modbus or by the PLC, or by lines and one
 * of these.  It is put in front of the backend: its outputs are written before
 * those of the axes, and what it says is in io_inputs.generator.
 *
 * Lines are written when they change.  A frame is sent in the period in which
 * it changes, and again at least every REFRESH_S, so that a generator can see
 * that edmd is there.  The usual frame counts in its second byte.
 *
 * A generator that tells its values is believed: what was asked is in force
 * when all that it tells agrees.  It is trouble, until a reset, if it then
 * tells another value, is silent, or does not agree in [generator] confirm_s.
 *
 * Threads: as in io.h.
 */
#ifndef IO_GENERATOR_H
#define IO_GENERATOR_H

#include "io.h"

struct plc;

/**
 * io_generator_open() - put the generator of @c in front of @m, which is open.
 *
 * Without an interface that reaches one, @m stays as it is.  @plc: the one that
 * may set it; it need not be open yet.
 * Return: 0, or -errno with @diag filled as io_open_fn does; @m is then still
 * to be closed.  Startup only.
 */
int io_generator_open(struct io_machine *m, const struct machine_config *c,
		      struct plc *plc, struct interp_diag *diag);

#endif /* IO_GENERATOR_H */
