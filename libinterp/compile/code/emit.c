/* SPDX-License-Identifier: Apache-2.0 */
/* emit.c - what the writers of programs have in common */
#include "code/emitter.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

int64_t emit_node_sub(const struct interp_program *p, size_t node,
		      uint32_t axis)
{
	const struct interp_program_head *h = p->head;

	for (uint32_t j = 0; j < h->naxes; j++) {
		if (h->column[j] == axis)
			return p->nodes[node * h->naxes + j];
	}
	return (int64_t)h->start_pulses[axis] * INTERP_SUB;
}

uint32_t emit_moved(const struct interp_program *p, uint32_t i)
{
	const struct interp_program_head *h = p->head;
	const int64_t *from = p->nodes + (size_t)i * h->naxes;
	const int64_t *to = from + h->naxes;
	uint32_t moved = 0;

	for (uint32_t j = 0; j < h->naxes; j++)
		moved |= (uint32_t)(from[j] != to[j]) << h->column[j];
	return moved;
}

int emit_line(const struct interp_sink *to, const char *format, ...)
{
	char s[512];
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(s, sizeof(s), format, ap);
	va_end(ap);
	if (n < 0 || (size_t)n >= sizeof(s))
		return -EOVERFLOW;
	return to->put(to->arg, s, (size_t)n);
}

int emit_refuse(struct interp_diag *diag, uint32_t line, const char *wanted,
		const char *found, ...)
{
	va_list ap;

	diag->line = line;
	diag->column = 1;		/* the whole line */
	snprintf(diag->wanted, sizeof(diag->wanted), "%s", wanted);
	va_start(ap, found);
	interp_diag_print(diag->found, sizeof(diag->found), found, ap);
	va_end(ap);
	return -EINVAL;
}

int emit_refuse_sensed(struct interp_diag *diag, const struct interp_seg *seg)
{
	if (!(seg->flags & INTERP_SEG_SENSED))
		return 0;
	return emit_refuse(diag, seg->line, "moves with an end of their own",
			   "a move until %s",
			   seg->flags & INTERP_SEG_PROBE ? "contact" :
			   seg->flags & INTERP_SEG_HALF ?
			   "half between two contacts" :
			   "the end of the travel");
}

const char *emit_kind_name(uint8_t kind)
{
	static const char *const names[INTERP_NKINDS] = {
		[INTERP_LINE]		= "a line",
		[INTERP_ARC]		= "an arc",
		[INTERP_PAIR]		= "two contours at once",
		[INTERP_CURVE]		= "a curve",
		[INTERP_BEGIN]		= "the beginning",
		[INTERP_DWELL]		= "a dwell",
		[INTERP_STOP]		= "a stop",
		[INTERP_OPTIONAL_STOP]	= "an optional stop",
		[INTERP_AUX]		= "a switched output",
		[INTERP_MCODE]		= "an M code for the PLC",
		[INTERP_ELECTRODE]	= "an electrode",
		[INTERP_TIMED]		= "a cycle with a time (S)",
		[INTERP_TIMED_END]	= "the end of a cycle with a time",
		[INTERP_END]		= "the end",
	};

	return kind < INTERP_NKINDS && names[kind] ? names[kind] :
						     "a segment of its kind";
}
