/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ctl.h - what the verbs of edmctl share
 *
 * A verb is a row of the table in main.c and a function here. Each function
 * returns the exit code of the program.
 */
#ifndef CTL_CTL_H
#define CTL_CTL_H

#include "mean.h"
#include "talk.h"

#include "interp/setting.h"

#include <jansson.h>

#define CTL_WORDS_MAX	14		/* a verb and what follows it */

struct ctl {
	/* Options. */
	const char *machine, *url, *key;
	bool json;
	double timeout_s;
	const char *name, *id;
	bool hold, wait, once, in_line;
	int from_line;			/* 0: not given */
	double from_mm;			/* 0: not given */
	double electrode;		/* submit: its number; 0: not given */
	const char *set[INTERP_NSETS];	/* submit; NULL: not given */
	unsigned int every;		/* record: cycles; 0: not given */
	const char *plot;
	const char *pulses;		/* doctor: CHIP:LINE */
	const char *fix, *root;		/* doctor: a machine file; a folder */
	bool csv;			/* history */
	const char *picture;		/* history: an SVG file */
	bool until_end;
	/* The verb, and what follows it. */
	const char *verb;
	const char *arg;		/* NULL if there is none */
	const char *value;		/* the second one; NULL too */
	const char *third;
	char *more[CTL_WORDS_MAX];	/* the third and those after it, then
					 * NULL */
	struct talk *talk;		/* NULL: it could not be opened, ... */
	int talk_err;			/* ... and this is the reason, from
					 * talk_open() */
	char said[TALK_SAID_MAX];
};

/**
 * ctl_ways_print() - edmd-jobs is silent: how the machine can still be stopped.
 * Nothing is said of a machine that is not on this host.
 */
void ctl_ways_print(const struct ctl *c);

int ctl_submit(struct ctl *c);
int ctl_keys(struct ctl *c);
int ctl_electrode(struct ctl *c);
int ctl_mdi(struct ctl *c);
int ctl_new_machine(struct ctl *c);
int ctl_offset(struct ctl *c);
int ctl_tech(struct ctl *c);
int ctl_generator(struct ctl *c);
int ctl_drive(struct ctl *c);

/** ctl_scope() - how far @axis is behind its targets, for @seconds, or until
 *  Ctrl-C if that is NULL. */
int ctl_scope(struct ctl *c, const char *axis, const char *seconds);

/** ctl_drives_ill() - a line for each drive in which something is wrong. */
void ctl_drives_ill(struct ctl *c);
int ctl_command(struct ctl *c);
int ctl_start(struct ctl *c);
int ctl_resume(struct ctl *c);
int ctl_retract(struct ctl *c);
int ctl_remove(struct ctl *c);
int ctl_move(struct ctl *c);
int ctl_set(struct ctl *c);
int ctl_step(struct ctl *c);
int ctl_done(struct ctl *c);
int ctl_override(struct ctl *c);
int ctl_jog(struct ctl *c);
int ctl_jog_on(struct ctl *c);

/* An axis that is to move: @mm_s tells how fast, time and again, and NAN that
 * it is to stop.  Another direction is another press. */
struct ctl_press {
	const char *axis;
	double (*mm_s)(void *arg);
	void *arg;
};

/** ctl_press() - Return: 0; else a code, and @said has why it does not move. */
int ctl_press(struct ctl *c, const struct ctl_press *asked, char *said,
	      size_t size);
int ctl_commission(struct ctl *c);
int ctl_home(struct ctl *c);
int ctl_place(struct ctl *c);
int ctl_alarms(struct ctl *c);
int ctl_faults(struct ctl *c);
int ctl_doctor(struct ctl *c);

/**
 * ctl_pulses() - send pulses to @line, CHIP:NUMBER, and print how fast it can
 * go.
 */
int ctl_pulses(const char *line);
int ctl_queue(struct ctl *c);
int ctl_clear(struct ctl *c);
int ctl_totals(struct ctl *c);
int ctl_show(struct ctl *c);
int ctl_history(struct ctl *c);

/** ctl_ended() - the list of the jobs that have ended. */
int ctl_ended(struct ctl *c);

int ctl_identify(struct ctl *c);
int ctl_status(struct ctl *c);
int ctl_watch(struct ctl *c);
int ctl_record(struct ctl *c);
int ctl_latency(struct ctl *c);
int ctl_support(struct ctl *c);

struct shm_status;

