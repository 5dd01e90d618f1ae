/* SPDX-License-Identifier: Apache-2.0 */
/* entry.c - the way into a program that begins at a place inside it */
#include "entry.h"

#include "interp/axis.h"
#include "interp/mcode_arg.h"

#include <stdarg.h>
#include <stdio.h>

/* A sinker comes in from above; a wire stands in its kerf. */
int config_way_out(const struct machine_config *c)
{
	const bool wire = c->wire.guides != INTERP_GUIDES_OFF ||
			  c->sim.process == PROCESS_WIRE;

	return wire || !(c->axes.present >> INTERP_Z & 1) ? -1 : INTERP_Z;
}

struct words {
	char *to;
	size_t size, n;
};

__attribute__((format(printf, 2, 3)))
static void say(struct words *w, const char *format, ...)
{
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(w->to + w->n, w->size - w->n, format, ap);
	va_end(ap);
	w->n = n < 0 || (size_t)n >= w->size - w->n ? w->size - 1 :
	       w->n + (size_t)n;
}

void config_entry_words(const struct machine_config *c,
			const struct interp_build_entry *e, char *to,
			size_t size)
{
	struct words w = { .to = to, .size = size };

	say(&w, "positions it to");
	for (int i = 0; i < INTERP_NAXES; i++)
		if (c->axes.present >> i & 1)
			say(&w, " %c%.3f", INTERP_AXIS_LETTERS[i],
			    e->entry_mm[i]);
	if (e->npassed)
		say(&w, "; not done again:");
	for (uint32_t i = 0; i < e->npassed; i++)
		say(&w, " M%u", interp_mcode_number(e->passed[i]));
	if (e->again)
		say(&w, "; told again, because the PLC had not answered: M%u",
		    interp_mcode_number(e->again));
	say(&w, ", off the work; then it ");
	if (e->far_mm <= e->from_mm && !e->next_line) {
		say(&w, "moves no more");
		return;
	}
	if (e->far_mm <= e->from_mm) {
		say(&w, "goes on with line %u", e->next_line);
		return;
	}
	if (config_way_out(c) < 0)
		say(&w, "stops for the wire to be threaded, ");
	say(&w, "comes in along its path, %.3f mm up to line %u, and %s",
	    e->far_mm - e->from_mm, e->line, e->dead ?
	    "goes on without power" : "cuts on from the first spark");
}
