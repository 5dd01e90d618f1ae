/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator.c - [generator]: how each field reaches it, and what then does
 */
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WORD_MAX	40
#define WANTED_LINES	"lines, as lines 20 21 26 weights 3 6 12, or as lines " \
			"5 6 codes 2 4 8 16; one line for what is on or off"
#define WANTED_CAN	"can ID byte N, as can 1009 byte 2 bits 16 scale 0.1; " \
			"or bit N, of the byte"
#define NATURAL_BITS	16

/* -- A way as text --------------------------------------------------------- */

struct words {
	const char *at;
	char word[WORD_MAX];
};

static bool next(struct words *w)
{
	size_t n;

	w->at += strspn(w->at, " \t,");
	n = strcspn(w->at, " \t,");
	snprintf(w->word, sizeof(w->word), "%.*s", (int)n, w->at);
	w->at += n;
	return n > 0;
}

static bool number(const char *word, double *ret)
{
	char *end;

	*ret = strtod(word, &end);
	return end != word && *end == '\0' && isfinite(*ret);
}

/* On or off; polarity is one of these too. */
static bool is_switch(int field)
{
	return field >= INTERP_NGENERATOR || field == INTERP_TECH_POLARITY ||
	       field == INTERP_TECH_ISO;
}

static double range_min(int field)
{
	return field < INTERP_NGENERATOR ? interp_tech_field[field].min : 0;
}

static double range_max(int field)
{
	return field < INTERP_NGENERATOR ? interp_tech_field[field].max : 1;
}

static void give(struct process_delivers *d, double value)
{
	if (d->n < PROCESS_VALUES_MAX)
		d->value[d->n++] = value;
}

static void give_switch(struct process_delivers *d, int field)
{
	give(d, field == INTERP_TECH_POLARITY ? -1 : 0);
	give(d, 1);
}

/* All that the machine file and a table may say. */
static void give_all(struct process_delivers *d, int field)
{
	d->there = true;
	d->min = range_min(field);
	d->max = range_max(field);
	if (is_switch(field))
		give_switch(d, field);
}

static const char *read_lines(struct words *w, struct config_way *ret)
{
	while (next(w) && strcmp(w->word, "weights") != 0 &&
	       strcmp(w->word, "codes") != 0) {
		if (ret->nlines == CONFIG_WAY_LINES)
			return "has a seventh line";
		if (config_line_read(w->word, &ret->line[ret->nlines]) ||
		    !ret->line[ret->nlines].wired)
			return "has a word that is no line";
		ret->nlines++;
	}
	return ret->nlines ? NULL : "has no line";
}

static const char *read_codes(struct words *w, struct config_way *ret)
{
	const uint32_t most = 1u << ret->nlines;
	double v;

	while (next(w)) {
		if (ret->ncodes == most)
			return "has more codes than its lines make";
		if (!number(w->word, &v))
			return "has a code that is no number";
		ret->code[ret->ncodes++] = v;
	}
	return ret->ncodes < 2 ? "has fewer than two codes" : NULL;
}

static const char *read_weights(struct words *w, struct config_way *ret)
{
	double weight[CONFIG_WAY_LINES];
	uint8_t n = 0;

	while (next(w)) {
		if (n == ret->nlines)
			return "has more weights than lines";
		if (!number(w->word, &weight[n]) || !(weight[n] > 0))
			return "has a weight that is not above 0";
		n++;
	}
	if (n < ret->nlines)
		return "has fewer weights than lines";
	ret->ncodes = (uint8_t)(1u << n);
	for (uint32_t code = 0; code < ret->ncodes; code++)
		for (uint8_t i = 0; i < n; i++)
			ret->code[code] += code >> i & 1 ? weight[i] : 0;
	return NULL;
}

/* No line on is no value of a sum: it would be a current of 0. */
static const char *give_codes(struct config_way *w, int field)
{
	for (uint32_t i = 0; i < w->ncodes; i++) {
		const double v = w->code[i];

		if (v == 0)
			continue;
		if (v < range_min(field) || v > range_max(field))
			return "makes a value out of the field's range";
		give(&w->gives, v);
	}
	return NULL;
}

static const char *read_way_lines(struct words *w, int field,
				  struct config_way *ret)
{
	const char *wrong = read_lines(w, ret);
	const bool weights = strcmp(w->word, "weights") == 0;

