/* SPDX-License-Identifier: Apache-2.0 */
/*
 * check_generator.c - [generator]: what its keys must agree on
 */
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define WANTED_REGISTER	"register N, as register 10 scale 0.1"

struct check {
	const struct machine_config *c;
	const struct config_lines *lines;
	struct interp_diag *diag;
};

/* Found and wanted are filled; the line is that of @key. */
static int refuse_at(struct check *q, enum config_section_id s,
		     const char *key)
{
	q->diag->line = q->lines->at[config_key_find(s, key)][0];
	q->diag->column = 0;
	return -EINVAL;
}

static int refuse(struct check *q, const char *key)
{
	return refuse_at(q, SECTION_GENERATOR, key);
}

static const char *key_name(int field, bool told, char *buf, size_t size)
{
	snprintf(buf, size, "%s%s", told ? "told_" : "", process_name(field));
	return buf;
}

/* A way of which nothing is wrong but the company that it is in. */
static const char *misfit(const struct check *q, int field, bool told,
			  const struct config_way *w)
{
	const int interface = config_generator_interface(q->c);

	if (w->kind == WAY_NONE)
		return NULL;
	if (!config_generator_beside(interface))
		return "is of a generator without interface lines, can, modbus "
		       "or plc";
	if (w->kind == WAY_CAN && interface != GENERATOR_CAN)
		return "is a frame, and the interface is not can";
	if (w->kind == WAY_REGISTER && interface != GENERATOR_MODBUS)
		return "is a register, and the interface is not modbus";
	if (w->kind == WAY_PLC && interface != GENERATOR_PLC)
		return "is by the PLC, and the interface is not plc";
	if (told && w->kind == WAY_LINES)
		return "is told by lines, which are outputs";
	if (told && w->kind == WAY_DAC)
		return "is told by a converter's output";
	if (!told && w->input)
		return "is an input register, which nobody can write";
	if (w->within > 0 && (!told || field >= INTERP_NGENERATOR ||
			      w->bits == 1))
		return "has within, which is of a number that is told";
	if (w->kind == WAY_REGISTER &&
	    (field == PROCESS_SPARK || field == PROCESS_SENSE))
		return "is a register, and those take a round trip: it must "
		       "be a line";
	if (!told && config_generator_gpio(q->c, field))
		return "is a second way: gpio has a line for it";
	return NULL;
}

static const char *wrong_with(const struct check *q, int field, bool told,
			      const char *text)
{
	struct config_way w;
	const char *wrong = config_way_read(text, field, &w);

	return wrong ? wrong : misfit(q, field, told, &w);
}

/* Of some ways to say it those that it would take there. */
static void offer(const struct check *q, int field, bool told, char *buf,
		  size_t size)
{
	static const char *const ways[] = {
		"line 20", "lines 20 21 26 weights 3 6 12",
		"lines 5 6 codes 60 80 120 180",
		"can 1013 byte 0 bit 3", "can 1013 byte 0 bits 16 scale 0.1",
		"register 14 bit 0", "register 10 bits 16 scale 0.1",
		"register 11 codes 60 80 120 180",
		"input 30 bits 16 scale 0.1", "plc",
		"dac iio:device0 voltage0 scale 2 to 10",
	};
	size_t len = (size_t)snprintf(buf, size, "auto, none");

	for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++)
		if (len < size && !wrong_with(q, field, told, ways[i]))
			len += (size_t)snprintf(buf + len, size - len,
						", as %s", ways[i]);
}

static int check_way(struct check *q, int field, bool told)
{
	const char *text = told ? q->c->generator.told[field] :
				  q->c->generator.field[field];
	char key[24], offered[240];
	const char *wrong;

	if (!*text || strcmp(text, "auto") == 0)
		return 0;
	wrong = wrong_with(q, field, told, text);
	if (!wrong)
		return 0;
	offer(q, field, told, offered, sizeof(offered));
	interp_diag_say(q->diag, "generator.%s \"%.60s\" %s; %s",
			key_name(field, told, key, sizeof(key)), text, wrong,
			offered);
	return refuse(q, key);
}

