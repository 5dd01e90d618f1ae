/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_bus.h - what the files of the CAN master share: the bus, its drives,
 * and what the log says of them
 *
 * Threads: can402_tell() and can402_count() belong to the cycle's thread,
 * can402_note() to the thread that logs; the others are as in io.h.
 */
#ifndef IO_CAN402_BUS_H
#define IO_CAN402_BUS_H

#include "can402.h"
#include "can_socket.h"
#include "config.h"
#include "drives.h"

#include <stdatomic.h>

/* Opens the brakes of @axes, a bit each, and closes all others. */
typedef bool can402_brake_fn(void *arg, uint32_t axes);

enum can402_note_kind {
	NOTE_TROUBLE, NOTE_ABORT, NOTE_PASSED, NOTE_EMERGENCY, NOTE_UP,
	NOTE_SILENT, NOTE_LOST, NOTE_WARNING, NOTE_UNMAPPED, NOTE_BUS_OFF,
	NOTE_DOWN, NOTE_BACK, NOTE_FULL, NOTE_FOREIGN, NOTE_MALFORMED,
	/* In the order of enum can_got: */
	NOTE_BUS_WARNING, NOTE_BUS_PASSIVE, NOTE_BUS_ACTIVE, NOTE_RX_OVERFLOW,
	NOTE_TX_OVERFLOW, NOTE_END
};

struct can402_note {
	enum can402_note_kind kind;
	uint8_t node, axis, passed;
	uint8_t maker[5];		/* of an emergency */
	uint32_t number, more, value;
};

#define CAN402_NOTES	256		/* a power of two */

/* What the log has said about a drive so far. */
struct can402_told {
	bool up, lost;
	enum drive_trouble trouble;
	uint32_t emergencies, unanswered, aborts, warnings;
};

/* One drive that brakes; can402_stop.c. */
struct can402_stop {
	int32_t was;			/* increments: the previous target */
	double speed;			/* increments a period, at the start */
	double a;			/* ... a period^2: how hard it brakes */
	double at;			/* increments: where it is by now */
	int32_t coast;			/* pulses it may have run on, after a
					 * stop */
	bool ill;			/* its drive stops by itself, while the
					 * others brake on the path */
};

struct can402 {
	int fd;
	uint32_t n;
	struct drive drive[IO_NAXES];
	uint8_t axis[IO_NAXES];
	struct config_can402 c;
	struct config_input input[IO_NAXES][CONFIG_NINPUTS];
	int64_t period_ns;
	uint32_t beat_every, beat_in;
	enum can_got bus;		/* CAN_NOTHING: well */
	bool stopped;			/* bus trouble, until a reset */
	int32_t plc_node;		/* our node for a PLC on this bus;
					 * 0: no PLC on it */
	bool were_on;			/* a period ago the drives had power */
	uint32_t stopping, stop_of;	/* periods left until all stand, and
					 * periods that braking takes */
	struct can402_stop stop[IO_NAXES];
	/* can402_brake.c: brakes that lines open */
	uint32_t braked, open;		/* bit per axis: has a brake; it is
					 * open */
	uint32_t brake_periods;		/* that a brake needs to open */
	uint32_t opening[IO_NAXES];	/* periods left until it is open */
	uint32_t closing;
	bool brakes_lost;		/* the lines of brakes do not answer */
	can402_brake_fn *brake;
	void *brake_arg;
	bool placed;			/* the drives' zeros are set */
	struct io_outputs out;
	double gap_v;
	struct io_shares shares;
	bool has_shares;
	uint32_t gap_age;
	struct can402_told told[IO_NAXES];
	uint32_t asked;			/* the drive whose object was asked for
					 * last */
	uint32_t malformed, foreign, lost;	/* all so far */
	uint16_t foreign_id;		/* of another master's last frame */
	uint32_t states[NOTE_END - NOTE_BUS_WARNING];	/* of the controller */
	/* Written by read and write, taken by note. */
	struct can402_note notes[CAN402_NOTES];
	_Atomic uint32_t put, taken;
};

/* -- can402_note.c -------------------------------------------------------- */

/** can402_tell() - say what the next line of the log is about. */
void can402_tell(struct can402 *s, const struct can402_note *n);

/**
 * can402_count() - count an event, which is the @n-th of its kind.
 *
 * The log tells of the first, the second, the fourth, the eighth and so on, so
 * that a flood of events makes few lines.
 */
void can402_count(struct can402 *s, enum can402_note_kind kind, uint32_t n);

/** can402_watch() - tell what has changed on drive @i. */
void can402_watch(struct can402 *s, uint32_t i);

/** can402_note() - io_machine.note */
bool can402_note(void *self, char *buf, size_t size);

/* -- can402.c ------------------------------------------------------------- */

/* Of struct io_machine. */
void can402_read(void *self, struct io_inputs *in);
void can402_write(void *self, const struct io_outputs *out);
void can402_close(void *self);
bool can402_origin(void *self, int32_t ret[IO_NAXES]);
void can402_originate(void *self, const int32_t zero[IO_NAXES]);

/* -- can402_told.c -------------------------------------------------------- */

/* Of struct io_machine. */
void can402_drives(void *self, struct cia402_told *ret);
bool can402_object(void *self, const struct cia402_request *r);

/* -- can402_stop.c -------------------------------------------------------- */

/**
 * can402_stop_step() - once a period, before the drives get their targets.
 *
 * @on: the drives are to have power, and the bus works.
 *
 * Drives that can brake do so together.  In a period each loses the same part
 * of its speed, so that they stay on the tangent of the path.
 *
 * Return: true while they brake; until then no drive may be stopped alone.
 */
bool can402_stop_step(struct can402 *s, bool on);

/** can402_stop_target() - the target of drive @i while it brakes, pulses. */
int32_t can402_stop_target(struct can402 *s, uint32_t i);

/* -- can402_brake.c ------------------------------------------------------- */

/**
 * can402_brake_step() - once a period, after can402_stop_step() said @on.
 *
 * A brake is open while its drive has torque and follows its targets.
 *
 * Return: true while the drives must hold their axes, because @on is true or a
 * brake is still closing.
 */
bool can402_brake_step(struct can402 *s, bool on);

/** can402_brake_opens() - a brake is still opening: nothing may move. */
bool can402_brake_opens(const struct can402 *s);

/**
 * can402_brake_close() - close all brakes; the drives hold the axes meanwhile.
 * It waits, so it is not RT-safe.
 */
void can402_brake_close(struct can402 *s);

/* -- can402_open.c -------------------------------------------------------- */

/** can402_open() - the bus, without lines for brakes.  Startup only. */
io_open_fn can402_open;

/**
 * can402_attach() - the drives that @c names, on the open socket @fd, which
 * belongs to the machine from then on. Return: 0 or -ENOMEM. Startup only.
 */
int can402_attach(struct io_machine *m, const struct machine_config *c, int fd);

/* After so many periods without a gap frame there is no gap. */
#define CAN402_STALE	20

#endif /* IO_CAN402_BUS_H */
