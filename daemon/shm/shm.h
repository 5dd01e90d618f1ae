/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shm.h - edmd's shared memory: layout and the three crossings
 *
 * Three objects in /dev/shm/edmd and /dev/shm/edmd-jobs, or in /dev/shm where
 * there are no such folders, named edmd.<machine>.*:
 *
 *	status		edmd writes, anyone of the group reads: one snapshot,
 *			a ring of per-cycle trace records, a ring of events
 *	command		a socket: edmd-jobs sends commands, each is answered by
 *			an event with its id; acts that end motion also come by
 *			a socket of their own (shm_stop_create())
 *	program.<n>	edmd-jobs writes once; edmd copies it before it looks at
 *			it (interp/program.h)
 *
 * Status begins with a struct shm_head.  A reader whose layout
 * version or size differs must not read on.  All numbers are of the machine's
 * byte order; the objects never leave it.
 *
 * A machine's name is 1 to 31 of A-Z a-z 0-9 _ -; every call that takes one
 * returns -EINVAL for any other.
 *
 * A restarted edmd takes its predecessor's status over in place: mappings
 * stay good, both rings go on counting, head.instance is new.  The socket is
 * made anew and must be connected again; it tells which edmd listens.  An
 * edmd that ends in order removes both objects.
 *
 * The jobs that ended last are kept in status as well: a service that could not
 * write that down, and was killed, does not take one of them for a job to be
 * cut.
 *
 * The ids of the last commands that were taken are kept in status too, with
 * what was answered: no edmd of this machine takes one of them again.
 *
 * Everything that two processes touch at once is read and written through C11
 * atomics, the records word by word, so a torn one is noticed, never used.
 *
 * Units: in every name.  Sign: feed + toward the program's end.
 */
#ifndef EDM_SHM_H
#define EDM_SHM_H

#include "cia402.h"
#include "states.h"
#include "verbs.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ck_ring.h>

#define SHM_MAGIC	0x65646d64u	/* "edmd" */
#define SHM_LAYOUT	20
#define SHM_NAXES	8		/* X Y Z A B C U V */
#define SHM_NGENERATOR	7		/* values of a generator */
#define SHM_NTOLD	16		/* what it tells: PROCESS_NTOLD */
#define SHM_NAME_MAX	32
#define SHM_PATH_MAX	96

#define SHM_TRACE_SLOTS		16384	/* powers of two */
#define SHM_EVENT_SLOTS		1024
#define SHM_COMMAND_SLOTS	64
#define SHM_DONE_SLOTS		256	/* commands that are remembered */
#define SHM_ENDED_SLOTS		64	/* jobs that ended; a power of two */
#define SHM_LATENCY_BINS	256	/* of 1 us; the last holds all above */
#define SHM_TOOK_PARTS		128	/* bins of this part of a period ... */
#define SHM_TOOK_BINS		256	/* ... up to two periods; likewise */

struct shm_head {
	uint32_t magic;
	uint32_t layout;
	uint64_t bytes;
	char machine[SHM_NAME_MAX];
	int32_t pid;			/* of the writer */
	uint32_t instance;		/* drawn anew at every start of edmd */
};

/* The same numbers as enum cycle_state. */
#define SHM_STATE_NUMBER(id, name, power, running) SHM_##id,
enum shm_state {
	SHM_NO_STATE,
	STATE_ROWS(SHM_STATE_NUMBER)
};
#undef SHM_STATE_NUMBER

/* The same numbers as enum moved_how. */
enum shm_moved {
	SHM_MOVED_NOT,
	SHM_MOVED_GOES_ON,
	SHM_MOVED_THERE,
	SHM_MOVED_SHORT,
	SHM_MOVED_FAULT
};