/* A word that it has for no value that it can be asked for. */
static int check_told(struct check *q, int field)
{
	struct process_delivers d;
	struct config_way asked, told;
	char key[24];

	if (field >= INTERP_NGENERATOR)
		return 0;
	config_way(q->c, field, false, &asked);
	config_way(q->c, field, true, &told);
	config_delivers(q->c, field, &d);
	if (told.kind == WAY_NONE || asked.kind == WAY_NONE || d.there)
		return 0;
	key_name(field, true, key, sizeof(key));
	interp_diag_say(q->diag, "generator.%s tells no value that generator."
			"%s can ask for; the same values, codes and scale",
			key, process_name(field));
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

static int check_dac(struct check *q, int field)
{
	struct config_way w, x;

	config_way(q->c, field, false, &w);
	for (int i = 0; w.kind == WAY_DAC && i < field; i++) {
		config_way(q->c, i, false, &x);
		if (x.kind != WAY_DAC || x.id != w.id ||
		    x.current != w.current || strcmp(x.device, w.device) != 0)
			continue;
		interp_diag_say(q->diag, "generator.%s and generator.%s are "
				"both %s %s%u; a channel of its own for each",
				process_name(field), process_name(i), w.device,
				w.current ? "current" : "voltage", w.id);
		return refuse(q, process_name(field));
	}
	return 0;
}

/* The second byte of the usual frame counts the frames. */
static bool is_count(const struct check *q, const struct config_way *w)
{
	return w->kind == WAY_CAN &&
	       w->id == (uint16_t)q->c->generator.can_id &&
	       w->bit < 16 && w->bit + w->bits > 8;
}

/* Registers are one row of bits. */
static bool have_in_common(const struct config_way *a,
			   const struct config_way *b)
{
	const bool registers = a->kind == WAY_REGISTER;
	const uint32_t at = registers ? 16u * a->id + a->bit : a->bit;
	const uint32_t other = registers ? 16u * b->id + b->bit : b->bit;

	return a->kind == b->kind && (registers || a->id == b->id) &&
	       a->input == b->input && at < other + b->bits &&
	       other < at + a->bits;
}

/* What edmd writes of another field, or sends itself, says nothing of this
 * one. */
static int check_echo(struct check *q, int field, const struct config_way *w,
		      const char *key)
{
	const bool said = strcmp(q->c->generator.told[field], "auto") != 0;

	for (int i = 0; i < PROCESS_NFIELDS && said; i++) {
		const bool frame = w->kind == WAY_CAN;
		struct config_way x;

		config_way(q->c, i, false, &x);
		if (frame ? x.kind != WAY_CAN || x.id != w->id :
			    i == field || !have_in_common(&x, w))
			continue;
		interp_diag_say(q->diag, "generator.%s is in %s %u, and there "
				"edmd %s generator.%s; where the generator "
				"tells it", key, frame ? "frame" : "register",
				w->id, frame ? "sends" : "writes",
				process_name(i));
		return refuse(q, key);
	}
	return 0;
}

static int check_bits(struct check *q, int field, bool told)
{
	struct config_way w, x;
	char key[24];

	config_way(q->c, field, told, &w);
	if (w.kind != WAY_CAN && w.kind != WAY_REGISTER)
		return 0;
	key_name(field, told, key, sizeof(key));
	for (int i = 0; i < field; i++) {
		config_way(q->c, i, told, &x);
		if (!have_in_common(&x, &w))
			continue;
		interp_diag_say(q->diag, "generator.%s and generator.%s%s "
				"have bits of %s %u in common; a place of its "
				"own for each", key, told ? "told_" : "",
				process_name(i), w.kind == WAY_CAN ? "frame" :
				"register", w.id);
		return refuse(q, key);
	}
	if (!told && is_count(q, &w)) {
		interp_diag_say(q->diag, "generator.%s is in byte 1 of frame "
				"%u, which counts the frames; another byte, or "
				"another identifier", key, w.id);
		return refuse(q, key);
	}
	return told ? check_echo(q, field, &w, key) : 0;
}

static bool is_the_drives(const struct machine_config *c, uint32_t id)
{
	return c->backend == BACKEND_CAN402 &&
	       strcmp(c->can402.interface, c->generator.can_interface) == 0 &&
	       (id == (uint32_t)c->can402.gap_id ||
		!config_frame_is_free(c, id));
}

/* All that CiA 301 gives a node has its number in the lower seven bits. */
static bool is_the_plcs(const struct machine_config *c, uint32_t id)
{
	return config_has_plc(c) &&
	       config_generator_interface(c) == GENERATOR_CAN &&
	       strcmp(c->plc.interface, c->generator.can_interface) == 0 &&
	       (id & 0x7f) == (uint32_t)c->plc.node;
}

static int check_id(struct check *q, const char *key, uint32_t id)
{
	if (id == 0)
		return 0;
	if (is_the_drives(q->c, id)) {
		interp_diag_say(q->diag, "generator.%s %u, which is in use on "
				"that bus; " CONFIG_FRAME_WANTED, key, id);
		return refuse(q, key);
	}
	if (is_the_plcs(q->c, id)) {
		interp_diag_say(q->diag, "generator.%s %u, which is between "
				"edmd and the PLC on that bus; one whose rest "
				"by 128 is not plc.node %g", key, id,
				q->c->plc.node);
		return refuse(q, key);
	}
	return 0;
}

static int check_ids(struct check *q, int field, bool told)
{
	struct config_way w;
	char key[24];

	config_way(q->c, field, told, &w);
	return w.kind == WAY_CAN &&
	       check_id(q, key_name(field, told, key, sizeof(key)), w.id);
}

/* A person's field has any value, and a way to the generator has not. */
static int check_two_hands(struct check *q, uint32_t fields)
{
	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		struct config_way w;

		config_way(q->c, i, false, &w);
		if (!(fields >> i & 1) || w.kind == WAY_NONE)
			continue;
		interp_diag_say(q->diag, "generator.by_hand has %s, which "
				"reaches the generator by itself; one of the "
				"two", process_name(i));
		return refuse(q, "by_hand");
	}
	return 0;
}

