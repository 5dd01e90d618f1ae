/* SPDX-License-Identifier: Apache-2.0 */
/*
 * maps.c - the files of geometric errors: [geometry] maps, [axis.X] pitch_map
 *
 * They have rows of points, `MM UM`: where the axis was sent, and its error
 * there.  In the file of [geometry] maps each row has a head that says which
 * axis has the error, along which axis.  A pitch_map is one row without a
 * head.  docs/homing.md describes them.  # begins a comment.
 */
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BOM		"\xef\xbb\xbf"	/* some editors begin UTF-8 files with
					 * it */
#define ERROR_MAX_UM	10000.0
#define LEAN_MAX_UM_M	(INTERP_ERRORMAP_SLOPE_MAX * 1e6)
#define GROWTH_MAX_UM_M_K	100.0

struct map {
	const struct machine_config *c;
	struct interp_diag *diag;
	const char *key;		/* "geometry.maps",
					 * "axis.X.pitch_map" */
	const char *name;		/* of the file, as it was given */
	uint32_t line, head_line;
	const char *text, *at;		/* the line, and where it is read */
	struct interp_errormap *to;
	struct interp_errormap_row *row;	/* being filled; NULL: none */
	bool heads;			/* rows have them */
	bool any;			/* a head was read */
};

static int refuse_at(const struct map *m, uint32_t line, const char *found,
		     const char *wanted)
{
	char where[32] = "";

	if (m->at)
		snprintf(where, sizeof(where), "%d:",
			 (int)(m->at - m->text) + 1);
	return interp_diag_say(m->diag, "%.20s: %.60s:%u:%s %s; %s", m->key,
			       m->name, line, where, found, wanted);
}

static int refuse(const struct map *m, const char *found, const char *wanted)
{
	return refuse_at(m, m->line, found, wanted);
}

/* -- Words and numbers ---------------------------------------------------- */

static void blanks_skip(struct map *m)
{
	m->at += strspn(m->at, " \t\r\n");
}

static bool number_take(struct map *m, double *ret)
{
	char *end;

	*ret = strtod(m->at, &end);
	if (end == m->at || !isfinite(*ret))
		return false;
	m->at = end;
	blanks_skip(m);
	return true;
}

static bool word_take(struct map *m, const char *word)
{
	const size_t n = strcspn(m->at, " \t\r\n");

	if (strlen(word) != n || strncmp(m->at, word, n) != 0)
		return false;
	m->at += n;
	blanks_skip(m);
	return true;
}

static int refuse_axis(const struct map *m)
{
	char letters[2 * INTERP_NAXES + 1] = "", wanted[64];
	int n = 0;

	for (int i = 0; i < INTERP_NAXES; i++)
		if (m->c->axes.present >> i & 1)
			n += snprintf(letters + n, sizeof(letters) - (size_t)n,
				      " %c", INTERP_AXIS_LETTERS[i]);
	snprintf(wanted, sizeof(wanted), "a letter of those it has:%s",
		 letters);
	return refuse(m, "not an axis of this machine", wanted);
}

static int axis_take(struct map *m, uint8_t *ret)
{
	for (uint8_t i = 0; i < INTERP_NAXES; i++) {
		const char letter[] = { INTERP_AXIS_LETTERS[i], '\0' };
		const char *was = m->at;

		if (!word_take(m, letter))
			continue;
		*ret = i;
		if (m->c->axes.present >> i & 1)
			return 0;
		m->at = was;
		break;
	}
	return refuse_axis(m);
}

/* -- Rows ----------------------------------------------------------------- */

static int row_end(struct map *m)
{
	if (!m->row || m->row->n >= 2)
		return 0;
	m->at = NULL;
	return refuse_at(m, m->heads ? m->head_line : m->line,
			 "fewer than two points", m->heads ?
			 "two points or more under each row's head" :
			 "two points or more, or pitch_map = none");
}

static int row_begin(struct map *m, uint8_t along, uint8_t across)
{
	struct interp_errormap *to = m->to;

	m->at = m->text;
	for (int i = 0; i < to->nrows; i++)
		if (to->row[i].along == along && to->row[i].across == across)
			return refuse(m, "this row was given before",
				      "one row for each error; a pitch in "
				      "pitch_map or in maps, not both");
	if (to->nrows == INTERP_ERRORMAP_ROWS)
		return refuse(m, "too many rows", "at most 16");
	m->row = &to->row[to->nrows++];
	m->row->along = along;
	m->row->across = across;
	m->row->n = 0;
	m->head_line = m->line;
	return 0;
}

