/* SPDX-License-Identifier: Apache-2.0 */
/*
 * picture.c - the way that a job went, as an SVG file
 *
 * Two views, each along an axis of the machine.  Faults and retracts stand at
 * their places on the way.
 */
#include "file.h"
#include "history.h"

#include <math.h>
#include <string.h>
#include <sysexits.h>

#define WIDTH		860.0		/* of the sheet, and ... */
#define VIEW		360.0		/* ... of a view, at most, px */
#define MARGIN		40.0
#define TOP		150.0		/* under the text */
#define FLAT_MM		1e-3		/* less is no extent */

static const char axis_letters[] = "XYZ";

struct view {
	int a, b;			/* to the right, up */
	double left, top, px_mm;
	double min[2], max[2];
};

struct picture {
	FILE *f;
	json_t *points;			/* rows of um: tally_json.c */
	double min[3], max[3];		/* mm */
};

/* What XML would take for its own. */
static void put_text(FILE *f, const char *s)
{
	for (; *s; s++) {
		if (strchr("&<>\"'", *s) || (unsigned char)*s < ' ')
			fprintf(f, "&#%d;", (unsigned char)*s < ' ' ? '?' : *s);
		else
			fputc(*s, f);
	}
}

static double mm_of(json_t *row, int i)
{
	return (double)json_integer_value(json_array_get(row, (size_t)i)) / 1e3;
}

/* -- Where things are ------------------------------------------------------ */

static void measure(struct picture *p)
{
	json_t *row;
	size_t n;

	json_array_foreach(p->points, n, row) {
		for (int i = 0; i < 3; i++) {
			const double mm = mm_of(row, i);

			p->min[i] = n ? fmin(p->min[i], mm) : mm;
			p->max[i] = n ? fmax(p->max[i], mm) : mm;
		}
	}
}

static double extent(const struct picture *p, int i)
{
	return p->max[i] - p->min[i];
}

/* The point of the way at @place_mm. */
static void at_place(const struct picture *p, double place_mm, double ret[3])
{
	const size_t n = json_array_size(p->points);
	json_t *a, *b;
	double part;
	size_t i = 1;

	while (i + 1 < n &&
	       mm_of(json_array_get(p->points, i), 3) < place_mm)
		i++;
	b = json_array_get(p->points, i < n ? i : n - 1);
	a = json_array_get(p->points, i < n ? i - 1 : n - 1);
	part = (place_mm - mm_of(a, 3)) / (mm_of(b, 3) - mm_of(a, 3));
	part = part > 0 ? fmin(part, 1) : 0;
	for (int k = 0; k < 3; k++)
		ret[k] = mm_of(a, k) + part * (mm_of(b, k) - mm_of(a, k));
}

static double px_x(const struct view *v, double mm)
{
	return v->left + (mm - v->min[0]) * v->px_mm;
}

static double px_y(const struct view *v, double mm)
{
	return v->top + (v->max[1] - mm) * v->px_mm;
}

static struct view view_of(const struct picture *p, int a, int b, double left)
{
	const double most = fmax(fmax(extent(p, a), extent(p, b)), FLAT_MM);

	return (struct view) {
		.a = a, .b = b, .left = left, .top = TOP, .px_mm = VIEW / most,
		.min = { p->min[a], p->min[b] },
		.max = { p->max[a], p->max[b] },
	};
}

/* -- What is drawn --------------------------------------------------------- */

static void draw_way(const struct picture *p, const struct view *v)
{
	json_t *row, *before = NULL;
	int cut = -1;
	size_t n;

	json_array_foreach(p->points, n, row) {
		const int now = (int)json_integer_value(json_array_get(row, 4));

		if (before && now != cut) {
			fprintf(p->f, "%s<polyline class=\"%s\" points=\"%.2f,"
				"%.2f", cut < 0 ? "" : "\"/>\n",
				now ? "cut" : "rapid",
				px_x(v, mm_of(before, v->a)),
				px_y(v, mm_of(before, v->b)));
			cut = now;
		}
		if (before)
			fprintf(p->f, " %.2f,%.2f", px_x(v, mm_of(row, v->a)),
				px_y(v, mm_of(row, v->b)));
		before = row;
	}
	fputs(cut < 0 ? "" : "\"/>\n", p->f);
}

static void draw_retracts(const struct picture *p, const struct view *v,
			  json_t *rows)
{
	double at[3];
	json_t *row;
	size_t n;

	json_array_foreach(rows, n, row) {
		const double count = (double)json_integer_value(
			json_array_get(row, 2));

		at_place(p, mm_of(row, 0), at);
		fprintf(p->f, "<circle class=\"retract\" cx=\"%.2f\" "
			"cy=\"%.2f\" r=\"%.1f\"><title>%.0f retracts, line "
			"%lld, %.3f mm</title></circle>\n",
			px_x(v, at[v->a]), px_y(v, at[v->b]),
			fmin(12, 2.5 + log2(fmax(count, 1))), count,
			(long long)json_integer_value(json_array_get(row, 1)),
			mm_of(row, 0));
	}
}

static void draw_faults(const struct picture *p, const struct view *v,
			json_t *rows)
{
	double at[3];
	json_t *row;
	size_t n;

	json_array_foreach(rows, n, row) {
		const double place_mm = ctl_number_of(row, "place_mm");

		at_place(p, place_mm, at);
		fprintf(p->f, "<g class=\"fault\" transform=\"translate(%.2f "
			"%.2f)\"><path d=\"M-5-5 5 5M-5 5 5-5\"/><title>",
			px_x(v, at[v->a]), px_y(v, at[v->b]));
		put_text(p->f, ctl_text_of(row, "fault"));
		fprintf(p->f, ", line %.0f, %.3f mm</title></g>\n",
			ctl_number_of(row, "line"), place_mm);
	}
}

