/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pitch.c - [axis.X] pitch_map: a file of places and errors
 *
 * A point a line, `MM UM`: where the axis was sent, and how much farther (+)
 * or less far (-) it came.  # begins a comment.
 */
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ERROR_MAX_UM	10000.0

struct map {
	struct interp_diag *diag;
	const char *key_of;		/* the axis, one letter */
	const char *name;		/* of the file, as it was given */
	uint32_t line;
	struct config_pitch *to;
};

static int refuse(const struct map *m, const char *found, const char *wanted)
{
	snprintf(m->diag->found, sizeof(m->diag->found),
		 "axis.%s.pitch_map: %.60s:%u: %s", m->key_of, m->name,
		 m->line, found);
	snprintf(m->diag->wanted, sizeof(m->diag->wanted), "%s", wanted);
	return -EINVAL;
}

static const char *blanks_skip(const char *s)
{
	return s + strspn(s, " \t\r\n");
}

static int number_take(const char **at, double *ret)
{
	char *end;

	*ret = strtod(*at, &end);
	if (end == *at || !isfinite(*ret))
		return -EINVAL;
	*at = blanks_skip(end);
	return 0;
}

static int point_add(struct map *m, double at_mm, double error_um)
{
	struct config_pitch *p = m->to;
	const double run_mm = p->n ? at_mm - p->at_mm[p->n - 1] : 1;

	if (p->n == CONFIG_PITCH_POINTS)
		return refuse(m, "too many points", "at most 128");
	if (!(run_mm > 0))
		return refuse(m, "a place not above the one before it",
			      "places that rise from line to line");
	if (fabs(error_um) > ERROR_MAX_UM)
		return refuse(m, "an error of more than 10 mm",
			      "-10000 to 10000 um");
	if (p->n && fabs(error_um - p->error_um[p->n - 1]) >= 1e3 * run_mm)
		return refuse(m, "an error that changes as fast as the place",
			      "errors that leave the axis going forward");
	p->at_mm[p->n] = at_mm;
	p->error_um[p->n++] = error_um;
	return 0;
}

static int line_take(struct map *m, char *text)
{
	const char *at;
	double at_mm, error_um;

	text[strcspn(text, "#")] = '\0';
	at = blanks_skip(text);
	if (*at == '\0')
		return 0;
	if (number_take(&at, &at_mm) < 0 || number_take(&at, &error_um) < 0 ||
	    *at != '\0')
		return refuse(m, "not a point",
			      "two numbers: place in mm, error in um");
	return point_add(m, at_mm, error_um);
}

static int lines_take(struct map *m, FILE *f)
{
	char text[128];
	int err = 0;

	while (!err && fgets(text, sizeof(text), f)) {
		m->line++;
		err = !strchr(text, '\n') && !feof(f) ?
		      refuse(m, "too long a line", "at most 126 bytes") :
		      line_take(m, text);
	}
	if (!err && ferror(f))
		err = refuse(m, "cannot be read", "a file of points");
	if (!err && m->to->n < 2)
		err = refuse(m, "fewer than two points",
			     "two points or more, or pitch_map = none");
	return err;
}

static int map_read(struct machine_config *c, int axis,
		    struct interp_diag *diag)
{
	const char *name = c->pitch_map[axis];
	struct map m = {
		.diag = diag, .name = name, .to = &c->pitch[axis],
	};
	char path[520];
	FILE *f;
	int err;

	m.key_of = config_section[SECTION_AXIS].instance[axis];
	m.to->n = 0;
	if (strcmp(name, "none") == 0)
		return 0;
	snprintf(path, sizeof(path), "%s%s", name[0] == '/' ? "" :
		 c->folder, name);
	f = fopen(path, "re");
	if (!f)
		return refuse(&m, strerror(errno),
			      "a file beside the machine file, or none");
	err = lines_take(&m, f);
	fclose(f);
	return err;
}

int config_pitch_read(struct machine_config *c,
		      const struct config_lines *lines,
		      struct interp_diag *diag)
{
	const int key = config_key_find(SECTION_AXIS, "pitch_map");

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (map_read(c, i, diag) == 0)
			continue;
		diag->line = lines->at[key][i];
		diag->column = 0;
		return -EINVAL;
	}
	return 0;
}
