/* SPDX-License-Identifier: Apache-2.0 */
/* touch.c - the words of "offset", and what they mean */
#include "touch.h"

#include "keys.h"
#include "store_electrode.h"

#include "interp/angle.h"
#include "interp/nc.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define WORD_MAX	64
#define SKEW_OFF_MM	1.0		/* off the face, before it goes along */
#define SKEW_MOST_DEG	45.0
#define WANTED		"a system, G54 to G59.3, or an electrode, T3, and what " \
			"becomes of it: X=5 gives the place where X stands the number 5, X@5 puts " \
			"the origin at machine place 5, clear takes the machine file's again; X=probe+ or " \
			"Z=probe-20 feels for a face, 20 mm at most, bore R10, boss I15 J15 K5 and corner X+ Y- Q0.5 feel as " \
			"G160 to G162 do; skew Y+ I40 feels a face twice, 40 mm apart along X, for how the work lies; radius=2.5 is that of the electrode"

static const struct form {
	const char *name, *code, *letters;
	bool walls;			/* one on each axis, whose side is
					 * given */
} forms[] = {
	[TOUCH_BORE] = { "bore", "G160", "RQL", false },
	[TOUCH_BOSS] = { "boss", "G161", "IJKQL", false },
	[TOUCH_CORNER] = { "corner", "G162", "IJRQ", true },
	[TOUCH_SKEW] = { "skew", NULL, "IJRQ", true },
};
#define NFORMS	(int)(sizeof(forms) / sizeof(forms[0]))

/* @what: a word, which may have others behind it. */
static int refuse(char why[TOUCH_WHY_MAX], const char *what)
{
	const int n = (int)strcspn(what, " \n");

	snprintf(why, TOUCH_WHY_MAX, "'%.*s'; " WANTED, n < 40 ? n : 40, what);
	return -EINVAL;
}

static int axis_of(char letter)
{
	const char *at = strchr(INTERP_AXIS_LETTERS,
				toupper((unsigned char)letter));

	return letter && at ? (int)(at - INTERP_AXIS_LETTERS) : -1;
}

/* -- One word -------------------------------------------------------------- */

/* Return: 0; -EINVAL: it is no number; -ERANGE: it is not between these. */
static int read_mm(struct touch *t, const char *text, double low, double high,
		   double *ret)
{
	char *end;

	*ret = strtod(text, &end);
	if (end == text || *end || isnan(*ret))
		return -EINVAL;
	t->low = low;
	t->high = high;
	return *ret >= low && *ret <= high ? 0 : -ERANGE;
}

static int take_target(struct touch *t, const char *word)
{
	double n;

	t->work = -1;
	for (int i = 0; i < INTERP_NC_NWORK; i++)
		if (strcasecmp(config_section[SECTION_WORK].instance[i],
			       word) == 0)
			t->work = i;
	if (t->work >= 0)
		return 0;
	if (toupper((unsigned char)*word) != 'T' ||
	    !isdigit((unsigned char)word[1]) ||
	    read_mm(t, word + 1, 1, STORE_ELECTRODE_NUMBER_MAX, &n) ||
	    !store_electrode_ok(n))
		return -EINVAL;
	t->electrode = (uint32_t)n;
	return 0;
}

static int take_form(struct touch *t, const char *word)
{
	for (int i = TOUCH_BORE; i < NFORMS; i++) {
		if (strcasecmp(word, forms[i].name) != 0)
			continue;
		if (t->form)
			return -EINVAL;
		t->form = (enum touch_form)i;
		t->felt = i == TOUCH_SKEW ? 0 : 1u << INTERP_X | 1u << INTERP_Y;
		return 0;
	}
	return -ENOENT;
}

/* X=probe-20.  Without a sign Z goes down; X and Y have no such side. */
static int take_edge(struct touch *t, int axis, const char *way)
{
	if (t->form || axis > INTERP_Z || !strchr("+-", *way) ||
	    (!*way && axis != INTERP_Z))
		return -EINVAL;
	t->form = TOUCH_EDGE;
	t->felt = 1u << axis;
	t->way[axis] = *way == '+' ? 1 : -1;
	return !*way || !way[1] ? 0 :
	       read_mm(t, way + 1, 1e-3, 1e6, &t->most_mm);
}

