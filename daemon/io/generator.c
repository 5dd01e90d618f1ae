/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator.c - a generator in front of the machine that moves the axes
 */
#include "generator_own.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define REFRESH_S	2e-3
#define EVER		(UINT32_MAX / 4)	/* versions: before all that a
						 * place may need */

/* -- What the log says ----------------------------------------------------- */

void generator_tell(struct generator *g, const struct generator_note *n)
{
	const uint32_t put = atomic_load(&g->put);

	if (put - atomic_load(&g->taken) == GENERATOR_NOTES)
		return;
	g->notes[put % GENERATOR_NOTES] = *n;
	atomic_store(&g->put, put + 1);
}

/* As the Modbus standard has them. */
static const char *exception_words(int code)
{
	static const char *const words[] = {
		"", ", no such function", ", no such register",
		", no such value", ", its device failed",
	};

	return code > 0 && code < 5 ? words[code] : "";
}

/* A value that is not given, or was not told yet. */
static const char *value_text(double value, char buf[24])
{
	snprintf(buf, 24, isnan(value) ? "nothing" : "%g", value);
	return buf;
}

static void put_values(const struct generator_note *n, const char *how,
		       char *buf, size_t size)
{
	char asked[24], told[24];

	snprintf(buf, size, "generator: %s %s: asked %s, told %s%s",
		 process_name(n->field), how, value_text(n->asked, asked),
		 value_text(n->told, told), n->code ? ", not taken" : "");
}

static void put_text(const struct generator_note *n, const char *words,
		     char *buf, size_t size)
{
	const char *name = process_name(n->field);
	char asked[24], own[CONFIG_FAULT_MAX];

	switch (n->kind) {
	case GENERATOR_SILENT:
		snprintf(buf, size, "generator: it does not tell its %s any "
			 "more", name);
		break;
	case GENERATOR_DIFFERS:
		put_values(n, "was in force and is no more", buf, size);
		break;
	case GENERATOR_LATE:
		put_values(n, "is not in force in confirm_s", buf, size);
		break;
	case GENERATOR_FAULT:
		snprintf(buf, size, "generator: its own fault %s",
			 config_fault_text(words, n->code, own, sizeof(own)));
		break;
	case GENERATOR_UNCOUNTED:
		snprintf(buf, size, n->field == PROCESS_FAULT ?
			 "generator: its sums of pulses stand still or jump, "
			 "for share_stale_ms" :
			 "generator: it does not tell its %s, for "
			 "share_stale_ms", name);
		break;
	case GENERATOR_DAC:
		snprintf(buf, size, "generator: the converter of %s: asked %s: "
			 "%s", name, value_text(n->asked, asked),
			 strerror(n->code));
		break;
	case GENERATOR_LINES_LOST:
		snprintf(buf, size, "generator: its lines do not answer");
		break;
	case GENERATOR_REFUSES:
		snprintf(buf, size, "generator: it refuses %s: asked %s, "
			 "answered exception %d%s", name,
			 value_text(n->asked, asked), n->code,
			 exception_words(n->code));
		break;
	case GENERATOR_LINK_DOWN:
		snprintf(buf, size, "generator: its Modbus link is down: %s",
			 strerror(n->code));
		break;
	case GENERATOR_LINK_BACK:
		snprintf(buf, size, "generator: its Modbus link is there");
		break;
	case GENERATOR_BUS_DOWN:
		snprintf(buf, size, "generator: its CAN interface is down");
		break;
	case GENERATOR_BUS_BACK:
		snprintf(buf, size, "generator: its CAN interface is back");
		break;
	}
}

static bool generator_note(void *self, char *buf, size_t size)
{
	struct generator *g = self;
	const uint32_t taken = atomic_load(&g->taken);

	if (taken == atomic_load(&g->put))
		return g->axes.note && g->axes.note(g->axes.self, buf, size);
	put_text(&g->notes[taken % GENERATOR_NOTES], g->fault_words, buf, size);
	atomic_store(&g->taken, taken + 1);
	return true;
}

/* -- What it says ---------------------------------------------------------- */

static bool tells(const struct generator *g, int field)
{
	return g->told[field].kind != WAY_NONE;
}

static bool is_taken(const struct generator *g, int field)
{
	return field < PROCESS_NFIELDS &&
	       (g->way[field].kind == WAY_REGISTER ||
		g->way[field].kind == WAY_PLC);
}