struct shm_snapshot {
	uint64_t cycle;			/* since edmd started */
	int64_t time_ns;		/* CLOCK_REALTIME of this cycle */
	uint32_t state;			/* enum shm_state */
	uint32_t fault;			/* the first; enum cycle_fault; 0
					 * none */
	uint32_t outcome;		/* enum cycle_outcome of the last job */
	uint32_t program;		/* program.<n>, until unloaded; or 0 */
	uint32_t seg, tick;		/* place, exactly */
	uint64_t moved_by;		/* id of the command whose motion began
					 * last; 0: none */
	uint32_t moved, pad4;		/* how it ended; enum shm_moved */
	uint64_t faults;		/* all that are latched: bit n, fault
					 * n */
	uint32_t line;			/* of the source */
	uint32_t cond_number;
	char cond_letter;
	bool power, pump, negative;
	bool loaded;			/* the job has not ended: held counts */
	uint8_t unhomed;		/* bit per axis that has a home_method
					 * and was not homed, or is unplaced */
	uint8_t limit;			/* ... that is on its limit switch */
	uint8_t unplaced;		/* ... whose drive lost its place */
	int32_t pos[SHM_NAXES];		/* pulses */
	double pulse_mm[SHM_NAXES];
	double place_mm, far_mm, length_mm;	/* along the path */
	double feed_mm_s, gap_v;
	double depth_mm, depth_far_mm;	/* of the cut, below its first spark:
					 * now, and the deepest */
	/* Sums of the job. */
	uint64_t job_cycles, erode_cycles, jump_cycles;
	uint64_t cut_cycles, moved_cycles, other_cycles;	/* cycle.h */
	uint32_t retracts, jumps, shorts, overruns;
	uint32_t hunts, in_row;		/* how many times many retracts came in
					 * a row without progress; how many
					 * there are in the present row */
	uint32_t arcs;			/* times that the share of arcs was
					 * above arcing_share */
	uint32_t stand;			/* why the job stands or waits now; enum
					 * stand_reason */
	double retract_mm_max;
	double energy_j;		/* of the discharges; NAN: the machine
					 * does not count it */
	/* The cycle's own time, ns. */
	int64_t period_ns;
	int64_t wake_late_ns, wake_late_max_ns;
	int64_t took_ns, took_max_ns;
	/* Of probing, in pulses: the shift, which is pos minus the place in the
	 * program; where the last two contacts along each axis were; the axes
	 * that have one contact, and those that have two.  And in mm: the place
	 * on the path where the way back ends. */
	int32_t shift[SHM_NAXES], found[2][SHM_NAXES];
	uint32_t found_once, found_twice;
	double back_mm;
	/* For the next edmd, after a crash: the pulses that the drives were
	 * sent to; the part of them that homing added; the drives' own counts
	 * at pulse 0, if they are known; the direction in which each axis moved
	 * last. */
	int32_t drive[SHM_NAXES], home_shift[SHM_NAXES], origin[SHM_NAXES];
	int32_t off[SHM_NAXES];		/* they stand beside that, pulses */
	double sure_mm;			/* the place where they last did not */
	double moved_mm[SHM_NAXES];	/* and where each moved last */
	int32_t seen[SHM_NAXES];	/* ... to there, pulses */
	int8_t moved_way[SHM_NAXES];	/* ... in this direction; 0: none */
	int8_t toward[SHM_NAXES];
	int8_t limit_side[SHM_NAXES];	/* of the switches in `limit` */
	double axes_c;			/* as a PLC told it; 0: not told */
	/* Of the machine file: what drives the axes, and how they are homed. */
	uint64_t axes_key, home_key;
	uint64_t program_key;		/* of all bytes of the program; or 0 */
	double override;		/* of positioning; 1: as programmed */
	double plc_override;		/* a PLC said last; NAN: nothing yet */
	uint32_t mcode_at;		/* segment of `mcode` */
	uint8_t mcode;			/* M code that was sent to the PLC and
					 * is not answered; 0: none */
	uint8_t homed;			/* bit per axis */
	uint8_t moved_beside;		/* bit per axis: `moved_mm` is beside
					 * the path */
	uint8_t adrift;			/* ... it was blocked, or lagged */
	bool has_origin;
	bool confirmed;			/* what the stand asks for is done */
	bool depth_counts, depth_met;	/* for the next edmd: struct depth */
	int32_t depth_from[3];
	double depth_way[3], depth_known_mm;
	uint32_t stand_of;		/* the electrode's number; a bit of each
					 * field to set */
	uint32_t kept_stand, kept_of;	/* the same of the job, also while a
					 * fault is latched */
	uint32_t stand_n, pad5;		/* its number: a start may be for this
					 * one alone */
	uint64_t stand_cycles;		/* how long */
	/* By enum interp_tech_id: what the generator is asked for, NAN: its own
	 * setting; what it tells by enum process_id, NAN: nothing; a bit of
	 * each that it tells. */
	double asked[SHM_NGENERATOR], told[SHM_NTOLD];
	uint32_t tells;
	bool has_asked;			/* it has all of it, as far as it tells;
					 * else for its settle_ms */
};

