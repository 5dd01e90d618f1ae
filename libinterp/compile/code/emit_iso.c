/* SPDX-License-Identifier: Apache-2.0 */
/* emit_iso.c - writes a program as NC code of dialect `generic` */
#include "code/emitter.h"

#include "interp/angle.h"
#include "wire/curve.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

/* The values that are in force in the text so far. */
struct iso_writer {
	const struct interp_program *p;
	const struct interp_sink *to;
	struct interp_diag *diag;
	double feed_mm_s;
	uint16_t cond;
	uint8_t plane;
};

/* A line that is being put together. */
struct words {
	char s[400];
	size_t n;
};

__attribute__((format(printf, 2, 3)))
static void word(struct words *w, const char *format, ...)
{
	const size_t room = sizeof(w->s) - w->n;
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(w->s + w->n, room, format, ap);
	va_end(ap);
	w->n += n < 0 ? 0 : (size_t)n < room ? (size_t)n : room - 1;
}

/* A letter and a number with up to six decimals, without zeros at the end.  C
 * keeps its point: without one it may be a condition. */
static void number(struct words *w, char letter, double v)
{
	char s[40];
	int n = snprintf(s, sizeof(s), "%.6f", v);

	while (s[n - 1] == '0')
		n--;
	if (s[n - 1] == '.' && letter != 'C')
		n--;
	word(w, " %c%.*s", letter, n, n == 2 && s[0] == '-' && s[1] == '0' ?
	     "0 " : s);
}

/* The axes of the mask @axes, from all. */
static void places(struct words *w, const double mm[INTERP_NAXES],
		   uint32_t axes)
{
	for (uint32_t a = 0; a < INTERP_NAXES; a++) {
		if (axes & 1u << a)
			number(w, INTERP_AXIS_LETTERS[a], mm[a]);
	}
}

/* Where segment @i begins; that is where the one before it ends. */
static void begin_mm(const struct iso_writer *o, uint32_t i,
		     double ret[INTERP_NAXES])
{
	for (uint32_t a = 0; a < INTERP_NAXES; a++)
		ret[a] = emit_mm(o->p, a, emit_node_sub(o->p, i, a));
}

static void feed(struct iso_writer *o, struct words *w,
		 const struct interp_seg *seg)
{
	if ((double)seg->feed_mm_s == o->feed_mm_s)
		return;
	o->feed_mm_s = (double)seg->feed_mm_s;
	word(w, " F%.9g", o->feed_mm_s * 60);
}

/* G17 G18 G19: the axes of the plane and the letters of its centre. */
static const struct {
	uint8_t a, b;
	char i, j;
} planes[] = {
	{ INTERP_X, INTERP_Y, 'I', 'J' },
	{ INTERP_Z, INTERP_X, 'K', 'I' },
	{ INTERP_Y, INTERP_Z, 'J', 'K' },
};

/* Ends of an arc that are nearer to each other: a text may not tell any more
 * whether it goes round or nowhere. */
#define NEAR_MM		1e-5

/* Radii that differ by more are not taken by who reads the text. */
#define EVEN_MM		1e-6

static double gap_mm(const struct interp_arc *a,
		     const double from_mm[INTERP_NAXES],
		     const double to_mm[INTERP_NAXES])
{
	return hypot(to_mm[a->axis_a] - from_mm[a->axis_a],
		     to_mm[a->axis_b] - from_mm[a->axis_b]);
}

static int plane_of(const struct interp_arc *a)
{
	int plane = 0;

	while (plane < 3 && (planes[plane].a != a->axis_a ||
			     planes[plane].b != a->axis_b))
		plane++;
	return plane;
}

static void arc_part(struct words *w, const struct interp_arc *a,
		     const double from_mm[INTERP_NAXES],
		     const double to_mm[INTERP_NAXES], uint32_t axes)
{
	const struct vec from = { from_mm[a->axis_a], from_mm[a->axis_b] };
	const struct vec to = { to_mm[a->axis_a], to_mm[a->axis_b] };
	const struct curve c = curve_arc(from, to, (struct vec) { a->a_mm,
					 a->b_mm }, a->sweep);
	const struct vec centre = curve_evened(&c).centre;
	const int plane = plane_of(a);

	word(w, a->sweep < 0 ? "G2" : "G3");
	places(w, to_mm, axes);
	number(w, planes[plane].i, centre.x - from.x);
	number(w, planes[plane].j, centre.y - from.y);
}

/* Half of its turn, and half of the way of all other axes. */
static void middle_mm(const struct interp_arc *a,
		      const double from_mm[INTERP_NAXES],
		      const double to_mm[INTERP_NAXES],
		      double ret[INTERP_NAXES])
{
	const double r_mm = a->r_mm + a->dr_mm / 2;

	for (int i = 0; i < INTERP_NAXES; i++)
		ret[i] = (from_mm[i] + to_mm[i]) / 2;
	ret[a->axis_a] = a->a_mm + r_mm * cos(a->theta + a->sweep / 2);
	ret[a->axis_b] = a->b_mm + r_mm * sin(a->theta + a->sweep / 2);
}

