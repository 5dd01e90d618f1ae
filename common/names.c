/* SPDX-License-Identifier: Apache-2.0 */
/* names.c - the rule for the name of a machine, and lists of words */
#include "names.h"

#include <stdio.h>
#include <string.h>

#define LETTERS	"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz" \
		"0123456789_-"

bool names_machine_ok(const char *name)
{
	const size_t n = strnlen(name, NAMES_MACHINE_MAX);

	return n > 0 && n < NAMES_MACHINE_MAX && strspn(name, LETTERS) == n;
}

const char *names_join(const char *(*word)(int i), char *buf, size_t size)
{
	size_t n = 0;

	buf[0] = '\0';
	for (int i = 0; word(i) && n < size; i++)
		n += (size_t)snprintf(buf + n, size - n, "%s%s",
				      i == 0 ? "" : word(i + 1) ? ", " : " or ",
				      word(i));
	return buf;
}
