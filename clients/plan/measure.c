/* SPDX-License-Identifier: Apache-2.0 */
/*
 * measure.c - the distance at given poses
 */
#include "measure.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define MEASURED	6		/* axes of a line */

static bool read_pose(const char *line, double q[INTERP_NAXES])
{
	memset(q, 0, INTERP_NAXES * sizeof(*q));
	for (int k = 0; k < MEASURED; k++) {
		char *end;

		q[k] = strtod(line, &end);
		if (end == line || !(fabs(q[k]) <= 1e6))
			return false;
		line = end + (*end == ',');
	}
	return line[strspn(line, " \t\r\n")] == '\0';
}

static void measure(const struct job *j, const double q[INTERP_NAXES],
		    struct near_pair *pair)
{
	struct pose pose;

	motion_pose(&j->motion, q, &pose);
	near_distance(&j->bodies, &pose, pair);
	printf("%.9g %u %u %.9g %.9g %.9g %.9g %.9g %.9g\n", pair->mm,
	       j->part_tree.id[pair->part] + 1,
	       j->tool_tree.id[pair->tool] + 1, pair->p[0], pair->p[1],
	       pair->p[2], pair->q[0], pair->q[1], pair->q[2]);
}

int measure_poses(struct job *j)
{
	const bool standard = strcmp(j->o->program, "-") == 0;
	FILE *f = standard ? stdin : fopen(j->o->program, "r");
	struct near_pair pair = { 0 };
	double q[INTERP_NAXES];
	char *line = NULL;
	size_t room = 0;
	uint32_t n = 0;
	int err = 0;

	if (!f) {
		fprintf(stderr, "edm-plan: %s: %s; a file of poses\n",
			j->o->program, strerror(errno));
		return EX_NOINPUT;
	}
	while (err == 0 && getline(&line, &room, f) > 0) {
		n++;
		if (read_pose(line, q)) {
			measure(j, q, &pair);
		} else {
			fprintf(stderr, "%s:%u: error: not a pose; six "
				"numbers, X Y Z A B C\n", j->o->program, n);
			err = EX_DATAERR;
		}
	}
	free(line);
	if (!standard)
		fclose(f);
	return err;
}
