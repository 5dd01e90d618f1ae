/* SPDX-License-Identifier: Apache-2.0 */
/*
 * values.h - the condition in force, and the value of each of its fields
 *
 * A value is the one that was set while the job runs. Without one it is that of
 * the program's condition, and without that it is that of the machine file.
 *
 * Threads: one, that of the event loop.
 */
#ifndef VALUES_VALUES_H
#define VALUES_VALUES_H

#include "shm.h"

#include <jansson.h>

struct interp_tech;
struct machine_config;
struct values;

/** values_create() - Return: NULL if there is no memory. */
struct values *values_create(const struct machine_config *config);
/** values_destroy() - NULL is allowed. */
void values_destroy(struct values *v);

/**
 * values_fill() - put "condition", "values", "set", what the generator tells,
 * "told", and its own "generator_fault" in words into @to.  Without @status
 * (NULL) they are the values of the machine file.
 */
void values_fill(struct values *v, const struct shm_status *status,
		 const struct shm_snapshot *s, json_t *to);

/** values_json() - an object of the fields that @t has, by their names. */
json_t *values_json(const struct interp_tech *t);

/** values_fields() - name, unit and range of every field, for hello. */
json_t *values_fields(void);

#endif /* VALUES_VALUES_H */
