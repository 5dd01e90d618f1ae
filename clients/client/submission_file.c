/* SPDX-License-Identifier: Apache-2.0 */
/*
 * submission_file.c - reads the file of a job, and tells the answer
 */
#include "submission_file.h"

#include "grow.h"
#include "plain.h"
#include "submission.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

int submission_read(const char *program, const char *path,
		    struct submission_file *t)
{
	bool std = strcmp(path, "-") == 0;
	FILE *f = std ? stdin : fopen(path, "rbe");
	int err;

	if (!f) {
		fprintf(stderr, "%s: %s: %s; a file of NC code, or - for "
			"standard input\n", program, path, strerror(errno));
		return EX_NOINPUT;
	}
	err = grow_read(f, SUBMISSION_BYTES_MAX, &t->bytes, &t->size);
	if (!std)
		fclose(f);
	if (err == 0)
		return 0;
	fprintf(stderr, "%s: %s: %s; a file of NC code of at most 64 "
		"MiB\n", program, path, strerror(-err));
	return err == -EISDIR ? EX_NOINPUT :
	       err == -EFBIG ? EX_DATAERR :
	       err == -ENOMEM ? EX_SOFTWARE : EX_IOERR;
}

const char *submission_file_name(const char *path)
{
	const char *slash = strrchr(path, '/');

	return strcmp(path, "-") == 0 ? "stdin" : slash ? slash + 1 : path;
}

void submission_print_refusal(const char *program, const char *path,
			      const struct talk_ack *a)
{
	json_t *j = json_loads(a->body, 0, NULL);
	const char *found, *wanted;
	char what[512], want[512];
	int line, column;

	if (j && json_unpack(j, "{s:i,s:i,s:s,s:s}", "line", &line, "column",
			     &column, "found", &found, "wanted",
			     &wanted) == 0 && line > 0) {
		plain_copy(what, sizeof(what), found);
		plain_copy(want, sizeof(want), wanted);
		fprintf(stderr, "%s:%d:%d: error: %s; %s\n", path, line,
			column, what, want);
	} else {
		fprintf(stderr, "%s: %s: %s\n", program, path, a->reason);
	}
	json_decref(j);
}

void submission_print_notes(const struct talk_ack *a)
{
	json_t *j = json_loads(a->body, 0, NULL), *note;
	char text[512];
	size_t i;

	json_array_foreach(json_object_get(j, "notes"), i, note) {
		if (!json_is_string(note))
			continue;
		plain_copy(text, sizeof(text), json_string_value(note));
		fprintf(stderr, "%s\n", text);
	}
	json_decref(j);
}
