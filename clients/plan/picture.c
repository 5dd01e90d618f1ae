/* SPDX-License-Identifier: Apache-2.0 */
/*
 * picture.c - an SVG: ghosts of the electrode on its way, and the clearance
 *
 * Left, the part as a light shape and the electrode at each node and between
 * them, seen from the side that shows most of the way.  Right, the distance
 * along each block, over what is to be kept.
 */
#include "plan.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define SIDE		460.0		/* of either picture */
#define TRIS_MAX	60000		/* drawn of a body */
#define POSES		24		/* of a block, in the curve */
#define GHOSTS		24		/* of a way of many nodes */

struct view {
	double u[3], v[3];		/* right and up */
	double mid[2], scale;
};

/* The two axes of space the end of the electrode moves along most. */
static void choose_view(const struct plan *p, struct view *w)
{
	const struct plan_way *b = &p->best;
	double lo[3], hi[3], least = DBL_MAX;
	int away = 0;

	for (int k = 0; k < 3; k++) {
		lo[k] = p->j->part.min[k];
		hi[k] = p->j->part.max[k];
	}
	for (uint32_t i = 0; i < b->n; i++) {
		struct pose pose;
		double at[3];

		motion_pose(&p->j->motion, b->q[i], &pose);
		rot_apply(&pose.r, p->j->motion.ball_mm, at);
		v_add(at, pose.t, at);
		for (int k = 0; k < 3; k++) {
			lo[k] = fmin(lo[k], at[k] - p->j->motion.ball_r_mm);
			hi[k] = fmax(hi[k], at[k] + p->j->motion.ball_r_mm);
		}
	}
	for (int k = 0; k < 2; k++) {
		if (hi[k] - lo[k] < least) {
			least = hi[k] - lo[k];
			away = k;
		}
	}
	memset(w, 0, sizeof(*w));
	w->u[!away] = 1;
	w->v[2] = 1;
	w->mid[0] = (lo[!away] + hi[!away]) / 2;
	w->mid[1] = (lo[2] + hi[2]) / 2;
	w->scale = (SIDE - 20) / fmax(hi[!away] - lo[!away], hi[2] - lo[2]);
}

/* Places on the paper of the corners of a triangle. Return: does it face us? */
static bool project(const struct view *w, const struct mesh *m, uint32_t i,
		    const struct pose *pose, double ret[3][2])
{
	for (uint32_t k = 0; k < 3; k++) {
		double p[3];

		rot_apply(&pose->r, mesh_corner(m, i, k), p);
		v_add(p, pose->t, p);
		ret[k][0] = SIDE / 2 + (v_dot(w->u, p) - w->mid[0]) * w->scale;
		ret[k][1] = SIDE / 2 - (v_dot(w->v, p) - w->mid[1]) * w->scale;
	}
	return (ret[1][0] - ret[0][0]) * (ret[2][1] - ret[0][1]) >
	       (ret[1][1] - ret[0][1]) * (ret[2][0] - ret[0][0]);
}

/* The triangles on one side as one path: their shadow. */
static void put_shadow(FILE *f, const struct view *w, const struct mesh *m,
		       const struct pose *pose, const char *style)
{
	const uint32_t step = m->ntris / TRIS_MAX + 1;

	fprintf(f, "<path %s d=\"", style);
	for (uint32_t i = 0; i < m->ntris; i += step) {
		double at[3][2];

		if (project(w, m, i, pose, at))
			fprintf(f, "M%.1f %.1fL%.1f %.1fL%.1f %.1fZ", at[0][0],
				at[0][1], at[1][0], at[1][1], at[2][0],
				at[2][1]);
	}
	fputs("\"/>\n", f);
}

static void put_ghost(FILE *f, const struct plan *p, const struct view *w,
		      const double q[INTERP_NAXES], const char *colour)
{
	char style[160];
	struct pose pose;

	motion_pose(&p->j->motion, q, &pose);
	snprintf(style, sizeof(style), "fill=\"%s\" fill-opacity=\"0.3\"",
		 colour);
	put_shadow(f, w, &p->j->tool, &pose, style);
}

static void put_way(FILE *f, const struct plan *p)
{
	const uint32_t last = p->best.n - 1, step = last / GHOSTS + 1;
	const struct pose still = { .r = { { { 1, 0, 0 }, { 0, 1, 0 },
					     { 0, 0, 1 } } } };
	struct view w;

	choose_view(p, &w);
	put_shadow(f, &w, &p->j->part, &still, "fill=\"#99a\" fill-opacity="
		   "\"0.3\"");
	for (uint32_t i = 0; i < last; i += step)
		put_ghost(f, p, &w, p->best.q[i], i == 0 ? "#c60" : "#06c");
	put_ghost(f, p, &w, p->best.q[last], "#063");
	if (p->contact)
		put_ghost(f, p, &w, p->contact, "#c00");
}

