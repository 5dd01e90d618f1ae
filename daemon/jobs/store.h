/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store.h - jobs, events and a few numbers, kept through a power cut
 *
 * One SQLite database, <dir>/<machine>.db, in WAL with synchronous=FULL: what
 * a call has returned 0 for is on the disk.  A lock file beside it keeps a
 * second service of the same machine out.
 *
 * When the disk is full, read-only or fails, the store is degraded: it goes on
 * in memory, calls that write return STORE_KEPT, and store_tick() writes what
 * was kept when there is room.  Calls that take a promise (a new job, a key, a
 * job that is about to begin) are refused with the reason instead.  A damaged
 * file is set aside and recovered as far as that goes.
 *
 * Every job has a number n, never used twice, which is also the n of its
 * program.<n> in shared memory.
 *
 * Units: in every name; times are microseconds since 1970.
 * Threads: one.  Calls return 0, STORE_KEPT or -errno unless they say more, and
 * log what SQLite said.  What is only told of a job, or of the machine, may be
 * STORE_MISSED, too.
 */
#ifndef JOBS_STORE_H
#define JOBS_STORE_H

#include "interp/setting.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define STORE_KEPT	1		/* in memory, not on the disk */
#define STORE_MISSED	2		/* nowhere: too much is in memory */
#define STORE_BUSY_MS	500

enum job_state {
	JOB_QUEUED, JOB_READY, JOB_RUNNING, JOB_HELD,
	JOB_DONE, JOB_FAULT, JOB_STOPPED,
	JOB_INTERRUPTED,		/* by a power cut: it waits to be
					 * resumed */
	JOB_NSTATES
};

struct store;

struct store_job {
	uint32_t n;
	char id[64], name[64];
	char sha256[65];		/* hex */
	char tech_sha256[65];		/* of its technology table; "" */
	enum job_state state;
	bool hold;			/* waits for "start" */
	bool loaded;			/* program.<n> exists, or may exist */
	int64_t submitted_us;
	int64_t begun_us;		/* 0: not yet */
	uint32_t lines;			/* of the text */
	uint32_t electrode;		/* it begins with; 0: the one in the
					 * holder */
	char setting[INTERP_SETTING_MAX];	/* interp/setting.h */
	uint32_t measures;		/* its text says what: touch.h; 0: it is
					 * a job to cut */
};

struct store_new {
	const char *id, *name, *sha256;
	const char *tech_sha256;	/* of the technology table; "": none */
	const char *text;
	size_t bytes;
	uint32_t lines;
	bool hold;
	const char *begin_at;		/* for store_resume_at(); NULL: there is
					 * none */
	const char *told;		/* the text of its event "queued"; NULL:
					 * there is none */
	int64_t now_us;
	uint32_t electrode, measures;	/* as in struct store_job */
	const char *setting;		/* NULL: "" */
};

/* How a job ended. */
struct store_end {
	enum job_state state;
	const char *reason;		/* in words; "" if done */
	int64_t now_us;
	double place_mm, length_mm, depth_mm, job_s, erode_s;
	double energy_j;		/* NAN: the machine does not count it */
	uint32_t jumps, retracts, shorts, arcs;
};

struct store_note {
	const char *kind, *job, *outcome, *text;
	double place_mm;
	int64_t now_us;
};

/* A value that was set while a job ran. */
struct store_change {
	const char *field;		/* its name */
	double was, now;		/* NAN: the generator's own */
	double place_mm;
	int64_t time_ns;
};

enum store_list { STORE_QUEUE, STORE_SHOW, STORE_HISTORY, STORE_ALARMS,
		  STORE_TRAIL, STORE_EVENTS, STORE_DAYS, STORE_MONTHS };

/** store_state_name() - "queued", ... */
const char *store_state_name(enum job_state s);

/* Of the number "elsewhere": a store was mended, and nobody has said yet that
 * its loss is known.  The other bits are axes. */
#define STORE_UNSEEN	(UINT32_C(1) << 31)

/**
 * store_open() - open or make the database.
 *
 * A disk that is full, read-only or fails is no error here: see store_why().
 * Return: 0; -EALREADY if another service has it; -ELOOP if one of its files is
 * a link or no regular file, which is then logged; -EPROTO if a newer version
 * made it; -errno if @dir cannot be used.
 */
int store_open(struct store **ret, const char *dir, const char *machine);
/** store_close() - NULL is allowed. */
void store_close(struct store *s);

/** store_why() - why the store is degraded; "": it is not. */
const char *store_why(const struct store *s);

/** store_missed() - how many calls were STORE_MISSED since the store became
 *  degraded last. */
uint64_t store_missed(const struct store *s);

/** store_mended() - what was done to a damaged file; "": nothing. */
const char *store_mended(const struct store *s);

/**
 * store_tick() - try to store what was kept, a piece at a time; to be called
 * every 20 ms.  Return: true when nothing is kept any more.
 */
bool store_tick(struct store *s, int64_t now_us);

/** store_retain() - forget ended jobs above @jobs and older than @days (0: any
 *  number), a few at a time, but never the last 20. */
void store_retain(struct store *s, int64_t jobs, int64_t days, int64_t now_us);