static int arc(struct iso_writer *o, struct words *w, uint32_t i)
{
	const struct interp_seg *seg = &o->p->segs[i];
	const struct interp_arc *a = &o->p->arcs[seg->arg];
	const uint32_t axes = emit_moved(o->p, i) | 1u << a->axis_a |
			      1u << a->axis_b;
	const double turns = fabs(a->sweep) / ANGLE_TURN;
	const int plane = plane_of(a);
	double at[3][INTERP_NAXES], gap;

	if (plane == 3)
		return emit_refuse(o->diag, seg->line, "arcs in XY, ZX or YZ",
				   "an arc in another plane");
	begin_mm(o, i, at[0]);
	begin_mm(o, i + 1, at[2]);
	gap = gap_mm(a, at[0], at[2]);
	if (turns >= 2)
		return emit_refuse(o->diag, seg->line, "arcs of less than two "
				   "turns", "an arc of %.2f turns", turns);
	if (plane != o->plane)
		word(w, "G%u ", 17u + (unsigned int)plane);
	o->plane = (uint8_t)plane;
	if (gap < NEAR_MM && turns < 0.5) {
		word(w, "G1");
		places(w, at[2], axes);
	} else if (turns > 1 || (gap < NEAR_MM && gap > 0) ||
		   (turns > 0.5 && fabs(a->dr_mm) > EVEN_MM)) {
		middle_mm(a, at[0], at[2], at[1]);
		arc_part(w, a, at[0], at[1], axes);
		feed(o, w, seg);
		word(w, "\n");
		arc_part(w, a, at[1], at[2], axes);
	} else {
		arc_part(w, a, at[0], at[2], axes);
	}
	feed(o, w, seg);
	return 0;
}

static int aux(struct iso_writer *o, struct words *w,
	       const struct interp_seg *seg)
{
	static const char *const names[INTERP_NAUX] = {
		[INTERP_AUX_POWER_OFF]		= "M5",
		[INTERP_AUX_POWER_POSITIVE]	= "M3",
		[INTERP_AUX_POWER_NEGATIVE]	= "M4",
		[INTERP_AUX_PUMP_ON]		= "T84",
		[INTERP_AUX_PUMP_OFF]		= "T85",
	};

	if (INTERP_AUX_OF(seg->arg) >= INTERP_NAUX)
		return emit_refuse(o->diag, seg->line, "M3 M4 M5 T84 T85",
				   "switched output %u", seg->arg);
	word(w, "%s", names[INTERP_AUX_OF(seg->arg)]);
	return 0;
}

static void condition(struct iso_writer *o, struct words *w,
		      const struct interp_seg *seg)
{
	const struct interp_cond *c = &o->p->conds[seg->cond];

	if (seg->cond == o->cond)
		return;
	o->cond = seg->cond;
	if (c->letter)
		word(w, "%c%03u ", c->letter, c->number);
}

static int words_of(struct iso_writer *o, struct words *w, uint32_t i)
{
	const struct interp_seg *seg = &o->p->segs[i];
	const int err = emit_refuse_sensed(o->diag, seg);
	double end_mm[INTERP_NAXES];

	if (err)
		return err;
	condition(o, w, seg);
	switch (seg->kind) {
	case INTERP_LINE:
		word(w, seg->flags & INTERP_SEG_RAPID ? "G0" : "G1");
		begin_mm(o, i + 1, end_mm);
		places(w, end_mm, emit_moved(o->p, i));
		if (!(seg->flags & INTERP_SEG_RAPID))
			feed(o, w, seg);
		return 0;
	case INTERP_ARC:
		return arc(o, w, i);
	case INTERP_DWELL:
		word(w, "G4 P%.15g", seg->arg / 1000.0);
		return 0;
	case INTERP_STOP:
		word(w, "M0");
		return 0;
	case INTERP_ELECTRODE:
		/* The places are the machine's: a T word would shift them. */
		word(w, seg->arg & INTERP_ELECTRODE_STOP ? "M0" : "G4 P0");
		return 0;
	case INTERP_OPTIONAL_STOP:
		word(w, "M1");
		return 0;
	case INTERP_AUX:
		return aux(o, w, seg);
	case INTERP_MCODE:
		word(w, "M%u", interp_mcode_number(seg->arg));
		return 0;
	case INTERP_END:
		word(w, "M2");
		return 0;
	default:
		return emit_refuse(o->diag, seg->line, "lines and arcs", "%s",
				   emit_kind_name(seg->kind));
	}
}

int interp_iso_write(const struct interp_program *p,
		     const struct interp_sink *to, struct interp_diag *diag)
{
	struct iso_writer o = { .p = p, .to = to, .diag = diag };
	int err = emit_line(to, "G21 G17 G90 G91.1\n");

	for (uint32_t i = 1; !err && i < p->head->nsegs; i++) {
		struct words w = { .n = 0 };

		if (!interp_program_seg_ok(p, i, &p->segs[i]))
			return -EBADMSG;
		err = words_of(&o, &w, i);
		if (!err)
			err = emit_line(to, "%s\n", w.s);
	}
	return err;
}