static int check_by_hand(struct check *q)
{
	char odd[CONFIG_WAY_WORD];
	const uint32_t fields = config_hand_read(q->c->generator.by_hand, odd);

	if (!*odd)
		return check_two_hands(q, fields);
	interp_diag_say(q->diag, "generator.by_hand has \"%s\"; of peak_a "
			"on_us off_us polarity ignition_v iso servo_v sense "
			"pump, those that a person sets, each once", odd);
	return refuse(q, "by_hand");
}

static int check_fault_words(struct check *q)
{
	struct config_way told;
	const char *wrong;

	config_way(q->c, PROCESS_FAULT, true, &told);
	wrong = config_fault_read(q->c->generator.fault_words,
				  (exp2(told.bits) - 1) * told.scale);
	if (!wrong)
		return 0;
	interp_diag_say(q->diag, "generator.fault_words \"%.60s\" %s; none, "
			"or numbers and words, as 1 no water, 2 too warm",
			q->c->generator.fault_words, wrong);
	return refuse(q, "fault_words");
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

/* What the machine file itself gives, for a condition that does not. */
static int check_servo(struct check *q)
{
	const double servo_v = q->c->gap.servo_v;
	struct process_delivers d;
	char range[120];

	config_delivers(q->c, INTERP_TECH_SERVO_V, &d);
	if (process_takes(&d, INTERP_TECH_SERVO_V, servo_v))
		return 0;
	process_range_text(&d, INTERP_TECH_SERVO_V, range, sizeof(range));
	interp_diag_say(q->diag, "gap.servo_v %g V does not reach the "
			"generator; %s; or another [generator] servo_v",
			servo_v, range);
	return refuse_at(q, SECTION_GAP, "servo_v");
}

/* -- Modbus and a PLC ------------------------------------------------------ */

static bool has(const struct machine_config *c, enum config_way_kind kind)
{
	struct config_way w;

	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		config_way(c, i, false, &w);
		if (w.kind == kind)
			return true;
	}
	return false;
}

/* An interface that reaches nothing is no interface. */
static int check_reaches(struct check *q, enum config_way_kind kind,
			 const char *wanted)
{
	const int interface = config_generator_interface(q->c);

	if (has(q->c, kind))
		return 0;
	interp_diag_say(q->diag, "generator.interface is %s and it reaches no "
			"field; peak_a = %s", config_interface_word(interface),
			wanted);
	return refuse(q, "interface");
}

/* One that edmd sets while it sparks as it likes has sparks with another
 * condition than the place's. */
