/* SPDX-License-Identifier: Apache-2.0 */
/* plain.c - text without control characters */
#include "plain.h"

#include <stdint.h>
#include <string.h>

/* Characters that are invisible but change what is seen. */
static bool is_hidden(uint32_t c)
{
	static const struct {
		uint32_t first, last;
	} hidden[] = {
		{ 0x00, 0x1f },			/* C0 */
		{ 0x7f, 0x9f },			/* DEL, C1 */
		{ 0xad, 0xad },			/* soft hyphen */
		{ 0x34f, 0x34f },		/* joins, without a width */
		{ 0x61c, 0x61c },		/* direction of writing */
		{ 0x115f, 0x1160 },		/* letters that are blank */
		{ 0x17b4, 0x17b5 },
		{ 0x180b, 0x180f },		/* no width */
		{ 0x200b, 0x200f },		/* no width, direction */
		{ 0x2028, 0x202e },		/* ends of lines, direction */
		{ 0x2060, 0x206f },		/* no width, direction */
		{ 0x3164, 0x3164 },		/* a letter that is blank */
		{ 0xfeff, 0xfeff },		/* no width */
		{ 0xffa0, 0xffa0 },		/* a letter that is blank */
		{ 0xfff9, 0xfffb },		/* notes between lines */
		{ 0x1bca0, 0x1bca3 },		/* of shorthand, of music */
		{ 0x1d173, 0x1d17a },
		{ 0xe0000, 0xe0fff },		/* tags */
	};

	for (size_t i = 0; i < sizeof(hidden) / sizeof(hidden[0]); i++)
		if (c >= hidden[i].first && c <= hidden[i].last)
			return true;
	return false;
}

/* The smallest character with this many bytes; a longer form of it is
 * refused. */
static const uint32_t smallest[] = { 0, 0, 0x80, 0x800, 0x10000 };

static size_t length_of(unsigned char first)
{
	if (first < 0x80)
		return 1;
	if (first >= 0xc2 && first < 0xe0)
		return 2;
	if (first >= 0xe0 && first < 0xf0)
		return 3;
	return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

size_t plain_bytes(const char *s)
{
	const unsigned char *at = (const unsigned char *)s;
	const size_t n = length_of(at[0]);
	uint32_t c;

	if (at[0] >= ' ' && at[0] < 0x7f)
		return 1;
	if (n == 0 || at[0] == '\0')
		return 0;
	c = n == 1 ? at[0] : at[0] & (0x7fu >> n);
	for (size_t i = 1; i < n; i++) {
		if ((at[i] & 0xc0) != 0x80)
			return 0;
		c = c << 6 | (at[i] & 0x3fu);
	}
	if (c < smallest[n] || c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff) ||
	    is_hidden(c))
		return 0;
	return n;
}

bool plain_is(const char *s)
{
	for (size_t n; *s; s += n) {
		n = plain_bytes(s);
		if (n == 0)
			return false;
	}
	return true;
}

void plain_copy(char *to, size_t room, const char *from)
{
	while (*from) {
		size_t n = plain_bytes(from);

		if ((n ? n : 1) >= room)
			break;
		if (n > 1)
			memmove(to, from, n);
		else
			*to = n ? *from : '?';
		n = n ? n : 1;
		to += n;
		from += n;
		room -= n;
	}
	*to = '\0';
}