	ret->kind = WAY_LINES;
	ret->gives.there = true;
	if (wrong)
		return wrong;
	if (is_switch(field)) {
		give_switch(&ret->gives, field);
		return *w->word || ret->nlines > 1 ?
		       "is of a field that is on or off" : NULL;
	}
	if (!*w->word)
		return "has neither weights nor codes";
	wrong = weights ? read_weights(w, ret) : read_codes(w, ret);
	return wrong ? wrong : give_codes(ret, field);
}

static const char *read_can_pair(struct words *w, struct config_way *ret,
				 double at[2])
{
	char key[WORD_MAX];
	double v;

	memcpy(key, w->word, sizeof(key));
	if (!next(w) || !number(w->word, &v))
		return "has a word without its number";
	if (strcmp(key, "byte") == 0 && v >= 0 && v <= 7 && v == floor(v))
		at[0] = v;
	else if (strcmp(key, "bit") == 0 && v >= 0 && v <= 7 && v == floor(v))
		at[1] = v;
	else if (strcmp(key, "bits") == 0 && v >= 1 && v <= 32 &&
		 v == floor(v))
		ret->bits = (uint8_t)v;
	else if (strcmp(key, "scale") == 0 && v > 0)
		ret->scale = v;
	else
		return "has a word that is none of byte 0 to 7, bit 0 to 7, "
		       "bits 1 to 32, scale above 0";
	return NULL;
}

/* The count with all bits set says: the generator's own setting. */
static void give_counts(struct config_way *w, int field)
{
	const double counts = exp2(w->bits) - 2;
	const double least = ceil(range_min(field) / w->scale);

	w->gives.step = w->scale;
	w->gives.min = fmax(least, 1) * w->scale;
	w->gives.max = fmin(counts * w->scale, range_max(field));
}

static const char *read_can(struct words *w, int field, struct config_way *ret)
{
	double id, at[2] = { -1, 0 };
	const char *wrong;

	if (!next(w) || !number(w->word, &id) || id < 1 || id > 2047 ||
	    id != floor(id))
		return "has no identifier of 1 to 2047";
	*ret = (struct config_way) {
		.kind = WAY_CAN, .gives.there = true, .id = (uint16_t)id,
		.bits = is_switch(field) ? 1 : NATURAL_BITS, .scale = 1,
	};
	while (next(w)) {
		wrong = read_can_pair(w, ret, at);
		if (wrong)
			return wrong;
	}
	if (at[0] < 0)
		return "has no byte";
	ret->bit = (uint8_t)(8 * at[0] + at[1]);
	if (ret->bit + ret->bits > 64)
		return "goes beyond the eighth byte";
	if (is_switch(field) != (ret->bits == 1))
		return is_switch(field) ? "is of a field that is on or off" :
					  "is one bit of a number";
	if (is_switch(field))
		give_switch(&ret->gives, field);
	else
		give_counts(ret, field);
	return ret->gives.n || ret->gives.max > ret->gives.min ? NULL :
	       "cannot hold a value of the field";
}

static const char *way_read(const char *text, int field,
			    struct config_way *ret)
{
	struct words w = { .at = text };

	*ret = (struct config_way) { .kind = WAY_NONE };
	next(&w);
	if (strcmp(w.word, "none") == 0)
		return *w.at ? "has a word after none" : NULL;
	if (strcmp(w.word, "lines") == 0 || strcmp(w.word, "line") == 0)
		return read_way_lines(&w, field, ret);
	if (strcmp(w.word, "can") == 0)
		return read_can(&w, field, ret);
	return "begins with no word of auto, none, lines, can";
}

/* -- The interface --------------------------------------------------------- */

int config_generator_interface(const struct machine_config *c)
{
	if (c->generator.interface != GENERATOR_AUTO)
		return c->generator.interface;
	return config_machine_is(c, MACHINE_MODEL) ? GENERATOR_SIM :
						     GENERATOR_NONE;
}

bool config_generator_limits(const struct machine_config *c)
{
	return config_generator_interface(c) != GENERATOR_SIM &&
	       config_backend(c)->has_gap(c);
}

/* What every CAN generator was sent before a machine file could say more. */
static void usual_frame(const struct machine_config *c, int field,
			struct config_way *ret)
{
	static const struct { uint8_t bit, bits; } at[PROCESS_NFIELDS] = {
		[PROCESS_SPARK] = { 0, 1 }, [PROCESS_PUMP] = { 1, 1 },
		[INTERP_TECH_POLARITY] = { 2, 1 },
		[INTERP_TECH_PEAK_A] = { 16, 16 },
		[INTERP_TECH_ON_US] = { 32, 16 },
		[INTERP_TECH_OFF_US] = { 48, 16 },
	};

