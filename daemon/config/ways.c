/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ways.c - how a field reaches the generator, as text of the machine file
 */
#include "keys.h"

#include "plc_signals.h"

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NATURAL_BITS	16

const char *config_way_word(enum config_way_kind kind)
{
	static const char *const words[] = {
		[WAY_NONE] = "none", [WAY_OWN] = "own", [WAY_CAN] = "can",
		[WAY_LINES] = "lines", [WAY_REGISTER] = "register",
		[WAY_PLC] = "plc", [WAY_DAC] = "dac",
	};

	return words[kind];
}

_Static_assert(CONFIG_DEVICE_MAX == CONFIG_WAY_WORD, "a device is a word");

struct words {
	const char *at;
	char word[CONFIG_WAY_WORD];
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
	return end != word && *end == '\0' && isfinite(*ret) &&
	       !strpbrk(word, "xX");
}

/* On or off; polarity is one of these too. */
static bool is_switch(int field)
{
	return (field >= INTERP_NGENERATOR && field < PROCESS_NFIELDS) ||
	       field == INTERP_TECH_POLARITY || field == INTERP_TECH_ISO;
}

static double range_min(int field)
{
	return field < INTERP_NGENERATOR ? interp_tech_field[field].min : 0;
}

static double range_max(int field)
{
	return field < INTERP_NGENERATOR ? interp_tech_field[field].max :
	       field < PROCESS_NFIELDS ? 1 : (double)INFINITY;
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

void config_way_all(int field, bool by_hand, struct process_delivers *ret)
{
	*ret = (struct process_delivers) {
		.there = true, .by_hand = by_hand,
		.min = range_min(field), .max = range_max(field),
	};
	if (is_switch(field))
		give_switch(ret, field);
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

static const char *read_codes(struct words *w, uint32_t most,
			      struct config_way *ret)
{
	double v;

	while (next(w)) {
		if (ret->ncodes == most)
			return "has more codes than its lines or bits make";
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
	return w->gives.n ? NULL : "makes no value but 0, which is none";
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
	wrong = weights ? read_weights(w, ret) :
			  read_codes(w, 1u << ret->nlines, ret);
	return wrong ? wrong : give_codes(ret, field);
}

/* A place in bits: what may be said of it. */
struct place {
	double byte, bit;		/* -1: not said */
	int bytes, bit_max, bits_max;
	bool wide;			/* two registers may be one number */
};

static bool is_whole(double v, double min, double max)
{
	return v >= min && v <= max && v == floor(v);
}

static bool read_pair(const char *key, double v, struct place *at,
		      struct config_way *ret)
{
	if (strcmp(key, "byte") == 0 && is_whole(v, 0, at->bytes - 1))
		at->byte = v;
	else if (strcmp(key, "bit") == 0 && is_whole(v, 0, at->bit_max))
		at->bit = v;
	else if (strcmp(key, "bits") == 0 && is_whole(v, 1, at->bits_max))
		ret->bits = (uint8_t)v;
	else if (strcmp(key, "bits") == 0 && at->wide && v == 32)
		ret->bits = 32;
	else if (strcmp(key, "scale") == 0 && v > 0)
		ret->scale = v;
	else if (strcmp(key, "within") == 0 && v > 0)
		ret->within = v;
	else
		return false;
	return true;
}

static bool is_end(const char *word, bool *ret_low)
{
	*ret_low = strcmp(word, "low") == 0;
	return *ret_low || strcmp(word, "high") == 0;
}

static bool read_place(struct words *w, struct place *at,
		       struct config_way *ret)
{
	char key[CONFIG_WAY_WORD];
	double v;

	while (next(w) && strcmp(w->word, "codes") != 0) {
		memcpy(key, w->word, sizeof(key));
		if (strcmp(key, "first") == 0 && at->wide && next(w) &&
		    is_end(w->word, &ret->low_first))
			continue;
		if (!next(w) || !number(w->word, &v) ||
		    !read_pair(key, v, at, ret))
			return false;
	}
	return true;
}

/* In a frame the count with all bits set says: the generator's own setting. */
static void give_counts(struct config_way *w, int field)
{
	const double counts = exp2(w->bits) -
			      (w->kind == WAY_REGISTER ? 1 : 2);
	const double least = ceil(range_min(field) / w->scale);

	w->gives.step = w->scale;
	w->gives.min = fmax(least, 1) * w->scale;
	w->gives.max = fmin(counts * w->scale, range_max(field));
}

/* Not codes. */
static const char *give_place(struct config_way *w, int field)
{
	if (is_switch(field) != (w->bits == 1))
		return is_switch(field) ? "is of a field that is on or off" :
					  "is one bit of a number";
	if (is_switch(field) && (w->scale != 1 || w->within > 0))
		return "has a scale, and is of a field that is on or off";
	if (is_switch(field))
		give_switch(&w->gives, field);
	else
		give_counts(w, field);
	return w->gives.n || w->gives.max > w->gives.min ? NULL :
	       "cannot hold a value of the field";
}

static const char *read_can(struct words *w, int field, struct config_way *ret)
{
	struct place at = { -1, 0, 8, 7, 32, false };
	double id;

	if (!next(w) || !number(w->word, &id) || !is_whole(id, 1, 2047))
		return "has no identifier of 1 to 2047";
	*ret = (struct config_way) {
		.kind = WAY_CAN, .gives.there = true, .id = (uint16_t)id,
		.bits = is_switch(field) ? 1 : NATURAL_BITS, .scale = 1,
	};
	if (!read_place(w, &at, ret) || *w->word)
		return "has a word that is none of byte 0 to 7, bit 0 to 7, "
		       "bits 1 to 32, scale, within of what is told";
	if (at.byte < 0)
		return "has no byte";
	ret->bit = (uint8_t)(8 * at.byte + at.bit);
	if (ret->bit + ret->bits > 64)
		return "goes beyond the eighth byte";
	return give_place(ret, field);
}

static const char *read_register(struct words *w, int field,
				 struct config_way *ret)
{
	struct place at = { -1, 0, 0, 15, 16, field >= PROCESS_NFIELDS };
	const bool input = strcmp(w->word, "input") == 0;
	const char *wrong;
	double id;

	if (!next(w) || !number(w->word, &id) || !is_whole(id, 0, 65535))
		return "has no address of 0 to 65535";
	*ret = (struct config_way) {
		.kind = WAY_REGISTER, .gives.there = true, .input = input,
		.id = (uint16_t)id, .scale = 1,
		.bits = is_switch(field) ? 1 : NATURAL_BITS,
	};
	if (!read_place(w, &at, ret))
		return "has a word that is none of bit 0 to 15, bits 1 to 16 or "
		       "32, first, scale, codes, within of what is told";
	if (ret->low_first && ret->bits != 32)
		return "has an order, and one register";
	ret->bit = (uint8_t)at.bit;
	if (at.bit > 0 && ret->bits == NATURAL_BITS)
		ret->bits = (uint8_t)(NATURAL_BITS - ret->bit);
	if (ret->bit + ret->bits > 16 && (ret->bit || ret->bits != 32))
		return "goes beyond the sixteenth bit";
	if (ret->bits == 32 && ret->id == 65535)
		return "goes beyond the last register";
	if (!*w->word)
		return give_place(ret, field);
	if (is_switch(field))
		return "has codes and is of a field that is on or off";
	if (field >= PROCESS_NFIELDS)
		return "has codes and is a sum or a number";
	ret->scale = 0;
	wrong = read_codes(w, (uint32_t)fmin(exp2(ret->bits),
					     PROCESS_VALUES_MAX), ret);
	return wrong ? wrong : give_codes(ret, field);
}

/* The scale of its signal; 1: it is a bit, or a number; 0: a PLC has none. */
static double plc_scale(int field)
{
#define SCALE(S, id, i, tpdo, rpdo, byte, name, unit, scale, help) \
	[INTERP_TECH_##id] = scale,
	static const double scale[PROCESS_NTOLD] = {
		PLC_PULSE_ROWS(SCALE, 0)
		[INTERP_TECH_POLARITY] = 1, [INTERP_TECH_ISO] = 1,
		[PROCESS_PUMP] = 1, [PROCESS_FAULT] = 1,
	};
#undef SCALE

	return scale[field];
}

bool config_plc_pulse(int field)
{
	return plc_scale(field) > 0;
}

/* As in a frame, all bits set say: its own setting. */
static const char *read_plc(struct words *w, int field, struct config_way *ret)
{
	*ret = (struct config_way) {
		.kind = WAY_PLC, .gives.there = true,
		.bits = is_switch(field) ? 1 : NATURAL_BITS,
		.scale = plc_scale(field),
	};
	if (*w->at)
		return "has a word after plc";
	if (field == PROCESS_SPARK || field == PROCESS_SENSE)
		return "is by the PLC, and those take a round trip: it must be "
		       "a line";
	if (!config_plc_pulse(field))
		return "is a sum, and the PLC has no signal for it";
	return give_place(ret, field);
}

static bool is_channel(const char *word, struct config_way *ret)
{
	const bool voltage = strncmp(word, "voltage", 7) == 0;
	const char *at = word + 7;
	double id;

	ret->current = !voltage;
	if ((!voltage && strncmp(word, "current", 7) != 0) ||
	    strspn(at, "0123456789") != strlen(at) || !number(at, &id) ||
	    !is_whole(id, 0, 65535))
		return false;
	ret->id = (uint16_t)id;
	return true;
}

static double *dac_key(const char *key, struct config_way *w)
{
	return strcmp(key, "scale") == 0 ? &w->scale :
	       strcmp(key, "zero") == 0 ? &w->zero :
	       strcmp(key, "to") == 0 ? &w->most : NULL;
}

/* Its steps are the device's; it is asked for them when it is opened. */
static const char *read_dac(struct words *w, int field, struct config_way *ret)
{
	double *at;

	*ret = (struct config_way) {
		.kind = WAY_DAC, .gives.there = true, .scale = 1,
		.most = (double)NAN,
	};
	if (is_switch(field))
		return "is of a field that is on or off";
	if (!next(w))
		return "has no device";
	memcpy(ret->device, w->word, sizeof(ret->device));
	if (!next(w) || !is_channel(w->word, ret))
		return "has no channel voltageN or currentN";
	while (next(w)) {
		at = dac_key(w->word, ret);
		if (!at || !next(w) || !number(w->word, at))
			return "has a word that is none of scale, zero, to "
			       "with a number";
	}
	if (!(ret->scale > 0) || !(ret->most > ret->zero))
		return "has no scale above 0, or no highest output: to N, "
		       "above zero";
	ret->gives.min = range_min(field);
	ret->gives.max = fmin((ret->most - ret->zero) * ret->scale,
			      range_max(field));
	return ret->gives.max > ret->gives.min ? NULL :
	       "cannot hold a value of the field";
}

/* Of two scales one would be lost. */
static bool has_twice(const char *text)
{
	struct words a = { .at = text };

	while (next(&a)) {
		struct words b = { .at = a.at };

		while (strspn(a.word, "abcdefghijklmnopqrstuvwxyz") ==
		       strlen(a.word) && next(&b))
			if (strcmp(a.word, b.word) == 0)
				return true;
	}
	return false;
}

const char *config_way_read(const char *text, int field,
			    struct config_way *ret)
{
	struct words w = { .at = text };

	*ret = (struct config_way) { .kind = WAY_NONE };
	next(&w);
	if (strcmp(w.word, "none") == 0)
		return *w.at ? "has a word after none" : NULL;
	if (has_twice(w.at))
		return "has a word twice";
	if (strcmp(w.word, "lines") == 0 || strcmp(w.word, "line") == 0)
		return read_way_lines(&w, field, ret);
	if (strcmp(w.word, "can") == 0)
		return read_can(&w, field, ret);
	if (strcmp(w.word, "register") == 0 || strcmp(w.word, "input") == 0)
		return read_register(&w, field, ret);
	if (strcmp(w.word, "plc") == 0)
		return read_plc(&w, field, ret);
	if (strcmp(w.word, "dac") == 0)
		return read_dac(&w, field, ret);
	return "begins with no word of auto, none, lines, can, register, plc, "
	       "dac";
}

/* Numbers only: to look a name up takes as long as it likes. */
static bool is_address(const char *host)
{
	uint8_t at[sizeof(struct in6_addr)];

	return inet_pton(strchr(host, ':') ? AF_INET6 : AF_INET, host, at) == 1;
}

const char *config_modbus_read(const char *text, struct config_modbus_at *ret)
{
	const char *port = strrchr(text, ':'), *host = text;
	size_t n = port ? (size_t)(port - text) : 0;
	double number_of;

	*ret = (struct config_modbus_at) { .serial = *text == '/' };
	if (ret->serial) {
		snprintf(ret->host, sizeof(ret->host), "%s", text);
		return strlen(text) < sizeof(ret->host) ? NULL : "is too long";
	}
	if (!port)
		return "is no device and has no port";
	if (*host == '[' && n > 1 && port[-1] == ']') {
		host++;
		n -= 2;
	}
	if (n == 0 || n >= sizeof(ret->host))
		return "has no address";
	snprintf(ret->host, sizeof(ret->host), "%.*s", (int)n, host);
	snprintf(ret->port, sizeof(ret->port), "%s", port + 1);
	if (!is_address(ret->host))
		return "has no address in numbers";
	return number(port + 1, &number_of) && is_whole(number_of, 1, 65535) &&
	       strspn(port + 1, "0123456789") == strlen(port + 1) ? NULL :
	       "has no port of 1 to 65535";
}

uint32_t config_hand_read(const char *text, char odd[CONFIG_WAY_WORD])
{
	struct words w = { .at = text };
	uint32_t fields = 0;

	*odd = '\0';
	while (strcmp(text, "none") != 0 && next(&w)) {
		int i = 0;

		while (i < PROCESS_SPARK && strcmp(w.word, process_name(i)))
			i++;
		if (!*odd && (i == PROCESS_SPARK || fields >> i & 1))
			memcpy(odd, w.word, sizeof(w.word));
		fields |= i < PROCESS_SPARK ? 1u << i : 0;
	}
	return fields;
}

/* -- A generator's own faults ---------------------------------------------- */

/* The next one: its number and its words.  Return: false at the end, or where
 * it is none: @ret then is 0. */
static bool next_fault(const char **at, long *ret, int *ret_n,
		       const char **ret_words)
{
	char *end;

	*at += strspn(*at, " \t,");
	*ret = strtol(*at, &end, 10);
	if (**at == '\0' || end == *at || *ret < 1 || *ret > 65535) {
		*ret = 0;
		return false;
	}
	*ret_words = end + strspn(end, " \t");
	*ret_n = (int)strcspn(*ret_words, ",");
	*at = *ret_words + *ret_n;
	return true;
}

static bool has_fault(const char *words, long fault)
{
	const char *text;
	long at;
	int n;

	while (next_fault(&words, &at, &n, &text))
		if (at == fault)
			return true;
	return false;
}

const char *config_fault_read(const char *words, double most)
{
	const char *text;
	long fault;
	int n;

	if (strcmp(words, "none") == 0)
		return NULL;
	while (next_fault(&words, &fault, &n, &text)) {
		if (n == 0 || n > CONFIG_FAULT_MAX - 8)
			return "has a number without words, or with more than "
			       "56 bytes of them";
		if (has_fault(words, fault))
			return "has a number twice";
		if ((double)fault > most)
			return "has a number that generator.told_fault does "
			       "not tell";
	}
	return *words ? "has words without a number of 1 to 65535 before them" :
			NULL;
}

const char *config_fault_text(const char *words, double fault, char *buf,
			      size_t size)
{
	const char *text;
	long at;
	int n;

	*buf = '\0';
	if (fault > 0)
		snprintf(buf, size, "%.0f", fault);
	while (next_fault(&words, &at, &n, &text))
		if ((double)at == fault)
			snprintf(buf, size, "%ld %.*s", at, n, text);
	return buf;
}
