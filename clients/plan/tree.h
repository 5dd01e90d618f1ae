/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tree.h - a mesh in a tree of oriented boxes
 *
 * Every box contains its triangles completely.  It is turned so that it is thin
 * where they are, so a thin curved wall has thin boxes.  The two children of a
 * node are neighbours in the array.  Triangles are copied in the order of the
 * leaves.
 *
 * Units: mm.  Threads: once built it is only read.
 */
#ifndef PLAN_TREE_H
#define PLAN_TREE_H

#include "box.h"
#include "mesh.h"
#include "tri.h"

#define TREE_LEAF	1

struct tree {
	const struct mesh *mesh;	/* lent */
	struct box *node;		/* node[0] is the root */
	uint32_t nnodes, ntris;
	struct triangle *tri;
	double (*plane)[4];		/* for each triangle, its unit normal
					 * and its height; zeros: no area */
	uint32_t *id;			/* for each triangle, its number in the
					 * mesh */
};

/** tree_build() - Return: 0 or -ENOMEM; @m is not empty. */
int tree_build(struct tree *t, const struct mesh *m);

/** tree_free() - @t may be all zeros. */
void tree_free(struct tree *t);

#endif /* PLAN_TREE_H */
