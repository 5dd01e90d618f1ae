/* SPDX-License-Identifier: Apache-2.0 */
/* survey.h - the first reading of a trace: extent, events, where to zoom */
#ifndef PLOT_SURVEY_H
#define PLOT_SURVEY_H

#include "thin.h"

/** survey_read() - fill a zeroed @s. Return: 0, -ENODATA, -ENOMEM, -EINVAL. */
int survey_read(struct thin_survey *s, struct csv *c);

#endif /* PLOT_SURVEY_H */
