/* SPDX-License-Identifier: Apache-2.0 */
/*
 * macro_var.c - variables: #1, #100, #<name>, and what is known of the machine
 * before the program runs
 */
#include "code/macro.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* -- By number ------------------------------------------------------------ */

/* The place where it is stored, or NULL. */
static double *place_of(struct macro_line *l, uint32_t n)
{
	const bool fanuc = l->r->d->macros == MACRO_FANUC;

	if (n >= 1 && n <= (fanuc ? 33 : 30))
		return &l->m->local[l->m->level][n];
	if (fanuc ? (n >= 100 && n <= 199) || (n >= 500 && n <= 999) :
		    n >= 31 && n <= 5000)
		return &l->m->variable[n];
	return NULL;
}

/* Places are in the units in force, as the program writes them. */
static double in_units(const struct nc_reader *r, uint32_t axis, double mm)
{
	return interp_axis_is_rotary((enum interp_axis)axis) ? mm :
	       mm / r->unit_mm;
}

/* The place where the program stands, in the work offset in force or in machine
 * coordinates. */
static bool position(const struct nc_reader *r, uint32_t n, uint32_t first,
		     bool machine, double *ret)
{
	const uint32_t i = n - first;
	double mm[INTERP_NAXES];

	if (n < first || i >= INTERP_NAXES)
		return false;
	interp_turn_to(&r->contour.guides.turn, nc_here(r), mm);
	*ret = machine ? in_units(r, i, mm[i]) :
	       (nc_here(r)[i] - r->offset_mm[i]) / r->scale[i];
	return true;
}

/* From #5221 on; there are twenty numbers for each work offset. */
static bool work_offset(const struct nc_reader *r, uint32_t n, double *ret)
{
	const uint32_t k = (n - 5221) / 20, i = (n - 5221) % 20;

	if (n < 5221 || k >= INTERP_NC_NWORK || i >= INTERP_NAXES)
		return false;
	*ret = in_units(r, i, r->work_mm[k][i]);
	return true;
}

static bool known(const struct macro_line *l, uint32_t n, double *ret)
{
	const struct nc_reader *r = l->r;

	if (r->d->macros == MACRO_FANUC)
		return position(r, n, 5001, false, ret) ||
		       position(r, n, 5021, true, ret) ||
		       position(r, n, 5041, false, ret) ||
		       work_offset(r, n, ret);
	if (n == 5220) {
		*ret = r->work + 1;
		return true;
	}
	return position(r, n, 5420, false, ret) || work_offset(r, n, ret);
}

static int refuse(struct macro_line *l, const uint8_t *at, double number)
{
	return macro_refuse(l, at, l->r->d->macros == MACRO_FANUC ?
			    "#1 to #33, #100 to #199, #500 to #999; to read, "
			    "places (#5001 #5021 #5041) and work offsets "
			    "(#5221 ...)" :
			    "#1 to #5000, #<name>; to read, places (#5420 ...) "
			    "and work offsets (#5220 ...)",
			    "variable #%g, whose value is not known here",
			    number);
}

int macro_get(struct macro_line *l, const uint8_t *at, double number,
	      double *ret)
{
	const bool whole = number >= 0 && number < 1e6 &&
			   number == floor(number);
	const double *place;

	if (whole && number == 0 && l->r->d->macros == MACRO_FANUC) {
		*ret = NAN;
		return 0;
	}
	place = whole ? place_of(l, (uint32_t)number) : NULL;
	if (place && isnan(*place) && number >= 100)
		nc_note_vacant(l->r, (uint32_t)number);
	if (place)
		*ret = *place;
	else if (!whole || !known(l, (uint32_t)number, ret))
		return refuse(l, at, number);
	return 0;
}

int macro_set(struct macro_line *l, const uint8_t *at, double number, double v)
{
	const bool whole = number >= 0 && number < 1e6 &&
			   number == floor(number);
	double *place = whole ? place_of(l, (uint32_t)number) : NULL;

	if (number == 3000)
		return macro_refuse(l, at, "a program that raises no alarm",
				    "the program's own alarm, #3000 = %g", v);
	if (!place)
		return macro_refuse(l, at, "#1 ... and the common ones: the "
				    "machine's cannot be written", "a value "
				    "for #%g", number);
	*place = v;
	return 0;
}

/* -- By name -------------------------------------------------------------- */

int macro_name(struct macro_line *l, char name[MACRO_NAME_MAX])
{
	const uint8_t *at = l->p;
	size_t n = 0;

	if (l->p == l->end || *l->p != '<')
		return macro_refuse(l, at, "a name in < >", "no name");
	for (l->p++; l->p < l->end && *l->p != '>'; l->p++) {
		if (*l->p == ' ' || *l->p == '\t')
			continue;
		if (n == MACRO_NAME_MAX - 1 || *l->p <= ' ' || *l->p > '~')
			return macro_refuse(l, at,
					    "a name of up to 31 letters, and >",
					    "a name too long or not ASCII");
		name[n++] = (char)tolower(*l->p);
	}
	name[n] = '\0';
	if (n == 0 || l->p == l->end)
		return macro_refuse(l, at, "a name in < >", "a name without %s",
				    n ? "its >" : "letters");
	l->p++;
	return 0;
}

/* LinuxCNC's own: places in the work offset in force, #<_x> to #<_v>. */
static bool own_place(const struct nc_reader *r, const char *name, double *ret)
{
	const char *axis = name[0] == '_' && name[1] && !name[2] ?
			   strchr(INTERP_AXIS_LETTERS, toupper(name[1])) : NULL;

	return axis && position(r, (uint32_t)(axis - INTERP_AXIS_LETTERS), 0,
				false, ret);
}

int macro_get_named(struct macro_line *l, const uint8_t *at, const char *name,
		    double *ret)
{
	const struct macro_named *n = macro_find(l->m, name);

	if (n)
		*ret = n->value;
	else if (!own_place(l->r, name, ret))
		return macro_refuse(l, at, name[0] == '_' ?
				    "a parameter that the program has given a "
				    "value; of LinuxCNC's own, places: #<_x> "
				    "... #<_v>" :
				    "a parameter that has been given a value",
				    "#<%s>, which has no value", name);
	return 0;
}

struct macro_named *macro_find(struct nc_macro *m, const char *name)
{
	const uint32_t level = name[0] == '_' ? 0 : m->level + 1;

	for (uint32_t i = 0; i < m->nnamed; i++) {
		if (m->named[i].level == level &&
		    strcmp(m->named[i].name, name) == 0)
			return &m->named[i];
	}
	return NULL;
}

int macro_set_named(struct macro_line *l, const uint8_t *at, const char *name,
		    double v)
{
	struct nc_macro *m = l->m;
	struct macro_named *n = macro_find(m, name);
	double own;

	if (own_place(l->r, name, &own))
		return macro_refuse(l, at, "another name", "a value for #<%s>, "
				    "which is a place of the machine", name);
	if (!n && m->nnamed == MACRO_NAMED_MAX)
		return macro_refuse(l, at, "up to 256 names", "#<%s>, a name "
				    "too many", name);
	if (!n) {
		n = &m->named[m->nnamed++];
		snprintf(n->name, sizeof(n->name), "%s", name);
		n->level = name[0] == '_' ? 0 : m->level + 1;
	}
	n->value = v;
	return 0;
}
