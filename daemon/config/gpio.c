/* SPDX-License-Identifier: Apache-2.0 */
/* gpio.c - [gpio]: a line as text, and keys that must agree */
#include "keys.h"

#include "cycle.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OFFSET_MAX	4095		/* the kernel has no larger chip */

const char *config_line_read(const char *text, struct config_line_at *ret)
{
	const char *colon;
	char *end;
	unsigned long n;

	*ret = (struct config_line_at) { .wired = false };
	if (strcmp(text, "none") == 0)
		return NULL;
	if (strlen(text) >= CONFIG_LINE_MAX)
		return "is too long";
	ret->inverted = *text == '!';
	text += ret->inverted;
	colon = strrchr(text, ':');
	if (colon) {
		memcpy(ret->chip, text, (size_t)(colon - text));
		if (colon == text)
			return "has no chip before its colon";
		text = colon + 1;
	}
	if (*text < '0' || *text > '9')
		return "has no line number";
	n = strtoul(text, &end, 10);
	if (*end || n > OFFSET_MAX)
		return "has no line number of 0 to 4095";
	ret->offset = (unsigned int)n;
	ret->wired = true;
	return NULL;
}

const char *config_encoder_read(const char *text,
				struct config_encoder_at *ret)
{
	const size_t n = strcspn(text, " ");
	const char *rest = text + n + strspn(text + n, " ");
	char a[CONFIG_ENCODER_MAX];
	const char *wrong;

	*ret = (struct config_encoder_at) { .present = false };
	if (strcmp(text, "none") == 0)
		return NULL;
	ret->present = true;
	if (strncmp(text, "counter", 7) == 0 && strchr(text, '/') &&
	    !strstr(text, "..") && *rest == '\0') {
		snprintf(ret->counter, sizeof(ret->counter), "%s", text);
		return NULL;
	}
	ret->lines = true;
	snprintf(a, sizeof(a), "%.*s", (int)n, text);
	wrong = config_line_read(a, &ret->a);
	if (!wrong)
		wrong = config_line_read(rest, &ret->b);
	if (!wrong && (!ret->a.wired || !ret->b.wired))
		wrong = "has one line";
	if (!wrong && strcmp(ret->a.chip, ret->b.chip) != 0)
		wrong = "has lines of two chips";
	if (!wrong && (ret->a.inverted || ret->b.inverted))
		wrong = "has a !: encoder_counts below 0 turns it round";
	return wrong;
}

static const struct config_key *key_of_line(int line)
{
	const size_t at = offsetof(struct machine_config, gpio.line) +
			  (size_t)line * CONFIG_LINE_MAX;
	const struct config_key *k;
	int row = 0;

	while ((k = config_key(row))->section != SECTION_GPIO ||
	       k->offset != at)
		row++;
	return k;
}

const char *config_line_name(int line)
{
	return key_of_line(line)->name;
}

/* -- What the keys must agree on ------------------------------------------ */

struct check {
	const struct machine_config *c;
	const struct config_lines *lines;
	struct interp_diag *diag;
	struct config_line_at at[CONFIG_NLINES];
};

static void blame(struct check *q, const struct config_key *k, int instance)
{
	q->diag->line = q->lines->at[config_key_find(k->section, k->name)]
					 [instance];
	q->diag->column = 0;
}

static int check_axis(struct check *q, int axis)
{
	static const int needs[] = { LINE_STEP, LINE_DIR };

	for (int i = 0; i < 2; i++) {
		const int line = needs[i] + axis;

		if (!(q->c->axes.present >> axis & 1) || q->at[line].wired)
			continue;
		blame(q, key_of_line(line), 0);
		return interp_diag_say(q->diag, "axis.%c is present and "
				       "gpio.%s is none; gpio.%s = the number "
				       "of a line, or [axis.%c] present = no",
				       INTERP_AXIS_LETTERS[axis],
				       config_line_name(line),
				       config_line_name(line),
				       INTERP_AXIS_LETTERS[axis]);
	}
	return 0;
}

