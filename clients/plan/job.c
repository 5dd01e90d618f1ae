/* SPDX-License-Identifier: Apache-2.0 */
/*
 * job.c - load machine and bodies, and refuse what cannot be meant
 */
#include "job.h"

#include "compiling.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* More than the gap, so that the walls are not eroded on the way in. */
#define GAP_MORE_MM	0.05

static int load_machine(struct job *j)
{
	const char *path = j->o->machine_file;
	struct interp_diag d = { 0 };
	int err = 0;

	config_defaults(&j->config);
	if (path)
		err = config_read(&j->config, path, &d);
	if (err == -EINVAL) {
		interp_diag_tell(&d, path);
		return EX_CONFIG;
	}
	if (err < 0) {
		fprintf(stderr, "edm-plan: %s: %s; a machine file\n", path,
			strerror(-err));
		return EX_NOINPUT;
	}
	err = config_kinematics(&j->config, &j->kin, &d);
	if (err == -EINVAL) {
		interp_diag_tell(&d, path);
		return EX_CONFIG;
	}
	if (err == -ENOENT) {
		interp_kin_clear(&j->kin);
		fprintf(stderr, "edm-plan: %s: no chain in [kinematics]; X Y Z "
			"alone move the electrode\n",
			path ? path : "the built-in machine");
	}
	return 0;
}

/* -- Is it a body, and of a size that can be meant? ----------------------- */

static void say_tri(const struct mesh *m, uint32_t i, FILE *f)
{
	fprintf(f, "triangle %u", i + 1);
	for (uint32_t k = 0; k < 3; k++) {
		const double *c = mesh_corner(m, i, k);

		fprintf(f, "%s(%.4g %.4g %.4g)", k ? "-" : " ", c[0], c[1],
			c[2]);
	}
}

#define NO_TRI		UINT32_MAX

/* @tri: one triangle or two. */
static int refuse_flaw(const struct mesh *m, const char *what,
		       const uint32_t tri[2], const char *wanted)
{
	fprintf(stderr, "edm-plan: %s: %s, ", m->name, what);
	say_tri(m, tri[0], stderr);
	if (tri[1] != NO_TRI) {
		fputs(" and ", stderr);
		say_tri(m, tri[1], stderr);
	}
	fprintf(stderr, "; %s, or --accept-flaws\n", wanted);
	return EX_DATAERR;
}

static int check_body(const struct job *j, const struct tree *t,
		      struct mesh_findings *f)
{
	const struct mesh *m = t->mesh;
	const uint32_t first[2] = { 0, NO_TRI };
	const uint32_t open[2] = { f->open_tri, NO_TRI };
	const double size = mesh_size_mm(m);
	char what[80];

	f->crossings = mesh_crossings(t, f->cross_tri);
	if (j->o->accept_flaws)
		return 0;
	if (!(f->volume_mm3 > 1e-9 * size * size * size))
		return refuse_flaw(m, "no volume", first, "a closed body");
	if (f->open) {
		snprintf(what, sizeof(what), "%u open edges", f->open);
		return refuse_flaw(m, what, open, "a closed body: an open one "
				   "has no inside");
	}
	if (f->crossings) {
		snprintf(what, sizeof(what), "%s%u pairs of triangles cross",
			 f->crossings >= 1000 ? "over " : "", f->crossings);
		return refuse_flaw(m, what, f->cross_tri,
				   "a body that does not cross itself");
	}
	return 0;
}

static int check_size(const struct job *j, const struct mesh *m)
{
	const double size = mesh_size_mm(m);

	if (j->o->any_size || (size >= 1 && size <= 10000))
		return 0;
	fprintf(stderr, "edm-plan: %s: %.4g mm long; --unit inch or --unit m "
		"if its numbers are not mm, --any-size if they are\n", m->name,
		size);
	return EX_DATAERR;
}

static int check_place(const struct job *j, const struct mesh *m,
		       const char *option)
{
	for (int k = 0; k < 3 && !j->o->any_size; k++) {
		const double far = (m->min[k] + m->max[k]) / 2;

		if (fabs(far) <= 10000)
			continue;
		fprintf(stderr, "edm-plan: %s: its middle is at %c %.6g mm; a "
			"mesh in the frame of the machine, %s to move it, or "
			"--any-size if it is meant\n", m->name, "XYZ"[k], far,
			option);
		return EX_DATAERR;
	}
	return 0;
}

bool job_are_apart(const struct job *j, double mm)
{
	return mm > mesh_size_mm(&j->part) || mm > mesh_size_mm(&j->tool);
}

