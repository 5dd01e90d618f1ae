/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stl.c - a mesh from an STL file, mended by admesh
 *
 * Triangles that are there twice or have no area are removed.  Where edges are
 * open, corners that are up to a micrometre apart become one.  Triangles whose
 * corners run backward are turned.  Nothing is made up: holes are not
 * filled, and no triangle is removed because its neighbours are missing.
 */
#include "mesh.h"
#include "stl_raw.h"
#include "vec.h"

#include <admesh/stl.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define JOIN_MM		0.001

/* Two facets that meet at more than this meet at a true edge. */
#define SMOOTH		(30 * PLAN_RADIAN)

static int fill(stl_file *s, const struct stl_raw *raw)
{
	stl_initialize(s);
	s->stats.type = inmemory;
	s->stats.number_of_facets = (int)raw->n;
	s->stats.original_num_facets = (int)raw->n;
	stl_allocate(s);
	if (stl_get_error(s))
		return EX_OSERR;
	for (uint32_t i = 0; i < raw->n; i++) {
		stl_facet f = { 0 };
		float normal[3];

		memcpy(f.vertex, raw->corner[i], sizeof(f.vertex));
		stl_calculate_normal(normal, &f);
		stl_normalize_vector(normal);
		memcpy(&f.normal, normal, sizeof(f.normal));
		s->facet_start[i] = f;
		stl_facet_stats(s, f, i == 0);
	}
	stl_get_size(s);
	return 0;
}

/* admesh hashes the bits of numbers: -0 and 0 have to be one. */
static void scale(struct stl_raw *raw, const struct mesh_load *from)
{
	for (uint32_t i = 0; i < raw->n; i++)
		for (int k = 0; k < 9; k++) {
			float *x = &raw->corner[i][k / 3][k % 3];

			*x = (float)((double)*x * from->unit_mm) + 0.0f;
		}
}

static bool is_open(const stl_file *s)
{
	return s->stats.connected_facets_3_edge < s->stats.number_of_facets;
}

/* Corners are moved where edges are open; how far goes into what is kept. */
static int connect_edges(stl_file *s, struct stl_raw *raw,
			 struct mesh_findings *f)
{
	struct stl_welded welded;
	uint32_t doubled;
	int err = fill(s, raw);

	if (err)
		return err;
	stl_check_facets_exact(s);
	if (!is_open(s))
		return 0;
	stl_close(s);
	stl_initialize(s);
	err = stl_raw_weld(raw, JOIN_MM, &welded);
	if (err == 0)
		err = stl_raw_drop_doubles(raw, &doubled);
	if (err == 0)
		err = fill(s, raw);
	if (err)
		return err;
	stl_check_facets_exact(s);
	f->joined = welded.moved;
	f->joined_mm = welded.most;
	f->doubled += doubled;
	return 0;
}

static int mend(stl_file *s, struct stl_raw *raw, struct mesh_findings *f)
{
	const int err = connect_edges(s, raw, f);

	f->degenerate = (uint32_t)s->stats.degenerate_facets;
	if (err || s->stats.number_of_facets < 4)
		return err;
	stl_fix_normal_directions(s);
	f->turned = (uint32_t)s->stats.facets_reversed;
	stl_generate_shared_vertices(s);
	return 0;
}

static int take(struct mesh *m, const stl_file *s, const double shift[3])
{
	m->ntris = (uint32_t)s->stats.number_of_facets;
	m->nverts = (uint32_t)s->stats.shared_vertices;
	m->vert = malloc(m->nverts * sizeof(*m->vert));
	m->tri = malloc(m->ntris * sizeof(*m->tri));
	if (!m->vert || !m->tri)
		return EX_OSERR;
	for (uint32_t i = 0; i < m->nverts; i++) {
		m->vert[i][0] = (double)s->v_shared[i].x + shift[0];
		m->vert[i][1] = (double)s->v_shared[i].y + shift[1];
		m->vert[i][2] = (double)s->v_shared[i].z + shift[2];
	}
	for (uint32_t i = 0; i < m->ntris; i++)
		for (int k = 0; k < 3; k++)
			m->tri[i][k] = (uint32_t)s->v_indices[i].vertex[k];
	mesh_bounds(m);
	return 0;
}