/* What the store takes on the disk, and its state. */
struct store_size {
	char path[512];
	int64_t bytes;			/* of the files */
	uint32_t jobs;
	uint32_t kept;			/* entries in memory */
	uint64_t dropped;
};

void store_measure(struct store *s, struct store_size *ret);

/** store_add() - a new job, queued, with its event, or not at all.  @ret_n its
 *  number. */
int store_add(struct store *s, const struct store_new *j, uint32_t *ret_n);

/* Find a job: 0, -ENOENT, or -EIO: it cannot be known. */
int store_find(struct store *s, const char *id, struct store_job *ret);
int store_find_number(struct store *s, uint32_t n, struct store_job *ret);
int store_loaded(struct store *s, struct store_job *ret);
/** ... the job to be loaded next: number "selected", if it waits, else the
 *  oldest. */
int store_head(struct store *s, struct store_job *ret);

/** store_text() - the text of job @n; to be freed.  -EILSEQ: it is not the one
 *  that was sent. */
int store_text(struct store *s, uint32_t n, char **ret, size_t *ret_bytes);

int store_set_state(struct store *s, uint32_t n, enum job_state state);
int store_set_hold(struct store *s, uint32_t n, bool hold);
/** store_set_loaded() - @loaded true is on the disk, or refused. */
int store_set_loaded(struct store *s, uint32_t n, bool loaded);
int store_begin(struct store *s, uint32_t n, int64_t now_us);

/**
 * store_may_begin() - job @n is about to be started: this is on the disk, or
 * refused.
 *
 * If it is not on the disk, the job has not begun, whatever happens afterwards.
 * 0: no job was started after all.
 */
int store_may_begin(struct store *s, uint32_t n);
int store_end(struct store *s, uint32_t n, const struct store_end *e);
/** store_give_up() - a job that was interrupted is not resumed; what was cut of
 *  it stays in the history. */
int store_give_up(struct store *s, uint32_t n, const char *reason,
		  int64_t now_us);
int store_set_tech(struct store *s, uint32_t n, const char *sha256);
#define STORE_PUT_OFF	(-2.0)

/** store_set_forecast() - it will take @s; -1: that cannot be told, and @why;
 *  STORE_PUT_OFF: not yet. */
int store_set_forecast(struct store *s, uint32_t n, double forecast_s,
		       const char *why);
/** store_unforecast() - the first that waits and has no forecast; @later: that
 *  was put off. */
int store_unforecast(struct store *s, bool later, struct store_job *ret);
/** store_interrupt() - @at: its checkpoint, hex, for store_resume_at(). */
int store_interrupt(struct store *s, uint32_t n, const char *at);
/**
 * store_again() - the interrupted job @n is in the queue again, and has not
 * begun.
 */
int store_again(struct store *s, uint32_t n);
/** store_interrupted() - the job that was interrupted last.  0 or -ENOENT. */
int store_interrupted(struct store *s, struct store_job *ret);
/** store_resume_at() - the checkpoint of job @n; to be freed.  NULL: none. */
char *store_resume_at(struct store *s, uint32_t n);
/** store_change() - add a change to job @n; the same change is kept once. */
int store_change(struct store *s, uint32_t n, const struct store_change *c);
int store_note(struct store *s, const struct store_note *e);

/**
 * store_together() - whatever is written up to store_commit() is written at
 * once.  @durable: it survives a power cut, and not only a kill.  Both
 * return 0, or STORE_KEPT: what was written without a promise is in
 * memory; what must be on the disk is not written.
 */
int store_together(struct store *s, bool durable);
int store_commit(struct store *s);

/** store_waiting() - jobs that are queued and not loaded. */
uint32_t store_waiting(struct store *s);
/** store_waiting_s() - what these will take; @ret_untold: not counting so many
 *  of them, of which that is not known. */
double store_waiting_s(struct store *s, uint32_t *ret_untold);

/**
 * store_number() - a number that is kept by name; @otherwise if there is none.
 */
int64_t store_number(struct store *s, const char *key, int64_t otherwise);
int store_set_number(struct store *s, const char *key, int64_t value);

#define STORE_JSON_MAX	60000	/* bytes: an answer fits one LCM packet */

/**
 * store_json() - a list as JSON, to be freed.
 *
 * STORE_SHOW: the object of job @id. STORE_TRAIL: where it was (tally_json.c).
 * STORE_QUEUE and STORE_HISTORY: an array of
 * the jobs behind job @id in that order, or the first ones if it is ""; at most
 * @rows (0: 200), and no more than fit one answer. So a client asks again with
 * the last job it got, until the array is empty. STORE_ALARMS and
 * STORE_EVENTS: the last ones, each with its number n.
 * Return: NULL if there is no such job, no memory, or the store failed.
 */
char *store_json(struct store *s, enum store_list what, const char *id,
		 int rows);

/* A list that is asked for: behind job `job`, or from its beginning if that is
 * "".  With `words` only jobs in whose name, outcome, day and electrodes (T3)
 * all of them are; STORE_DAYS and STORE_MONTHS sum those up. */
struct store_asked {
	enum store_list what;
	const char *job, *words;
	int rows;
};

/** store_look() - as store_json(), for lists of jobs. */
char *store_look(struct store *s, const struct store_asked *a);

#endif /* JOBS_STORE_H */
