/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verb.h - a row of the table of verbs
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_VERB_H
#define JOBS_VERB_H

#include "jobs.h"

#include <jansson.h>

#define REFUSED		1		/* understood, and the answer is no */

#define VERB_OWN	UINT32_MAX	/* the service does it itself */

enum verb_kind {
	VERB_ASKS,			/* a repeat is asked again */
	VERB_SIGNS,			/* of a press: many a second, so they
					 * are not written down; late, they are
					 * no use */
	VERB_ACTS,			/* done once: act.h */
	VERB_ENDS,			/* the same; and if nothing can be
					 * written it is done all the same */
};

struct verb {
	const char *name;
	enum trust_role role;		/* the least that may ask for it */
	enum verb_kind kind;
	void (*run)(struct jobs *j, const struct verb *v,
		    const struct jobs_lcm_command *c);
	uint32_t machine;		/* enum shm_verb, for verb_machine() */
	const char *wants;		/* the state it wants */
};

/**
 * verbs_answer() - answer @code and @reason to the sender. Return: 0; or
 * STORE_KEPT: it could not be written to the disk, and this was answered.
 */
int verbs_answer(struct jobs *j, const struct jobs_lcm_command *c, int code,
		 const char *reason);

/** verbs_answer_json() - answer with @o, which it takes; NULL: no memory. */
void verbs_answer_json(struct jobs *j, const struct jobs_lcm_command *c,
		       json_t *o);

/** verbs_store() - the verb "store". */
void verbs_store(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c);

/** verbs_why() - the verb "why": waits.c. */
void verbs_why(struct jobs *j, const struct verb *v,
	       const struct jobs_lcm_command *c);

/** verbs_values() - the verb "values": the condition in force. */
void verbs_values(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c);

/** verbs_checkpoint() - the verb "checkpoint". */
void verbs_checkpoint(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c);

/** verbs_settle() - answer act @c according to the @code of edmd. */
void verbs_settle(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c, int code);

/**
 * verbs_await() - edmd has act @c under way: answer it when edmd has answered.
 */
void verbs_await(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c);

/* -- verbs_generator.c -- */

/** verbs_generator() - the verb "generator": each value, asked and told. */
void verbs_generator(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c);

/** verbs_generator_field() - the field that @c tries; INTERP_NGENERATOR: all
 *  of them.  Return: -1 if it was refused. */
int verbs_generator_field(struct jobs *j, const struct jobs_lcm_command *c);

/* -- verbs_drive.c -- */

/** verbs_drives() - the verb "drives": what is known of each. */
void verbs_drives(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c);

/** verbs_drive_arg() - SHM_OBJECT() of the axis and the object that the text of
 *  @c names, "X 6064" or, to store, "X".  Return: false if it was refused. */
bool verbs_drive_arg(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c, uint32_t *ret);

/** verbs_drive_end() - answer @c with what became of @arg. */
void verbs_drive_end(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c, uint32_t arg);

/* The object that stores what is set, and what is written into it. */
#define VERBS_STORE_INDEX	0x1010
#define VERBS_STORE_SUB		3	/* the parameters of the application */
#define VERBS_STORE_WORD	0x65766173	/* "save" */

/** verbs_axis() - the text must begin with the letter of an axis that the
 *  machine has; @n: how long it is.  Return: -1 if it was refused. */
int verbs_axis(struct jobs *j, const struct jobs_lcm_command *c, size_t n);

/* -- verbs_queue.c: functions of rows -- */

void verbs_remove(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c);
void verbs_move(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c);
void verbs_text(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c);
void verbs_queue(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c);
void verbs_show(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c);
void verbs_trail(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c);
void verbs_events(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c);
void verbs_alarms(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c);
void verbs_totals(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c);
void verbs_history(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c);

#endif /* JOBS_VERB_H */
