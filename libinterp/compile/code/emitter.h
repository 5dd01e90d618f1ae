/* SPDX-License-Identifier: Apache-2.0 */
/* emitter.h - what the writers of programs have in common */
#ifndef CODE_EMIT_H
#define CODE_EMIT_H

#include "interp/emit.h"
#include "interp/program.h"

#include <stddef.h>

/** emit_node_sub() - where axis @axis stands at node @node, subpulses. */
int64_t emit_node_sub(const struct interp_program *p, size_t node,
		      uint32_t axis);

/** emit_moved() - mask of the axes whose place differs over segment @i. */
uint32_t emit_moved(const struct interp_program *p, uint32_t i);

/** emit_mm() - subpulses of @axis in mm. */
static inline double emit_mm(const struct interp_program *p, uint32_t axis,
			     int64_t sub)
{
	return (double)sub / INTERP_SUB * p->head->pulse_mm[axis];
}

/** emit_line() - one formatted line to the sink. */
int emit_line(const struct interp_sink *to, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/** emit_refuse() - fill the diag with a source line. Return: -EINVAL. */
int emit_refuse(struct interp_diag *diag, uint32_t line, const char *wanted,
		const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/**
 * emit_refuse_sensed() - refuse a motion that ends where the machine says.
 *
 * As a plain motion it would cut to the farthest place that it may reach.
 *
 * Return: 0 or -EINVAL.
 */
int emit_refuse_sensed(struct interp_diag *diag, const struct interp_seg *seg);

/** emit_kind_name() - of a segment, for a refusal. */
const char *emit_kind_name(uint8_t kind);

#endif /* CODE_EMIT_H */
