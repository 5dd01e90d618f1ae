/* SPDX-License-Identifier: Apache-2.0 */
/* setting_text.c - reads the settings that a job brings */
#include "interp/setting_text.h"

#include "names.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define WORD_MAX	40

static const struct {
	double min, max;
	const char *unit;
} range[INTERP_NSETS] = {
	[INTERP_SET_TAPER] = { -80, 80, " degrees" },
	[INTERP_SET_WIRE] = { -50, 50, " mm" },
	[INTERP_SET_SCALE] = { 0.001, 1000, "" },
	[INTERP_SET_TURN] = { -360, 360, " degrees" },
	[INTERP_SET_PLANE] = { -2000, 2000, " mm" },
	[INTERP_SET_SECOND] = { -2000, 2000, " mm" },
};

static int find(const char *(*name)(int i), const char *word)
{
	int i = 0;

	while (name(i) && strcmp(name(i), word) != 0)
		i++;
	return name(i) ? i : -1;
}

static int refuse_number(int key, const char *value, struct interp_diag *diag)
{
	return interp_diag_say(diag, "%s=%s; a number from %g to %g%s",
			       interp_set_name(key), value, range[key].min,
			       range[key].max, range[key].unit);
}

static int take_mirror(const char *value, struct interp_setting *s,
		       struct interp_diag *diag)
{
	const int mirror = find(interp_mirror_name, value);
	char all[80];

	if (mirror < 0)
		return interp_diag_say(diag, "mirror=%s; %s", value,
				       names_join(interp_mirror_name, all,
						  sizeof(all)));
	s->mirror = mirror;
	return 0;
}

static int take(int key, const char *value, struct interp_setting *s,
		struct interp_wire *w, struct interp_diag *diag)
{
	double *const to[INTERP_NSETS] = {
		[INTERP_SET_TAPER] = &s->taper_deg,
		[INTERP_SET_WIRE] = &s->wire_mm,
		[INTERP_SET_SCALE] = &s->scale,
		[INTERP_SET_TURN] = &s->turn_deg,
		[INTERP_SET_PLANE] = &w->z_program_mm,
		[INTERP_SET_SECOND] = &w->z_second_mm,
	};
	char *end;
	double v;

	if (key == INTERP_SET_MIRROR)
		return take_mirror(value, s, diag);
	v = strtod(value, &end);
	if (end == value || *end || !(v >= range[key].min &&
				      v <= range[key].max))
		return refuse_number(key, value, diag);
	*to[key] = v;
	return 0;
}

/* One word, and where the next one may begin. */
static const char *cut(const char *text, char word[WORD_MAX])
{
	const size_t n = strcspn(text, " ");

	word[0] = '\0';
	strncat(word, text, n < WORD_MAX ? n : WORD_MAX - 1);
	return text + n + strspn(text + n, " ");
}

int interp_setting_read(const char *text, struct interp_setting *s,
			struct interp_wire *w, struct interp_diag *diag)
{
	char word[WORD_MAX], all[160], *value;
	uint32_t had = 0;
	int key, err = 0;

	diag->line = diag->column = 0;
	for (text += strspn(text, " "); *text && !err;) {
		text = cut(text, word);
		value = strchr(word, '=');
		if (value)
			*value++ = '\0';
		key = find(interp_set_name, word);
		if (key < 0 || !value)
			return interp_diag_say(diag, "%s where a setting "
					       "should be; taper=3, or %s",
					       word, names_join(interp_set_name,
							all, sizeof(all)));
		if (had & 1u << key)
			return interp_diag_say(diag, "%s twice; once", word);
		had |= 1u << key;
		err = take(key, value, s, w, diag);
	}
	if (!err && !(w->z_program_mm < w->z_second_mm))
		err = interp_diag_say(diag, "a plane at %g mm, and the second "
				      "one at %g mm; the second one above it",
				      w->z_program_mm, w->z_second_mm);
	return err;
}