static int check_sizes(const struct job *j)
{
	const double a = mesh_size_mm(&j->part), b = mesh_size_mm(&j->tool);
	int err = check_size(j, &j->part);

	if (err == 0)
		err = check_size(j, &j->tool);
	if (err == 0)
		err = check_place(j, &j->part, "--part-at");
	if (err == 0)
		err = check_place(j, &j->tool, "--electrode-at");
	if (err || j->o->any_size || (a < 20 * b && b < 20 * a))
		return err;
	fprintf(stderr, "edm-plan: part and electrode are %.4g and %.4g mm "
		"long; both in one unit, mm or --unit inch, or --any-size if "
		"they are\n", a, b);
	return EX_DATAERR;
}

static int load_body(const struct job *j, const struct mesh_load *from,
		     struct mesh *m, struct mesh_findings *f, struct tree *t)
{
	int err = mesh_load(m, from, f);

	if (err == 0 && tree_build(t, m)) {
		fprintf(stderr, "edm-plan: %s: out of memory\n", from->path);
		err = EX_OSERR;
	}
	return err ? err : check_body(j, t, f);
}

static int load_bodies(struct job *j)
{
	struct mesh_load from = { .path = j->o->part,
				  .unit_mm = j->o->unit_mm };
	int err;

	memcpy(from.shift_mm, j->o->part_at, sizeof(from.shift_mm));
	err = load_body(j, &from, &j->part, &j->part_found, &j->part_tree);
	if (err)
		return err;
	from.path = j->o->electrode;
	for (int k = 0; k < 3; k++)
		from.shift_mm[k] = j->o->electrode_at[k] + j->kin.tip_mm[k];
	err = load_body(j, &from, &j->tool, &j->tool_found, &j->tool_tree);
	return err ? err : check_sizes(j);
}

/* Sparks ignite over the whole gap, so the clearance has to be all of it. */
static void choose_clearance(struct job *j)
{
	const double guess = j->part_found.chord_mm + j->tool_found.chord_mm;

	j->clear_mm = j->o->clearance_mm >= 0 ? j->o->clearance_mm :
		      j->config.sim.open_gap_mm + GAP_MORE_MM;
	j->chord_mm = (j->o->chord_mm >= 0 ? j->o->chord_mm : guess) +
		      j->part_found.grain_mm + j->tool_found.grain_mm +
		      j->part_found.joined_mm + j->tool_found.joined_mm;
}

int job_load(struct job *j, const struct job_options *o)
{
	int err;

	*j = (struct job) { .o = o };
	err = load_machine(j);
	if (err == 0)
		err = load_bodies(j);
	if (err)
		return err;
	proved_init(&j->proved);
	j->bodies = (struct bodies) { &j->part_tree, &j->tool_tree,
				      &j->proved };
	motion_init(&j->motion, &j->kin, &j->tool);
	choose_clearance(j);
	return 0;
}

void job_free(struct job *j)
{
	tree_free(&j->part_tree);
	tree_free(&j->tool_tree);
	mesh_free(&j->part);
	mesh_free(&j->tool);
}

/* -- Words ---------------------------------------------------------------- */

/* admesh turns the triangles of a shell to run as its first one.  If the shell
 * is inside out after that, it was the first one that ran backward. */
static void describe_turned(const struct mesh *m, const struct mesh_findings *f,
			    FILE *out)
{
	const bool odd = f->shells == 1 && f->inverted && f->turned;
	const uint32_t turned = odd ? m->ntris - f->turned : f->turned;

	if (turned)
		fprintf(out, "           %u triangles that ran backward are "
			"turned\n", turned);
	if (!f->inverted || odd)
		return;
	fprintf(out, "           inside and outside are exchanged in %u of %u "
		"shells: ", f->inverted, f->shells);
	say_tri(m, f->inverted_tri, out);
	fputc('\n', out);
}

static void describe_body(const char *what, const struct mesh *m,
			  const struct mesh_findings *f, FILE *out)
{
	fprintf(out, "%-10s %s: %u triangles, %.4g x %.4g x %.4g mm, "
		"%.6g mm3\n", what, m->name, m->ntris, m->max[0] - m->min[0],
		m->max[1] - m->min[1], m->max[2] - m->min[2], f->volume_mm3);
	if (f->doubled)
		fprintf(out, "           %u triangles that are there twice are "
			"removed\n", f->doubled);
	if (f->degenerate)
		fprintf(out, "           %u triangles without area are "
			"removed\n", f->degenerate);
	if (f->joined)
		fprintf(out, "           %u corners that nearly meet are "
			"joined, by %.4f mm at most\n", f->joined,
			f->joined_mm);
	describe_turned(m, f, out);
	if (f->open)
		fprintf(out, "           %u open edges: it has no inside\n",
			f->open);
	if (f->crossings)
		fprintf(out, "           %u pairs of triangles cross\n",
			f->crossings);
	if (f->grain_mm > 0.0005)
		fprintf(out, "           so far from the origin its numbers "
			"are %.4f mm coarse\n", f->grain_mm);
}

