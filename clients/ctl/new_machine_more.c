/* SPDX-License-Identifier: Apache-2.0 */
/* new_machine_more.c - places, gap, generator, joints and wire of a new
 * machine */
#include "new_machine.h"

#include <string.h>

static bool is(const char *a, const char *b)
{
	return strcmp(a, b) == 0;
}

static int index_of(char axis)
{
	return (int)(strchr(AXES, axis) - AXES);
}

static bool word(struct machine *m, const char *question, const char *plain,
		 char ret[WORD_MAX])
{
	while (new_answer(&m->over, question, plain, ret))
		if (new_is_word(ret))
			return true;
	return false;
}

/* -- The questions --------------------------------------------------------- */

static bool ask_home(struct machine *m, char axis)
{
	static const struct wanted place = { 1, -1e5, 1e5 };
	static const struct wanted method = { 1, -128, 127 };
	const int i = index_of(axis);
	const bool gpio = is(m->backend, "gpio");
	char q[96];

	snprintf(q, sizeof(q), "%c: how its place is found", axis);
	if (!new_choose(&m->over, q, is(m->backend, "can402") ?
				"none drive absolute" : "none switch",
				m->home[i]))
		return false;
	snprintf(q, sizeof(q), "%c: the switch lies toward", axis);
	if (is(m->home[i], "switch") &&
	    !new_choose(&m->over, q, "- +", m->side[i]))
		return false;
	snprintf(q, sizeof(q), "%c: its place there, mm or degrees", axis);
	if (!is(m->home[i], "none") &&
	    !new_numbers(&m->over, q, "0", &place,
				 (double *[]) { &m->home_at[i] }))
		return false;
	snprintf(q, sizeof(q), "%c: the drive's method, object 6098", axis);
	if (is(m->home[i], "drive") &&
	    !new_numbers(&m->over, q, "37", &method,
				 (double *[]) { &m->home_by[i] }))
		return false;
	snprintf(q, sizeof(q), "%c: line of the home switch", axis);
	if (gpio && is(m->home[i], "switch") &&
	    !word(m, q, "none", m->home_line[i]))
		return false;
	snprintf(q, sizeof(q), "%c: line of its limit switches", axis);
	return !gpio || word(m, q, "none", m->limit_line[i]);
}

static bool ask_gap(struct machine *m)
{
	static const char *const comparator[] = { "open", "spark", "short" };
	char q[96];

	if (is(m->backend, "can402")) {
		strcpy(m->gap, "none");
		if (!word(m, "CAN identifier of the gap's frames, 0: none yet",
			  "0", m->gap_at[0]))
			return false;
		if (!is(m->gap_at[0], "0"))
			strcpy(m->gap, "can");
		return true;
	}
	if (!is(m->backend, "gpio"))
		return true;
	if (!new_choose(&m->over, "how the gap is read: none (not yet), lines "
				"(comparators), voltage (a converter)",
				"none lines voltage", m->gap))
		return false;
	for (int i = 0; i < 3 && is(m->gap, "lines"); i++) {
		snprintf(q, sizeof(q), "line of the comparator: gap %s",
			 comparator[i]);
		if (!word(m, q, "none", m->gap_at[i]))
			return false;
	}
	return !is(m->gap, "voltage") ||
	       (word(m, "converter, as iio:device0", "iio:device0",
		     m->gap_at[0]) &&
		word(m, "volts at the gap for a volt at its input", "1",
		     m->gap_at[1]));
}

static bool ask_generator(struct machine *m)
{
	if (is(m->backend, "null") || is(m->backend, "sim"))
		return true;
	if (!new_choose(&m->over, "how the generator gets a condition: none "
				"(by hand), lines, can, modbus",
				"none lines can modbus", m->generator))
		return false;
	if (is(m->generator, "modbus"))
		return word(m, "its port, /dev/ttyUSB0 or ADDRESS:PORT",
			    "/dev/ttyUSB0", m->reached) &&
		       new_answer(&m->over, "where the peak current goes",
					  "register 10 scale 0.1", m->peak);
	if (is(m->generator, "can"))
		return word(m, "CAN identifier of its frame, docs/generator.md",
			    "512", m->reached);
	if (is(m->generator, "lines"))
		return new_answer(&m->over, "where the peak current goes",
					  "lines 20 21 26 weights 3 6 12",
					  m->peak);
	return new_answer(&m->over, "what a person sets at it, as on_us "
				  "off_us", "none", m->by_hand);
}

