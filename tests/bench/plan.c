/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.c - what the core of edm-plan costs with two bodies and a dense program
 *
 *	plan PART ELECTRODE MACHINE DENSE
 *
 * It prints one line: the number of triangles; the seconds to load both bodies
 * and to build both trees; the milliseconds of a distance at the poses of the
 * program, median and worst, each asked once without a first pair and once with
 * the pair of the pose before; the milliseconds of the proof of a block, the
 * middle one of four; and for all blocks how many poses were looked at.  The
 * times are CPU time, so that a busy machine matters less. tests/bench/plan
 * runs it.
 */
#include "bench.h"
#include "job.h"

#include "interp/kinematics.h"

#include <string.h>

#define BLOCKS		4
#define KEEP_MM		0.1

static double cpu_s(void)
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* Of all nodes that are not rapid: ms, sorted. */
static uint32_t distances(const struct job *j, const struct route *w, bool warm,
			  double *ms)
{
	struct near_pair pair = { 0 };
	uint32_t n = 0;

	for (uint32_t i = 1; i < w->n; i++) {
		struct pose pose;
		double from;

		if (w->node[i].rapid)
			continue;
		motion_pose(&j->motion, w->node[i].q, &pose);
		if (!warm)
			pair = (struct near_pair) { 0 };
		from = cpu_s();
		near_distance(&j->bodies, &pose, &pair);
		ms[n++] = 1e3 * (cpu_s() - from);
	}
	qsort(ms, n, sizeof(*ms), bench_order);
	return n;
}

/* Blocks that reach over a quarter of the way each. */
static double proofs(const struct job *j, const struct route *w,
		     uint64_t *poses)
{
	uint32_t first = 1;
	double ms[BLOCKS];

	while (w->node[first].rapid)
		first++;
	for (uint32_t i = 0; i < BLOCKS; i++) {
		const uint32_t all = w->n - 1 - first;
		struct proof p = { 0 };
		struct clearance c;
		struct block b;
		double from;

		clearance_init(&c, KEEP_MM);
		block_init(&b, &j->motion,
			   w->node[first + all * i / BLOCKS].q,
			   w->node[first + all * (i + 1) / BLOCKS].q);
		from = cpu_s();
		bench_must(prove_block(&j->bodies, &b, &c, &p));
		ms[i] = 1e3 * (cpu_s() - from);
		*poses += p.queries;
	}
	return bench_median(ms, BLOCKS);
}

int main(int argc, char **argv)
{
	static struct job j;
	struct job_options o = { .unit_mm = 1,
				 .any_size = true,
				 .quiet = true };
	struct mesh_load load = { .unit_mm = 1 };
	struct route_text text = { 0 };
	struct mesh_findings found;
	struct route w;
	uint64_t poses = 0;
	double t[3], *ms;
	uint32_t n;

	bench_must(argc == 5);
	o.part = argv[1];
	o.electrode = argv[2];
	o.machine_file = argv[3];
	text.path = argv[4];
	bench_must(job_load(&j, &o) == 0);
	bench_must(route_read(&w, &j.config, &text) == 0);
	job_free(&j);
	t[0] = cpu_s();
	load.path = o.part;
	bench_must(mesh_load(&j.part, &load, &found) == 0);
	load.path = o.electrode;
	bench_must(mesh_load(&j.tool, &load, &found) == 0);
	t[1] = cpu_s();
	bench_must(tree_build(&j.part_tree, &j.part) == 0);
	bench_must(tree_build(&j.tool_tree, &j.tool) == 0);
	t[2] = cpu_s();
	ms = calloc(w.n, sizeof(*ms));
	bench_must(ms != NULL);
	printf("%u %.3f %.3f", j.part.ntris + j.tool.ntris, t[1] - t[0],
	       t[2] - t[1]);
	for (int warm = 0; warm < 2; warm++) {
		n = distances(&j, &w, warm, ms);
		printf(" %.3f %.3f", ms[n / 2], ms[n - 1]);
	}
	printf(" %.2f", proofs(&j, &w, &poses));
	printf(" %llu\n", (unsigned long long)poses);
	free(ms);
	route_free(&w);
	job_free(&j);
	return 0;
}