/* One that tells nothing still answers. */
static bool answers(const struct generator *g, int field)
{
	return tells(g, field) || is_taken(g, field);
}

double generator_slack(const struct config_way *told)
{
	return told->scale * 0.501 + told->within;
}

/* What was asked is a step of the generator, but for a converter: then it is a
 * step of that beside it. */
static double slack_of(const struct generator *g, int field)
{
	const double step = g->dac ? generator_dac_step(g, field) : 0;

	return step + generator_slack(&g->told[field]);
}

static bool agrees(const struct generator *g, int field)
{
	return !tells(g, field) || isnan(g->value[field]) ||
	       fabs(g->heard[field] - g->value[field]) <= slack_of(g, field);
}

void generator_trouble(struct generator *g, const struct generator_note *n)
{
	struct generator_note full = *n;

	if (g->says.trouble)
		return;
	g->says.trouble = true;
	if (n->field < INTERP_NGENERATOR) {
		full.asked = g->value[n->field];
		full.told = g->heard[n->field];
	}
	if (n->kind == GENERATOR_LATE || n->kind == GENERATOR_DIFFERS)
		full.code = agrees(g, n->field);
	generator_tell(g, &full);
}

static void trouble_of(struct generator *g, enum generator_note_kind kind,
		       int field)
{
	generator_trouble(g, &(struct generator_note) {
		.kind = kind, .field = field });
}

void generator_refused(struct generator *g, int field, int exception)
{
	generator_trouble(g, &(struct generator_note) {
		.kind = GENERATOR_REFUSES, .field = field, .code = exception });
}

/* What was asked last is still on its way to it. */
static bool is_on_its_way(const struct generator *g)
{
	return g->takes && g->taken_version != g->asked;
}

/* The first field that it tells otherwise, or that waits for its answer; -1:
 * there is none. */
static int odd_one(const struct generator *g)
{
	const bool waits = is_on_its_way(g);

	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (!agrees(g, i))
			return i;
	for (int i = 0; i < PROCESS_NFIELDS && waits; i++)
		if (is_taken(g, i))
			return i;
	for (int i = 0; g->dac && i < INTERP_NGENERATOR; i++)
		if (g->way[i].kind == WAY_DAC && generator_dac_waits(g))
			return i;
	return -1;
}

/* One that it had, and tells otherwise now; -1: there is none. */
static int lost_one(const struct generator *g)
{
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (g->had >> i & 1 && !agrees(g, i))
			return i;
	return -1;
}

static bool is_silent(struct generator *g)
{
	bool silent = false;

	for (int i = 0; i < PROCESS_NTOLD; i++) {
		if (!answers(g, i) || g->age[i] <= g->silent)
			continue;
		silent = true;
		trouble_of(g, GENERATOR_SILENT, i);
	}
	return silent;
}

static bool is_there(const struct generator *g)
{
	for (int i = 0; i < PROCESS_NTOLD; i++)
		if (answers(g, i) && g->age[i] >= g->up)
			return false;
	return true;
}

/* It may be switched on after edmd: it is judged from then on. */
static void greet(struct generator *g)
{
	if (g->came || !is_there(g))
		return;
	g->came = true;
	g->waited = 0;
	g->says.trouble = false;
}

/* A place may need an older version than that of its last step against arcs. */
static void have_nothing(struct generator *g)
{
	g->says.in_force = g->asked - EVER;
}

static void look(struct generator *g)
{
	const bool silent = is_silent(g);
	const int odd = odd_one(g), lost = lost_one(g);

	if (g->heard[PROCESS_FAULT] > 0)
		generator_trouble(g, &(struct generator_note) {
			.kind = GENERATOR_FAULT, .field = PROCESS_FAULT,
			.code = (int)g->heard[PROCESS_FAULT] });
	if (lost >= 0)
		trouble_of(g, GENERATOR_DIFFERS, lost);
	g->settling -= g->settling > 0 && !is_on_its_way(g);
	if (odd < 0 && !silent && !g->settling) {
		g->had = UINT32_MAX;
		g->says.in_force = g->asked;
		g->waited = 0;
	} else if (g->says.in_force == g->asked) {
		if (odd >= 0)
			trouble_of(g, GENERATOR_DIFFERS, odd);
		have_nothing(g);
	} else if (odd >= 0 && ++g->waited > g->confirm) {
		trouble_of(g, GENERATOR_LATE, odd);
	}
}

