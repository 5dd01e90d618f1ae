/* SPDX-License-Identifier: Apache-2.0 */
/*
 * history.h - what a job came to: as text, as CSV, as a picture
 */
#ifndef CTL_HISTORY_H
#define CTL_HISTORY_H

#include "ctl.h"

/** history_print() - sums, conditions and faults of the JSON of one job. */
void history_print(json_t *job);

/** history_csv() - all jobs that have ended, or job c->arg, on stdout. */
int history_csv(struct ctl *c);

/** history_picture() - job c->arg as an SVG file, c->picture. */
int history_picture(struct ctl *c);

#endif /* CTL_HISTORY_H */
