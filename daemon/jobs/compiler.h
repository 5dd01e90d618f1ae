/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compiler.h - NC code to a program, in a thread of its own
 *
 * A text of millions of lines takes seconds. Commands and status go on
 * meanwhile: the thread, and those that it starts, have SCHED_BATCH.
 *
 * Threads: that of the event loop, which also gets the result.
 */
#ifndef JOBS_COMPILE_H
#define JOBS_COMPILE_H

#include "config.h"
#include "interp/build_from.h"
#include "interp/nc.h"
#include "interp/wear.h"
#include "shm.h"
#include "store_electrode.h"
#include "store_text.h"

#include <systemd/sd-event.h>

struct compiler;
struct compiler_result;

struct compiler_request {
	const struct machine_config *config;	/* lent, until the end */
	double start_mm[INTERP_NAXES];
	const char *name;			/* of its file: the dialect */
	const char *text;			/* lent, until the end */
	size_t bytes;
	/* If not empty: a long text is read from this file, or, if it is given,
	 * written to it when it is found good; store_text.h. */
	char text_file[STORE_TEXT_PATH_MAX];
	uint8_t sha256[32];			/* of the text, if that is
						 * known ... */
	bool has_sha256;			/* ... and to be compared */
	/* If it goes on where another one was interrupted: start_mm is where
	 * that one began, and these values were set in it. */
	bool goes_on;
	/* Copies: the table may change meanwhile. */
	struct interp_electrode electrode[STORE_ELECTRODES_MAX];
	struct interp_electrodes electrodes;	/* but for `at` */
	bool wants_wear;		/* of its electrodes */
	const char *wants_block;	/* to be loaded on this machine; NULL:
					 * no */
	char setting[INTERP_SETTING_MAX];	/* interp/setting.h */
	const char *dialect;		/* NULL: by machine file and name */
	double work_mm[INTERP_NC_NWORK][INTERP_NAXES];	/* offset_request() */
	double work_turn_deg[INTERP_NC_NWORK];
	uint32_t segs_max, executed_max;	/* 0: as many as a job may
						 * have */
	uint32_t walked_max;		/* interp_build_options */
	struct interp_build_from from;
	struct shm_sets sets;
	/* By a request that was the same but for this; NULL: none.  It is on
	 * the heap and belongs to the compiler.  It is the result if technology
	 * table and dialect are the same too. */
	struct compiler_result *made;
};

#define COMPILER_NOTES_MAX	16

/* What is cut otherwise than it is written. */
struct compiler_note {
	uint32_t line;
	char text[200];
};

/* diag is filled if err is -EINVAL.  What is taken out of it has to be
 * cleared. */
struct compiler_result {
	int err;			/* -EILSEQ: the text is not that of its
					 * hash */
	int keep_err;			/* why it could not be written */
	struct interp_diag diag;
	uint32_t lines;
	struct compiler_note note[COMPILER_NOTES_MAX];
	uint32_t nnotes;		/* all of them, also those not kept */
	char tech_sha256[65];		/* of the table, hex; "": none */
	uint8_t dialect_sha256[32];	/* of its file; zeros: built in */
	char tech_refusal[1024];		/* of the table or the
					 * dialect; "": none */
	struct interp_build_entry entry;	/* if it goes on */
	struct interp_wear wear;	/* if it was wanted */
	int block;			/* the program, if it was wanted: what
					 * shm_program_name() takes; -1 */
	int32_t start_pulses[INTERP_NAXES];	/* where it begins */
};

typedef void (*compiler_done_fn)(void *arg, struct compiler_result *r);

/**
 * compiler_start() - begin; the event loop calls @done once.
 *
 * Return: 0 or a negative errno.
 */
int compiler_start(struct compiler **ret, sd_event *event,
		   const struct compiler_request *request,
		   compiler_done_fn done, void *arg);

/** compiler_forget() - free what was taken out. */
void compiler_forget(struct compiler_result *r);
/** compiler_take_out() - what @r has belongs to the caller from now on. */
void compiler_take_out(struct compiler_result *r);

/**
 * compiler_destroy() - the service ends; @done is not called.
 *
 * A long text takes minutes, and nobody commands the machine while a service
 * that ends waits.  So a thread that still works goes on until the process
 * ends, and what was lent to it has to stay.
 *
 * Not for one whose @done was called: that one frees itself. NULL is allowed.
 *
 * Return: the @arg of compiler_start(); NULL: the thread still works.
 */
void *compiler_destroy(struct compiler *c);

#endif /* JOBS_COMPILE_H */