static int check_spark(struct check *q)
{
	const int interface = config_generator_interface(q->c);
	struct config_way spark;

	config_way(q->c, PROCESS_SPARK, false, &spark);
	if (spark.kind != WAY_NONE || !config_generator_beside(interface) ||
	    !config_backend(q->c)->has_gap(q->c))
		return 0;
	interp_diag_say(q->diag, "generator.spark reaches nothing; spark = %s: "
			"a line ends sparks at once",
			config_generator_gpio(q->c, PROCESS_SPARK) ?
			"auto, which is [gpio] spark" :
			interface == GENERATOR_CAN ?
			"can ID byte N bit N, or line N" :
			q->c->backend == BACKEND_GPIO ?
			"line N, or [gpio] spark" : "line N");
	return refuse(q, "spark");
}

/* libmodbus would take 9600 for another one. */
static int check_baud(struct check *q)
{
	static const double speed[] = {
		300, 600, 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200,
		230400, 460800, 500000, 576000, 921600
	};
	const double baud = q->c->generator.baud;

	for (size_t i = 0; i < sizeof(speed) / sizeof(speed[0]); i++)
		if (baud == speed[i])
			return 0;
	interp_diag_say(q->diag, "generator.modbus_baud %.0f is no speed of a "
			"serial port; 300 600 1200 2400 4800 9600 19200 38400 "
			"57600 115200 230400 460800 500000 576000 921600",
			baud);
	return refuse(q, "modbus_baud");
}

static int check_modbus_at(struct check *q)
{
	const struct config_generator *g = &q->c->generator;
	struct config_modbus_at at;
	const char *wrong = config_modbus_read(g->modbus, &at);

	if (wrong) {
		interp_diag_say(q->diag, "generator.modbus \"%s\" %s; "
				CONFIG_MODBUS_WANTED, g->modbus, wrong);
		return refuse(q, "modbus");
	}
	if ((at.serial && g->unit < 1) ||
	    (g->unit > 247 && (at.serial || g->unit < 255))) {
		interp_diag_say(q->diag, "generator.modbus_unit %.0f %s; 1 to "
				"247%s", g->unit, at.serial ?
				"on a serial port" : "over TCP",
				at.serial ? "" : ", 0 or 255");
		return refuse(q, "modbus_unit");
	}
	return check_baud(q);
}

/* One answer that is lost is no fault yet. */
static int check_modbus_silence(struct check *q)
{
	const struct config_generator *g = &q->c->generator;
	const double least = 2 * g->timeout_ms + g->every_ms;

	if (g->silent_ms >= least)
		return 0;
	interp_diag_say(q->diag, "generator.silent_ms %g is less than two "
			"modbus_timeout_ms and a modbus_every_ms; at least %g",
			g->silent_ms, least);
	return refuse(q, "silent_ms");
}

static int check_modbus(struct check *q)
{
	if (config_generator_interface(q->c) != GENERATOR_MODBUS)
		return 0;
	return check_modbus_at(q) || check_modbus_silence(q) ||
	       check_reaches(q, WAY_REGISTER, WANTED_REGISTER) ? -EINVAL : 0;
}

/* CiA 301 keeps 6E0 and what follows for itself. */
#define PULSE_NODE_MAX	95

static int check_by_plc(struct check *q)
{
	if (config_generator_interface(q->c) != GENERATOR_PLC)
		return 0;
	if (!config_has_plc(q->c)) {
		interp_diag_say(q->diag, "generator.interface is plc and there "
				"is no PLC; [plc] interface = can1, or where "
				"it is");
		return refuse(q, "interface");
	}
	if (q->c->plc.node > PULSE_NODE_MAX) {
		interp_diag_say(q->diag, "generator.interface is plc and "
				"plc.node %.0f; a node of 1 to %d, for the "
				"identifier of EdmdPulse", q->c->plc.node,
				PULSE_NODE_MAX);
		return refuse(q, "interface");
	}
	return check_reaches(q, WAY_PLC, "plc");
}

/* -- Counts for the gap servo ---------------------------------------------- */

