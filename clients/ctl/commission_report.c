/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission_report.c - what the walk found, as one page with pictures
 */
#include "commission.h"

#include "output.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define LEFT	60.0			/* of the picture, for numbers */
#define WIDE	420.0
#define HIGH	110.0

/* Text of a file or of a machine may hold anything. */
static void put_text(FILE *f, const char *text)
{
	for (; *text; text++) {
		if (*text == '<' || *text == '>' || *text == '&')
			fprintf(f, "&#%d;", *text);
		else
			fputc(*text, f);
	}
}

/* The lowest and the highest, at the left; what x is, below. */
static void put_axes(FILE *f, json_t *row, double low, double high)
{
	const size_t n = json_array_size(json_object_get(row, "y"));

	fprintf(f, "<path d=\"M%g 0V%gH%g\"/>"
		"<text x=\"%g\" y=\"12\">%.4g</text>"
		"<text x=\"%g\" y=\"%g\">%.4g</text>"
		"<text x=\"%g\" y=\"%g\">%.4g ", LEFT, HIGH, LEFT + WIDE,
		LEFT - 6, high, LEFT - 6, HIGH, low, LEFT + WIDE, HIGH + 16,
		ctl_number_of(row, "step") * (double)(n - 1));
	put_text(f, ctl_text_of(row, "along"));
	fprintf(f, "</text><text x=\"%g\" y=\"%g\">0</text>", LEFT + 4,
		HIGH + 16);
}

static void put_row(FILE *f, const char *name, json_t *row)
{
	json_t *y = json_object_get(row, "y"), *v;
	const size_t n = json_array_size(y);
	double low = INFINITY, high = -INFINITY;
	size_t i;

	json_array_foreach(y, i, v) {
		low = fmin(low, json_number_value(v));
		high = fmax(high, json_number_value(v));
	}
	if (n == 0)
		return;
	fprintf(f, "<figure><figcaption>");
	put_text(f, name);
	fprintf(f, "</figcaption><svg viewBox=\"0 0 %g %g\">",
		LEFT + WIDE + 10, HIGH + 20);
	put_axes(f, row, low, high);
	fprintf(f, "<polyline points=\"");
	json_array_foreach(y, i, v)
		fprintf(f, "%.1f,%.1f ", LEFT + (n > 1 ? WIDE * (double)i /
			(double)(n - 1) : 0), HIGH - HIGH *
			(json_number_value(v) - low) /
			fmax(high - low, 1e-12));
	fprintf(f, "\"/></svg></figure>\n");
}

static void put_step(FILE *f, const char *name, json_t *s)
{
	const bool good = json_is_true(json_object_get(s, "good"));
	json_t *wrote = json_object_get(s, "wrote"), *v;
	json_t *plot = json_object_get(s, "plot");
	const char *key;
	size_t i;

	fprintf(f, "<tr class=\"%s\"><th>", good ? "good" : "wrong");
	put_text(f, name);
	fprintf(f, "<td>%s<td>", good ? "good" : "wrong");
	put_text(f, ctl_text_of(s, "said"));
	json_array_foreach(wrote, i, v) {
		fputs("<br><code>", f);
		put_text(f, json_string_value(v));
		fputs("</code>", f);
	}
	json_object_foreach(plot, key, v)
		put_row(f, key, v);
	fputc('\n', f);
}

static void put_page(FILE *f, const struct tour *w)
{
	const time_t now = time(NULL);
	const char *name;
	char when[32];
	struct tm at;
	json_t *s;

	strftime(when, sizeof(when), "%Y-%m-%d %H:%M",
		 localtime_r(&now, &at));
	fputs("<!DOCTYPE html><meta charset=\"utf-8\"><title>commissioning"
	      "</title><style>body{font:15px sans-serif;margin:2em}"
	      "table{border-collapse:collapse}td,th{padding:.4em .8em;"
	      "text-align:left;vertical-align:top;border-top:1px solid #ccc}"
	      ".wrong td{background:#fdd}figure{margin:.6em 0}svg{width:490px;"
	      "height:130px}polyline,path{fill:none;stroke:#06c}"
	      "path{stroke:#888}text{font-size:11px;text-anchor:end;"
	      "fill:#555}</style><h1>", f);
	put_text(f, w->config.name);
	fputs("</h1><p>", f);
	put_text(f, w->path);
	fprintf(f, ", %s</p><table>\n", when);
	json_object_foreach(w->steps, name, s)
		put_step(f, name, s);
	fputs("</table>\n", f);
}

int tour_report(const struct tour *w)
{
	char path[PATH_MAX];
	FILE *f;

	snprintf(path, sizeof(path), "%s.commission.html", w->path);
	f = fopen(path, "we");
	if (!f)
		return -errno;
	put_page(f, w);
	return output_close(f);
}