	if (at[field].bits == 0 || c->generator.can_id == 0)
		return;
	*ret = (struct config_way) {
		.kind = WAY_CAN, .gives.there = true,
		.id = (uint16_t)c->generator.can_id, .bit = at[field].bit,
		.bits = at[field].bits, .scale = 0.1,
	};
	if (is_switch(field))
		give_switch(&ret->gives, field);
	else
		give_counts(ret, field);
}

/* [gpio] has lines for some of it. */
static bool has_gpio_line(const struct machine_config *c, int field)
{
	const int line = field == PROCESS_SPARK ? LINE_SPARK :
			 field == PROCESS_PUMP ? LINE_PUMP : -1;
	struct config_line_at at;

	if (line < 0 || c->backend != BACKEND_GPIO)
		return false;
	config_line_read(c->gpio.line[line], &at);
	return at.wired;
}

static void by_itself(const struct machine_config *c, int field,
		      struct config_way *ret)
{
	const int interface = config_generator_interface(c);

	*ret = (struct config_way) { .kind = WAY_NONE };
	if (interface == GENERATOR_CAN && !has_gpio_line(c, field))
		usual_frame(c, field, ret);
	else if (interface == GENERATOR_SIM || has_gpio_line(c, field))
		ret->kind = WAY_OWN;
	if (ret->kind == WAY_OWN)
		give_all(&ret->gives, field);
}

void config_way(const struct machine_config *c, int field, bool told,
		struct config_way *ret)
{
	const char *text = told ? c->generator.told[field] :
				  c->generator.field[field];

	if (!told && strcmp(text, "auto") == 0)
		by_itself(c, field, ret);
	else if (way_read(text, field, ret))
		*ret = (struct config_way) { .kind = WAY_NONE };
}

static bool is_by_hand(const struct machine_config *c, int field)
{
	struct words w = { .at = c->generator.by_hand };

	while (next(&w))
		if (strcmp(w.word, process_name(field)) == 0)
			return true;
	return false;
}

void config_delivers(const struct machine_config *c, int field,
		     struct process_delivers *ret)
{
	struct config_way w;

	config_way(c, field, false, &w);
	*ret = w.gives;
	if (!is_by_hand(c, field))
		return;
	*ret = (struct process_delivers) { .by_hand = true };
	give_all(ret, field);
}

static void add_id(const struct config_way *w, uint16_t *id, uint32_t *n)
{
	uint32_t i = 0;

	while (i < *n && id[i] != w->id)
		i++;
	if (w->kind == WAY_CAN && i == *n)
		id[(*n)++] = w->id;
}

uint32_t config_generator_frames(const struct machine_config *c,
				 const char *name)
{
	uint16_t id[PROCESS_NFIELDS + INTERP_NGENERATOR];
	struct config_way w;
	uint32_t n = 0;

	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		config_way(c, i, false, &w);
		add_id(&w, id, &n);
		if (i < INTERP_NGENERATOR) {
			config_way(c, i, true, &w);
			add_id(&w, id, &n);
		}
	}
	return strcmp(c->generator.can_interface, name) == 0 ? n : 0;
}

/* -- What may be asked ----------------------------------------------------- */

static int refuse_value(const struct process_delivers *d, int field,
			double value, const char *who,
			struct interp_diag *diag)
{
	const char *name = process_name(field);
	const char *unit = interp_tech_field[field].unit;
	char range[120];

	snprintf(diag->found, sizeof(diag->found), "%s: %s %g%s%s does not "
		 "reach the generator", who, name, value, *unit ? " " : "",
		 unit);
	process_range_text(d, field, range, sizeof(range));
	if (d->there)
		snprintf(diag->wanted, sizeof(diag->wanted), "%s; or another "
			 "[generator] %s", range, name);
	else
		snprintf(diag->wanted, sizeof(diag->wanted), "no %s in the "
			 "condition; or [generator] %s = how it is reached; "
			 "or [generator] by_hand = %s, and a person sets it",
			 name, name, name);
	return -EINVAL;
}

int config_generator_takes(const struct machine_config *c,
			   const struct interp_tech *t, const char *who,
			   struct interp_diag *diag)
{
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		struct process_delivers d;

		if (isnan(t->v[i]) || !config_generator_limits(c))
			continue;
		/* A generator that nobody turns round is positive. */
		if (i == INTERP_TECH_POLARITY && t->v[i] > 0)
			continue;
		config_delivers(c, i, &d);
		if (isnan(process_nearest(&d, i, t->v[i])))
			return refuse_value(&d, i, t->v[i], who, diag);
	}
	return 0;
}

/* -- What the keys must agree on ------------------------------------------- */