/* What SHM_DO_SET has set in a job; written when it changes. */
#define SHM_SETS_MAX	64

struct shm_set {
	double value;
	uint32_t cond;			/* index of the program's condition */
	uint32_t field;			/* enum interp_tech_id */
};

struct shm_sets {
	uint64_t program_key;		/* as in the snapshot */
	uint64_t n;
	struct shm_set set[SHM_SETS_MAX];
};

struct shm_trace {
	uint64_t cycle;
	double place_mm, feed_mm_s, gap_v;
	uint32_t line;
	uint32_t state;			/* enum shm_state */
	int32_t pos[SHM_NAXES];		/* as commanded, pulses */
	int32_t sent[SHM_NAXES];	/* pos and what [contour] adds to it */
	int32_t actual[SHM_NAXES];	/* measured before that, pulses, less
					 * what homing and compensation add */
};

enum shm_event_kind {
	SHM_EV_ANSWER = 1,		/* id: the command's; code:
					 * cycle_answer */
	SHM_EV_STATE,			/* code: the new enum shm_state */
	SHM_EV_FAULT,			/* code: cycle_fault */
	SHM_EV_LOADED,			/* code: program n */
	SHM_EV_ENDED,			/* code: cycle_outcome */
	SHM_EV_CONDITION,		/* called; id: its letter; code:
					 * number */
	SHM_EV_SET,			/* id: the field, enum interp_tech_id */
	SHM_EV_SELECT,			/* by the PLC; code: job n */
	SHM_EV_HUNTING,			/* code: retracts in a row */
	SHM_EV_STAND,			/* the job stands or waits; code: enum
					 * stand_reason, NONE: no longer; id:
					 * what it is about, and above 32 bits
					 * its number */
};

struct shm_event {
	uint64_t cycle;
	int64_t time_ns;
	uint64_t id;
	uint32_t kind;
	int32_t code;
	uint32_t program, line;		/* line: of the source, at place_mm */
	double place_mm;
	double was, now;		/* set: values, NAN the generator's
					 * own */
};

/*
 * A ring that one writer fills and any number of readers follow at their own
 * pace: common/stamped.h.  A reader that fell behind skips records, and is told
 * how many.
 */
struct shm_trace_slot {
	uint64_t stamp;
	struct shm_trace record;
};

struct shm_event_slot {
	uint64_t stamp;
	struct shm_event record;
};

struct shm_sets_slot {
	uint64_t stamp;
	struct shm_sets record;
};

/* A command that was taken; its code follows when it is answered. */
struct shm_done {
	uint64_t id;
	int32_t code;			/* enum shm_answer; SHM_TAKEN */
	uint32_t instance;		/* of the edmd that took it */
};

/* A job that ended, or ended for now in a fault. */
struct shm_ended {
	uint32_t program;		/* n */
	uint32_t outcome;		/* enum shm_outcome */
	uint8_t hash[32];		/* SHA-256 of its text */
	int64_t time_ns, period_ns;
	double place_mm, far_mm, length_mm, depth_mm;
	uint64_t job_cycles;		/* 0: it had not begun */
	uint32_t jumps, retracts, shorts, arcs;
	uint64_t erode_cycles;
	double energy_j;		/* as in the snapshot */
};

struct shm_ended_slot {
	uint64_t stamp;
	struct shm_ended record;
};

struct shm_done_slot {
	uint64_t stamp;
	struct shm_done record;
};

/*
 * Snapshot n goes to snap[n & 1] and snap_next becomes n + 1 when it is whole,
 * so that a writer killed in the middle of one leaves the other.
 */
struct shm_snap {
	uint64_t stamp;
	struct shm_snapshot record;
};

struct shm_drives {
	uint64_t stamp;
	struct cia402_told record;
};

struct shm_status {
	struct shm_head head;
	uint64_t born;			/* drawn when the object was made */
	uint32_t latency_us[SHM_LATENCY_BINS];	/* histogram of wake_late */
	uint32_t took[SHM_TOOK_BINS];	/* and of what each period took */
	struct shm_snap snap[2];
	uint64_t snap_next;		/* snapshots written so far */
	uint64_t trace_next;		/* records written so far */
	uint64_t event_next;
	uint64_t sets_next;
	uint64_t done_next;
	uint64_t ended_next;
	uint64_t drives_next;
	struct shm_sets_slot sets[2];
	struct shm_drives drives[2];
	struct shm_done_slot done[SHM_DONE_SLOTS];
	struct shm_ended_slot ended[SHM_ENDED_SLOTS];
	struct shm_trace_slot trace[SHM_TRACE_SLOTS];
	struct shm_event_slot event[SHM_EVENT_SLOTS];
};

