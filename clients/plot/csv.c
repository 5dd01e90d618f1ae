/* SPDX-License-Identifier: Apache-2.0 */
/* csv.c - read a trace CSV, row by row */
#include "csv.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#define HEADING	"t_s,line,s_mm,feed_mm_s,gap_v,state,X,Y,Z,A,B,C,U,V"
#define ACTUAL	",X_actual,Y_actual,Z_actual,A_actual,B_actual,C_actual," \
		"U_actual,V_actual"
#define SLOW_BYTES	(16 << 20)	/* from here on progress is told */

const char *const csv_state_word[CSV_NSTATES] = {
	"idle", "travel", "approach", "erode", "retract", "jump", "hold",
	"fault", "jog", "home", "touch",
};

static int refuse(const struct csv *c, size_t column, const char *found,
		  const char *wanted)
{
	fprintf(stderr, "%s:%lu:%zu: error: %.40s; %s\n", c->path, c->line,
		column + 1, found, wanted);
	return -EINVAL;
}

static ssize_t read_line(struct csv *c)
{
	size_t n = 0;
	int b = 0;

	/* What is no trace may have no lines at all. */
	while (n < sizeof(c->text) - 1 && b != '\n' &&
	       (b = getc_unlocked(c->f)) != EOF)
		c->text[n++] = (char)b;
	c->text[n] = '\0';
	if (n > 0) {
		c->read_bytes += (long long)n;
		c->line++;
	}
	return (ssize_t)n;
}

static int check_heading(struct csv *c)
{
	size_t n = strlen(HEADING);

	if (read_line(c) <= 0)
		return refuse(c, 0, "an empty file", "a trace begins with "
			      HEADING);
	if (strncmp(c->text, HEADING, n) != 0 ||
	    !strchr(",\r\n", c->text[n]))
		return refuse(c, 0, "not the heading of a trace", HEADING);
	c->has_actual = strncmp(c->text + n, ACTUAL, strlen(ACTUAL)) == 0;
	return 0;
}

int csv_open(struct csv *c, const char *program, const char *path)
{
	struct stat st;

	*c = (struct csv) { .program = program, .path = path };
	c->f = fopen(path, "re");
	if (!c->f || fstat(fileno(c->f), &st) < 0) {
		int err = errno;

		fprintf(stderr, "%s: error: %s: %s; a trace CSV is wanted\n",
			program, path, strerror(err));
		return -err;
	}
	c->all_bytes = 2 * (long long)st.st_size;	/* read twice */
	return check_heading(c);
}

void csv_rewind(struct csv *c)
{
	rewind(c->f);
	c->line = 0;
	read_line(c);
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
	fprintf(stderr, "\r%s: plot: reading %s, %d %% ", c->program, c->path,
		percent);
}

/* One number and the comma behind it. */
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
	return number(at, ret) && isfinite(*ret);
}

/* A trace without a gap sensor leaves the voltage empty. */
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
	ssize_t n = read_line(c);

	if (n <= 0)
		return 0;
	tell(c);
	at = c->text;
	if (parse(c, &at, ret))
		return 1;
	/* Whoever wrote the last line was stopped in its middle. */
	if (c->text[n - 1] != '\n' && feof(c->f))
		return 0;
	at[strcspn(at, ",\r\n")] = '\0';
	return refuse(c, (size_t)(at - c->text), *at ? at : "nothing",
		      c->has_actual ? "a row of " HEADING ACTUAL :
				      "a row of " HEADING);
}

void csv_close(struct csv *c)
{
	if (c->percent)
		fputs("\r\033[K", stderr);
	if (c->f)
		fclose(c->f);
}
