/* SPDX-License-Identifier: Apache-2.0 */
/* job_text.h - the text of a job, and the dialect it is written in */
#ifndef INTERP_JOB_TEXT_H
#define INTERP_JOB_TEXT_H

#include <stddef.h>

struct interp_dialect;

struct interp_text {
	const char *at;			/* need not be NUL-terminated */
	size_t bytes;
	const struct interp_dialect *dialect;	/* NULL: generic */
};

#endif /* INTERP_JOB_TEXT_H */