/* What is told while it is dark is of sparks before that. */
static void hand_energy_on(struct generator *g, struct io_inputs *in)
{
	if (!tells(g, PROCESS_ENERGY_J))
		return;
	in->energy_valid = !isnan(g->heard[PROCESS_ENERGY_J]);
	in->energy_j = g->value[PROCESS_SPARK] > 0 ? g->energy_j : 0;
	g->energy_j -= in->energy_j;
}

static void generator_read(void *self, struct io_inputs *in)
{
	struct generator *g = self;

	g->axes.read(g->axes.self, in);
	g->ill = in->trouble != IO_WELL || in->lost;
	for (int i = 0; i < PROCESS_NTOLD; i++)
		g->age[i] += g->age[i] < UINT32_MAX;
	g->up += g->up < UINT32_MAX;
	if (g->fd >= 0)
		generator_can_read(g);
	if (g->modbus)
		g->modbus_read(g);
	if (g->plc)
		generator_plc_read(g);
	if (g->dac)
		generator_dac_read(g);
	greet(g);
	look(g);
	hand_energy_on(g, in);
	generator_counts_read(g, in);
	memcpy(g->says.told, g->heard, sizeof(g->says.told));
	in->generator = g->says;
	/* Where the bus is the drives' too, it is their trouble. */
	in->generator.trouble = g->says.trouble || (g->down && !g->ill);
}

/* What a sum can have gone on by since it was told last. */
static double most_of(const struct generator *g, int field)
{
	const double each_s = field == PROCESS_ENERGY_J ? PROCESS_MOST_W :
				PROCESS_MOST_PULSES_S;

	return each_s * g->period_s * ((double)g->age[field] + g->silent);
}

/* More than that, or than half of its range: it has begun anew. */
static void run_on(struct generator *g, int field, uint64_t count)
{
	const struct config_way *w = &g->told[field];
	const uint64_t bits = (UINT64_C(1) << w->bits) - 1;
	const uint64_t more = (count - g->count[field]) & bits;
	const bool first = isnan(g->heard[field]);
	const double ahead = (double)more * w->scale;
	const bool reset = first || more > bits / 2 ||
			   ahead > most_of(g, field);
	const double add = reset ? 0 : ahead;

	g->heard[field] = first ? 0 : g->heard[field] + add;
	generator_counts_hear(g, field, reset);
	if (field == PROCESS_ENERGY_J)
		g->energy_j += add;
}

void generator_hears(struct generator *g, int field, uint64_t count)
{
	if (process_is_sum(field))
		run_on(g, field, count);
	else
		g->heard[field] = generator_value(&g->told[field], field,
						  count);
	g->count[field] = count;
	g->age[field] = 0;
}

/* -- What it is asked for -------------------------------------------------- */

uint32_t generator_code(const struct config_way *w, double value)
{
	for (uint32_t i = 0; i < w->ncodes; i++)
		if (w->code[i] == value)
			return i;
	return 0;
}

/* A negative electrode is on.  With all bits on it has its own setting. */
uint64_t generator_count(const struct config_way *w, int field, double value)
{
	if (field == INTERP_TECH_POLARITY)
		return value < 0;
	if (w->ncodes)
		return generator_code(w, value);
	if (w->bits == 1)
		return value > 0;
	return isnan(value) ? UINT64_MAX : (uint64_t)(value / w->scale + 0.5);
}

double generator_value(const struct config_way *w, int field, uint64_t count)
{
	if (field == INTERP_TECH_POLARITY)
		return count ? -1 : 1;
	if (w->ncodes)
		return count < w->ncodes ? w->code[count] : (double)NAN;
	return (double)count * (w->bits == 1 ? 1 : w->scale);
}

/* What it tells does not show when it has its value: it tells the same of the
 * one before, or nothing.  Registers that are not told are settled where they
 * are written. */
static bool is_unseen(const struct generator *g, int field)
{
	const enum config_way_kind kind = g->way[field].kind;

	return agrees(g, field) &&
	       (kind == WAY_CAN || kind == WAY_LINES ||
		(kind == WAY_REGISTER && tells(g, field)));
}

static bool is_same(double a, double b)
{
	return a == b || (isnan(a) && isnan(b));
}