struct check {
	const struct machine_config *c;
	const struct config_lines *lines;
	struct interp_diag *diag;
};

/* Found and wanted are filled; the line is that of @key. */
static int refuse(struct check *q, const char *key)
{
	q->diag->line = q->lines->at[config_key_find(SECTION_GENERATOR, key)]
				    [0];
	q->diag->column = 0;
	return -EINVAL;
}

static const char *key_name(int field, bool told, char *buf, size_t size)
{
	snprintf(buf, size, "%s%s", told ? "told_" : "", process_name(field));
	return buf;
}

static int check_way(struct check *q, int field, bool told)
{
	const char *text = told ? q->c->generator.told[field] :
				  q->c->generator.field[field];
	const int interface = config_generator_interface(q->c);
	struct config_way w;
	const char *wrong;
	char key[24];

	if (!told && strcmp(text, "auto") == 0)
		return 0;
	key_name(field, told, key, sizeof(key));
	wrong = way_read(text, field, &w);
	if (!wrong && w.kind != WAY_NONE && interface != GENERATOR_LINES &&
	    interface != GENERATOR_CAN)
		wrong = "is of a generator without interface lines or can";
	if (!wrong && w.kind == WAY_CAN && interface == GENERATOR_LINES)
		wrong = "is a frame, and the interface is lines";
	if (!wrong && told && w.kind == WAY_LINES)
		wrong = "is told by lines, which are outputs";
	if (!wrong && !told && w.kind != WAY_NONE &&
	    has_gpio_line(q->c, field))
		wrong = "is a second way: gpio has a line for it";
	if (!wrong)
		return 0;
	interp_diag_say(q->diag, "generator.%s \"%.60s\" %s; none, %s; %s",
			key, text, wrong, WANTED_LINES, WANTED_CAN);
	return refuse(q, key);
}

static bool is_line(const struct check *q, const struct config_line_at *a,
		    const struct config_line_at *b)
{
	const char *chip = q->c->gpio.chip;

	return a->wired && b->wired && a->offset == b->offset &&
	       strcmp(*a->chip ? a->chip : chip,
		      *b->chip ? b->chip : chip) == 0;
}

static int refuse_line(struct check *q, int field, const char *other,
		       const struct config_line_at *at)
{
	interp_diag_say(q->diag, "generator.%s and %s are both line %u; a "
			"line of its own for each", process_name(field), other,
			at->offset);
	return refuse(q, process_name(field));
}

static int check_gpio_line(struct check *q, int field,
			   const struct config_line_at *at)
{
	struct config_line_at other;
	char name[32];

	for (int i = 0; i < CONFIG_NLINES; i++) {
		config_line_read(q->c->gpio.line[i], &other);
		if (!is_line(q, at, &other))
			continue;
		snprintf(name, sizeof(name), "gpio.%s", config_line_name(i));
		return refuse_line(q, field, name, at);
	}
	return 0;
}

static int check_same_line(struct check *q, int field, int k,
			   const struct config_way *w, int other)
{
	struct config_way x;
	char name[32];

	config_way(q->c, other, false, &x);
	for (int j = 0; x.kind == WAY_LINES && j < x.nlines; j++) {
		if ((other == field && j >= k) ||
		    !is_line(q, &w->line[k], &x.line[j]))
			continue;
		snprintf(name, sizeof(name), "generator.%s",
			 process_name(other));
		return refuse_line(q, field, name, &w->line[k]);
	}
	return 0;
}

static int check_lines(struct check *q, int field)
{
	struct config_way w;

	config_way(q->c, field, false, &w);
	for (int k = 0; w.kind == WAY_LINES && k < w.nlines; k++) {
		if (check_gpio_line(q, field, &w.line[k]))
			return -EINVAL;
		for (int i = 0; i <= field; i++)
			if (check_same_line(q, field, k, &w, i))
				return -EINVAL;
	}
	return 0;
}

/* The second byte of the usual frame counts the frames. */
static bool is_count(const struct check *q, const struct config_way *w)
{
	return w->id == (uint16_t)q->c->generator.can_id &&
	       w->bit < 16 && w->bit + w->bits > 8;
}

