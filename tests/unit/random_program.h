/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_program.h - random NC texts and records, in every dialect
 *
 * Short lines and tiny arcs are as frequent as long ones.  Not every text is
 * accepted: a word may have no use where it stands.
 */
#ifndef RANDOM_PROGRAM_H
#define RANDOM_PROGRAM_H

#include "walk_help.h"

#include <stdarg.h>

struct script {
	char at[16384];
	int n;
	uint64_t *seed;
	double x, y;			/* where the program stands, as told */
	bool places;			/* I and J are places */
	bool turning;			/* with rotary axes */
	int decimals;
};

__attribute__((format(printf, 2, 3)))
static inline void put(struct script *t, const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	t->n += vsnprintf(t->at + t->n, sizeof(t->at) - (size_t)t->n, format,
			  ap);
	va_end(ap);
	assert_true(t->n < (int)sizeof(t->at) - 1000);
}

/* A length of a few pulses, of tenths, or of millimetres. */
static inline double some_mm(struct script *t)
{
	uint64_t *s = t->seed;

	switch (rnd(s) % 4) {
	case 0:
		return (double)((int)(rnd(s) % 13) - 6) * 1e-3;
	case 1:
		return uniform(s, -0.02, 0.02);
	case 2:
		return uniform(s, -0.3, 0.3);
	default:
		return uniform(s, -4, 4);
	}
}

/* As it is written. */
static inline double rounded(const struct script *t, double v)
{
	const double grain = pow(10, t->decimals);

	return round(v * grain) / grain;
}

/* A word, and what it says. */
static inline double put_word(struct script *t, const char *letter, double v)
{
	const double said = rounded(t, v);

	put(t, "%s%.*f ", letter, t->decimals, said);
	return said;
}

static inline void put_xy(struct script *t, double x, double y)
{
	t->x += put_word(t, "X", x);
	t->y += put_word(t, "Y", y);
}

static inline void put_others(struct script *t)
{
	static const char *const names[] = { "Z", "A", "B", "C", "U", "V" };
	uint64_t *s = t->seed;

	for (int i = 0; i < 6; i++)
		if (rnd(s) % 6 == 0)
			put_word(t, names[i], some_mm(t));
}

static inline void put_line(struct script *t, bool others)
{
	put(t, "G%d ", (int)(rnd(t->seed) % 5 != 0));
	put_xy(t, some_mm(t), some_mm(t));
	if (others)
		put_others(t);
	put(t, "\n");
}

/* Many in a row, along a curve: what a CAM system writes. */
static inline void put_dense(struct script *t, bool others)
{
	const double step = pow(10, uniform(t->seed, -3, -0.5));
	const double turn = uniform(t->seed, -0.3, 0.3);
	double way = uniform(t->seed, 0, 6.28);
	const bool rotary = others && t->turning;

	for (uint64_t n = 3 + rnd(t->seed) % 20; n > 0; n--) {
		put(t, "G1 ");
		put_xy(t, step * cos(way), step * sin(way));
		if (rotary)
			put_word(t, "C", step * uniform(t->seed, 2, 2.5));
		put(t, "\n");
		way += turn;
	}
}

static inline void put_arc(struct script *t, bool others)
{
	uint64_t *s = t->seed;
	const double r = pow(10, uniform(s, -3.2, 0.6));
	const double t0 = uniform(s, 0, 6.28), t1 = uniform(s, 0, 6.28);
	const double i = -r * cos(t0), j = -r * sin(t0);
	const double x = t->x, y = t->y;

	put(t, "G%d ", 2 + (int)(rnd(s) % 2));
	if (rnd(s) % 6)
		put_xy(t, i + r * cos(t1), j + r * sin(t1));
	else
		put_xy(t, 0, 0);
	if (others && rnd(s) % 8 == 0) {
		put_word(t, "R", rnd(s) % 2 ? 2 * r : -2 * r);
	} else {
		put_word(t, "I", i + (t->places ? x : 0));
		put_word(t, "J", j + (t->places ? y : 0));
	}
	if (others && rnd(s) % 4 == 0)
		put_others(t);
	put(t, "\n");
}

/* -- Dialect generic ------------------------------------------------------- */

static inline void put_splines(struct script *t)
{
	uint64_t *s = t->seed;

	switch (rnd(s) % 3) {
	case 0:
		put(t, "G5 X%.3f Y%.3f I%.3f J%.3f P%.3f Q%.3f\n",
		    some_mm(t), some_mm(t), some_mm(t), some_mm(t),
		    some_mm(t), some_mm(t));
		break;
	case 1:
		put(t, "G5.1 X%.3f Y%.3f I%.3f J%.3f\n", some_mm(t),
		    some_mm(t), some_mm(t), some_mm(t));
		break;
	default:
		put(t, "G5.2 X%.3f Y%.3f P%.2f L%d\n", some_mm(t), some_mm(t),
		    uniform(s, 0.3, 3), 2 + (int)(rnd(s) % 3));
		for (uint64_t n = 3 + rnd(s) % 4; n > 0; n--)
			put(t, "X%.3f Y%.3f P%.2f\n", some_mm(t), some_mm(t),
			    uniform(s, 0.3, 3));
		put(t, "G5.3\n");
	}
	put(t, "G1 X0.01\n");
}