static int point_check(const struct map *m, double at_mm, double error_um)
{
	const struct interp_errormap_row *r = m->row;
	const int last = r->n - 1;

	if (r->n == INTERP_ERRORMAP_POINTS)
		return refuse(m, "too many points", "at most 128 in a row");
	if (fabs(error_um) > ERROR_MAX_UM)
		return refuse(m, "an error of more than 10 mm",
			      "-10000 to 10000 um");
	if (last < 0)
		return 0;
	if (!(at_mm > r->at_mm[last]))
		return refuse(m, "a place not above the one before it",
			      "places that rise from line to line");
	if (fabs(error_um * 1e-3 - r->error_mm[last]) >
	    INTERP_ERRORMAP_SLOPE_MAX * (at_mm - r->at_mm[last]))
		return refuse(m, "too steep from the point before it",
			      "at most 10 um more or less for each mm");
	return 0;
}

static int point_take(struct map *m)
{
	double at_mm, error_um;
	int err;

	if (!m->row)
		return refuse(m, "a point before any row",
			      "pitch X, or straightness Y along X, above it");
	if (!number_take(m, &at_mm) || !number_take(m, &error_um) ||
	    *m->at != '\0')
		return refuse(m, "not a point",
			      "two numbers: place in mm, error in um");
	m->at = m->text;
	err = point_check(m, at_mm, error_um);
	if (err)
		return err;
	m->row->at_mm[m->row->n] = at_mm;
	m->row->error_mm[m->row->n++] = error_um * 1e-3;
	return 0;
}

/* -- Heads ---------------------------------------------------------------- */

static int line_end(struct map *m)
{
	return *m->at == '\0' ? 0 :
	       refuse(m, "more than belongs here", "the end of the line");
}

static int pitch_take(struct map *m)
{
	uint8_t axis = 0;

	return axis_take(m, &axis) || line_end(m) ? -EINVAL :
	       row_begin(m, axis, axis);
}

/* `Y along X`: two axes. */
static int pair_take(struct map *m, uint8_t *across, uint8_t *along)
{
	const char *second;

	if (axis_take(m, across))
		return -EINVAL;
	if (!word_take(m, "along"))
		return refuse(m, "not `along`", "Y along X: the error of Y "
			      "where X goes");
	second = m->at;
	if (axis_take(m, along))
		return -EINVAL;
	m->at = *along == *across ? second : m->at;
	return *along == *across ?
	       refuse(m, "an axis along itself", "two axes; an axis's own "
		      "error is its pitch") : 0;
}

static int straightness_take(struct map *m)
{
	uint8_t across = 0, along = 0;

	return pair_take(m, &across, &along) || line_end(m) ? -EINVAL :
	       row_begin(m, along, across);
}

static int value_take(struct map *m, double most, double *ret,
		      const char *wanted)
{
	const char *from = m->at;

	if (number_take(m, ret) && fabs(*ret) <= most)
		return 0;
	m->at = from;
	return refuse(m, "not a number in its range", wanted);
}

/* An angle is between two axes.  If it were given both ways, it would be
 * corrected twice. */
static bool same_axes(const struct interp_errormap_lean *a,
		      const struct interp_errormap_lean *b)
{
	return (a->along == b->along && a->across == b->across) ||
	       (a->along == b->across && a->across == b->along);
}

static int squareness_take(struct map *m)
{
	struct interp_errormap_lean l = { 0 };
	double um_m = 0;

	if (pair_take(m, &l.across, &l.along) ||
	    value_take(m, LEAN_MAX_UM_M, &um_m, "um of error for each m, "
		       "-10000 to 10000") || line_end(m))
		return -EINVAL;
	m->at = m->text;
	for (int i = 0; i < m->to->nleans; i++)
		if (same_axes(&m->to->lean[i], &l))
			return refuse(m, "this angle was given before",
				      "one angle for each two axes, whichever "
				      "of them leans");
	if (m->to->nleans == INTERP_ERRORMAP_LEANS)
		return refuse(m, "too many angles", "at most 8");
	l.rad = um_m * 1e-6;
	m->to->lean[m->to->nleans++] = l;
	return 0;
}

static int growth_take(struct map *m)
{
	const char *from = m->at;
	double um_m_k = 0, fixed_mm = 0;
	uint8_t axis = 0;

	if (axis_take(m, &axis))
		return -EINVAL;
	if (interp_axis_is_rotary((enum interp_axis)axis)) {
		m->at = from;
		return refuse(m, "growth of a rotary axis",
			      "a letter of X Y Z U V");
	}
	if (value_take(m, GROWTH_MAX_UM_M_K, &um_m_k, "um for each m and K, "
		       "-100 to 100; 11.5 for steel") ||
	    value_take(m, 1e7, &fixed_mm, "the place that does not move, mm") ||
	    line_end(m))
		return -EINVAL;
	m->at = m->text;
	if (m->to->growth[axis].per_k != 0)
		return refuse(m, "this growth was given before",
			      "one growth for each axis");
	m->to->growth[axis] = (struct interp_errormap_growth) {
		um_m_k * 1e-6, fixed_mm, m->c->over_k
	};
	return 0;
}

