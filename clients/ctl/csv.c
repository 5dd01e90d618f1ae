/* SPDX-License-Identifier: Apache-2.0 */
/* csv.c - reads a trace CSV, row by row */
#include "csv.h"
#include "standard.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEADING	"t_s,line,s_mm,feed_mm_s,gap_v,state,X,Y,Z,A,B,C,U,V"
#define ACTUAL	",X_actual,Y_actual,Z_actual,A_actual,B_actual,C_actual," \
		"U_actual,V_actual"
#define MOST	1e10			/* no machine has a place farther
					 * away */
#define SLOW_BYTES	(16 << 20)	/* for a larger file, progress is
					 * shown */

const char *const csv_state_word[CSV_NSTATES] = {
	"idle", "travel", "approach", "erode", "retract", "jump", "hold",
	"fault", "jog", "home", "probe",
};

static int refuse(const struct csv *c, size_t column, const char *found,
		  const char *wanted)
{
	fprintf(stderr, "%s:%lu:%zu: error: %.40s; %s\n", c->path, c->line,
		column + 1, found, wanted);
	return -EINVAL;
}

/*
 * Read a line, with its end, into c->text.  Return: its length; 0 at the end of
 * the file; -EINVAL, after a message, if it cannot be a line of a trace.
 */
static int read_line(struct csv *c)
{
	size_t n = 0;
	int ch = 0;

	while (ch != '\n' && (ch = getc_unlocked(c->f)) != EOF) {
		if (n == 0)
			c->line++;
		if (ch == '\0')
			return refuse(c, n, "a NUL byte",
				      "the text of a trace");
		if (n + 1 >= sizeof(c->text))
			return refuse(c, n, "a line that does not end",
				      "at most 4095 bytes in a line");
		c->text[n++] = (char)ch;
	}
	if (ferror(c->f))
		return refuse(c, n, strerror(errno), "a file that can be read");
	c->text[n] = '\0';
	c->read_bytes += (long long)n;
	return (int)n;
}

static int check_heading(struct csv *c)
{
	const size_t n = strlen(HEADING);
	const int got = read_line(c);

	if (got < 0)
		return got;
	c->line = 1;
	if (got == 0)
		return refuse(c, 0, "an empty file", "a trace begins with "
			      HEADING);
	if (strncmp(c->text, HEADING, n) != 0 ||
	    !strchr(",\r\n", c->text[n]))
		return refuse(c, 0, "not the heading of a trace", HEADING);
	c->has_actual = strncmp(c->text + n, ACTUAL, strlen(ACTUAL)) == 0;
	return 0;
}

int csv_open(struct csv *c, const char *program, const char *path, int times)
{
	struct stat st = { 0 };

	*c = (struct csv) { .program = program, .path = path };
	c->f = fopen(path, "re");
	if (!c->f || fstat(fileno(c->f), &st) < 0 || S_ISDIR(st.st_mode)) {
		int err = S_ISDIR(st.st_mode) ? EISDIR : errno;

		fprintf(stderr, "%s: error: %s: %s; a trace CSV is wanted\n",
			program, path, strerror(err));
		return -err;
	}
	c->all_bytes = times * (long long)st.st_size;
	return check_heading(c);
}

static void tell(struct csv *c)
{
	int percent;

	if (c->all_bytes < SLOW_BYTES || !isatty(STDERR_FILENO))
		return;
	percent = (int)(100 * c->read_bytes / c->all_bytes);
	if (percent == c->percent)
		return;
	c->percent = percent;
	standard_control(stderr, "\r");
	fprintf(stderr, "%s: reading %s, %d %% ", c->program, c->path, percent);
}

/* Read one number and the comma behind it. */
static bool number(char **at, double *ret)
{
	char *end;

	*ret = strtod(*at, &end);
	if (end == *at)
		return false;
	if (*end == ',')
		end++;
	else if (*end && *end != '\r' && *end != '\n')
		return false;
	*at = end;
	return true;
}

static bool place_number(char **at, double *ret)
{
	char *const from = *at;

	if (number(at, ret) && fabs(*ret) < MOST)
		return true;
	*at = from;			/* that is what the place told is of */
	return false;
}

/* In a trace without a gap sensor the voltage is empty. */
static bool gap_number(char **at, double *ret)
{
	if (**at != ',')
		return number(at, ret);
	(*at)++;
	*ret = NAN;
	return true;
}

static bool word(char **at, enum csv_state *ret)
{
	size_t n = strcspn(*at, ",\r\n");

	for (int i = 0; i < CSV_NSTATES; i++) {
		if (strlen(csv_state_word[i]) != n ||
		    strncmp(csv_state_word[i], *at, n) != 0)
			continue;
		*ret = (enum csv_state)i;
		*at += n + ((*at)[n] == ',');
		return true;
	}
	return false;
}

static bool parse(const struct csv *c, char **at, struct csv_row *r)
{
	double line;

	if (!place_number(at, &r->t_s) || !place_number(at, &line) ||
	    !place_number(at, &r->s_mm) || !place_number(at, &r->feed_mm_s) ||
	    !gap_number(at, &r->gap_v) || !word(at, &r->state))
		return false;
	for (int i = 0; i < CSV_NAXES; i++)
		if (!place_number(at, &r->axis_mm[i]))
			return false;
	for (int i = 0; c->has_actual && i < CSV_NAXES; i++)
		if (!place_number(at, &r->actual_mm[i]))
			return false;
	return true;
}

int csv_next(struct csv *c, struct csv_row *ret)
{
	char *at;
	const int n = read_line(c);

	if (n <= 0)
		return n;
	tell(c);
	at = c->text;
	if (parse(c, &at, ret))
		return 1;
	/* The program that wrote the last line was stopped in the middle of
	 * it. */
	if (c->text[n - 1] != '\n' && feof(c->f))
		return 0;
	at[strcspn(at, ",\r\n")] = '\0';
	for (char *b = at; *b; b++)
		if (*b < ' ' || *b > '~')
			*b = '?';
	return refuse(c, (size_t)(at - c->text), *at ? at : "nothing",
		      c->has_actual ? "a row of " HEADING ACTUAL :
				      "a row of " HEADING);
}

void csv_close(struct csv *c)
{
	if (c->percent)
		standard_control(stderr, "\r\033[K");
	if (c->f)
		fclose(c->f);
}
