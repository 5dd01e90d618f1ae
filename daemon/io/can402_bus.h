/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_bus.h - the master's own: a bus, its drives, and what to say of them
 *
 * Threads: can402_tell() and can402_count() the cycle's, can402_note() the
 * logging one's; the rest as io.h.
 */
#ifndef IO_CAN402_BUS_H
#define IO_CAN402_BUS_H

#include "can402.h"
#include "can_socket.h"
#include "config.h"

#include <stdatomic.h>

enum can402_note_kind {
	NOTE_TROUBLE, NOTE_ABORT, NOTE_EMERGENCY, NOTE_UP, NOTE_SILENT,
	NOTE_BUS_OFF, NOTE_DOWN, NOTE_BACK, NOTE_FULL, NOTE_FOREIGN,
	NOTE_MALFORMED
};

struct can402_note {
	enum can402_note_kind kind;
	uint8_t node, axis;
	uint32_t number, more;
};

#define CAN402_NOTES	32		/* a power of two */

/* What was said of a drive. */
struct can402_told {
	bool up;
	enum drive_trouble trouble;
	uint32_t emergencies, unanswered;
};

struct can402 {
	int fd;
	uint32_t n;
	struct drive drive[IO_NAXES];
	uint8_t axis[IO_NAXES];
	struct config_can402 c;
	uint32_t beat_every, beat_in;
	enum can_got bus;		/* CAN_NOTHING: well */
	bool stopped;			/* bus trouble, until a reset */
	bool placed;			/* the drives' zeros are set */
	int32_t resync_max[IO_NAXES];	/* pulses */
	struct io_outputs out;
	uint8_t count;
	double gap_v;
	struct io_shares shares;
	bool has_shares;
	uint32_t gap_age;
	struct can402_told told[IO_NAXES];
	uint32_t malformed, foreign, lost;	/* all so far */
	/* Written by read and write, taken by note. */
	struct can402_note notes[CAN402_NOTES];
	_Atomic uint32_t put, taken;
};

/* -- can402_note.c ------------------------------------------------------------ */

/** can402_tell() - what the next line of the log is to say. */
void can402_tell(struct can402 *s, const struct can402_note *n);

/**
 * can402_count() - the @n-th of its kind; told of are the first, the second,
 * the fourth ...: a flood says little.
 */
void can402_count(struct can402 *s, enum can402_note_kind kind, uint32_t n);

/** can402_watch() - tell what is new of drive @i. */
void can402_watch(struct can402 *s, uint32_t i);

/** can402_note() - io_machine.note */
bool can402_note(void *self, char *buf, size_t size);

/* -- can402.c ----------------------------------------------------------------- */

/* Of struct io_machine. */
void can402_read(void *self, struct io_inputs *in);
void can402_write(void *self, const struct io_outputs *out);
void can402_close(void *self);
bool can402_origin(void *self, int32_t ret[IO_NAXES]);
void can402_originate(void *self, const int32_t zero[IO_NAXES]);

/* -- can402_open.c ------------------------------------------------------------ */

/**
 * can402_attach() - the drives that @c names, on an open @fd, which is the
 * machine's from then on.  Return: 0 or -ENOMEM.  Startup only.
 */
int can402_attach(struct io_machine *m, const struct machine_config *c, int fd);

/* Periods without a gap frame, then there is no gap. */
#define CAN402_STALE	20

#endif /* IO_CAN402_BUS_H */
