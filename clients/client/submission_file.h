/* SPDX-License-Identifier: Apache-2.0 */
/*
 * submission_file.h - a program that sends a file as a job: reads it, and tells
 * the person what edmd-jobs answered
 *
 * Threads: one.
 */
#ifndef CLIENT_SUBMISSION_FILE_H
#define CLIENT_SUBMISSION_FILE_H

#include "talk.h"

struct submission_file {
	char *bytes;			/* to be freed */
	size_t size;
};

/**
 * submission_read() - the file at @path, or standard input if it is "-".
 *
 * Return: 0, or the exit code of @program after a message.
 */
int submission_read(const char *program, const char *path,
		    struct submission_file *ret);

/** submission_file_name() - the name of a job that is the file at @path. */
const char *submission_file_name(const char *path);

/**
 * submission_print_refusal() - why it was refused.  The service says
 * NAME:LINE:COLUMN, but the sender knows the text as @path.
 */
void submission_print_refusal(const char *program, const char *path,
			      const struct talk_ack *a);

/** submission_print_notes() - what it says of a job that it took. */
void submission_print_notes(const struct talk_ack *a);

#endif /* CLIENT_SUBMISSION_FILE_H */