void job_describe(const struct job *j, FILE *f)
{
	describe_body("part", &j->part, &j->part_found, f);
	describe_body("electrode", &j->tool, &j->tool_found, f);
	fprintf(f, "clearance  %.3f mm%s, and %.4f mm for the chords of the "
		"meshes%s\n", j->clear_mm,
		j->o->clearance_mm < 0 ? " (the gap and 0.05 mm)" : "",
		j->chord_mm, j->o->chord_mm < 0 ? " (guessed)" : "");
}

void job_say_pair(const struct job *j, const struct near_pair *pair, FILE *f)
{
	fprintf(f, "  part's ");
	say_tri(&j->part, j->part_tree.id[pair->part], f);
	fprintf(f, "\n  electrode's ");
	say_tri(&j->tool, j->tool_tree.id[pair->tool], f);
	fprintf(f, "\n  nearest at %.4f %.4f %.4f of the part\n", pair->p[0],
		pair->p[1], pair->p[2]);
}

/* -- Inside --------------------------------------------------------------- */

static bool any_inside(const struct mesh *of, const struct mesh *in,
		       const struct pose *to_in, const uint32_t *vert,
		       uint32_t n)
{
	for (uint32_t i = 0; i < n; i++) {
		double p[3];

		rot_apply(&to_in->r, of->vert[vert[i]], p);
		v_add(p, to_in->t, p);
		if (fabs(mesh_winding(in, p)) > 0.5)
			return true;
	}
	return false;
}

static struct pose inverse(const struct pose *p)
{
	struct pose ret;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			ret.r.m[i][k] = p->r.m[k][i];
	rot_apply(&ret.r, p->t, ret.t);
	for (int i = 0; i < 3; i++)
		ret.t[i] = -ret.t[i];
	return ret;
}

int job_inside(const struct job *j, const struct pose *pose, char *say,
	       size_t size)
{
	const struct pose back = inverse(pose);
	uint32_t *of_tool = NULL, *of_part = NULL;
	const uint32_t ntool = mesh_shells(&j->tool, &of_tool);
	const uint32_t npart = mesh_shells(&j->part, &of_part);
	int err = 0;

	if (ntool == 0 || npart == 0) {
		err = -1;
	} else if (any_inside(&j->tool, &j->part, pose, of_tool, ntool)) {
		snprintf(say, size, "the electrode is inside the part");
		err = 1;
	} else if (any_inside(&j->part, &j->tool, &back, of_part, npart)) {
		snprintf(say, size, "the part is inside the electrode");
		err = 1;
	}
	free(of_tool);
	free(of_part);
	return err;
}

/* -- Blocks of a way ------------------------------------------------------ */

void job_block(const struct job *j, const struct route *w, uint32_t i,
	       struct block *ret)
{
	block_init(ret, &j->motion, w->node[i].q, w->node[i + 1].q);
}

double job_strays_mm(const struct route *w, uint32_t i, const struct block *b)
{
	double off[INTERP_NAXES];

	for (int k = 0; k < INTERP_NAXES; k++)
		off[k] = w->lattice[k] + (double)w->node[i + 1].strays;
	return motion_strays_mm(b, off);
}

bool job_moves_known(const struct job *j, const struct route *w,
		     const char *path)
{
	const uint32_t known = motion_moves(&j->motion);

	for (uint32_t i = 1; i < w->n; i++) {
		for (int k = 0; k < INTERP_NAXES; k++) {
			if (known & 1u << k ||
			    w->node[i].q[k] == w->node[i - 1].q[k])
				continue;
			fprintf(stderr, "%s:%u: error: axis %c moves, and "
				"chain of [kinematics] does not say what it "
				"moves; a chain with %c\n", path,
				w->node[i].line,
				INTERP_AXIS_LETTERS[k], INTERP_AXIS_LETTERS[k]);
			return false;
		}
	}
	return true;
}

void job_axes_find(const struct job *j, const double from[INTERP_NAXES],
		   const double to[INTERP_NAXES], struct job_axes *ret)
{
	const uint32_t moves = motion_moves(&j->motion) &
			       j->config.axes.present;
	struct block b;

	*ret = (struct job_axes) { 0 };
	block_init(&b, &j->motion, from, to);
	for (uint32_t i = 0; i < INTERP_NAXES; i++)
		if (moves & 1u << i)
			ret->axis[ret->n++] = (enum interp_axis)i;
	for (uint32_t i = 0; i < j->kin.njoints; i++) {
		const enum interp_axis a = j->kin.joint[i].axis;

		ret->reach_mm[a] = b.reach_mm[i] * (interp_axis_is_rotary(a) ?
						    PLAN_RADIAN : 1);
	}
}
