/* SPDX-License-Identifier: Apache-2.0 */
/*
 * view.c - an HTML page to turn the bodies and step along the way
 *
 * The page is one file and needs nothing from outside: it has both meshes, the
 * poses of the electrode and a small WebGL program.  Of a mesh with more than
 * TRIS_MAX triangles only some are drawn.
 */
#include "plan.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TRIS_MAX	60000u
#define STEPS		40		/* of a block */

extern const char view_page_head[], view_page_tail[];

static void put_mesh(FILE *f, const char *name, const struct mesh *m)
{
	const uint32_t step = m->ntris / TRIS_MAX + 1;

	fprintf(f, "const %s=[", name);
	for (uint32_t i = 0; i < m->ntris; i += step)
		for (uint32_t k = 0; k < 3; k++) {
			const double *c = mesh_corner(m, i, k);

			fprintf(f, "%.3f,%.3f,%.3f,", c[0], c[1], c[2]);
		}
	fputs("];\n", f);
}

static void put_pose(FILE *f, const struct plan *p, uint32_t i, int k,
		     struct near_pair *pair)
{
	struct block b;
	struct pose pose;
	double q[INTERP_NAXES], mm;

	block_init(&b, &p->j->motion, p->best.q[i], p->best.q[i + 1]);
	block_at(&b, (double)k / STEPS, q);
	block_pose(&b, (double)k / STEPS, &pose, NULL);
	mm = near_distance(&p->j->bodies, &pose, pair);
	fputs("{r:[", f);
	for (int c = 0; c < 9; c++)
		fprintf(f, "%.9g,", pose.r.m[c / 3][c % 3]);
	fprintf(f, "],t:[%.6f,%.6f,%.6f],mm:%.4f,b:%u,q:\"", pose.t[0],
		pose.t[1], pose.t[2], mm, i + 1);
	for (int c = 0; c < INTERP_NAXES; c++)
		if (motion_moves(&p->j->motion) & 1u << c)
			fprintf(f, "%c%.3f ", INTERP_AXIS_LETTERS[c], q[c]);
	fprintf(f, "\",p:[%.3f,%.3f,%.3f]},\n", pair->p[0], pair->p[1],
		pair->p[2]);
}

int view_put(const struct plan *p)
{
	struct near_pair pair = { 0 };
	char *text = NULL;
	size_t size;
	FILE *f;
	int err;

	if (!p->j->o->view)
		return 0;
	f = open_memstream(&text, &size);
	if (!f)
		return EX_OSERR;
	fputs(view_page_head, f);
	put_mesh(f, "PART", &p->j->part);
	put_mesh(f, "TOOL", &p->j->tool);
	fputs("const POSES=[\n", f);
	for (uint32_t i = 0; i + 1 < p->best.n; i++)
		for (int k = i == 0 ? 0 : 1; k <= STEPS; k++)
			put_pose(f, p, i, k, &pair);
	fputs("];\n", f);
	fputs(view_page_tail, f);
	err = fclose(f) ? EX_OSERR : put_text(p->j->o->view, text);
	free(text);
	return err;
}