static void normal_of(const struct mesh *m, uint32_t i, double ret[3])
{
	double u[3], v[3];

	v_sub(mesh_corner(m, i, 1), mesh_corner(m, i, 0), u);
	v_sub(mesh_corner(m, i, 2), mesh_corner(m, i, 0), v);
	v_cross(u, v, ret);
}

/*
 * A chord of length h, with an angle to the next one, belongs to a circle that
 * bulges out of it by h tan(angle / 4) / 2.  Where the surface is hollow, it
 * bulges into the body and takes nothing from the clearance.
 */
static double bulge(const struct mesh *m, uint32_t i, uint32_t k, uint32_t j)
{
	const double *a = mesh_corner(m, i, k), *b = mesh_corner(m, i,
								 (k + 1) % 3);
	double n[3], o[3], x[3], edge[3], area, other, angle, h;

	normal_of(m, i, n);
	normal_of(m, j, o);
	area = v_length(n);
	other = v_length(o);
	if (!(area > 0) || !(other > 0))
		return 0;
	v_sub(b, a, edge);
	v_cross(n, o, x);
	angle = atan2(v_dot(x, edge) / v_length(edge), v_dot(n, o));
	if (angle <= 0 || angle > SMOOTH)
		return 0;
	h = fmin(area, other) / v_length(edge);
	return h * tan(angle / 4) / 2;
}

/* A triangle of a shell that was turned has its corners in another order than
 * admesh has them: @at is where its edge @k is now. */
static uint32_t edge_now(const struct mesh *m, uint32_t i, uint32_t k,
			 const stl_file *s)
{
	const bool turned = m->tri[i][1] !=
			    (uint32_t)s->v_indices[i].vertex[1];

	return turned ? 2 - k : k;
}

static void judge_edges(const struct mesh *m, const stl_file *s,
			struct mesh_findings *f)
{
	for (uint32_t i = 0; i < m->ntris; i++) {
		for (uint32_t k = 0; k < 3; k++) {
			const int j = s->neighbors_start[i].neighbor[k];

			if (j < 0) {
				f->open_tri = f->open++ ? f->open_tri : i;
				continue;
			}
			f->chord_mm = fmax(f->chord_mm,
					   bulge(m, i, edge_now(m, i, k, s),
						 (uint32_t)j));
		}
	}
}

static int mended(struct mesh *m, const struct mesh_load *from,
		  struct stl_raw *raw, struct mesh_findings *f)
{
	stl_file s;
	int err;

	scale(raw, from);
	err = stl_raw_drop_doubles(raw, &f->doubled);
	if (err)
		return err;
	err = mend(&s, raw, f);
	if (err == 0 && s.stats.number_of_facets < 4) {
		fprintf(stderr, "edm-plan: %s: %u triangles are left of %u, "
			"the others have no area or are there twice; a closed "
			"body\n", from->path,
			(unsigned int)s.stats.number_of_facets, f->in_file);
		err = EX_DATAERR;
	}
	if (err == 0)
		err = take(m, &s, from->shift_mm);
	if (err == 0)
		err = mesh_turn_shells(m, f) ? EX_OSERR : 0;
	if (err == 0)
		judge_edges(m, &s, f);
	stl_close(&s);
	return err;
}

int mesh_load(struct mesh *m, const struct mesh_load *from,
	      struct mesh_findings *f)
{
	struct stl_raw raw;
	double far = 0;
	int err = stl_raw_read(from->path, &raw);

	*m = (struct mesh) { .name = from->path };
	*f = (struct mesh_findings) { .in_file = raw.n };
	if (err)
		return err;
	err = mended(m, from, &raw, f);
	free(raw.corner);
	if (err == EX_OSERR)
		fprintf(stderr, "edm-plan: %s: out of memory\n", from->path);
	if (err) {
		mesh_free(m);
		return err;
	}
	for (int k = 0; k < 3; k++)
		far = fmax(far, fmax(fabs(m->min[k] - from->shift_mm[k]),
				     fabs(m->max[k] - from->shift_mm[k])));
	f->grain_mm = far * 0x1p-24;
	return 0;
}
