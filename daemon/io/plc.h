/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc.h - a PLC over CAN: edmd as a CANopen slave, frames in, frames out
 *
 * plc_signals.h is the table of all signals: each has its object in the
 * dictionary, its place in a frame (PDO) and its range.
 *
 * What the PLC asks for is valid while its frames come and the bit `Alive` in
 * them changes: plc_alive().
 *
 * Units: in every name; counts are scaled as the table says.
 * Threads: RT-safe; one object belongs to one thread.
 */
#ifndef IO_PLC_H
#define IO_PLC_H

#include "can_msg.h"
#include "plc_signals.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PLC_NAXES	8		/* X Y Z A B C U V */

/* What a generator is asked for, and what it has: counts of PLC_PULSE_ROWS. */
struct plc_pulse {
	uint16_t number;		/* of what is asked; 0: of nothing */
	uint8_t bits;			/* PLC_ASKED_ or PLC_TOLD_ */
	uint16_t value[PLC_NPULSES];	/* UINT16_MAX: its own setting */
};

/* What edmd tells the PLC: whole numbers in the units of the table. */
struct plc_tell {
	uint8_t state;			/* enum shm_state */
	uint8_t flags;			/* PLC_TOGGLE ... PLC_NEGATIVE */
	uint8_t fault;			/* enum cycle_fault */
	uint8_t mcode;			/* M code that waits for the PLC; 0:
					 * none */
	uint16_t gap;			/* 0.01 V */
	int16_t feed;			/* um/s, signed along the path */
	uint32_t job;			/* program n; 0: none */
	uint32_t line;			/* of the source text */
	int32_t pos[PLC_NAXES];		/* pulses */
	uint8_t stand;			/* enum stand_reason */
	uint32_t stand_of;		/* words/stands.h */
	uint16_t electrode;		/* that is to be in from here on; 0:
					 * none */
	uint16_t condition;		/* number of the one in force ... */
	uint8_t letter;			/* ... ASCII; 0: none */
	struct plc_pulse pulse;		/* the generator is asked for */
};

/* What the PLC asks for. */
struct plc_ask {
	uint8_t command;		/* PLC_PERMIT ... PLC_ALIVE */
	uint8_t locks;			/* PLC_DOOR ... PLC_WIRE: each 1 while
					 * all is well, so that a cut wire
					 * counts as a lock */
	uint16_t override;		/* 0.1 % */
	uint16_t program;		/* to be selected; 0: none */
	uint8_t mcode_done;		/* the M code it has carried out */
	uint8_t axes_c;			/* their temperature, 0.25 degC; 0: not
					 * told */
	struct plc_pulse pulse;		/* that the generator has */
	uint16_t pulse_fault;		/* its own; 0: none */
};

/* Flags of plc_tell, and bits of plc_ask.command and plc_ask.locks. */
#define PLC_BIT_VALUE(id, of, bit, name, help) PLC_##id = 1 << (bit),
enum plc_bit {
	PLC_BIT_ROWS(PLC_BIT_VALUE)
	PLC_LOCKS	= 0x1f,		/* all interlocks */
};
#undef PLC_BIT_VALUE

/* Of CiA 301; PLC_TEXT is a VISIBLE_STRING of four characters. */
enum plc_type { PLC_U8, PLC_U16, PLC_U32, PLC_I16, PLC_I32, PLC_TEXT };

/* One object of the dictionary that carries a signal. */
struct plc_signal {
	uint16_t index;
	uint8_t sub;
	enum plc_type type;
	uint8_t pdo;			/* the TPDO or RPDO that it is in; 0:
					 * none */
	uint8_t byte;			/* its first byte in that */
	bool asked;			/* the PLC writes it */
	uint16_t offset;		/* in struct plc_tell or plc_ask */
	int64_t min, max;		/* counts */
	const char *name;
};

extern const struct plc_signal plc_signal[];
extern const size_t plc_nsignals;

#define PLC_NRPDO	4		/* from 1 on */
#define PLC_HISTORY	8
#define PLC_EMCY_OFF	0x80000000u

struct plc {
	uint8_t node;
	double cycles_per_ms;
	uint16_t beat_ms;		/* 1017: own heartbeat; 0: none */
	uint32_t beat_cycles, send_cycles;	/* heartbeat and TPDOs */
	uint32_t emcy_id;		/* 1014; PLC_EMCY_OFF: none are sent */
	uint32_t alive_cycles;		/* the PLC is dead if its toggle did not
					 * change for so long */
	uint32_t beat_in, send_in;
	struct plc_tell tell;
	struct plc_ask ask;
	bool sets;			/* the PLC sets the generator ... */
	uint16_t sent;			/* ... number of what was sent last */
	uint32_t heard[PLC_NRPDO];	/* frames that were taken */
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
	uint32_t twins;			/* frames of another device with our
					 * node */
	struct can_msg answer;		/* of the SDO server, if ... */
	bool answers;			/* ... this is set */
	uint8_t next;			/* TPDO to send next; 0: none is due */
};

/** plc_init() - nothing was heard yet, and permit is off. */
void plc_init(struct plc *p, uint8_t node);

/**
 * plc_receive() - take a frame. Return: false if it is not for us.
 *
 * A frame of a wrong length, or with a value out of range, changes nothing and
 * is counted.
 */
bool plc_receive(struct plc *p, const struct can_msg *m);

/**
 * plc_emit() - the frames of this period, after p->tell was filled.
 * Return: how many into @ret, at most PLC_EMITS.
 */
size_t plc_emit(struct plc *p, struct can_msg *ret);

#define PLC_EMITS	6		/* heartbeat, emergency, SDO answer,
					 * three TPDOs */

/** plc_period() - once a period before the frames: time goes by. */
void plc_period(struct plc *p);

/** plc_beat() - send a heartbeat every @ms from now on; 0: none. */
void plc_beat(struct plc *p, uint16_t ms);

/** plc_alive() - is the PLC there? */
static inline bool plc_alive(const struct plc *p)
{
	return p->alive;
}

/** plc_bytes() - the size of a type. */
size_t plc_bytes(enum plc_type t);

/* -- plc_sdo.c ------------------------------------------------------------- */

/**
 * plc_sdo() - take a request; the answer is p->answer.
 *
 * What the PLC asks for can be written by SDO only while the node is
 * pre-operational: then no PDOs come that it would contradict.
 */
void plc_sdo(struct plc *p, const struct can_msg *m);

/** plc_value() - the value of a signal, as it is sent. */
uint32_t plc_value(const struct plc *p, const struct plc_signal *s);

/** plc_take() - put @raw into its signal; false if it is out of range. */
bool plc_take(struct plc *p, const struct plc_signal *s, uint32_t raw);

/* What a PLC_OBJECT row's value is, or which member of struct plc has it. */
enum plc_live { PLC_FIXED, PLC_PLUS_NODE, PLC_REGISTER, PLC_ERRORS, PLC_ERROR,
		PLC_EMCY, PLC_BEAT, PLC_NLIVE };

struct plc_constant {
	uint16_t index;
	uint8_t sub;
	enum plc_type type;
	uint32_t value;
	enum plc_live live;
};

extern const struct plc_constant plc_constant[];
extern const size_t plc_nconstants;

#endif /* IO_PLC_H */