/* Arcs may be left out: then they are in one of the others. */
static int check_sum(struct check *q, int field)
{
	const double most = PROCESS_MOST_PULSES_S * 1e-3 *
			    q->c->gap.share_stale_ms;
	struct config_way w;
	char key[24];

	config_way(q->c, field, true, &w);
	key_name(field, true, key, sizeof(key));
	if (w.kind == WAY_NONE && field == PROCESS_ARCS)
		return 0;
	if (w.kind == WAY_NONE) {
		interp_diag_say(q->diag, "gap.source is counts and generator."
				"%s is none; told_opens, told_sparks and "
				"told_shorts of a generator on can or modbus",
				key);
		return refuse_at(q, SECTION_GAP, "source");
	}
	if (exp2(w.bits - 1) * w.scale >= most)
		return 0;
	interp_diag_say(q->diag, "generator.%s has bits %u: in "
			"gap.share_stale_ms %g it may begin anew unseen; bits "
			"%d at least, or a shorter share_stale_ms", key,
			w.bits, q->c->gap.share_stale_ms,
			w.kind == WAY_REGISTER ? 32 :
			(int)ceil(log2(most / w.scale)) + 1);
	return refuse(q, key);
}

/* The second telling with sparks is the first reading, and one answer may be
 * lost. */
static int check_stale(struct check *q)
{
	const struct config_generator *g = &q->c->generator;
	const bool modbus = config_generator_interface(q->c) ==
			    GENERATOR_MODBUS;
	const double least = modbus ? 2 * g->every_ms + g->timeout_ms :
			     4e-6 * (double)config_period_ns(q->c);

	if (q->c->gap.share_stale_ms >= least)
		return 0;
	interp_diag_say(q->diag, "gap.share_stale_ms %g is less than %s; at "
			"least %g", q->c->gap.share_stale_ms, modbus ?
			"two generator.modbus_every_ms and a modbus_timeout_ms"
			: "four periods", least);
	return refuse_at(q, SECTION_GAP, "share_stale_ms");
}

/* Without sparks there is nothing to count, and a gap to be felt. */
static bool has_voltage(const struct machine_config *c)
{
	return c->backend == BACKEND_CAN402 ? c->can402.gap_id > 0 :
	       c->backend == BACKEND_GPIO && strcmp(c->gpio.adc, "none") != 0;
}

static int check_counts(struct check *q)
{
	if (q->c->gap.source != GAP_COUNTS)
		return 0;
	if (!has_voltage(q->c)) {
		interp_diag_say(q->diag, "gap.source is counts and nothing "
				"feels the gap without sparks; gpio.adc with "
				"backend gpio, can402.gap_id with can402; with "
				"backend sim source = shares");
		return refuse_at(q, SECTION_GAP, "source");
	}
	for (int i = PROCESS_OPENS; i <= PROCESS_SHORTS; i++)
		if (check_sum(q, i))
			return -EINVAL;
	return check_stale(q);
}

static int check_interface(struct check *q)
{
	const bool model = config_machine_is(q->c, MACHINE_MODEL);
	const int i = config_generator_interface(q->c);

	if (model == (i == GENERATOR_SIM) || (model && i == GENERATOR_NONE))
		return 0;
	interp_diag_say(q->diag, "generator.interface and machine.backend do "
			"not agree; interface = sim with backend sim, %s",
			"and none, lines, can, modbus or plc with the others");
	return refuse(q, "interface");
}

int config_check_generator(const struct machine_config *c,
			   const struct config_lines *lines,
			   struct interp_diag *diag)
{
	struct check q = { c, lines, diag };

	if (check_interface(&q) || check_by_hand(&q) ||
	    check_fault_words(&q) ||
	    check_id(&q, "can_id", (uint32_t)c->generator.can_id))
		return -EINVAL;
	for (int i = 0; i < PROCESS_NTOLD; i++)
		if ((i < PROCESS_NFIELDS && check_way(&q, i, false)) ||
		    check_way(&q, i, true))
			return -EINVAL;
	for (int i = 0; i < PROCESS_NTOLD; i++) {
		const bool asked = i < PROCESS_NFIELDS;

		if ((asked && (check_lines(&q, i) || check_dac(&q, i) ||
			       check_bits(&q, i, false) ||
			       check_ids(&q, i, false))) ||
		    check_bits(&q, i, true) || check_ids(&q, i, true) ||
		    check_told(&q, i))
			return -EINVAL;
	}
	return check_modbus(&q) || check_by_plc(&q) || check_spark(&q) ||
	       check_servo(&q) || check_counts(&q) ||
	       check_guard(&q, LINE_WATCHDOG, c->gpio.watchdog_by,
			   "watchdog") ||
	       check_guard(&q, LINE_ESTOP, c->gpio.estop_by, "estop") ||
	       config_check_unused(c, lines, diag) ?
	       -EINVAL : 0;
}
