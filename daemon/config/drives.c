/* SPDX-License-Identifier: Apache-2.0 */
/* drives.c - objects of a CiA 402 drive, as words in a line */
#include "drives.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define WORD_MAX	32

static int refuse(struct interp_diag *d, const char *word, const char *wanted)
{
	return interp_diag_say(d, "\"%s\"; %s", word, wanted);
}

/* Read the next word into @ret; false: there is none. */
static bool next_word(const char **at, char ret[WORD_MAX])
{
	size_t n;

	*at += strspn(*at, " \t,");
	n = strcspn(*at, " \t,");
	snprintf(ret, WORD_MAX, "%.*s", (int)n, *at);
	*at += n;
	return n > 0 && strcmp(ret, "none") != 0;
}

/* All of @text up to @end must be a hexadecimal number, at most @most. */
static bool hex(const char **text, char end, uint32_t most, uint32_t *ret)
{
	char *stop;
	unsigned long long x;

	if (strchr("+-", **text) || **text == '\0')
		return false;
	errno = 0;
	x = strtoull(*text, &stop, 16);
	if (stop == *text || *stop != end || errno || x > most)
		return false;
	*text = stop + (end != '\0');
	*ret = (uint32_t)x;
	return true;
}

static bool object_read(const char *word, struct config_object *ret)
{
	uint32_t index, sub, value, bytes;

	if (!hex(&word, ':', 0xffff, &index) || !hex(&word, '=', 0xff, &sub) ||
	    !hex(&word, '/', UINT32_MAX, &value) ||
	    !hex(&word, '\0', 4, &bytes) || bytes == 0 || bytes == 3 ||
	    (bytes < 4 && value >> 8 * bytes))
		return false;
	*ret = (struct config_object) {
		(uint16_t)index, (uint8_t)sub, (uint8_t)bytes, value
	};
	return true;
}

int config_drive_sdo(const char *text, struct config_object *ret,
		     struct interp_diag *diag)
{
	char word[WORD_MAX];
	int n = 0;

	while (next_word(&text, word)) {
		if (n == CONFIG_SDO_MAX)
			return refuse(diag, word, "at most 16 objects");
		if (!object_read(word, &ret[n++]))
			return refuse(diag, word, "INDEX:SUB=VALUE/BYTES, as "
				      "605e:0=2/2: hexadecimal, 1, 2 or 4 "
				      "bytes that hold the value");
	}
	return n;
}

int config_drive_leave(const char *text, uint16_t *ret,
		       struct interp_diag *diag)
{
	char word[WORD_MAX];
	int n = 0;

	while (next_word(&text, word)) {
		const char *at = word;
		uint32_t index;

		if (n == CONFIG_LEAVE_MAX)
			return refuse(diag, word, "at most 8 objects");
		if (!hex(&at, '\0', 0xffff, &index))
			return refuse(diag, word, "hexadecimal indexes of "
				      "objects, as 1006 60c2");
		ret[n++] = (uint16_t)index;
	}
	return n;
}

#define INPUT_BITS	32

/* NAME:BIT or NAME:!BIT. Return: enum config_input_id, or -EINVAL. */
static int input_read(const char *word, struct config_input *ret)
{
	static const char *const names[CONFIG_NINPUTS] = {
		"limit_low", "limit_high", "home", "estop", "contact"
	};
	const size_t n = strcspn(word, ":");
	const bool inverted = word[n] == ':' && word[n + 1] == '!';
	const char *bit = word + n + 1 + inverted;
	char *end;
	unsigned long at;

	if (word[n] != ':' || *bit < '0' || *bit > '9')
		return -EINVAL;
	at = strtoul(bit, &end, 10);
	if (*end || at >= INPUT_BITS)
		return -EINVAL;
	*ret = (struct config_input) {
		true, 1u << at, inverted ? 1u << at : 0
	};
	for (int i = 0; i < CONFIG_NINPUTS; i++)
		if (strlen(names[i]) == n && strncmp(word, names[i], n) == 0)
			return i;
	return -EINVAL;
}

int config_drive_inputs(const char *text,
			struct config_input ret[CONFIG_NINPUTS],
			struct interp_diag *diag)
{
	char word[WORD_MAX];
	int n = 0;

	memset(ret, 0, CONFIG_NINPUTS * sizeof(*ret));
	for (; next_word(&text, word); n++) {
		struct config_input in;
		const int i = input_read(word, &in);

		if (i < 0)
			return refuse(diag, word, "limit_low, limit_high, "
				      "home, estop or contact, each as home:2 "
				      "or home:!2, with a bit of object 60FD, 0 "
				      "to 31");
		if (ret[i].wired)
			return refuse(diag, word, "each input once");
		ret[i] = in;
	}
	return n;
}

int config_drive_identity(const char *text, uint32_t ret[4],
			  uint8_t *ret_given, struct interp_diag *diag)
{
	char word[WORD_MAX];
	int n = 0;

	*ret_given = 0;
	while (next_word(&text, word)) {
		const char *at = word;
		const bool any = strcmp(word, "x") == 0;

		if (n == 4 || (!any && !hex(&at, '\0', UINT32_MAX, &ret[n])))
			return refuse(diag, word, "up to four hexadecimal "
				      "numbers, or x: vendor, product, "
				      "revision, serial");
		if (!any)
			*ret_given |= (uint8_t)(1u << n);
		n++;
	}
	return n;
}
