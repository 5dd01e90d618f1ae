/* SPDX-License-Identifier: Apache-2.0 */
/*
 * measure.h - the distance at given poses
 */
#ifndef PLAN_MEASURE_H
#define PLAN_MEASURE_H

#include "job.h"

/**
 * measure_poses() - what --measure does.
 *
 * For each line of axes X Y Z A B C of the file it prints the distance, the two
 * triangles, counted from 1, and the two points.
 *
 * Return: 0 or a sysexits code.
 */
int measure_poses(struct job *j);

#endif /* PLAN_MEASURE_H */