static bool is_same(const struct check *q, int a, int b)
{
	const struct config_line_at *x = &q->at[a], *y = &q->at[b];
	const char *chip = q->c->gpio.chip;

	return x->wired && y->wired && x->offset == y->offset &&
	       strcmp(*x->chip ? x->chip : chip,
		      *y->chip ? y->chip : chip) == 0;
}

/* Inputs may share a line: limit switches in series. */
static int check_shared(struct check *q, int output)
{
	for (int i = output + 1; i < CONFIG_NLINES; i++) {
		const struct config_key *k = key_of_line(i);

		if (!is_same(q, output, i))
			continue;
		blame(q, k, 0);
		return interp_diag_say(q->diag, "gpio.%s and gpio.%s are both "
				       "line %u; a line of its own for each "
				       "output", config_line_name(output),
				       k->name, q->at[i].offset);
	}
	return 0;
}

static int check_source(struct check *q)
{
	const struct config_key *k =
		config_key(config_key_find(SECTION_GAP, "source"));

	const bool lines = config_gpio_has_lines(q->c);

	if (strcmp(q->c->gpio.adc, "none") != 0 && q->c->gpio.adc_ratio == 0) {
		blame(q, config_key(config_key_find(SECTION_GPIO,
						    "adc_ratio")), 0);
		return interp_diag_say(q->diag, "gpio.adc_ratio is 0, which "
				       "would read each gap as a short; the "
				       "divider in front of the converter");
	}
	if (q->c->gap.source == (lines ? GAP_LINES : GAP_VOLTAGE) ||
	    q->c->gap.source == GAP_COUNTS)
		return 0;
	blame(q, k, 0);
	if (!lines)
		return interp_diag_say(q->diag,
				       "gap.source is %s and the gap is read "
				       "by gpio.adc; [gap] source = voltage, "
				       "or counts of the generator",
				       k->word((int)q->c->gap.source));
	return interp_diag_say(q->diag, "gap.source is %s and there are gap "
			       "lines; [gap] source = lines; or no gap_open, "
			       "gap_spark, gap_short",
			       k->word((int)q->c->gap.source));
}

static int check_gap(struct check *q)
{
	static const int needs[] = { LINE_GAP_OPEN, LINE_GAP_SHORT };

	if (!config_gpio_has_lines(q->c))
		return 0;
	for (int i = 0; i < 2; i++) {
		if (q->at[needs[i]].wired)
			continue;
		blame(q, key_of_line(needs[i]), 0);
		return interp_diag_say(q->diag, "the gap's comparators are "
				       "without gpio.%s; gap_open and "
				       "gap_short, and gap_spark if there is "
				       "one; or none of them",
				       config_line_name(needs[i]));
	}
	return 0;
}

static bool has_line(const struct config_line_at *list, int n,
		     const char *chip, const struct config_line_at *x)
{
	for (int i = 0; i < n; i++)
		if (list[i].wired && list[i].offset == x->offset &&
		    strcmp(*list[i].chip ? list[i].chip : chip,
			   *x->chip ? x->chip : chip) == 0)
			return true;
	return false;
}