static bool ask_wire(struct machine *m)
{
	static const struct wanted height = { 3, -2000, 2000 };

	return new_numbers(&m->over, "heights above the table, mm: lower "
				   "guide, upper guide, top of the work",
				   "-20 80 40", &height, (double *[]) {
					&m->heights[0], &m->heights[1],
					&m->heights[2] });
}

static bool has_guides(const struct machine *m)
{
	return is(m->kind, "wire") && strchr(m->axes, 'U') &&
	       strchr(m->axes, 'V');
}

bool new_more(struct machine *m)
{
	for (const char *at = m->axes; *at && !is(m->backend, "null"); at++)
		if (!ask_home(m, *at))
			return false;
	if (!ask_gap(m) || !ask_generator(m))
		return false;
	if (strpbrk(m->axes, "ABC") &&
	    !new_answer(&m->over, "joints from work to tool, as C(0 0 -120) "
				"A(0 15 -80) X Y Z; none", "none", m->chain))
		return false;
	return !has_guides(m) || ask_wire(m);
}

/* -- The file -------------------------------------------------------------- */

void new_put_axis(FILE *f, const struct machine *m, int i)
{
	if (!*m->home[i] || is(m->home[i], "none"))
		return;
	fprintf(f, "home_method = %s\nhome_at_mm = %.10g\n", m->home[i],
		m->home_at[i]);
	if (is(m->home[i], "absolute"))
		fprintf(f, "absolute = yes\n");
	else if (is(m->home[i], "drive"))
		fprintf(f, "drive_home = %.0f\nhome_fast_mm_s = %.10g\n",
			m->home_by[i], m->v_max[i]);
	else
		fprintf(f, "home_dir = %s\nhome_fast_mm_s = %.10g\n",
			m->side[i], m->v_max[i]);
}

static void put_line(FILE *f, const char *key, char axis, const char *line)
{
	if (*line && !is(line, "none"))
		fprintf(f, "%s%c = %s\n", key, axis, line);
}

void new_put_lines(FILE *f, const struct machine *m)
{
	for (int i = 0; i < NAXES; i++) {
		put_line(f, "home_", AXES[i], m->home_line[i]);
		put_line(f, "limit_", AXES[i], m->limit_line[i]);
	}
	if (is(m->gap, "lines"))
		fprintf(f, "gap_open = %s\ngap_spark = %s\ngap_short = %s\n",
			m->gap_at[0], m->gap_at[1], m->gap_at[2]);
	if (is(m->gap, "voltage"))
		fprintf(f, "adc = %s\nadc_ratio = %s\n", m->gap_at[0],
			m->gap_at[1]);
}

static void put_generator(FILE *f, const struct machine *m)
{
	if (!*m->generator)
		return;
	fprintf(f, "[generator]\ninterface = %s\n", m->generator);
	if (is(m->generator, "modbus"))
		fprintf(f, "modbus = %s\n", m->reached);
	if (is(m->generator, "can"))
		fprintf(f, "can_id = %s\n", m->reached);
	if (*m->peak)
		fprintf(f, "peak_a = %s\n", m->peak);
	if (*m->by_hand && !is(m->by_hand, "none"))
		fprintf(f, "by_hand = %s\n", m->by_hand);
	fputc('\n', f);
}

void new_put_more(FILE *f, const struct machine *m)
{
	put_generator(f, m);
	if (*m->chain && !is(m->chain, "none"))
		fprintf(f, "[kinematics]\nchain = %s\n\n", m->chain);
	if (has_guides(m))
		fprintf(f, "[wire]\nguides = relative           ; U V ride on "
			"X Y\nz_lower_mm = %.10g\nz_upper_mm = %.10g\n"
			"z_second_mm = %.10g\n\n", m->heights[0],
			m->heights[1], m->heights[2]);
	if (is(m->backend, "sim") && is(m->kind, "sinker"))
		fprintf(f, "[sim]\nblock = yes                 ; to be felt "
			"for, with a bore in its middle\nblock_x_min_mm = -30\n"
			"block_x_max_mm = 30\nblock_y_min_mm = -30\n"
			"block_y_max_mm = 30\nblock_top_mm = -5\n"
			"bore_mm = 12\n\n");
}
