/* SPDX-License-Identifier: Apache-2.0 */
/* nc.c - reads NC code, line after line */
#include "code/dialect.h"
#include "code/macro.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a tape or a serial line has around a text: NUL where nothing is punched,
 * DEL where something was, and DC1 to DC4, which start and stop the other
 * side.  CP/M and DOS ended a text with ^Z, and some posts still do. */
static bool is_leader(uint8_t c)
{
	return c == 0 || c == 0x7f || (c >= 0x11 && c <= 0x14);
}

static const uint8_t *end_of(const uint8_t *text, const uint8_t *end)
{
	for (const uint8_t *p = end; p > text; p--) {
		if (p[-1] == 0x1a || is_leader(p[-1]))
			end = p - 1;
		else if (nc_classes[p[-1]] != NC_BLANK &&
			 nc_classes[p[-1]] != NC_EOL)
			break;
	}
	return end;
}

/* A byte order mark does not belong to the text. */
static void open_text(struct nc_reader *r, const char *text, size_t bytes)
{
	r->text = (const uint8_t *)text;
	r->end = end_of(r->text, r->text + bytes);
	if (bytes >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
		r->text += 3;
	while (r->text < r->end && is_leader(*r->text))
		r->text++;
	r->text_end = r->end;
	r->end = nc_tape_end(r->text, r->end);
	r->at = r->text;
	r->line_at = r->text;
	r->frame[0].entry = (struct nc_place) { .line = 1 };
}

/* If a program has no feed, the gap is what limits the speed. */
static double first_feed(const struct nc_reader *r)
{
	const struct interp_axis_limits *l = r->o->machine->axis;

	if (r->o->feed_mm_s > 0 || !r->d->no_feed)
		return r->o->feed_mm_s;
	return fmin(l[INTERP_X].v_max_mm_s, l[INTERP_Y].v_max_mm_s);
}

/* As if G21 G17 G90 G91.1 G54 G94 stood at the beginning. */
static void reset_modes(struct nc_reader *r)
{
	const struct interp_nc_options *o = r->o;

	memcpy(r->work_mm, o->work_offset_mm, sizeof(r->work_mm));
	memcpy(r->turn_deg, o->work_turn_deg, sizeof(r->turn_deg));
	r->figure.scale = 1;
	r->arc_incremental = !r->d->arc_places;
	r->lengths = r->d->point != NC_POINT_FREE ||
		     (o->notes && o->notes->plan) ? NC_LENGTHS : 0;
	if (r->d->point == NC_POINT_WANTED)
		r->lengths |= NC_ANGLES;
	r->feed_mm_s = first_feed(r);
	r->feed_deg_s = r->feed_mm_s;
	r->fresh = true;
	r->absent = NC_AXES & ~o->machine->present;
	r->segs_max = o->segs_max ? o->segs_max : INTERP_NC_SEGS_MAX;
	r->executed_max = o->executed_max ? o->executed_max :
					    INTERP_NC_EXECUTED_MAX;
	r->escape = o->escape;
	nc_set_lift(r);
	nc_set_units(r, r->d->inches);
	nc_set_offset(r);
}

static int refuse_executed(struct nc_reader *r)
{
	char wanted[160];

	snprintf(wanted, sizeof(wanted), "up to %u, with fewer repeats (L); a "
		 "long line counts once more for each %d bytes, %d with "
		 "variables", r->executed_max, NC_COUNTED_BYTES,
		 NC_COUNTED_MACRO);
	return nc_refuse_at(r, r->line, wanted,
			    "more than %u lines carried out", r->executed_max);
}

static inline int read_line(struct nc_reader *r)
{
	int err;

	r->line++;
	if (r->executed++ >= r->executed_max)
		return refuse_executed(r);
	if (nc_scan_again(r))
		return r->block.groups == NC_BIT(NC_MOTION) ?
		       nc_run_motion(r) : nc_run_groups(r, r->block.groups);
	r->pattern.n = 0;
	err = nc_scan_line(r);
	if (!err && r->o->notes && r->o->notes->plan)
		nc_note_line(r);
	if (!err)
		err = nc_run_line(r);
	if (!err)
		nc_note_pattern(r);
	return err;
}

int nc_read_line(struct nc_reader *r)
{
	return read_line(r);
}

static int read_lines(struct nc_reader *r)
{
	int err = 0;

	while (!err && !r->over && r->at < r->end)
		err = read_line(r);
	return err ? err : nc_end_of_text(r);
}

/* The number of lines in the text: those that the main program has read, and
 * the rest. */
static uint32_t count_lines(const struct nc_reader *r)
{
	const struct nc_place next = r->depth ? r->frame[1].back : nc_next(r);
	const uint8_t *p = r->text + next.offset;
	uint32_t n = next.line - 1;

	for (; p < r->text_end; n++)
		p = nc_line_next(nc_line_end(p, r->text_end), r->text_end);
	return n;
}

int interp_nc_compile(const struct interp_text *text,
		      const struct interp_nc_options *o,
		      struct interp_build *b, struct interp_nc_result *ret,
		      struct interp_diag *diag)
{
	const struct interp_dialect *d = text->dialect ? text->dialect :
					 interp_dialect_by_name("generic");
	struct nc_reader r = { .o = o, .d = d->nc, .build = b, .diag = diag };
	static const struct interp_wire none = { .corner_angle_deg = 180 };
	int err;

	diag->line = diag->column = 0;
	contour_init(&r.contour, o->wire ? o->wire : &none, o->machine, b);
	r.contour.notes = o->notes;
	for (int i = 0; i < INTERP_NOFFSETS; i++)
		r.registers[i] = (struct nc_register) {
			o->offset_mm[i] != 0, o->offset_mm[i]
		};
	open_text(&r, text->bytes ? text->at : "", text->bytes);
	reset_modes(&r);
	err = nc_check_tape(&r);
	if (!err)
		err = nc_set_turn(&r);
	if (!err)
		err = nc_electrode_begin(&r);
	if (!err)
		err = nc_setting_begin(&r);
	if (!err)
		err = read_lines(&r);
	if (!err)
		err = nc_setting_end(&r);
	if (!err) {
		ret->lines = count_lines(&r);
		ret->executed = r.executed;
	}
	if (err == -EINVAL && o->refused)
		nc_list_refusals(&r);
	nc_forget_labels(&r);
	nc_macro_free(&r);
	nc_curve_free(&r.curve);
	nc_forget_conditions(&r);
	contour_free(&r.contour);
	return err;
}
