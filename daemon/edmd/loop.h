/* SPDX-License-Identifier: Apache-2.0 */
/*
 * loop.h - the real-time thread: once a period, take commands, run one cycle,
 * write the outputs
 *
 * The main thread places and fills the loop. From loop_start() to loop_stop()
 * it uses nothing of it but `crossing`.
 */
#ifndef EDMD_LOOP_H
#define EDMD_LOOP_H

#include "clock.h"
#include "crossing.h"
#include "plc_link.h"
#include "rt.h"
#include "shm.h"

#include <pthread.h>
#include <semaphore.h>

/* What the events told last. */
struct loop_told {
	enum cycle_state state;
	enum cycle_outcome outcome;
	uint32_t program, number;	/* the condition called last, and in */
	char letter;			/* which program; 0: none */
	uint32_t hunts;			/* of the totals */
	struct stand_now stand;
	uint64_t stood;			/* cycle in which that began */
};

struct loop_timing {
	int64_t late_ns, late_max_ns;
	int64_t took_ns, took_max_ns;
};

struct loop {
	/* Filled by the main thread. */
	struct cycle cycle;
	struct io_machine io;
	struct plc_link plc;
	struct setup_wanted wanted;
	struct shm_status *status;
	struct shm_commands *commands;
	struct shm_stops *stops;	/* NULL: no way of their own */
	struct program *program;	/* loaded; or NULL */
	double pulse_mm[SHM_NAXES];
	uint64_t axes_key, home_key;	/* key.h */
	uint32_t speed;			/* periods for each one of time */

	struct crossing crossing;

	/* Private. */
	struct setup_clock clock;
	struct setup_report *report;
	struct loop_told told;
	struct loop_timing timing;
	int64_t time_ns;		/* CLOCK_REALTIME of this period */
	struct io_outputs given;	/* to the machine, in the last cycle */
	struct io_plc plc_in;		/* what the PLC asks, this period */
	bool opening;			/* a program was asked for */
	bool ahead;			/* ... that is to be loaded later */
	uint64_t unloading;		/* command that waits for a stop */
	uint64_t asking;		/* command that waits for a drive */
	uint64_t moved_by;		/* command whose motion began last */
	bool ending;			/* no more commands: shutting down */
	pthread_t thread;
	sem_t ready;
};

/**
 * loop_start() - start the thread and wait until it is set up.
 *
 * @report: filled with what the host gave to the thread.
 *
 * Return: 0 or -errno. Startup only.
 */
int loop_start(struct loop *l, struct setup_report *report);

/** loop_stop() - make the outputs safe and end the thread. Startup only. */
void loop_stop(struct loop *l);

/* -- Its parts, all of them RT-safe ------------------------------------- */

/** loop_commands() - carry out a few of the commands in the ring. */
void loop_commands(struct loop *l);

/** loop_replies() - take the programs that the main thread has opened. */
void loop_replies(struct loop *l);

/** loop_drives() - once per real period: publish what is known of the drives,
 *  and answer who asked for an object. */
void loop_drives(struct loop *l);

/**
 * loop_notice() - send events for everything that has changed since the last
 * call.
 */
void loop_notice(struct loop *l);

/** loop_answer() - the event that answers command @id, and its record;
 *  @answer: enum shm_answer. */
void loop_answer(struct loop *l, uint64_t id, int32_t answer);

/** loop_event() - send an event of @kind, with the present time and place. */
void loop_event(struct loop *l, uint32_t kind, uint64_t id, int32_t code);

/** loop_event_set() - field @field is @now and was @was. */
void loop_event_set(struct loop *l, uint32_t field, double was, double now);

/** loop_sets() - record what is set in the job, for the next edmd. */
void loop_sets(struct loop *l);

/** loop_snapshot() - publish the state of the cycle. */
void loop_snapshot(const struct loop *l, struct shm_snapshot *ret);

/** loop_trace() - publish one record of the trace. */
void loop_trace(const struct loop *l, const struct io_inputs *in,
		struct shm_trace *ret);

/** loop_plc_read() - once per real period: read what the PLC asks for. */
void loop_plc_read(struct loop *l);

/** loop_plc_input() - hand this to a cycle. */
void loop_plc_input(struct loop *l, struct io_inputs *in);

/** loop_plc_write() - once per real period: tell the PLC how the machine is. */
void loop_plc_write(struct loop *l);

/**
 * loop_stands() - does the machine stand, and will nothing move it by itself?
 */
bool loop_stands(const struct loop *l);

#endif /* EDMD_LOOP_H */
