/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission.h - what the steps of edmctl commission share
 *
 * What a step found is kept in FILE.commission beside the machine file FILE,
 * so that the walk can be left and gone on with, and in FILE.commission.html.
 *
 * Threads: one.
 */
#ifndef CTL_COMMISSION_H
#define CTL_COMMISSION_H

#include "ctl.h"
#include "new_machine.h"

#include "config.h"
#include "shm.h"

#define SLOWLY		0.05		/* of the fastest speed; first of all */
#define FASTER		0.2
#define WAVE		0.8		/* swell of a speed, of its mean */
#define SAID_CHARS	240

struct tour {
	struct ctl *ctl;
	const char *path;		/* of the machine file */
	struct machine_config config;
	const struct shm_status *status;
	json_t *steps;			/* name: what was found */
	json_t *now;			/* ... by the step that is under way */
	int axis;			/* of that step */
	bool over;			/* the answers have ended */
	bool changed;			/* the machine file, since edmd read
					 * it */
	bool fault_wanted;		/* the step is after a fault */
	bool by_hand;			/* a person is there to hold a key */
};

/* -- commission.c ---------------------------------------------------------- */

/** tour_good(), tour_wrong() - what the step found.  The last word counts. */
void tour_good(struct tour *w, const char *form, ...)
	__attribute__((format(printf, 2, 3)));
void tour_wrong(struct tour *w, const char *form, ...)
	__attribute__((format(printf, 2, 3)));

/** tour_choose(), tour_number() - ask; false: the answers have ended. */
bool tour_choose(struct tour *w, const char *words, char ret[WORD_MAX],
		 const char *form, ...) __attribute__((format(printf, 4, 5)));
bool tour_number(struct tour *w, double plain, double *ret, const char *form,
		 ...) __attribute__((format(printf, 4, 5)));

/** tour_says_yes() - a question; "yes" is offered. */
bool tour_says_yes(struct tour *w, const char *question);

/* A row of the picture of a step. */
struct tour_plot {
	const char *name, *along;	/* of y and of x, with their units */
	double step;			/* of x, from one y to the next */
	json_t *y;
};

/** tour_plot() - takes its y. */
void tour_plot(struct tour *w, const struct tour_plot *p);

static inline char tour_letter(const struct tour *w)
{
	return INTERP_AXIS_LETTERS[w->axis];
}

/* -- commission_file.c ----------------------------------------------------- */

struct tour_key {
	const char *key;
	char value[80];
};

/**
 * tour_write() - set @n keys of a section of the machine file, all or none,
 * unless edmd would refuse the file then, which is told.  @n: 1 to 31.
 */
bool tour_write(struct tour *w, const char *section, const struct tour_key *key,
		size_t n);

/* -- commission_move.c ----------------------------------------------------- */

/* What the axis did in a motion, for each cycle, in mm. */
struct tour_trace {
	double *sent, *actual;
	size_t n, room, room_actual;
	double period_s;
};

struct tour_way {
	double mm, share;		/* of its fastest */
	double hz;			/* its speed swells and falls so often;
					 * 0: not */
};

/**
 * tour_go(), tour_move() - the axis of the step goes by so many mm while a
 * person holds a key, or because a script says go.
 *
 * @t: what it did is added to this; may be NULL.
 * Return: mm that it went; NAN: it did not, and tour_wrong() has said why.
 */
double tour_go(struct tour *w, const struct tour_way *way,
	       struct tour_trace *t);
double tour_move(struct tour *w, double mm, double share,
		 struct tour_trace *t);

/** tour_home_held() - the axis homes as long as a person holds the key.
 *  Return: false: it did not come to its end. */
bool tour_home_held(struct tour *w);

/** tour_gap() - mean and deviation of the gap's voltage in the next second. */
bool tour_gap(struct tour *w, double *ret_v, double *ret_sigma_v);

/** tour_state() - wait up to @seconds for this state; as it is then. */
const struct talk_status *tour_state(struct tour *w, const char *state,
				     double seconds);

/** tour_reset() - end a fault. */
bool tour_reset(struct tour *w);

/** tour_ill() - what is wrong with a drive, if any is; else "". */
void tour_ill(struct tour *w, char to[SAID_CHARS]);

/** tour_place() - of the axis of the step, mm. */
double tour_place(struct tour *w);

/* -- The steps: commission_axis.c, commission_machine.c -------------------- */

typedef void tour_fn(struct tour *w);

tour_fn tour_estop, tour_drives, tour_power, tour_direction, tour_scale,
	tour_limits, tour_home, tour_following, tour_backlash, tour_sense,
	tour_generator, tour_watchdog, tour_latency, tour_cut;

/* identify.c: keys of [axis.*] by enum interp_identify_id. */
extern const char *const ctl_identify_key[];

/* -- commission_report.c --------------------------------------------------- */

/** tour_report() - write FILE.commission.html. Return: 0 or -errno. */
int tour_report(const struct tour *w);

#endif /* CTL_COMMISSION_H */
