/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tree.h - a mesh in a tree of oriented boxes
 *
 * Every box holds its triangles whole and is turned along their spread, so a
 * thin curved wall has thin boxes.  The two children of a node stand side by
 * side.  Triangles are copied in the order of the leaves.
 *
 * Units: mm.  Threads: once built it is only read.
 */
#ifndef PLAN_TREE_H
#define PLAN_TREE_H

#include "mesh.h"
#include "tri.h"
#include "vec.h"

#define TREE_LEAF	2		/* triangles in a leaf, at most */

struct box {
	double centre[3];
	struct rot axis;		/* rows: unit vectors */
	double half[3];
};

struct tree_node {
	struct box box;
	uint32_t first;			/* child, or triangle of a leaf */
	uint32_t n;			/* triangles of a leaf; 0: not a leaf */
};

struct tree {
	const struct mesh *mesh;	/* lent */
	struct tree_node *node;		/* node[0] is the root */
	uint32_t nnodes, ntris;
	struct triangle *tri;
	double (*plane)[4];		/* of each, its unit normal and its
					 * height; zeros: it has no area */
	uint32_t *id;			/* of each, its number in the mesh */
};

/** tree_build() - Return: 0 or -ENOMEM; @m is not empty. */
int tree_build(struct tree *t, const struct mesh *m);

/** tree_free() - a zeroed tree is fine. */
void tree_free(struct tree *t);

#endif /* PLAN_TREE_H */
