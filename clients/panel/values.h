/* SPDX-License-Identifier: Apache-2.0 */
/*
 * values.h - the condition in force, and the value of each of its fields
 *
 * A value is what was set while the job runs; else what the program's
 * condition gives; else the machine file's.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_VALUES_H
#define PANEL_VALUES_H

#include "shm.h"

#include <jansson.h>

struct machine_config;
struct values;

/** values_create() - NULL if there is no memory. */
struct values *values_create(const struct machine_config *config);
/** values_destroy() - NULL is fine. */
void values_destroy(struct values *v);

/**
 * values_fill() - "condition", "values" and "set" into @to.
 *
 * @status may be NULL: the machine file's values then.
 */
void values_fill(struct values *v, const struct shm_status *status,
		 const struct shm_snapshot *s, json_t *to);

/** values_fields() - name, unit, range of every field, for hello. */
json_t *values_fields(void);

#endif /* PANEL_VALUES_H */
