/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs_tech.h - the technology table on the host: functions of rows in verbs.c
 *
 * What is bad is refused with its line and its field, and the file stays as it
 * is.
 */
#ifndef JOBS_VERBS_TECH_H
#define JOBS_VERBS_TECH_H

#include "verb.h"

/* text: lines C120.servo_v=30, or =-. */
void verbs_tech_set(struct jobs *j, const struct verb *v,
		    const struct jobs_lcm_command *c);
/* text: the table. */
void verbs_tech_save(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c);
/* arg: the number of a version. */
void verbs_tech_back(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c);
void verbs_tech_text(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c);
/* All of them. */
void verbs_tech_versions(struct jobs *j, const struct verb *v,
			 const struct jobs_lcm_command *c);

#endif /* JOBS_VERBS_TECH_H */
