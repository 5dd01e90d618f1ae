/* SPDX-License-Identifier: Apache-2.0 */
/* value.c - finds a key, and converts its value from text and to text */
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *config_section_name(enum config_section_id s, int instance,
				char *buf, size_t size)
{
	const struct config_section *sec = &config_section[s];

	if (sec->instance)
		snprintf(buf, size, "%s.%s", sec->name,
			 sec->instance[instance]);
	else
		snprintf(buf, size, "%s", sec->name);
	return buf;
}

int config_section_find(const char *name, int *ret_instance)
{
	char buf[64];

	for (int s = 0; s < CONFIG_NSECTIONS; s++) {
		for (int i = 0; i < config_section[s].ninstances; i++) {
			config_section_name((enum config_section_id)s, i, buf,
					    sizeof(buf));
			if (strcmp(buf, name) == 0) {
				*ret_instance = i;
				return s;
			}
		}
	}
	return -ENOENT;
}

int config_key_find(enum config_section_id s, const char *name)
{
	const struct config_key *k;

	for (int i = 0; (k = config_key(i)); i++)
		if (k->section == s && strcmp(k->name, name) == 0)
			return i;
	return -ENOENT;
}

static bool is_rotary(const struct config_key *k, int instance)
{
	return k->section == SECTION_AXIS &&
	       interp_axis_is_rotary((enum interp_axis)instance);
}

const char *config_key_default(const struct config_key *k, int instance)
{
	return k->def_rotary && is_rotary(k, instance) ? k->def_rotary :
							 k->def;
}

const char *config_key_unit(const struct config_key *k, int instance,
			    char *buf, size_t size)
{
	const char *unit = k->unit;

	if (!*unit)
		snprintf(buf, size, "%s", "");
	else if (is_rotary(k, instance) && strncmp(unit, "mm", 2) == 0)
		snprintf(buf, size, " deg%s", unit + 2);
	else
		snprintf(buf, size, " %s", unit);
	return buf;
}

const char *config_number(double x, char *buf, size_t size)
{
	if (x == rint(x) && fabs(x) < 1e15) {
		snprintf(buf, size, "%.0f", x + 0.0);
		return buf;
	}
	for (int digits = 6; digits <= 17; digits++) {
		snprintf(buf, size, "%.*g", digits, x);
		if (strtod(buf, NULL) == x)
			break;
	}
	return buf;
}

/* "sim, null": the words of an enum. */
static const char *words_of(const struct config_key *k, char *buf, size_t size)
{
	size_t n = 0;

	buf[0] = '\0';
	for (int i = 0; k->word(i) && n < size; i++)
		n += (size_t)snprintf(buf + n, size - n, "%s%s",
				      i ? ", " : "", k->word(i));
	return buf;
}

const char *config_key_range(const struct config_key *k, int instance,
			     char *buf, size_t size)
{
	char a[32], b[32], unit[16], words[160];

	switch (k->kind) {
	case KEY_NUMBER:
	case KEY_WHOLE:
	case KEY_COUNT:
		config_number(k->min, a, sizeof(a));
		config_number(k->max, b, sizeof(b));
		config_key_unit(k, instance, unit, sizeof(unit));
		snprintf(buf, size, "%s from %s to %s%s",
			 k->kind != KEY_NUMBER ? "whole number" : "number", a,
			 b, unit);
		break;
	case KEY_ENUM:
		snprintf(buf, size, "one of %s",
			 words_of(k, words, sizeof(words)));
		break;
	case KEY_BIT:
		snprintf(buf, size, "yes or no");
		break;
	case KEY_NAME:
		snprintf(buf, size, "1 to %zu letters, digits, - and _",
			 k->bytes - 1);
		break;
	case KEY_STRING:
		snprintf(buf, size, "text of 1 to %zu bytes", k->bytes - 1);
		break;
	case KEY_LINE:
		snprintf(buf, size, "none, or [!][CHIP:]NUMBER");
		break;
	}
	return buf;
}

const void *config_key_in(const struct config_key *k, int instance,
			  const struct machine_config *c)
{
	return (const char *)c + k->offset + k->stride * (size_t)instance;
}

void *config_key_at(const struct config_key *k, int instance,
		    struct machine_config *c)
{
	return (char *)c + k->offset + k->stride * (size_t)instance;
}

/* -- From text to value: each returns NULL, or what is wrong -------------- */