static double distance(const struct plan *p, uint32_t i, int k)
{
	struct near_pair pair = { 0 };
	struct block b;
	struct pose pose;

	block_init(&b, &p->j->motion, p->best.q[i], p->best.q[i + 1]);
	block_pose(&b, (double)k / POSES, &pose, NULL);
	return near_distance(&p->j->bodies, &pose, &pair);
}

/* The next number of 1, 2 or 5 and zeros. */
static double round_up(double mm)
{
	const double ten = pow(10, floor(log10(mm)));

	return mm <= ten ? ten : mm <= 2 * ten ? 2 * ten :
	       mm <= 5 * ten ? 5 * ten : 10 * ten;
}

static void put_scale(FILE *f, double step, double high, double keep)
{
	for (int i = 0; i * step <= high * 1.0001; i++) {
		const double y = SIDE - 40 - (SIDE - 80) * i * step / high;

		fprintf(f, "<path d=\"M40 %.1fH%.0f\" stroke=\"#ddd\"/>"
			"<text x=\"34\" y=\"%.1f\" text-anchor=\"end\">%g"
			"</text>\n", y, SIDE, y + 4, i * step);
	}
	fprintf(f, "<path d=\"M40 %.1fH%.0f\" stroke=\"#c00\" "
		"stroke-dasharray=\"4 3\"/>\n", SIDE - 40 - (SIDE - 80) * keep /
		high, SIDE);
}

static void put_curve(FILE *f, const struct plan *p)
{
	const uint32_t n = p->best.n - 1;
	const double keep = p->j->clear_mm + p->j->chord_mm;
	const double most = fmax(fmax(3 * keep, 1.5 * p->best.least_mm), 0.01);
	const double step = round_up(most / 6);
	const double high = ceil(most / step) * step;

	fprintf(f, "<g transform=\"translate(480 0)\" font-size=\"11\">"
		"<text x=\"40\" y=\"20\">distance along each block, mm, up to "
		"%g; dashed: %.3f, to be kept</text>\n", high, keep);
	put_scale(f, step, high, keep);
	fputs("<path fill=\"none\" stroke=\"#06c\" stroke-width=\"1.5\" d=\"",
	      f);
	for (uint32_t i = 0; i < n; i++) {
		for (int k = i == 0 ? 0 : 1; k <= POSES; k++) {
			const double d = fmin(distance(p, i, k), high);
			const double x = ((double)i + (double)k / POSES) / n;

			fprintf(f, "%c%.1f %.1f", i == 0 && k == 0 ? 'M' : 'L',
				40 + (SIDE - 40) * x,
				SIDE - 40 - (SIDE - 80) * d / high);
		}
	}
	fputs("\"/>\n", f);
	for (uint32_t i = 0; i <= n; i++)
		fprintf(f, "<path d=\"M%.1f 40V%.0f\" stroke=\"#999\" "
			"stroke-width=\"0.5\"/><text x=\"%.1f\" y=\"%.0f\">%u"
			"</text>\n", 40 + (SIDE - 40) * i / n, SIDE - 36,
			36 + (SIDE - 40) * i / n, SIDE - 20, i);
	fputs("</g>\n", f);
}

int picture_put(const struct plan *p)
{
	char *text = NULL;
	size_t size;
	FILE *f;
	int err;

	if (!p->j->o->picture)
		return 0;
	f = open_memstream(&text, &size);
	if (!f)
		return EX_OSERR;
	fprintf(f, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" "
		"height=\"%.0f\" font-family=\"sans-serif\" font-size=\"12\">\n"
		"<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
		2 * SIDE + 40, SIDE + 10);
	put_way(f, p);
	fprintf(f, "<text x=\"10\" y=\"20\">start orange, nodes blue, end "
		"green%s</text>\n<text x=\"10\" y=\"36\">%u blocks, %s "
		"%.3f mm</text>\n", p->contact ? ", first contact red" : "",
		p->best.n - 1, p->best.how ? "proved" : "least seen",
		p->best.least_mm);
	put_curve(f, p);
	fputs("</svg>\n", f);
	err = fclose(f) ? EX_OSERR : put_text(p->j->o->picture, text);
	free(text);
	return err;
}
