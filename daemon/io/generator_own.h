/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_own.h - what the files of the generator share
 *
 * Threads: as in io.h; generator_note() belongs to the thread that logs.
 */
#ifndef IO_GENERATOR_OWN_H
#define IO_GENERATOR_OWN_H

#include "can_socket.h"
#include "config.h"
#include "generator.h"
#include "plc.h"

#include <stdatomic.h>

#define GENERATOR_FRAMES	(PROCESS_NFIELDS + 1)
#define GENERATOR_NOTES		16	/* a power of two */

struct generator_frame {
	struct can_msg sent;		/* as it was sent last */
	bool counts;			/* in its second byte */
	bool owed;			/* the queue has not taken its change */
	uint32_t full;			/* ... nor anything for so many
					 * periods */
	uint32_t age;			/* periods since; refresh: now */
};

enum generator_note_kind {
	GENERATOR_SILENT, GENERATOR_DIFFERS, GENERATOR_LATE,
	GENERATOR_LINES_LOST, GENERATOR_BUS_DOWN, GENERATOR_BUS_BACK,
	GENERATOR_REFUSES, GENERATOR_LINK_DOWN, GENERATOR_LINK_BACK,
	GENERATOR_FAULT, GENERATOR_UNCOUNTED, GENERATOR_DAC
};

struct generator_note {
	enum generator_note_kind kind;
	int field;
	double asked, told;
	int code;			/* REFUSES: the exception; LINK, DAC:
					 * errno; FAULT: its number */
};

#define GENERATOR_NCOUNTS	(PROCESS_SHORTS - PROCESS_OPENS + 1)

/* Readings of the gap from the sums of pulses, PROCESS_OPENS on. */
struct generator_counts {
	bool wanted;			/* [gap] source is counts */
	double least;			/* pulses of a reading */
	uint32_t stale, age;		/* periods since the last reading, or
					 * since there are sparks */
	uint32_t told;			/* a bit for each that was told since
					 * they were looked at */
	bool begun;			/* `from` is with sparks */
	bool reset;			/* one began at 0 */
	bool read;			/* `shares` is a reading */
	double from[GENERATOR_NCOUNTS];
	struct io_shares shares;
};

struct generator_dac;
struct generator_lines;
struct generator_modbus;

struct generator {
	struct io_machine axes;		/* behind it */
	struct config_way way[PROCESS_NFIELDS], told[PROCESS_NTOLD];
	double value[PROCESS_NFIELDS];	/* as asked last; NAN: its own */
	uint32_t asked;			/* io_outputs.asked of these */
	double period_s;
	uint32_t refresh, silent, confirm, settle;	/* periods */
	struct io_generator says;
	uint32_t waited;		/* periods for its word */
	uint32_t settling;		/* periods, once it has taken what was
					 * asked, until that is there */
	uint32_t up;			/* periods since it was opened */
	bool came;			/* it has told all that it tells */
	uint32_t had;			/* a bit for each value that it had as
					 * it is asked */
	const char *fault_words;	/* config_fault_words() */
	bool ill;			/* the axes: no sparks */
	/* CAN; fd -1: none. */
	int fd;
	struct generator_frame frame[GENERATOR_FRAMES];
	uint32_t nframes;
	bool down;
	double heard[PROCESS_NTOLD];	/* NAN: nothing yet */
	uint64_t count[PROCESS_NTOLD];	/* ... as bits */
	uint32_t age[PROCESS_NTOLD];	/* periods */
	double energy_j;		/* told and not handed on yet */
	struct generator_counts counts;
	/* Lines; NULL: none. */
	struct generator_lines *lines;
	bool (*lines_write)(struct generator *g);
	void (*lines_close)(struct generator_lines *l);
	struct generator_dac *dac;	/* NULL: none */
	/* Modbus; NULL: none. */
	struct generator_modbus *modbus;
	/* Modbus and a PLC say which version they have taken. */
	bool takes;
	uint32_t taken_version;
	bool anew;			/* what it has taken once more */
	void (*modbus_write)(struct generator *g);
	void (*modbus_read)(struct generator *g);
	void (*modbus_end)(struct generator_modbus *m);
	/* A PLC; NULL: none. */
	struct plc *plc;
	uint32_t plc_heard[PLC_NRPDO];	/* of struct plc, as seen last */
	bool plc_empty;			/* it has said that it has nothing of
					 * before */
	/* Written by read and write, taken by note. */
	struct generator_note notes[GENERATOR_NOTES];
	_Atomic uint32_t put, taken;
};