/* X=5, X@5, X=probe+. */
static int take_axis(struct touch *t, uint32_t present, const char *word)
{
	const int axis = axis_of(*word);
	uint32_t *of = word[1] == '@' ? &t->at : &t->here;
	int err;

	if (axis < 0 || !(present >> axis & 1))
		return -EINVAL;
	if (word[1] == '=' && strncasecmp(word + 2, "probe", 5) == 0)
		return take_edge(t, axis, word + 7);
	if ((t->here | t->at) >> axis & 1)
		return -EINVAL;
	err = read_mm(t, word + 2, -1e6, 1e6, &t->mm[axis]);
	if (err == 0)
		*of |= 1u << axis;
	return err;
}

/* A corner is in X Y; how a face tilts is felt along Z too. */
static int last_wall(const struct touch *t)
{
	return t->form == TOUCH_SKEW ? INTERP_Z : INTERP_Y;
}

static int take_skew(struct touch *t, char letter, double mm)
{
	if (letter == 'R' && mm > 0 && t->most_mm == 0)
		t->most_mm = mm;
	else if (letter == 'Q' && mm > 0 && t->off_mm == 0)
		t->off_mm = mm;
	else if ((letter == 'I' || letter == 'J') && mm != 0 &&
		 t->along_mm == 0)
		t->along_mm = mm;
	else
		return -EINVAL;
	if (letter == 'I' || letter == 'J')
		t->along = letter == 'I' ? INTERP_X : INTERP_Y;
	return 0;
}

/* A word of the cycle: R10, or the side of a corner's wall: X+. */
static int take_cycle(struct touch *t, const char *word)
{
	const char letter = (char)toupper((unsigned char)*word);
	const size_t n = strlen(t->words);
	const int axis = axis_of(letter);
	double mm;
	int err = 0;

	if (t->form <= TOUCH_EDGE || strchr(t->words, letter))
		return -EINVAL;
	if (forms[t->form].walls && axis >= 0 && axis <= last_wall(t) &&
	    (strcmp(word + 1, "+") == 0 || strcmp(word + 1, "-") == 0))
		t->way[axis] = word[1] == '+' ? 1 : -1;
	else if (!strchr(forms[t->form].letters, letter))
		return -EINVAL;
	else if ((err = read_mm(t, word + 1, -1e6, 1e6, &mm)) != 0)
		return err;
	else if (t->form == TOUCH_SKEW)
		return take_skew(t, letter, mm);
	return (size_t)snprintf(t->words + n, sizeof(t->words) - n, " %c%s",
				letter, word + 1) < sizeof(t->words) - n ?
	       0 : -EINVAL;
}

static int take_word(struct touch *t, uint32_t present, const char *word)
{
	const int err = take_form(t, word);

	if (err != -ENOENT)
		return err;
	if (strcasecmp(word, "clear") == 0)
		t->clear = true;
	else if (strcasecmp(word, "new") == 0)
		t->is_new = true;
	else if (strncasecmp(word, "radius=", 7) == 0)
		return read_mm(t, word + 7, 1e-4, 1e4, &t->radius_mm);
	else if (word[1] == '=' || word[1] == '@')
		return take_axis(t, present, word);
	else
		return take_cycle(t, word);
	return 0;
}

/* -- All of them ----------------------------------------------------------- */

static bool has_walls(const struct touch *t)
{
	return (t->form == TOUCH_EDGE && t->felt != 1u << INTERP_Z) ||
	       t->form == TOUCH_CORNER;
}

static bool is_one(uint32_t axes)
{
	return axes && !(axes & (axes - 1));
}

static const char *against_skew(const struct touch *t)
{
	uint32_t felt = 0;

	for (int i = INTERP_X; i <= INTERP_Z; i++)
		felt |= (uint32_t)(t->way[i] != 0) << i;
	if (!is_one(felt))
		return "a skew without the side of its face; skew Y+ I40, "
		       "one of X Y Z";
	if (t->along_mm == 0 || felt >> t->along & 1)
		return "a skew without a way along its face; I40 along X, J40 "
		       "along Y";
	if (t->here | t->at || t->clear || t->is_new || t->radius_mm > 0)
		return "a skew gives a turn and no place; an edge gives a "
		       "place";
	if (t->work < 0 && felt == 1u << INTERP_Z)
		return "an electrode that tilts, which no axis turns; skew X+ "
		       "J20 or skew Y+ I20";
	return NULL;
}

