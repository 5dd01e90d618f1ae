/* SPDX-License-Identifier: Apache-2.0 */
/* queue.c - all jobs that wait, and all that were cut */
#include "ctl.h"

#include <stdio.h>
#include <string.h>

static int remove_one(struct ctl *c, const char *job)
{
	struct talk_answer a;
	const int err = ctl_ask(c, &(struct talk_question) {
		.verb = "remove", .job = job,
	}, &a);

	if (err)
		return err;
	talk_answer_free(&a);
	printf("job %s removed\n", job);
	return 0;
}

/* Return: how many of the first page waited and are gone; -1: @ret_err. */
static int clear_page(struct ctl *c, int *ret_err)
{
	json_t *page = NULL, *row;
	int n = 0;
	size_t i;

	*ret_err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "queue",
	}, &page);
	json_array_foreach(page, i, row)
		if (*ret_err == 0 &&
		    strcmp(ctl_text_of(row, "state"), "queued") == 0) {
			*ret_err = remove_one(c, ctl_text_of(row, "job"));
			n++;
		}
	json_decref(page);
	return *ret_err ? -1 : n;
}

int ctl_clear(struct ctl *c)
{
	int err;

	while (clear_page(c, &err) > 0)
		;
	return err;
}

int ctl_totals(struct ctl *c)
{
	json_t *rows = NULL, *row;
	char took[32], eroded[32];
	size_t i;
	int err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "totals", .text = c->arg,
	}, &rows);

	if (err == 0 && c->json) {
		err = ctl_put_json(rows);
		json_decref(rows);
		return err;
	}
	if (err == 0)
		printf("%-10s %5s %5s %17s %17s\n", "DAY", "JOBS", "DONE",
		       "TIME", "ERODING");
	json_array_foreach(rows, i, row) {
		ctl_duration(took, sizeof(took), ctl_number_of(row, "job_s"));
		ctl_duration(eroded, sizeof(eroded),
			     ctl_number_of(row, "erode_s"));
		printf("%-10s %5.0f %5.0f %17s %17s\n",
		       ctl_text_of(row, "time"), ctl_number_of(row, "jobs"),
		       ctl_number_of(row, "done"), took, eroded);
	}
	json_decref(rows);
	return err;
}