static const struct {
	const char *word;
	int (*take)(struct map *m);
} heads[] = {
	{ "pitch", pitch_take }, { "straightness", straightness_take },
	{ "squareness", squareness_take }, { "growth", growth_take },
};

static int head_take(struct map *m)
{
	for (size_t i = 0; i < sizeof(heads) / sizeof(heads[0]); i++) {
		if (!word_take(m, heads[i].word))
			continue;
		if (row_end(m))
			return -EINVAL;
		m->row = NULL;
		m->any = true;
		return heads[i].take(m);
	}
	return refuse(m, "neither a point nor a row's head",
		      "pitch X, straightness Y along X, squareness Y along X "
		      "UM, growth X UM MM, or two numbers");
}

/* -- Files ---------------------------------------------------------------- */

static int line_take(struct map *m, char *text)
{
	text[strcspn(text, "#\n")] = '\0';
	if (m->line == 1 && strncmp(text, BOM, strlen(BOM)) == 0)
		text += strlen(BOM);
	m->text = m->at = text;
	blanks_skip(m);
	if (*m->at == '\0')
		return 0;
	return m->heads && strchr("+-.0123456789", *m->at) == NULL ?
	       head_take(m) : point_take(m);
}

/* A file that was named must contain something to correct. */
static int file_end(const struct map *m)
{
	return m->heads && !m->any ?
	       refuse(m, "no error in it", "a row, squareness or growth; or "
		      "maps = none") : 0;
}

static int lines_take(struct map *m, FILE *f)
{
	char text[128];
	int err = 0;

	while (!err && fgets(text, sizeof(text), f)) {
		m->line++;
		m->at = NULL;
		err = !strchr(text, '\n') && !feof(f) ?
		      refuse(m, "too long a line", "at most 126 bytes") :
		      line_take(m, text);
	}
	m->at = NULL;
	if (!err && ferror(f))
		err = refuse(m, "cannot be read", "a file of points");
	return err ? err : row_end(m) || file_end(m) ? -EINVAL : 0;
}

static int file_take(struct map *m)
{
	char path[520];
	FILE *f;
	int err;

	snprintf(path, sizeof(path), "%s%s", m->name[0] == '/' ? "" :
		 m->c->folder, m->name);
	f = fopen(path, "re");
	if (!f)
		return refuse(m, strerror(errno),
			      "a file beside the machine file, or none");
	err = lines_take(m, f);
	fclose(f);
	return err;
}

static bool is_named(const char *name)
{
	return strcmp(name, "none") != 0;
}

static int pitch_read(struct machine_config *c, int axis,
		      struct interp_diag *diag)
{
	char key[32];
	struct map m = {
		.c = c, .diag = diag, .key = key, .name = c->pitch_map[axis],
		.to = &c->geometry,
	};

	snprintf(key, sizeof(key), "axis.%c.pitch_map",
		 INTERP_AXIS_LETTERS[axis]);
	return is_named(m.name) && (row_begin(&m, (uint8_t)axis, (uint8_t)axis)
				    || file_take(&m)) ? -EINVAL : 0;
}

static int maps_read(struct machine_config *c, struct interp_diag *diag)
{
	struct map m = {
		.c = c, .diag = diag, .key = "geometry.maps", .name = c->maps,
		.to = &c->geometry, .heads = true,
	};

	return is_named(m.name) ? file_take(&m) : 0;
}

static int blame(const struct config_lines *lines, enum config_section_id s,
		 const char *key, int instance, struct interp_diag *diag)
{
	diag->line = lines->at[config_key_find(s, key)][instance];
	diag->column = 0;
	return -EINVAL;
}

int config_maps_read(struct machine_config *c,
		     const struct config_lines *lines,
		     struct interp_diag *diag)
{
	c->geometry = (struct interp_errormap) { 0 };
	for (int i = 0; i < INTERP_NAXES; i++)
		if (pitch_read(c, i, diag))
			return blame(lines, SECTION_AXIS, "pitch_map", i, diag);
	return maps_read(c, diag) == 0 ? 0 :
	       blame(lines, SECTION_GEOMETRY, "maps", 0, diag);
}
