/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc.h - a PLC over CAN: edmd as a CANopen slave, frames in, frames out
 *
 * What crosses is one table of signals (plc_signal): each has its object in
 * the dictionary, its place in a process data object, its range and its words.
 * The SDO server, the frames, messages/edmd.eds and messages/edmd.dbc come
 * from it.
 *
 * The PLC's word counts as long as its frames come and its toggle bit turns:
 * plc_alive().
 *
 * Units: in every name; scaled as the table says.
 * Threads: plc_eds(), plc_dbc() and plc_document() any, with stdio; all else RT-safe, one
 * object belongs to one thread.
 */
#ifndef IO_PLC_H
#define IO_PLC_H

#include "can_msg.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define PLC_NAXES	8		/* X Y Z A B C U V */

/* What edmd tells, whole numbers in the units of the table. */
struct plc_tell {
	uint8_t state;			/* enum shm_state */
	uint8_t flags;			/* enum plc_flag */
	uint8_t fault;			/* enum cycle_fault */
	uint8_t mcode;			/* M code that waits for the PLC; 0 */
	uint16_t gap;			/* 0.01 V */
	int16_t feed;			/* um/s, signed along the path */
	uint32_t job;			/* program n; 0: none */
	uint32_t line;			/* of the source text */
	int32_t pos[PLC_NAXES];		/* pulses */
};

/* What the PLC asks. */
struct plc_ask {
	uint8_t command;		/* enum plc_command */
	uint8_t locks;			/* enum plc_lock */
	uint16_t override;		/* 0.1 % */
	uint16_t program;		/* to be selected; 0: none */
	uint8_t mcode_done;		/* the M code it has carried out */
	uint8_t axes_c;			/* their temperature, 0.25 degC; 0: not
					 * told */
};

enum plc_flag {
	PLC_TOGGLE	= 0x01,		/* turns with every frame */
	PLC_SPARK	= 0x02,		/* spark power is asked for */
	PLC_RUNS	= 0x04,		/* a job is under way */
	PLC_HELD	= 0x08,
	PLC_FAULTY	= 0x10,
	PLC_PUMP	= 0x20,
	PLC_LOADED	= 0x40,		/* a job is there to be started */
};

enum plc_command {
	PLC_PERMIT	= 0x01,		/* sparks and motion are allowed */
	PLC_START	= 0x02,		/* on its rising edge */
	PLC_HOLD	= 0x04,		/* as long as it is 1 */
	PLC_RESET	= 0x08,		/* on its rising edge */
	PLC_ALIVE	= 0x80,		/* turns at least each plc.alive_ms */
};

/* Each 1 while all is well, so that a cut wire is a lock. */
enum plc_lock {
	PLC_DOOR	= 0x01,		/* closed */
	PLC_LEVEL	= 0x02,		/* dielectric covers the work */
	PLC_TEMPERATURE	= 0x04,		/* in range */
	PLC_FIRE	= 0x08,		/* none */
	PLC_WIRE	= 0x10,		/* whole */
	PLC_LOCKS	= 0x1f,
};

enum plc_type { PLC_U8, PLC_U16, PLC_U32, PLC_I16, PLC_I32 };

/* One object of the dictionary that carries a signal. */
struct plc_signal {
	uint16_t index;
	uint8_t sub;
	enum plc_type type;
	bool asked;			/* the PLC writes it */
	uint8_t pdo;			/* 1 ... 4: TPDO or RPDO it is in; 0 */
	uint8_t byte;			/* its first one there */
	uint16_t offset;		/* in struct plc_tell or plc_ask */
	int64_t min, max;
	const char *name;		/* of the object and the signal */
	const char *unit;
	double scale;			/* unit per count */
	const char *help;
};

extern const struct plc_signal plc_signal[];
extern const size_t plc_nsignals;

#define PLC_HISTORY	8

struct plc {
	uint8_t node;
	uint32_t beat_cycles, send_cycles;	/* own heartbeat and TPDOs */
	uint32_t alive_cycles;		/* no turn of the toggle: dead */
	uint32_t beat_in, send_in;
	struct plc_tell tell;
	struct plc_ask ask;
	bool operational, stopped;	/* NMT */
	uint32_t since_turn;		/* cycles since the toggle turned */
	bool alive;
	bool toggle;
	bool booted;			/* the boot-up message is out */
	uint8_t register_1001;		/* error register; bit 0: a fault */
	uint8_t fault_sent;		/* by an emergency message */
	uint32_t history[PLC_HISTORY];	/* 1003: the newest first */
	uint8_t nhistory;
	uint32_t malformed, refused;	/* frames and values, in all */
	uint32_t twins;			/* frames of another one of our node */
	struct can_msg answer;		/* of the SDO server, if */
	bool answers;
	uint8_t next;			/* TPDO to send next, 0: none due */
};

/** plc_init() - nothing heard yet; permit is off. */
void plc_init(struct plc *p, uint8_t node);

/**
 * plc_receive() - a frame; false if it is not for us.
 *
 * One of a wrong length, or with a value out of range, changes nothing and is
 * counted.
 */
bool plc_receive(struct plc *p, const struct can_msg *m);

/**
 * plc_emit() - the frames of this period, after p->tell was filled.
 * Return: how many into @ret, at most PLC_EMITS.
 */
size_t plc_emit(struct plc *p, struct can_msg *ret);

#define PLC_EMITS	4		/* heartbeat, emergency, SDO answer, one
					 * TPDO */

/** plc_period() - once a period before the frames: time goes by. */
void plc_period(struct plc *p);

/** plc_alive() - is the PLC there? */
static inline bool plc_alive(const struct plc *p)
{
	return p->alive;
}

/** plc_bytes() - of a type. */
size_t plc_bytes(enum plc_type t);

/** plc_eds() - messages/edmd.eds, CiA 306. */
void plc_eds(FILE *f);

/** plc_dbc() - messages/edmd.dbc, for node @node. */
void plc_dbc(FILE *f, uint8_t node);

/** plc_document() - docs/plc-signals.md. */
void plc_document(FILE *f);

/* -- plc_sdo.c ------------------------------------------------------------- */

/**
 * plc_sdo() - a request; its answer is p->answer.
 *
 * What the PLC asks may be written while the node is pre-operational only:
 * then PDOs do not come, and nobody is overruled.
 */
void plc_sdo(struct plc *p, const struct can_msg *m);

/** plc_value() - of a signal, as the wire has it. */
uint32_t plc_value(const struct plc *p, const struct plc_signal *s);

/** plc_take() - put @raw into its signal; false if it is out of range. */
bool plc_take(struct plc *p, const struct plc_signal *s, uint32_t raw);

/* What a master asks for besides, and may write only as it is. */
enum plc_live { PLC_FIXED, PLC_PLUS_NODE, PLC_REGISTER, PLC_ERRORS, PLC_ERROR };

struct plc_constant {
	uint16_t index;
	uint8_t sub;
	enum plc_type type;
	uint32_t value;
	enum plc_live live;		/* not the value alone */
	const char *name;
};

extern const struct plc_constant plc_constant[];
extern const size_t plc_nconstants;

#endif /* IO_PLC_H */