/* Below 100: the verbs of words/verbs.h, SHM_DO_START and so on. */
#define SHM_VERB(verb)	SHM_DO_##verb,
enum shm_verb {
	VERB_ROWS(SHM_VERB)
	SHM_LOAD = 100,			/* arg: program n; when idle */
	SHM_UNLOAD,			/* forget program n and unmap it; a
					 * held one is stopped first */
	SHM_AHEAD,			/* copy program n: it is to be loaded
					 * later; when none is */
	SHM_OBJECT_GET,			/* arg: SHM_OBJECT() of a drive; what
					 * comes of it is in shm_drives() */
	SHM_OBJECT_SET,			/* ... to arg_mm; when idle */
};

#define SHM_OBJECT(axis, index, sub) \
	((uint32_t)(axis) << 24 | (uint32_t)(index) << 8 | (uint32_t)(sub))

/* Mirrors enum cycle_answer: the code of an SHM_EV_ANSWER. */
enum shm_answer {
	SHM_DONE, SHM_NO_PROGRAM, SHM_WRONG_STATE, SHM_BAD_ARGUMENT,
	SHM_NOT_HOMED, SHM_AT_LIMIT, SHM_BEYOND, SHM_NO_NODE, SHM_NOT_PASSED,
	SHM_ELSEWHERE, SHM_NOT_UP, SHM_PLC_HOLDS, SHM_STILL_THERE,
	SHM_NO_POWER,
	SHM_ASKS,
	SHM_NOT_ASKED,
	SHM_OVER,
	/* Not of the cycle: */
	SHM_LATE = 50,			/* came after its until_ns: not done */
	SHM_CUT_SHORT,			/* edmd ended while it did it; the place
					 * of the machine tells whether it is
					 * done */
	SHM_TAKEN = -1,			/* in struct shm_done: no answer yet */
	SHM_SEEN = 100,			/* and enum cycle_fault: a guard sees
					 * it */
};

/* Mirrors enum cycle_outcome. */
enum shm_outcome {
	SHM_OUTCOME_NONE, SHM_OUTCOME_DONE, SHM_OUTCOME_FAULT,
	SHM_OUTCOME_STOPPED
};

struct shm_command {
	uint64_t id;			/* never 0, nor one that was used */
	uint32_t verb;
	uint32_t arg;
	double arg_mm;
	int64_t until_ns;		/* CLOCK_MONOTONIC; then it is too
					 * late */
	uint32_t instance;		/* of the edmd it is meant for */
	uint32_t pad;
};

struct shm_commands;			/* edmd's end */
struct shm_stops;			/* of stop.c */

/* -- Writer: edmd ------------------------------------------------------- */

/**
 * shm_status_create() - make edmd.<machine>.status, or take it over.
 *
 * A lock on the object lasts as long as the process, and so tells a living
 * owner from a killed one. For this reason its descriptor stays open; no one
 * else uses it.
 *
 * @ret_before: the last snapshot of the edmd before, or cycle 0.
 *
 * Return: 0 or a negative errno; -EBUSY if a living edmd owns it, -EPERM if the
 * object is another user's.
 *
 * Startup only.
 */
int shm_status_create(struct shm_status **ret, const char *machine,
		      struct shm_snapshot *ret_before);

/** shm_status_destroy() - remove and unmap it; @s may be NULL. */
void shm_status_destroy(struct shm_status *s, const char *machine);

/** shm_publish() - publish a whole snapshot and its trace record. RT-safe. */
void shm_publish(struct shm_status *s, const struct shm_snapshot *snap);

/** shm_snapshot_put(), shm_trace_put() - publish only one of the two, because
 *  there is a trace record for every cycle, and a snapshot for every period of
 *  real time. */
void shm_snapshot_put(struct shm_status *s, const struct shm_snapshot *snap);
void shm_trace_put(struct shm_status *s, const struct shm_trace *t);

/** shm_event() - append an event to the ring. RT-safe; one writer. */
void shm_event(struct shm_status *s, const struct shm_event *e);

/** shm_sets_put() - all that is set now. RT-safe; one writer. */
void shm_sets_put(struct shm_status *s, const struct shm_sets *sets);