/* The first point is where it stands: at zero, by G92. */
static inline void put_nurbs(struct script *t)
{
	const int order = 2 + (int)(rnd(t->seed) % 3);
	const int points = order + (int)(rnd(t->seed) % 4);

	put(t, "G92 X0 Y0\nG90\nG6.2 P%d K0 X0 Y0 R1\n", order);
	for (int i = 1; i < points; i++) {
		const int k = i < order ? 0 : i - order + 1;

		put(t, "K%d X%.3f Y%.3f R%.2f\n", k, some_mm(t), some_mm(t),
		    uniform(t->seed, 0.3, 3));
	}
	for (int i = 0; i < order; i++)
		put(t, "K%d\n", points - order + 1);
	put(t, "G91\n");
}

static inline void put_orbit(struct script *t)
{
	uint64_t *s = t->seed;
	const double z = -uniform(s, 0.01, 0.2), r = uniform(s, 0.002, 0.1);

	put(t, "G14%d\n", (int)(rnd(s) % 4));
	switch (rnd(s) % 7) {
	case 0:
		put(t, "G86 Z%.3f\n", z);
		break;
	case 1:
		put(t, "G130 Z%.3f R%.3f Q%.3f P1\n", z, r,
		    uniform(s, 0.01, 0.1));
		break;
	case 2:
		put(t, "G131 Z%.3f R%.3f Q%.3f\n", z, r,
		    uniform(s, 0.01, 0.1));
		break;
	case 3:
		put(t, "G132 Z%.3f R%.3f Q%.3f\n", z, r,
		    uniform(s, 0.01, 0.1));
		break;
	case 4:
		put(t, "G133 Z%.3f R%.3f A3 Q0.05\n", z, r);
		break;
	case 5:
		put(t, "G134 Z%.3f R%.3f L%d\n", z, r,
		    1 + (int)(rnd(s) % 5));
		break;
	default:
		put(t, "G135 R%.3f Q%.3f\n", r, uniform(s, 0.01, 0.1));
	}
}

/* What moves nothing, or little. */
static inline void put_generic_word(struct script *t)
{
	static const char *const words[] = {
		"G4 P0.004", "G4 X0.002", "M0", "M1", "M3", "M4", "M5", "T84",
		"T85", "C120", "E001", "G17", "G21", "G94", "G53 G0 Z0.01",
		"G90 G28 Z0.02\nG91", "G92 Z0", "G92.1", "G54", "G55", "D1",
		"H1=0.01", "G40", "G49", "G50", "G18\nG17", "G91.1",
		"/ X500", "(a comment)", "S7", "N99", "F900", "G20\nG21",
		"G120 P1 Z-0.02", "G19\nG17", "M98 P1",
	};

	put(t, "%s\n", words[rnd(t->seed) %
			     (sizeof(words) / sizeof(words[0]))]);
}

static inline void put_probe(struct script *t)
{
	static const char *const words[] = {
		"G80 X-\nG92 X1\nG91", "G38.2 Z-0.1\nG92 Z0\nG91",
		"G81 Y+\nG92 Y1\nG91",
	};

	put(t, "%s\n", words[rnd(t->seed) % 3]);
}

static inline void put_generic(struct script *t)
{
	const uint64_t n = 2 + rnd(t->seed) % 8;

	t->turning = rnd(t->seed) % 2;
	put(t, "G21 G91 F%.0f\n", pow(10, uniform(t->seed, 2.5, 4.2)));
	for (uint64_t i = 0; i < n; i++) {
		switch (rnd(t->seed) % 12) {
		case 0:
		case 1:
		case 2:
			put_line(t, true);
			break;
		case 3:
		case 4:
		case 5:
			put_arc(t, true);
			break;
		case 6:
			put_dense(t, true);
			break;
		case 7:
			put_splines(t);
			break;
		case 8:
			put_nurbs(t);
			break;
		case 9:
			put_orbit(t);
			break;
		case 10:
			if (rnd(t->seed) % 8 == 0)
				put_probe(t);
			break;
		default:
			put_generic_word(t);
		}
	}
	put(t, "M2\nO1\nG1 X0.003 Y0.001\nG1 X-0.003 Y-0.001\nM99\n");
}

/* -- Dialects of wire machines --------------------------------------------- */