/* One line cannot be asked for edges and for levels at once. */
static int check_encoder(struct check *q, int axis)
{
	const struct config_key *k =
		config_key(config_key_find(SECTION_GPIO, "encoder_X") + axis);
	const char *chip = q->c->gpio.chip;
	const char *text = q->c->gpio.encoder[axis];
	struct config_encoder_at at;
	const char *wrong = config_encoder_read(text, &at);

	if (!wrong && at.present && !(q->c->axes.present >> axis & 1))
		wrong = "is of an axis that is not present";
	if (!wrong && at.present && q->c->drive[axis].encoder_counts == 0)
		wrong = "has encoder_counts 0";
	if (!wrong && at.lines &&
	    (has_line(q->at, CONFIG_NLINES, chip, &at.a) ||
	     has_line(q->at, CONFIG_NLINES, chip, &at.b) ||
	     has_line(&at.a, 1, chip, &at.b)))
		wrong = "has a line that is used for something else too";
	if (!wrong)
		return 0;
	blame(q, k, 0);
	return interp_diag_say(q->diag, "gpio.%s \"%s\" %s; two lines of one "
			       "chip, A and B, as 24 25 or gpiochip1:4 "
			       "gpiochip1:5; or a counter of the kernel, as "
			       "counter0/count0; or none",
			       k->name, text, wrong);
}

/* If nothing ends the sparks after edmd is gone, the machine builder must say
 * what does. */
static int check_guard(struct check *q, int line, const char *by,
		       const char *key)
{
	if (!q->at[LINE_SPARK].wired || q->at[line].wired ||
	    strcmp(by, "none") != 0)
		return 0;
	blame(q, key_of_line(LINE_SPARK), 0);
	return interp_diag_say(q->diag, "gpio.spark without gpio.%s; gpio.%s "
					"= the number of a line; or gpio.%s = "
					"in your words, what does it instead",
					config_line_name(line),
					config_line_name(line), key);
}

static int check_guards(struct check *q)
{
	return check_guard(q, LINE_WATCHDOG, q->c->gpio.watchdog_by,
			   "watchdog_by") ||
	       check_guard(q, LINE_ESTOP, q->c->gpio.estop_by, "estop_by");
}

double config_gpio_points_s(const struct machine_config *c)
{
	const double periods = c->gpio.high_cycles +
			       (c->gpio.signal ? 0 : c->gpio.low_cycles);

	const double in_period = c->gpio.edges_per_period > 1 ?
		floor(c->gpio.edges_per_period / periods) : 1 / periods;

	return 1e9 / (double)config_period_ns(c) * in_period;
}

static int check_speed(struct check *q, const struct config_key *k,
		       int instance, double most)
{
	const double v = *(const double *)config_key_in(k, instance, q->c);
	char section[32], unit[16];

	if (v <= most)
		return 0;
	blame(q, k, instance);
	config_section_name(k->section, instance, section, sizeof(section));
	config_key_unit(k, instance, unit, sizeof(unit));
	return interp_diag_say(q->diag, "%s.%s %g%s is faster than the lines "
			       "of [gpio], %g pulses/s; at most %g%s; or a "
			       "larger pulse_mm, a shorter period_us, signal "
			       "= quadrature", section, k->name, v, unit,
			       config_gpio_points_s(q->c),
			       floor(most * 1e6) / 1e6, unit);
}

/* A jump may go along any linear axis. */
static int check_speeds(struct check *q)
{
	const struct config_key *axis =
		config_key(config_key_find(SECTION_AXIS, "v_max_mm_s"));
	const struct config_key *jump =
		config_key(config_key_find(SECTION_JUMP, "v_max_mm_s"));

	for (int i = 0; i < INTERP_NAXES; i++) {
		const double most = config_gpio_points_s(q->c) *
				    q->c->axes.axis[i].pulse_mm;

		if (!(q->c->axes.present >> i & 1))
			continue;
		if (check_speed(q, axis, i, most))
			return -EINVAL;
		if (!interp_axis_is_rotary((enum interp_axis)i) &&
		    q->c->jump.height_mm > 0 && check_speed(q, jump, 0, most))
			return -EINVAL;
	}
	return 0;
}

/* -- Beside drives on a bus ------------------------------------------------ */

static bool has_brake_line(const struct machine_config *c, int axis)
{
	return c->can402.node[axis] > 0 && c->drive[axis].brake == BRAKE_LINE;
}