/** shm_drives_put() - what is known of the drives now. RT-safe; one writer. */
void shm_drives_put(struct shm_status *s, const struct cia402_told *told);

/** shm_drives() - what was put last; false: nothing. Any thread. */
bool shm_drives(const struct shm_status *s, struct cia402_told *ret);

/** shm_sets() - what was put last; false: nothing yet. Any thread. */
bool shm_sets(const struct shm_status *s, struct shm_sets *ret);

/**
 * shm_command_create() - listen at edmd.<machine>.command.
 *
 * Root, this user, and the user edm-jobs may connect. It starts a thread that
 * takes commands from the socket. Startup only.
 */
int shm_command_create(struct shm_commands **ret, const char *machine,
		       uint32_t instance);

/**
 * shm_command_destroy() - end the thread and remove the socket; @c may be NULL.
 */
void shm_command_destroy(struct shm_commands *c);

/**
 * shm_command_take() - the next command, if there is one; its fields are not
 * checked. RT-safe.
 */
bool shm_command_take(struct shm_commands *c, struct shm_command *ret);

/**
 * shm_stop_create() - listen at the place "stop" for acts that end motion:
 * words/stop_act.h.
 *
 * The group may connect.  It starts a thread that takes acts from the socket,
 * and answers them when @status has the answer.  The thread has SCHED_FIFO 1 if
 * the host allows it.  Startup only.
 */
int shm_stop_create(struct shm_stops **ret, const char *machine,
		    const struct shm_status *status);

/** shm_stop_destroy() - end the thread, remove the socket; @s may be NULL. */
void shm_stop_destroy(struct shm_stops *s);

/**
 * shm_stop_take() - the next act, as a command that is checked and never late.
 * @s: NULL: there is none.  RT-safe.
 */
bool shm_stop_take(struct shm_stops *s, struct shm_command *ret);

/** shm_stop_waits() - how many acts wait to be taken.  Any thread. */
unsigned int shm_stop_waits(const struct shm_stops *s);

/**
 * shm_done_begin() - record that command @id is taken, before it has any
 * effect.
 *
 * RT-safe; one writer.
 */
void shm_done_begin(struct shm_status *s, uint64_t id);

/**
 * shm_done_end() - command @id was answered with @code. RT-safe; one writer.
 */
void shm_done_end(struct shm_status *s, uint64_t id, int32_t code);

/** shm_ended_put() - a job has ended.  RT-safe; one writer. */
void shm_ended_put(struct shm_status *s, const struct shm_ended *e);

/* -- Readers, and edmd-jobs --------------------------------------------- */

/**
 * shm_status_open() - map read-only.
 * Return: 0; -ENOENT no edmd yet; -EPROTO another layout; -EPERM made by a
 * user who is neither root, edmd nor this one; else -errno.
 */
int shm_status_open(const struct shm_status **ret, const char *machine);

/**
 * shm_snapshot() - the last whole snapshot.  A bounded number of tries.
 * Return: false if there is none yet, or if the writer overtook every try; one
 * that writes once in 50 us or more cannot.  Any thread.
 */
bool shm_snapshot(const struct shm_status *s, struct shm_snapshot *ret);

/**
 * shm_alive() - is the process that writes @s still there?
 *
 * False also if another edmd has made the object again: then open it again. It
 * takes a few system calls; not for a tight loop. Any thread.
 */
bool shm_alive(const struct shm_status *s);

/**
 * Follows a ring; start with next = 0 (all there is) or *_next (only new).
 * A new mapping wants a new one.
 */
struct shm_follow {
	uint64_t next;
	uint64_t lost;			/* records this reader missed, in all */
};

/** shm_trace_next() - the next record; false if there is none yet. */
bool shm_trace_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_trace *ret);

/** shm_event_next() - the same for events. */
bool shm_event_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_event *ret);

/** shm_path() - the file of the object @what of @machine, to tell of it. */
void shm_path(char path[SHM_PATH_MAX], const char *machine, const char *what);

/**
 * shm_writer_claim() - become the only process that commands the machine and
 * loads it.
 *
 * Return: a descriptor that holds the claim until shm_writer_leave() or the end
 * of the process; -EBUSY if another living process has it; -EPERM if another
 * user made it; else -errno.
 *
 * Startup only.
 */
int shm_writer_claim(const char *machine);

