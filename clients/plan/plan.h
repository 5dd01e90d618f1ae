/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.h - from a dense program or an end pose to the fewest blocks
 */
#ifndef PLAN_PLAN_H
#define PLAN_PLAN_H

#include "job.h"

/** plan_program() - plan, prove, write. Return: 0, 1 no way; else sysexits. */
int plan_program(struct job *j);

#endif /* PLAN_PLAN_H */