/**
 * ctl_shm_open() - open edmd's status in the shared memory of this host.  If
 * that fails, print why.  Return: an exit code; 0: @ret is open.
 */
int ctl_shm_open(const struct ctl *c, const struct shm_status **ret);

/**
 * ctl_number() - read a number with nothing behind it; otherwise print what is
 * wrong.  Return: 0 or EX_USAGE.
 */
int ctl_number(const struct ctl *c, const char *text, const char *wanted,
	       double *ret);

/**
 * ctl_ask() - ask, and print only errors.  Return: an exit code; 0: @ret is
 * filled, and the caller frees it.
 */
int ctl_ask(struct ctl *c, const struct talk_question *q,
	    struct talk_answer *ret);

/**
 * ctl_ask_json() - the JSON of one answer.  Return: 0, or a sysexits code after
 * a message.
 */
int ctl_ask_json(struct ctl *c, const struct talk_question *q, json_t **ret);

/** ctl_put_json() - print it.  Return: an exit code. */
int ctl_put_json(json_t *o);

/** ctl_say() - ask, and print the one word of success. */
int ctl_say(struct ctl *c, const struct talk_question *q);

/** ctl_text_of(), ctl_number_of() - a member; "" and 0 if it is not there. */
const char *ctl_text_of(json_t *o, const char *key);
double ctl_number_of(json_t *o, const char *key);

/**
 * ctl_pages() - hand all pages of a list to @take, the last one empty: each
 * begins after the last job of the page before.
 * Return: an exit code; what @take returns, if it is not 0.
 */
int ctl_pages(struct ctl *c, const char *verb,
	      int (*take)(void *arg, json_t *page), void *arg);

/** ctl_unanswered() - print that no service answers. Return: EX_*. */
int ctl_unanswered(const struct ctl *c, int err);

/** ctl_first_status() - wait for the next status; NULL: none came in time. */
const struct talk_status *ctl_first_status(struct ctl *c);

/** ctl_when() - a JSON time in us as local time; "-" if there is none. */
void ctl_when(char to[32], json_t *row, const char *key);

/** ctl_wait() - follow job @id to its end. */
int ctl_wait(struct ctl *c, const char *id);

/** ctl_duration() - "1 h 02 min 03 s" */
void ctl_duration(char *to, size_t size, double s);

/** ctl_left() - "2 min 03 s"; before the job has cut, "1 min 02 s to 4 min 06
 *  s"; "?". */
void ctl_left(char *to, size_t size, const struct talk_status *s);
/** ctl_left_why() - when that is, and what it is known by. */
void ctl_left_why(char *to, size_t size, const struct talk_status *s);

/** ctl_deep_word() - "depth", or "wire" of a machine that has one. */
const char *ctl_deep_word(const struct talk_status *s);
/** ctl_deep() - the depth of the cut, or how the wire leans. */
void ctl_deep(char *to, size_t size, const struct talk_status *s);
/** ctl_speed() - @feed_mm_min; also by area, if the height is known. */
void ctl_speed(char *to, size_t size, const struct talk_status *s,
	       double feed_mm_min);
/** ctl_sums() - jumps, where there are any, retracts, shorts. */
void ctl_sums(char *to, size_t size, const struct talk_status *s);

/* -- line.c: progress in one line ----------------------------------------- */

#define LINE_MAX_CHARS	(2 * TALK_TEXT_MAX)

struct line {
	bool tty;
	bool drawn;			/* there is something to erase or to
					 * end */
	double told_s;			/* when the last line was printed */
	struct mean feed;
	char state[4 * TALK_WORD_MAX];	/* of that line */
	char text[LINE_MAX_CHARS];	/* of the last status; tty: unused */
};

/** line_feed() - take the feed of @s in mm/min; jumps and retracts are not of
 *  the cut. */
void line_feed(struct mean *m, double now_s, const struct talk_status *s);

void line_init(struct line *l);
/**
 * line_status() - draw the line.  If stdout is not a terminal, print it once a
 * second or on a change, and no text twice in a row.
 */
void line_status(struct line *l, const struct talk_status *s);
/** line_words() - the same for a text, every few seconds. */
void line_words(struct line *l, const char *text);
/** line_bar() - a bar for @done, from 0 to 1, with a text behind it. */
void line_bar(struct line *l, double done, const char *text);
/** line_end() - the next output begins on a new line. */
void line_end(struct line *l);

#endif /* CTL_CTL_H */