static void take(struct generator *g, const struct io_outputs *out)
{
	const bool other = out->asked != g->asked;

	if (other) {
		/* One that is still on its way to other values may tell those
		 * of before that. */
		if (g->says.in_force != g->asked)
			g->settling = g->settle;
		g->waited = 0;
		g->says.trouble = false;	/* it is judged anew */
	}
	/* A step against arcs, with sparks, is of one value. */
	if ((other && !out->power) || out->reset)
		g->had = 0;
	g->asked = out->asked;
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		if (is_same(g->value[i], out->pulse[i]))
			continue;
		g->had &= ~(1u << i);
		g->value[i] = out->pulse[i];
		if (is_unseen(g, i))
			g->settling = g->settle;
	}
	g->anew = out->reset;
	if (out->reset) {		/* what it has must be told again */
		g->says.trouble = false;
		have_nothing(g);
	}
	g->value[PROCESS_SENSE] = out->sense;
	g->value[PROCESS_PUMP] = out->pump && !g->ill;
	g->value[PROCESS_SPARK] = out->power && !g->ill && !g->says.trouble;
}

static void generator_write(void *self, const struct io_outputs *out)
{
	struct generator *g = self;

	take(g, out);
	if (g->lines && !g->lines_write(g))
		trouble_of(g, GENERATOR_LINES_LOST, PROCESS_NFIELDS);
	if (g->fd >= 0)
		generator_can_write(g);
	if (g->modbus)
		g->modbus_write(g);
	if (g->plc)
		generator_plc_write(g);
	if (g->dac)
		generator_dac_write(g);
	g->axes.write(g->axes.self, out);
}

static bool generator_origin(void *self, int32_t ret[IO_NAXES])
{
	const struct generator *g = self;

	return g->axes.origin(g->axes.self, ret);
}

static void generator_originate(void *self, const int32_t zero[IO_NAXES])
{
	const struct generator *g = self;

	g->axes.originate(g->axes.self, zero);
}

static void generator_drives(void *self, struct cia402_told *ret)
{
	const struct generator *g = self;

	g->axes.drives(g->axes.self, ret);
}

static bool generator_object(void *self, const struct cia402_request *r)
{
	const struct generator *g = self;

	return g->axes.object(g->axes.self, r);
}

static void generator_close(void *self)
{
	struct generator *g = self;

	for (int i = 0; i < PROCESS_NFIELDS; i++)
		g->value[i] = i < INTERP_NGENERATOR ? (double)NAN : 0;
	if (g->lines) {
		g->lines_write(g);
		g->lines_close(g->lines);
	}
	if (g->fd >= 0)
		generator_can_write(g);
	if (g->modbus)
		g->modbus_write(g);
	generator_dac_close(g);
	g->axes.close(g->axes.self);
	/* The last: it may wait for an answer. */
	if (g->modbus)
		g->modbus_end(g->modbus);
	generator_forget(g);
}

static uint32_t periods(const struct machine_config *c, double s)
{
	const double n = s * 1e9 / (double)config_period_ns(c);

	return n < 1 ? 1 : (uint32_t)(n + 0.5);
}

void generator_forget(struct generator *g)
{
	if (g->fd >= 0)
		close(g->fd);
	free(g);
}

struct generator *generator_attach(struct io_machine *m,
				   const struct machine_config *c, int fd)
{
	struct generator *g = calloc(1, sizeof(*g));

	if (!g)
		return NULL;
	g->axes = *m;
	have_nothing(g);
	g->fd = fd;
	g->period_s = (double)config_period_ns(c) * 1e-9;
	g->refresh = periods(c, REFRESH_S);
	g->silent = periods(c, c->generator.silent_ms * 1e-3);
	g->confirm = periods(c, c->generator.confirm_s);
	g->settle = periods(c, c->generator.settle_ms * 1e-3);
	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		config_way(c, i, false, &g->way[i]);
		g->value[i] = i < INTERP_NGENERATOR ? (double)NAN : 0;
	}
	generator_counts_init(g, c, periods(c, c->gap.share_stale_ms * 1e-3));
	g->fault_words = c->generator.fault_words;
	for (int i = 0; i < PROCESS_NTOLD; i++) {
		config_way(c, i, true, &g->told[i]);
		g->says.tells |= tells(g, i) ? 1u << i : 0;
		g->heard[i] = (double)NAN;
	}
	if (fd >= 0)
		generator_can_init(g, c);
	m->self = g;
	m->read = generator_read;
	m->write = generator_write;
	m->close = generator_close;
	m->note = generator_note;
	m->origin = m->origin ? generator_origin : NULL;
	m->originate = m->originate ? generator_originate : NULL;
	m->drives = m->drives ? generator_drives : NULL;
	m->object = m->object ? generator_object : NULL;
	return g;
}
