/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.c - from a dense program to the fewest blocks
 */
#include "plan.h"

#include <sysexits.h>

int plan_program(struct job *j)
{
	(void)j;
	fprintf(stderr, "edm-plan: it proves programs as yet; --check\n");
	return EX_USAGE;
}