static inline void put_wire_word(struct script *t, const char *dialect)
{
	static const char *const all[] = {
		"G0 X0.01 Y0", "M00", "M01", "F3000", "G92 X0. Y0.", "N5",
		"(a comment)",
	};
	static const char *const taper[] = {
		"G51 A1.", "G52 A0.5", "G50", "G51 A0.", "M98 P7",
	};
	const bool robofil = strcmp(dialect, "robofil") == 0;
	uint64_t *s = t->seed;

	if (!robofil && rnd(s) % 3 == 0)
		put(t, "%s\n", taper[rnd(s) % 5]);
	else if (robofil && rnd(s) % 4 == 0)
		put(t, "G%d\n", rnd(s) % 2 ? 38 + (int)(rnd(s) % 2) :
					     60 + (int)(rnd(s) % 2));
	else
		put(t, "%s\n", all[rnd(s) % 7]);
	if (strstr(t->at, "G92 X0.")) {
		t->x = 0;
		t->y = 0;
	}
}

/* With a wire offset: a contour that it can follow, and its way in. */
static inline void put_offset(struct script *t, const char *dialect)
{
	const char letter = strcmp(dialect, "robofil") == 0 ? 'D' : 'H';

	put(t, "G%d %c1\n", 41 + (int)(rnd(t->seed) % 2), letter);
	put(t, "G1 ");
	put_xy(t, 1, 0);
	put(t, "\n");
}

static inline void put_wire(struct script *t, const char *dialect)
{
	const uint64_t n = 2 + rnd(t->seed) % 6;
	const bool label_o = strcmp(dialect, "chmer") == 0;

	t->places = strcmp(dialect, "robofil") == 0;
	put(t, "G91 F%.0f\n", pow(10, uniform(t->seed, 2.5, 4.2)));
	if (rnd(t->seed) % 3 == 0)
		put_offset(t, dialect);
	for (uint64_t i = 0; i < n; i++) {
		switch (rnd(t->seed) % 4) {
		case 0:
			put_line(t, false);
			break;
		case 1:
			put_arc(t, false);
			break;
		case 2:
			put_dense(t, false);
			break;
		default:
			put_wire_word(t, dialect);
		}
	}
	put(t, "M02\n");
	if (!t->places)
		put(t, "%c7\nG1 X0.003 Y0.001\nM99\n", label_o ? 'O' : 'N');
}

/* -- Records --------------------------------------------------------------- */

static inline int some_units(struct script *t)
{
	return (int)(rnd(t->seed) %
		     (rnd(t->seed) % 2 ? 12 : 3000));
}

static inline void put_records(struct script *t, bool fourb)
{
	uint64_t *s = t->seed;

	for (uint64_t n = 2 + rnd(s) % 8; n > 0; n--) {
		const int x = some_units(t), y = some_units(t);
		const int r = (int)hypot(x, y), gy = (int)(rnd(s) % 2);

		if (rnd(s) % 2)
			put(t, "B%d B%d B%d %sG%c L%d\n", x, y, gy ? y : x,
			    fourb ? "B0 " : "", gy ? 'Y' : 'X',
			    1 + (int)(rnd(s) % 4));
		else if (fourb)
			put(t, "B%d B%d B%d B%d %s G%c %cR%d\n", x, y,
			    1 + (int)(rnd(s) % (uint64_t)(4 * r + 1)), r,
			    rnd(s) % 2 ? "D" : "DD", gy ? 'Y' : 'X',
			    rnd(s) % 2 ? 'N' : 'S', 1 + (int)(rnd(s) % 4));
		else
			put(t, "B%d B%d B%d G%c %cR%d\n", x, y,
			    1 + (int)(rnd(s) % (uint64_t)(4 * r + 1)),
			    gy ? 'Y' : 'X', rnd(s) % 2 ? 'N' : 'S',
			    1 + (int)(rnd(s) % 4));
	}
	put(t, "DD\n");
}

/* -- Any ------------------------------------------------------------------- */

/* Return: the dialect's name; @t has the text. */
static inline const char *random_text(struct script *t, uint64_t *s)
{
	static const char *const names[] = {
		"generic", "generic", "generic", "robofil", "skd2", "sodick",
		"chmer", "3b", "4b",
	};
	const char *name = names[rnd(s) % (sizeof(names) / sizeof(names[0]))];

	*t = (struct script) { .seed = s, .decimals = 3 };
	if (rnd(s) % 4 == 0)
		t->decimals = 3 + (int)(rnd(s) % 4);
	if (strcmp(name, "generic") == 0)
		put_generic(t);
	else if (name[1] == 'b' && name[2] == 0)
		put_records(t, name[0] == '4');
	else
		put_wire(t, name);
	return name;
}

#endif /* RANDOM_PROGRAM_H */