/** shm_writer_leave() - give the claim up; @fd may be -1. */
void shm_writer_leave(int fd, const char *machine);

/**
 * shm_command_open() - connect to command the machine, after
 * shm_writer_claim().
 *
 * @ret: a descriptor; close it with close().
 *
 * @ret_instance: the number of the edmd at the other end.
 *
 * Return: 0; -ENOENT: no edmd listens; -EAGAIN: it does not answer; -EACCES: it
 * does not accept this user; -EPROTO: another layout; else -errno.
 */
int shm_command_open(int *ret, const char *machine, uint32_t *ret_instance);

/** shm_command_put() - Return: 0; -EAGAIN: no room; -ENOTCONN: edmd is gone. */
int shm_command_put(int fd, const struct shm_command *c);

/**
 * shm_done() - what became of command @id.
 *
 * Return: false if it was not taken, or so long ago that it is forgotten.
 * RT-safe: a bounded search.  Any thread.
 */
bool shm_done(const struct shm_status *s, uint64_t id, struct shm_done *ret);

/** shm_ended_next() - the jobs that ended, as shm_event_next(). */
bool shm_ended_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_ended *ret);

#define SHM_PROGRAM_MAX	(INT64_C(4) << 30)	/* bytes of one program */

/**
 * shm_program_create() - make edmd.<machine>.program.<n>, @bytes to fill.
 *
 * It is filled with zeros. An object with the same n is replaced; a process
 * that has mapped the old one keeps it. The caller unmaps it by
 * shm_program_unmap() when it is written.
 *
 * Return: 0; -EINVAL for n 0 or no bytes; -EFBIG; -ENOSPC; else -errno.
 */
int shm_program_create(void **ret, const char *machine, uint32_t n,
		       size_t bytes);

/**
 * shm_program_begin() - make one that has no name yet, @bytes to fill.
 *
 * If nobody names it, it is gone when @ret_fd is closed and it is unmapped, or
 * with the process.  Return: as shm_program_create().  Any thread.
 */
int shm_program_begin(int *ret_fd, void **ret, const char *machine,
		      size_t bytes);

/**
 * shm_program_resize() - let it have @bytes instead of @was; what is new is
 * zeros.
 *
 * @at: where it is mapped; ret: it may be elsewhere
 *
 * Return: as shm_program_create(); then it is as it was.  Any thread.
 */
int shm_program_resize(int fd, void **at, size_t was, size_t bytes);

/** shm_program_name() - it is edmd.<machine>.program.<n> now, as it is. */
int shm_program_name(int fd, const char *machine, uint32_t n);

/**
 * shm_program_open() - a private copy of it, which nobody else can change.
 *
 * Return: 0; -ENOENT; -EPROTO if it was cut short meanwhile, or has holes;
 * -EFBIG; else -errno.
 */
int shm_program_open(const void **ret, size_t *ret_bytes, const char *machine,
		     uint32_t n);

/**
 * shm_program_read() - the same to look at.  One that this user made is not
 * copied: nobody else can change it.
 */
int shm_program_read(const void **ret, size_t *ret_bytes, const char *machine,
		     uint32_t n);

/** shm_program_map() - one of this process, by its descriptor. */
int shm_program_map(const void **ret, size_t *ret_bytes, int fd);
void shm_program_unmap(const void *block, size_t bytes);

/** SHM_PROGRAM_AHEAD - a name until it is known which n it will have. */
#define SHM_PROGRAM_AHEAD	UINT32_MAX

/* A file, whatever its names are.  No two that are there have one inode, and no
 * two after each other the same time too.  inode 0: none. */
struct shm_stamp {
	uint64_t inode;
	int64_t s, ns;			/* when it was made */
};

/** shm_program_stamp() - of the file that has the name n now. */
struct shm_stamp shm_program_stamp(const char *machine, uint32_t n);
/** shm_is_stamp() - has the name n now the file of @stamp? */
bool shm_is_stamp(const struct shm_stamp *stamp, const char *machine,
		  uint32_t n);
void shm_program_remove(const char *machine, uint32_t n);

/** shm_close() - unmap any of the above; @map may be NULL. */
void shm_close(const void *object, size_t bytes);

/** shm_state_name() - "erode", ...; "?" if unknown. Any thread. */
const char *shm_state_name(uint32_t state);
/** shm_outcome_name() - "done", ...; "none" while it runs. */
const char *shm_outcome_name(uint32_t outcome);

#endif /* EDM_SHM_H */
