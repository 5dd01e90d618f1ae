/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_link.h - the PLC of a machine: plc.h over a CAN interface
 *
 * It works beside any backend, on an interface of its own or on that of the
 * drives.  Once a period it reads what the PLC asks for, and later sends the
 * state of the machine.  It takes at most PLC_LINK_FRAMES frames in a period;
 * the others wait in the socket.
 *
 * A start and a reset are rising edges of their bits, and the bit must have
 * been 0 at least once since the PLC came.  So a PLC that comes back with the
 * bit set starts nothing.
 *
 * Threads: open and close are startup only; read and write are RT-safe, with a
 * system call for each frame; plc_link_note() may be called by one other
 * thread.
 */
#ifndef PLC_LINK_H
#define PLC_LINK_H

#include "io.h"
#include "plc.h"

#define PLC_LINK_FRAMES	16

struct machine_config;
struct interp_diag;

/* Counters of events; the thread that logs reads them. */
enum plc_count {
	PLC_CAME,			/* times its toggle began to turn */
	PLC_WENT,			/* times it stopped */
	PLC_MALFORMED,			/* frames of a wrong length or kind */
	PLC_REFUSED,			/* values and objects */
	PLC_TWINS,			/* frames of another device with our
					 * node */
	PLC_UNSENT,			/* frames not sent: the queue was
					 * full */
	PLC_WARNINGS, PLC_PASSIVE,	/* errors on the bus */
	PLC_BUS_OFF,
	PLC_DOWN,			/* times the interface went down */
	PLC_NCOUNTS
};

struct plc_link {
	struct plc plc;
	int fd;				/* -1: there is no PLC */
	char interface[16];
	uint8_t before;			/* its commands, a period ago */
	bool was_alive, is_down;
	uint32_t count[PLC_NCOUNTS];	/* atomic */
	uint32_t told[PLC_NCOUNTS];	/* belongs to the other thread */
};

/**
 * plc_link_open() - as [plc] says.
 *
 * Return: 0, also if there is no PLC; -errno with found and wanted of @diag
 * filled.  Startup only.
 */
int plc_link_open(struct plc_link *l, const struct machine_config *c,
		  struct interp_diag *diag);

/** plc_link_read() - once a period: read what the PLC asks for, and count the
 *  period. */
void plc_link_read(struct plc_link *l, struct io_plc *ret);

/** plc_link_write() - once a period: send the frames that are due. */
void plc_link_write(struct plc_link *l, const struct plc_tell *tell);

/**
 * plc_link_note() - put the next line for the log into @buf.
 *
 * An event that comes again and again is reported the first, second, fourth,
 * eighth, ... time.
 * Return: false if there is none.
 */
bool plc_link_note(struct plc_link *l, char *buf, size_t size);

/** plc_link_close() - also if there is no PLC. */
void plc_link_close(struct plc_link *l);

#endif /* PLC_LINK_H */