/**
 * generator_attach() - put one in front of @m whose frames go through @fd,
 * which belongs to it from then on; -1: it has none.
 * Return: NULL without memory.  Startup only.
 */
struct generator *generator_attach(struct io_machine *m,
				   const struct machine_config *c, int fd);

/** generator_forget() - free one that was not opened whole, without its lines.
 *  Startup only. */
void generator_forget(struct generator *g);

/** generator_code() - the code of the lines for @value; 0: none is on. */
uint32_t generator_code(const struct config_way *w, double value);

/** generator_count() - the bits for @value; NAN: all of them. */
uint64_t generator_count(const struct config_way *w, int field, double value);

/** generator_value() - the value of these bits. */
double generator_value(const struct config_way *w, int field, uint64_t count);

/** generator_slack() - how far from a value that it has it may tell it: by half
 *  a count, and by what the machine file allows beside it. */
double generator_slack(const struct config_way *told);

/** generator_hears() - it told these bits for field @field. */
void generator_hears(struct generator *g, int field, uint64_t count);

/** generator_trouble() - no sparks, until a reset or until something else is
 *  asked, and the log says why. */
void generator_trouble(struct generator *g, const struct generator_note *n);

/** generator_refused() - it answered field @field with this exception. */
void generator_refused(struct generator *g, int field, int exception);

/** generator_tell() - what the log is to say next. */
void generator_tell(struct generator *g, const struct generator_note *n);

/* -- generator_counts.c ---------------------------------------------------- */

/** generator_counts_init() - as [gap] source wants it; a reading of @stale
 *  periods ago is none. */
void generator_counts_init(struct generator *g, const struct machine_config *c,
			   uint32_t stale);

/** generator_counts_hear() - it told sum @field; @reset: it began at 0. */
void generator_counts_hear(struct generator *g, int field, bool reset);

/** generator_counts_read() - once a period, after what it told: the shares. */
void generator_counts_read(struct generator *g, struct io_inputs *in);

/* -- generator_can.c ------------------------------------------------------- */

/** generator_can_init() - lay out the frames, all off. */
void generator_can_init(struct generator *g, const struct machine_config *c);

/** generator_can_write() - send what has changed or is due. */
void generator_can_write(struct generator *g);

/** generator_can_read() - take what it tells. */
void generator_can_read(struct generator *g);

/* -- generator_lines.c ----------------------------------------------------- */

/** generator_lines_open() - request the lines, all off.  Return: as
 *  io_gpio_open(). */
int generator_lines_open(struct generator *g, const struct machine_config *c,
			 struct interp_diag *diag);

/* -- generator_dac.c ------------------------------------------------------- */

/** generator_dac_open() - its channels in @sysfs, at zero, and the thread that
 *  writes them.  Return: as io_gpio_open(). */
int generator_dac_open(struct generator *g, const char *sysfs,
		       struct interp_diag *diag);

/** generator_dac_close() - all at zero.  Startup only. */
void generator_dac_close(struct generator *g);

/** generator_dac_write() - what is to be there next. */
void generator_dac_write(struct generator *g);

/** generator_dac_read() - what of that is there, or failed. */
void generator_dac_read(struct generator *g);

/** generator_dac_waits() - is what was asked last not there yet, or not for
 *  settle_ms? */
bool generator_dac_waits(const struct generator *g);

/** generator_dac_step() - what a step of its converter is of field @field; 0:
 *  it has none. */
double generator_dac_step(const struct generator *g, int field);

/* -- generator_modbus.c ---------------------------------------------------- */

/** generator_modbus_open() - start the thread that speaks with the slave, which
 *  need not be there yet.  Return: as io_gpio_open(). */
int generator_modbus_open(struct generator *g, const struct machine_config *c,
			  struct interp_diag *diag);

/* -- generator_plc.c ------------------------------------------------------- */

/** generator_plc_write() - what the PLC is to be told next. */
void generator_plc_write(struct generator *g);

/** generator_plc_read() - take what it tells. */
void generator_plc_read(struct generator *g);

#endif /* IO_GENERATOR_OWN_H */