static void draw_view(const struct picture *p, const struct view *v,
		      json_t *job, json_t *trail)
{
	const int axis[2] = { v->a, v->b };

	fprintf(p->f, "<text x=\"%.0f\" y=\"%.0f\">", v->left, v->top - 24);
	for (int i = 0; i < 2; i++)
		fprintf(p->f, "%s%c %.3f to %.3f mm%s", i ? "up: " : "right: ",
			axis_letters[axis[i]], v->min[i], v->max[i],
			i ? "" : "; ");
	fputs("</text>\n", p->f);
	draw_way(p, v);
	draw_retracts(p, v, json_object_get(trail, "retracts_um"));
	draw_faults(p, v, json_object_get(job, "faults"));
}

/* -- The sheet ------------------------------------------------------------- */

static void put_head(const struct picture *p, json_t *job)
{
	char begun[32], took[32];

	ctl_when(begun, job, "first_us");
	ctl_duration(took, sizeof(took), ctl_number_of(job, "job_s"));
	fprintf(p->f, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 "
		"%.0f %.0f\" font-family=\"sans-serif\" font-size=\"13\">\n"
		"<style>.cut,.rapid{fill:none;stroke:#1456a0;stroke-width:1.5}"
		".rapid{stroke:#888;stroke-dasharray:4 3}.retract{fill:#e08a00;"
		"fill-opacity:.5}.fault{fill:none;stroke:#c00;stroke-width:2.5}"
		"</style>\n<rect width=\"100%%\" height=\"100%%\" "
		"fill=\"#fff\"/>\n<text x=\"%.0f\" y=\"30\" font-size=\"18\">",
		WIDTH, TOP + VIEW + MARGIN, MARGIN);
	put_text(p->f, ctl_text_of(job, "name"));
	fprintf(p->f, "</text>\n<text x=\"%.0f\" y=\"52\">job ", MARGIN);
	put_text(p->f, ctl_text_of(job, "job"));
	fprintf(p->f, ", %s; begun %s, %s; %.3f of %.3f mm</text>\n"
		"<text x=\"%.0f\" y=\"72\">%.0f retracts (circles), %.0f "
		"shorts, %.0f arcs, %.0f jumps, %zu faults (crosses); rapids "
		"dashed</text>\n", ctl_text_of(job, "state"), begun, took,
		ctl_number_of(job, "path_mm"), ctl_number_of(job, "length_mm"),
		MARGIN, ctl_number_of(job, "retracts"),
		ctl_number_of(job, "shorts"), ctl_number_of(job, "arcs"),
		ctl_number_of(job, "jumps"),
		json_array_size(json_object_get(job, "faults")));
}

static void put_conditions(const struct picture *p, json_t *rows)
{
	json_t *row;
	char took[32];
	size_t i;

	fprintf(p->f, "<text x=\"%.0f\" y=\"92\">", MARGIN);
	json_array_foreach(rows, i, row) {
		ctl_duration(took, sizeof(took), ctl_number_of(row, "job_s"));
		if (i < 8)
			fprintf(p->f, "%s%s %s", i ? "; " : "",
				*ctl_text_of(row, "condition") ?
				ctl_text_of(row, "condition") : "none", took);
	}
	fprintf(p->f, "%s</text>\n", json_array_size(rows) > 8 ? "; ..." : "");
}

static void draw(struct picture *p, json_t *job, json_t *trail)
{
	const int side = extent(p, 1) > extent(p, 0) ? 1 : 0;
	const bool above = extent(p, 0) >= FLAT_MM || extent(p, 1) >= FLAT_MM;
	struct view v = view_of(p, 0, 1, MARGIN);

	put_head(p, job);
	put_conditions(p, json_object_get(job, "conditions"));
	if (above)
		draw_view(p, &v, job, trail);
	v = view_of(p, side, 2, above ? WIDTH / 2 + MARGIN / 2 : MARGIN);
	if (extent(p, 2) >= FLAT_MM || !above)
		draw_view(p, &v, job, trail);
	fputs("</svg>\n", p->f);
}

static int write_sheet(const struct ctl *c, json_t *job, json_t *trail)
{
	struct picture p = { .points = json_object_get(trail, "points_um") };
	struct ctl_file o;
	int err;

	if (json_array_size(p.points) == 0) {
		fprintf(stderr, "edmctl: history %s: no way of it is kept: it "
			"has not moved, is not over yet, or is older than this "
			"edmd-jobs; a job with a way\n", c->arg);
		return EX_NOINPUT;
	}
	err = ctl_file_open(&o, c->picture, true);
	if (err)
		return err;
	p.f = o.f;
	measure(&p);
	draw(&p, job, trail);
	return ctl_file_close(&o, talk_interrupted() ? EX_TEMPFAIL : 0);
}

int history_picture(struct ctl *c)
{
	const size_t n = strlen(c->picture);
	json_t *job = NULL, *trail = NULL;
	int err;

	if (n < 5 || strcmp(c->picture + n - 4, ".svg") != 0) {
		fprintf(stderr, "edmctl: --picture %s; a name that ends with "
			".svg\n", c->picture);
		return EX_USAGE;
	}
	err = ctl_ask_json(c, &(struct talk_question) {
		.verb = "show", .job = c->arg }, &job);
	if (err == 0)
		err = ctl_ask_json(c, &(struct talk_question) {
			.verb = "trail", .job = c->arg }, &trail);
	if (err == 0)
		err = write_sheet(c, job, trail);
	json_decref(job);
	json_decref(trail);
	return err;
}
