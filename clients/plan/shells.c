/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shells.c - the shells of a mesh, and which of them are inside out
 *
 * Triangles that hang together are a shell.  If a shell is in no other one and
 * its volume is less than 0, it is inside out; and so are all shells in it,
 * its cavities.
 */
#include "mesh.h"

#include "vec.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE	UINT32_MAX

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

/* Vertices of one shell have one root. Return: by vertex, for free(). */
static uint32_t *join(const struct mesh *m)
{
	uint32_t *parent = malloc(m->nverts * sizeof(*parent));

	for (uint32_t i = 0; i < m->nverts && parent; i++)
		parent[i] = i;
	for (uint32_t i = 0; i < m->ntris && parent; i++)
		for (int k = 1; k < 3; k++)
			parent[root_of(parent, m->tri[i][k])] =
				root_of(parent, m->tri[i][0]);
	return parent;
}

uint32_t mesh_shells(const struct mesh *m, uint32_t **ret)
{
	uint32_t *parent = join(m), n = 0;

	*ret = parent;
	for (uint32_t i = 0; i < m->nverts && parent; i++)
		if (parent[i] == i)
			parent[n++] = i;
	return n;
}

/* -- Inside out ----------------------------------------------------------- */

struct shell {
	double volume_mm3;
	double min[3], max[3];
	uint32_t vert, tri;		/* one of each; tri: the first */
	bool inverted;
};

struct shells {
	const struct mesh *m;
	uint32_t n;
	uint32_t *of;			/* by vertex */
	struct shell *shell;
};

static uint32_t shell_of(const struct shells *s, uint32_t tri)
{
	return s->of[s->m->tri[tri][0]];
}

static int number(struct shells *s)
{
	uint32_t *parent = join(s->m);

	s->of = malloc(s->m->nverts * sizeof(*s->of));
	if (!parent || !s->of) {
		free(parent);
		return -ENOMEM;
	}
	memset(s->of, 0xff, s->m->nverts * sizeof(*s->of));
	for (uint32_t i = 0; i < s->m->nverts; i++) {
		const uint32_t root = root_of(parent, i);

		if (s->of[root] == NONE)
			s->of[root] = s->n++;
		s->of[i] = s->of[root];
	}
	free(parent);
	s->shell = calloc(s->n, sizeof(*s->shell));
	return s->shell ? 0 : -ENOMEM;
}

static void measure_shells(struct shells *s)
{
	const struct mesh *m = s->m;

	for (uint32_t i = 0; i < s->n; i++)
		s->shell[i].tri = NONE;
	for (uint32_t i = 0; i < m->ntris; i++) {
		struct shell *x = &s->shell[shell_of(s, i)];

		x->volume_mm3 += mesh_volume_of(m, i);
		for (uint32_t k = 0; k < 3; k++) {
			const double *p = mesh_corner(m, i, k);

			for (int a = 0; a < 3; a++) {
				x->min[a] = x->tri == NONE ? p[a] :
					    fmin(x->min[a], p[a]);
				x->max[a] = x->tri == NONE ? p[a] :
					    fmax(x->max[a], p[a]);
			}
			if (x->tri == NONE) {
				x->tri = i;
				x->vert = m->tri[i][0];
			}
		}
	}
}

static bool holds(const struct shells *s, uint32_t outer, uint32_t inner)
{
	const struct shell *a = &s->shell[outer], *b = &s->shell[inner];
	double sum = 0;

	for (int k = 0; k < 3; k++)
		if (!(a->min[k] < b->min[k] && a->max[k] > b->max[k]))
			return false;
	for (uint32_t i = 0; i < s->m->ntris; i++)
		if (shell_of(s, i) == outer)
			sum += mesh_angle_of(s->m, i, s->m->vert[b->vert]);
	return fabs(sum) > 2 * M_PI;
}

/* The outermost shell that holds shell @i; @i itself if none does. */
static uint32_t holder(const struct shells *s, uint32_t i)
{
	uint32_t ret = i;

	for (uint32_t k = 0; k < s->n; k++)
		if (k != i && fabs(s->shell[k].volume_mm3) >
			      fabs(s->shell[ret].volume_mm3) && holds(s, k, i))
			ret = k;
	return ret;
}

static void turn(uint32_t tri[3])
{
	const uint32_t keep = tri[1];

	tri[1] = tri[2];
	tri[2] = keep;
}

static void judge_shells(struct shells *s, struct mesh_findings *f)
{
	f->shells = s->n;
	for (uint32_t i = 0; i < s->n; i++) {
		struct shell *x = &s->shell[i];

		x->inverted = s->shell[holder(s, i)].volume_mm3 < 0;
		f->volume_mm3 += x->inverted ? -x->volume_mm3 : x->volume_mm3;
		if (x->inverted && f->inverted++ == 0)
			f->inverted_tri = x->tri;
	}
}

int mesh_turn_shells(struct mesh *m, struct mesh_findings *f)
{
	struct shells s = { .m = m };
	int err = number(&s);

	if (err == 0) {
		measure_shells(&s);
		judge_shells(&s, f);
		for (uint32_t i = 0; i < m->ntris && f->inverted; i++)
			if (s.shell[shell_of(&s, i)].inverted)
				turn(m->tri[i]);
	}
	free(s.of);
	free(s.shell);
	return err;
}