static int check_bits(struct check *q, int field, bool told)
{
	struct config_way w, x;
	char key[24];

	config_way(q->c, field, told, &w);
	if (w.kind != WAY_CAN)
		return 0;
	key_name(field, told, key, sizeof(key));
	for (int i = 0; i < field; i++) {
		if (told && i >= INTERP_NGENERATOR)
			break;
		config_way(q->c, i, told, &x);
		if (x.kind != WAY_CAN || x.id != w.id ||
		    x.bit + x.bits <= w.bit || w.bit + w.bits <= x.bit)
			continue;
		interp_diag_say(q->diag, "generator.%s and generator.%s%s "
				"have bits of frame %u in common; a place of "
				"its own for each", key, told ? "told_" : "",
				process_name(i), w.id);
		return refuse(q, key);
	}
	if (!told && is_count(q, &w)) {
		interp_diag_say(q->diag, "generator.%s is in byte 1 of frame "
				"%u, which counts the frames; another byte, or "
				"another identifier", key, w.id);
		return refuse(q, key);
	}
	return 0;
}

static int check_id(struct check *q, const char *key, uint32_t id)
{
	const struct config_can402 *k = &q->c->can402;
	bool taken = id < 0x180 || id >= 0x580 || id == (uint32_t)k->gap_id;

	if (q->c->backend != BACKEND_CAN402 || id == 0 ||
	    strcmp(k->interface, q->c->generator.can_interface) != 0)
		return 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		taken = taken || (k->node[i] > 0 &&
				  (uint32_t)k->node[i] == (id & 0x7f));
	if (!taken)
		return 0;
	interp_diag_say(q->diag, "generator.%s %u, which is in use on that "
			"bus; one from 384 to 1407 whose rest by 128 is no "
			"drive's node", key, id);
	return refuse(q, key);
}

static int check_ids(struct check *q, int field, bool told)
{
	struct config_way w;
	char key[24];

	if (told && field >= INTERP_NGENERATOR)
		return 0;
	config_way(q->c, field, told, &w);
	return w.kind == WAY_CAN &&
	       check_id(q, key_name(field, told, key, sizeof(key)), w.id);
}

static int check_by_hand(struct check *q)
{
	struct words w = { .at = q->c->generator.by_hand };

	while (next(&w) && strcmp(w.word, "none") != 0) {
		int i = 0;

		while (i < PROCESS_SPARK && strcmp(w.word, process_name(i)))
			i++;
		if (i < PROCESS_SPARK)
			continue;
		interp_diag_say(q->diag, "generator.by_hand has \"%s\"; of "
				"peak_a on_us off_us polarity ignition_v iso "
				"sense pump, those that a person sets",
				w.word);
		return refuse(q, "by_hand");
	}
	return 0;
}

/* As for [gpio] spark: something must end the sparks after edmd is gone. */
static int check_guard(struct check *q, int line, const char *by,
		       const char *key)
{
	struct config_line_at at;
	struct config_way w;

	config_way(q->c, PROCESS_SPARK, false, &w);
	config_line_read(q->c->gpio.line[line], &at);
	if (w.kind != WAY_LINES || strcmp(by, "none") != 0 ||
	    (at.wired && q->c->backend == BACKEND_GPIO))
		return 0;
	interp_diag_say(q->diag, "generator.spark is a line and there is no "
			"gpio.%s; gpio.%s_by = in your words, what does it",
			key, key);
	return refuse(q, "spark");
}

static int check_interface(struct check *q)
{
	const bool model = config_machine_is(q->c, MACHINE_MODEL);
	const int i = config_generator_interface(q->c);

	if (model == (i == GENERATOR_SIM) || (model && i == GENERATOR_NONE))
		return 0;
	interp_diag_say(q->diag, "generator.interface and machine.backend do "
			"not agree; interface = sim with backend sim, %s",
			"and none, lines or can with the others");
	return refuse(q, "interface");
}

int config_check_generator(const struct machine_config *c,
			   const struct config_lines *lines,
			   struct interp_diag *diag)
{
	struct check q = { c, lines, diag };

	if (check_interface(&q) || check_by_hand(&q) ||
	    check_id(&q, "can_id", (uint32_t)c->generator.can_id))
		return -EINVAL;
	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		const bool tells = i < INTERP_NGENERATOR;

		if (check_way(&q, i, false) ||
		    (tells && check_way(&q, i, true)))
			return -EINVAL;
	}
	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		const bool tells = i < INTERP_NGENERATOR;

		if (check_lines(&q, i) || check_bits(&q, i, false) ||
		    (tells && check_bits(&q, i, true)) ||
		    check_ids(&q, i, false) || check_ids(&q, i, true))
			return -EINVAL;
	}
	return check_guard(&q, LINE_WATCHDOG, c->gpio.watchdog_by,
			   "watchdog") ||
	       check_guard(&q, LINE_ESTOP, c->gpio.estop_by, "estop") ?
	       -EINVAL : 0;
}