static int check_brake_line(struct check *q, int axis)
{
	const int line = LINE_BRAKE + axis;
	const bool wired = q->at[line].wired;
	const char letter = INTERP_AXIS_LETTERS[axis];

	if (wired == has_brake_line(q->c, axis))
		return 0;
	if (wired)
		blame(q, key_of_line(line), 0);
	else
		blame(q, config_key(config_key_find(SECTION_AXIS, "brake")),
		      axis);
	return wired ?
		interp_diag_say(q->diag, "gpio.brake_%c of an axis that does "
				"not have [axis.%c] brake = line; this, and "
				"can402.node_%c, or none", letter, letter,
				letter) :
		interp_diag_say(q->diag, "axis.%c.brake = line and "
				"gpio.brake_%c is none; gpio.brake_%c = the "
				"number of a line, or another brake", letter,
				letter, letter);
}

/* What nobody would read or write must not look as if somebody did. */
static int refuse_unused(struct check *q, const struct config_key *k)
{
	blame(q, k, 0);
	return interp_diag_say(q->diag, "gpio.%s with backend can402; of "
			       "[gpio] it has chip, brake_X ... brake_V, "
			       "brake_ms and, with [generator] spark = line "
			       "..., watchdog_by and estop_by", k->name);
}

static int check_unused(struct check *q)
{
	const int adc = config_key_find(SECTION_GPIO, "adc");
	const int encoder = config_key_find(SECTION_GPIO, "encoder_X");

	for (int i = 0; i < CONFIG_NLINES; i++)
		if (q->at[i].wired && (i < LINE_BRAKE ||
				       i >= LINE_BRAKE + INTERP_NAXES))
			return refuse_unused(q, key_of_line(i));
	if (strcmp(q->c->gpio.adc, "none") != 0)
		return refuse_unused(q, config_key(adc));
	for (int i = 0; i < INTERP_NAXES; i++)
		if (strcmp(q->c->gpio.encoder[i], "none") != 0)
			return refuse_unused(q, config_key(encoder + i));
	return 0;
}

static void read_lines(struct check *q)
{
	for (int i = 0; i < CONFIG_NLINES; i++)
		config_line_read(q->c->gpio.line[i], &q->at[i]);
}

int config_check_brakes(const struct machine_config *c,
			const struct config_lines *lines,
			struct interp_diag *diag)
{
	struct check q = { .c = c, .lines = lines, .diag = diag };

	read_lines(&q);
	if (check_unused(&q))
		return -EINVAL;
	for (int i = 0; i < INTERP_NAXES; i++)
		if (check_brake_line(&q, i) || check_shared(&q, LINE_BRAKE + i))
			return -EINVAL;
	return 0;
}

int config_check_gpio(const struct machine_config *c,
		      const struct config_lines *lines,
		      struct interp_diag *diag)
{
	struct check q = { .c = c, .lines = lines, .diag = diag };

	read_lines(&q);
	for (int i = 0; i < INTERP_NAXES; i++)
		if (check_axis(&q, i))
			return -EINVAL;
	for (int i = 0; i < CONFIG_NOUTPUTS; i++)
		if (check_shared(&q, i))
			return -EINVAL;
	for (int i = 0; i < INTERP_NAXES; i++)
		if (check_encoder(&q, i))
			return -EINVAL;
	if (check_gap(&q) || check_guards(&q) || check_speeds(&q))
		return -EINVAL;
	return config_gpio_has_gap(c) ? check_source(&q) : 0;
}

bool config_gpio_has_gap(const struct machine_config *c)
{
	return config_gpio_has_lines(c) || strcmp(c->gpio.adc, "none") != 0;
}

bool config_gpio_has_lines(const struct machine_config *c)
{
	struct config_line_at at;

	for (int i = LINE_GAP_OPEN; i <= LINE_GAP_SHORT; i++) {
		config_line_read(c->gpio.line[i], &at);
		if (at.wired)
			return true;
	}
	return false;
}
