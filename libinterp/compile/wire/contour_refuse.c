/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour_refuse.c - what a wire's contour is refused for
 */
#include "interp/nc.h"
#include "wire/contour.h"
#include "wire/track.h"

#include <errno.h>
#include <stdio.h>

static const char *plane_name(int p)
{
	return p ? " on the second plane" : "";
}

#define LINES_MAX	40

/* A curve has many motions in one line. */
static const char *name_lines(const struct contour *k, uint32_t m, uint32_t n,
			      char to[LINES_MAX])
{
	const uint32_t a = k->m[m].word.line, b = k->m[n].word.line;

	if (a == b)
		snprintf(to, LINES_MAX, "line %u", a);
	else
		snprintf(to, LINES_MAX, "lines %u and %u", a, b);
	return to;
}

static int refuse_stuck(const struct contour *k, const struct track_fault *f,
			int plane, struct interp_diag *diag)
{
	const uint32_t a = k->m[f->a].word.line, b = k->m[f->b].word.line;
	const bool skips = k->guides.wire->gouge == INTERP_GOUGE_SKIP;
	char lines[LINES_MAX];

	diag->line = a < b ? a : b;
	if (f->found_mm >= 0)
		snprintf(diag->found, sizeof(diag->found),
			 "a width of %.4f mm between the motions of %s%s",
			 f->found_mm, name_lines(k, f->a, f->b, lines),
			 plane_name(plane));
	else
		snprintf(diag->found, sizeof(diag->found),
			 "no room for the wire between the motions of %s%s",
			 name_lines(k, f->a, f->b, lines), plane_name(plane));
	snprintf(diag->wanted, sizeof(diag->wanted),
		 "%.4f mm for this offset, or a smaller one; %s", f->wanted_mm,
		 skips ? "or a contour that begins where the wire fits" :
		 "[wire] gouge = skip leaves out what is too narrow");
	return -EINVAL;
}

static int refuse_near_lead(const struct contour *k,
			    const struct track_fault *f, int plane,
			    struct interp_diag *diag)
{
	diag->line = k->m[f->a].word.line;
	return interp_diag_say(diag, "a lead that comes within %.4f mm of the "
				     "contour of line %u%s; %.4f mm: a lead "
				     "from farther off, square to the contour "
				     "if it can be", f->found_mm,
				     k->m[f->b].word.line, plane_name(plane),
				     f->wanted_mm);
}

static int refuse_round(const struct contour *k, const struct track_fault *f,
			int plane, struct interp_diag *diag)
{
	diag->line = k->m[f->a].word.line;
	return interp_diag_say(diag, "a lead on an arc of %.4f mm radius whose "
			       "end the wire passes at %.4f mm, by the contour "
			       "of line %u%s; a larger radius, or a straight "
			       "lead", f->found_mm, f->wanted_mm,
			       k->m[f->b].word.line, plane_name(plane));
}

static int refuse_crowded(const struct contour *k, const struct track_fault *f,
			  struct interp_diag *diag)
{
	diag->line = k->m[f->a].word.line;
	return interp_diag_say(diag, "a contour up to line %u that crosses "
				     "itself too often under its offset; "
				     "fewer motions that are short against "
				     "the offset", k->m[f->b].word.line);
}

int contour_refuse_track(const struct contour *k, const struct track_fault *f,
			 int plane, struct interp_diag *diag)
{
	if (f->kind == TRACK_LEAD)
		return refuse_near_lead(k, f, plane, diag);
	if (f->kind == TRACK_ROUND)
		return refuse_round(k, f, plane, diag);
	if (f->kind == TRACK_CROWDED)
		return refuse_crowded(k, f, diag);
	return refuse_stuck(k, f, plane, diag);
}

void contour_note_left(const struct contour *k, const struct track_fault *f,
		       int plane)
{
	char text[160], lines[LINES_MAX];

	if (!k->notes)
		return;
	name_lines(k, f->a, f->b, lines);
	if (f->kind == TRACK_POINT)
		snprintf(text, sizeof(text), "the corner of %s is so sharp "
			 "that the wire leaves %.4f mm of its point%s", lines,
			 f->found_mm, plane_name(plane));
	else
		snprintf(text, sizeof(text), "what lies between the motions of "
			 "%s is too narrow for the wire%s and is left out "
			 "(gouge = skip)", lines, plane_name(plane));
	k->notes->say(k->notes->arg, k->m[f->a].word.line, text);
}

void contour_note_constant(const struct contour *k, const struct face *f)
{
	const uint32_t line = k->m[f->first_constant].word.line;
	char text[160];

	if (!k->notes)
		return;
	snprintf(text, sizeof(text), "%u fillets, the first on line %u, would "
		 "turn inside out on the second plane and keep their radius "
		 "there", f->nconstant, line);
	k->notes->say(k->notes->arg, line, text);
}

int contour_refuse_faces(const struct contour *k, const struct face_fault *f,
			 struct interp_diag *diag)
{
	char lines[LINES_MAX];

	diag->line = k->m[f->a].word.line;
	if (f->crowded)
		return interp_diag_say(diag, "a contour up to line %u that "
				       "crosses itself too often under its "
				       "taper; fewer motions that are short "
				       "against the taper",
				       k->m[f->b].word.line);
	return interp_diag_say(diag, "the faces of %s, which meet below the "
				     "second plane; a smaller taper, or a "
				     "second plane that is lower",
				     name_lines(k, f->a, f->b, lines));
}

int contour_refuse_lead(const struct contour_motion *m, double by_mm,
			struct interp_diag *diag)
{
	diag->line = m->word.line;
	return interp_diag_say(diag, "a lead of %.4f mm for a change of "
				     "offset of %.4f mm; a motion longer than "
				     "the offset, square to the contour if it "
				     "can be", curve_length(&m->c[0]), by_mm);
}

int contour_refuse_alone(const struct interp_build_word *w,
			 struct interp_diag *diag)
{
	diag->line = w->line;
	return interp_diag_say(diag, "another axis alone under an offset or a "
				     "taper; G40 and G50 before it");
}

int contour_refuse_plane(const struct interp_build_word *w,
			 struct interp_diag *diag)
{
	diag->line = w->line;
	return interp_diag_say(diag, "an arc outside the plane XY under an "
				     "offset, a taper or corner control; G17 "
				     "arcs, or G40 and G50");
}

int contour_refuse_length(const struct interp_build_word *w,
			  struct interp_diag *diag)
{
	diag->line = w->line;
	return interp_diag_say(diag, "more than %u motions under one offset; "
				     "G40 and G41 or G42 again between them",
				     CONTOUR_MOTIONS_MAX);
}