/* What they say together that cannot be; NULL: it can. */
static const char *against(const struct touch *t)
{
	const uint32_t z = 1u << INTERP_Z;

	if (t->clear + (t->form != TOUCH_NOTHING) + (t->at != 0) > 1 ||
	    (t->clear && t->here))
		return "clear, X@5 and what is felt are three things; one at "
		       "a time";
	if (t->form && t->form != TOUCH_SKEW && t->here & ~t->felt)
		return "a number for an axis that is not felt; one axis at a "
		       "time, or those of the form";
	if (t->radius_mm > 0 && !has_walls(t))
		return "radius= without a wall along X or Y; an edge or a "
		       "corner";
	if (t->form == TOUCH_SKEW)
		return against_skew(t);
	if (t->form == TOUCH_CORNER && !(t->way[INTERP_X] && t->way[INTERP_Y]))
		return "a corner without the sides of its walls; corner X+ Y-";
	if (t->form == TOUCH_BOSS && !strchr(t->words, 'I') &&
	    !strchr(t->words, 'J'))
		return "a boss without a way to its sides; boss I15 J15 K5";
	if (t->work >= 0 && t->is_new)
		return "new is for an electrode; T3 Z=probe-20 new";
	if (t->work < 0 && t->is_new && t->felt & ~z)
		return "new is for its length; T3 Z=probe-20 new";
	if (t->work < 0 && (t->form == TOUCH_BORE || t->form == TOUCH_BOSS))
		return t->at || t->clear ? "where the middle is, as X=12.5 "
		       "Y=3, machine places" : NULL;
	if (t->work < 0 && (t->clear || t->at || (t->form | t->here) == 0 ||
			    (t->form && t->felt != z) || t->here & ~z))
		return "an electrode, T3, has its length along Z; T3 "
		       "Z=probe-20 Z=5, where the machine place of the face is "
		       "5; its middle by T3 boss I15 J15 K5, its turn by T3 "
		       "skew Y+ I20";
	return NULL;
}

static int judge(struct touch *t, const char *text, char why[TOUCH_WHY_MAX])
{
	const char *what = against(t);

	for (int i = INTERP_X; t->form == TOUCH_SKEW && i <= INTERP_Z; i++)
		t->felt |= (uint32_t)(t->way[i] != 0) << i;
	/* An axis without a way to its sides is left out. */
	if (t->form == TOUCH_BOSS && !strchr(t->words, 'I'))
		t->felt &= ~(1u << INTERP_X);
	if (t->form == TOUCH_BOSS && !strchr(t->words, 'J'))
		t->felt &= ~(1u << INTERP_Y);
	if (what) {
		snprintf(why, TOUCH_WHY_MAX, "%s", what);
		return -EINVAL;
	}
	return t->clear || t->here || t->at || t->form ? 0 :
	       refuse(why, text);
}

int touch_read(struct touch *ret, uint32_t present, const char *text,
	       char why[TOUCH_WHY_MAX])
{
	const char *at = text;
	char word[WORD_MAX];

	*ret = (struct touch) { .work = -1 };
	for (bool first = true; first || *at; first = false) {
		const size_t n = strcspn(at, " \n");
		int err = 0;

		snprintf(word, sizeof(word), "%.*s", (int)n, at);
		if (n >= sizeof(word) || (first && take_target(ret, word) < 0))
			return refuse(why, at);
		if (!first && n)
			err = take_word(ret, present, word);
		if (err == -ERANGE)
			snprintf(why, TOUCH_WHY_MAX, "'%s'; a number of mm "
				 "from %.10g to %.10g", word, ret->low,
				 ret->high);
		if (err < 0)
			return err == -ERANGE ? -EINVAL : refuse(why, at);
		at += n + (at[n] != '\0');
	}
	return judge(ret, text, why);
}

/* -- The lines that feel --------------------------------------------------- */

static void edge_text(const struct touch *t, double back_mm, char *to,
		      size_t size)
{
	const int axis = __builtin_ctz(t->felt), way = t->way[axis];
	const char letter = INTERP_AXIS_LETTERS[axis];
	char most[32] = "";

	if (t->most_mm > 0)
		snprintf(most, sizeof(most), "%.4f", t->most_mm);
	/* Behind the contact only distances mean anything, and it feels along
	 * one axis, whatever is turned. */
	snprintf(to, size, "G10 L2 P0 R0\nG21 G91 F60\nG80 %c%c%s\n"
		 "G0 %c%.4f\nM2\n", letter, way > 0 ? '+' : '-', most,
		 letter, -way * back_mm);
}