static const char *parse_number(const struct config_key *k, const char *text,
				double *ret)
{
	char *end;
	double x;

	/* strtod() also accepts inf, nan and hex; refuse these here. */
	if (text[strspn(text, "+-.0123456789eE")])
		return "is not a number";
	x = strtod(text, &end);
	if (end == text || *end)
		return "is not a number";
	if (k->kind != KEY_NUMBER && isfinite(x) && x != floor(x))
		return "is not a whole number";
	if (x < k->min)
		return "is too small";
	if (x > k->max)
		return "is too large";
	*ret = x + 0.0;			/* -0 becomes 0 */
	return NULL;
}

static const char *parse_count(const struct config_key *k, const char *text,
			       uint32_t *ret)
{
	double x = 0;
	const char *wrong = parse_number(k, text, &x);

	if (!wrong)
		*ret = (uint32_t)x;
	return wrong;
}

static const char *parse_enum(const struct config_key *k, const char *text,
			      int *ret)
{
	for (int i = 0; k->word(i); i++) {
		if (strcmp(k->word(i), text) == 0) {
			*ret = i;
			return NULL;
		}
	}
	return "is not known";
}

static const char *parse_bit(int instance, const char *text, uint32_t *ret)
{
	uint32_t bit = UINT32_C(1) << instance;

	if (strcmp(text, "yes") == 0)
		*ret |= bit;
	else if (strcmp(text, "no") == 0)
		*ret &= ~bit;
	else
		return "is neither yes nor no";
	return NULL;
}

#define LETTERS	"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"

static const char *parse_text(const struct config_key *k, const char *text,
			      char *ret)
{
	if (!*text)
		return "is empty";
	if (strlen(text) >= k->bytes)
		return "is too long";
	if (k->kind == KEY_NAME && text[strspn(text, LETTERS "0123456789-_")])
		return "has a character that does not go into a file's name";
	for (const char *p = text; *p; p++)
		if ((unsigned char)*p < ' ' || *p == 0x7f)
			return "has a control character";
	memcpy(ret, text, strlen(text) + 1);
	return NULL;
}

static const char *parse_line(const struct config_key *k, const char *text,
			      char *ret)
{
	struct config_line_at at;
	const char *wrong = config_line_read(text, &at);

	return wrong ? wrong : parse_text(k, text, ret);
}

int config_key_parse(const struct config_key *k, int instance,
		     const char *text, struct machine_config *c,
		     struct interp_diag *diag)
{
	void *at = config_key_at(k, instance, c);
	const char *wrong = NULL;
	char section[32];

	switch (k->kind) {
	case KEY_NUMBER:
	case KEY_WHOLE:
		wrong = parse_number(k, text, at);
		break;
	case KEY_COUNT:
		wrong = parse_count(k, text, at);
		break;
	case KEY_ENUM:
		wrong = parse_enum(k, text, at);
		break;
	case KEY_BIT:
		wrong = parse_bit(instance, text, at);
		break;
	case KEY_NAME:
	case KEY_STRING:
		wrong = parse_text(k, text, at);
		break;
	case KEY_LINE:
		wrong = parse_line(k, text, at);
		break;
	}
	if (!wrong)
		return 0;

	config_section_name(k->section, instance, section, sizeof(section));
	snprintf(diag->found, sizeof(diag->found), "%s.%s '%.40s' %s", section,
		 k->name, text, wrong);
	config_key_range(k, instance, diag->wanted, sizeof(diag->wanted));
	return -EINVAL;
}

const char *config_key_format(const struct config_key *k, int instance,
			      const struct machine_config *c, char *buf,
			      size_t size)
{
	const void *in = config_key_in(k, instance, c);

	switch (k->kind) {
	case KEY_NUMBER:
	case KEY_WHOLE:
		return config_number(*(const double *)in, buf, size);
	case KEY_COUNT:
		return config_number(*(const uint32_t *)in, buf, size);
	case KEY_ENUM:
		snprintf(buf, size, "%s", k->word(*(const int *)in));
		break;
	case KEY_BIT:
		snprintf(buf, size, "%s",
			 *(const uint32_t *)in >> instance & 1 ? "yes" : "no");
		break;
	case KEY_NAME:
	case KEY_STRING:
	case KEY_LINE:
		snprintf(buf, size, "%s", (const char *)in);
		break;
	}
	return buf;
}
