/* SPDX-License-Identifier: Apache-2.0 */
/*
 * measure.h - print the distance at given poses
 */
#ifndef PLAN_MEASURE_H
#define PLAN_MEASURE_H

#include "job.h"

/**
 * measure_poses() - do what --measure asks.
 *
 * Each line of the file has the places of X Y Z A B C.  For each it prints the
 * distance, the two nearest triangles, counted from 1, and their nearest
 * points.
 *
 * Return: 0 or a sysexits code.
 */
int measure_poses(struct job *j);

#endif /* PLAN_MEASURE_H */