/* The face at two places; off it before it goes along. */
static void skew_text(const struct touch *t, double back_mm, char *to,
		      size_t size)
{
	const int axis = __builtin_ctz(t->felt), way = t->way[axis];
	const char letter = INTERP_AXIS_LETTERS[axis];
	const double off_mm = t->off_mm > 0 ? t->off_mm :
			      fmax(back_mm, SKEW_OFF_MM);
	char feel[96], most[32] = "";

	if (t->most_mm > 0)
		snprintf(most, sizeof(most), "%.4f", t->most_mm);
	snprintf(feel, sizeof(feel), "G80 %c%c%s\nG0 %c%.4f\n", letter,
		 way > 0 ? '+' : '-', most, letter, -way * off_mm);
	snprintf(to, size, "G10 L2 P0 R0\nG21 G91 F60\n%sG0 %c%.4f\n%sM2\n",
		 feel, INTERP_AXIS_LETTERS[t->along], t->along_mm, feel);
}

void touch_text(const struct touch *t, const char *ask, double back_mm,
		char to[TOUCH_TEXT_MAX])
{
	int n = snprintf(to, TOUCH_TEXT_MAX, "(%.200s", ask);

	while (isspace((unsigned char)to[n - 1]))
		n--;
	for (int i = 0; i < n; i++)
		if (to[i] == '\n')
			to[i] = ' ';
	n += snprintf(to + n, TOUCH_TEXT_MAX - (size_t)n, ")\n");
	if (t->form == TOUCH_EDGE)
		edge_text(t, back_mm, to + n, TOUCH_TEXT_MAX - (size_t)n);
	else if (t->form == TOUCH_SKEW)
		skew_text(t, back_mm, to + n, TOUCH_TEXT_MAX - (size_t)n);
	else
		snprintf(to + n, TOUCH_TEXT_MAX - (size_t)n, "G10 L2 P0 R0\n"
			 "G21 G90 F60\n"
			 "%s%s\nM2\n", forms[t->form].code, t->words);
}

int touch_of_text(struct touch *ret, uint32_t present, const char *text)
{
	char ask[256], why[TOUCH_WHY_MAX];
	const size_t n = strcspn(text, ")\n");

	if (*text != '(' || n > sizeof(ask))
		return -EINVAL;
	snprintf(ask, sizeof(ask), "%.*s", (int)n - 1, text + 1);
	return touch_read(ret, present, ask, why);
}

/* -- What was found -------------------------------------------------------- */

bool touch_is_found(const struct touch *t, const struct shm_snapshot *s)
{
	const bool twice = t->form == TOUCH_BORE || t->form == TOUCH_BOSS ||
			   t->form == TOUCH_SKEW;

	return (t->felt & ~(twice ? s->found_twice : s->found_once)) == 0;
}

void touch_at_mm(const struct touch *t, const struct shm_snapshot *s,
		 double ret_mm[INTERP_NAXES])
{
	const bool middle = t->form == TOUCH_BORE || t->form == TOUCH_BOSS;

	for (int i = 0; i < INTERP_NAXES; i++) {
		double at = s->pos[i];

		if (middle && t->felt >> i & 1)
			at = ((double)s->found[0][i] + s->found[1][i]) / 2;
		else if (t->felt >> i & 1)
			at = s->found[0][i];
		ret_mm[i] = at * s->pulse_mm[i];
	}
}

double touch_zero_mm(const struct touch *t, int axis)
{
	return t->mm[axis] -
	       (axis < INTERP_Z ? t->way[axis] * t->radius_mm : 0);
}

/* Beyond that its normal is nearer to the other axis. */
bool touch_is_one_face(const struct touch *t, const struct shm_snapshot *s)
{
	double deg;

	if (t->form != TOUCH_SKEW)
		return true;
	touch_angle(t, s, &deg);
	return fabs(deg) <= SKEW_MOST_DEG;
}

enum touch_angle touch_angle(const struct touch *t,
			     const struct shm_snapshot *s, double *ret_deg)
{
	const int axis = __builtin_ctz(t->felt);
	const double by_mm = ((double)s->found[0][axis] - s->found[1][axis]) *
			     s->pulse_mm[axis];
	const double deg = atan(by_mm / t->along_mm) * ANGLE_RADIAN;

	/* A face along Y goes toward X- where the work turns toward Y. */
	*ret_deg = axis == INTERP_X ? -deg : deg;
	if (axis != INTERP_Z)
		return TOUCH_TURN;
	return t->along == INTERP_X ? TOUCH_TILT_X : TOUCH_TILT_Y;
}
