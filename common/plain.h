/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plain.h - text that only shows something and does nothing else
 *
 * Names and reasons come from files and packets of others. A control character
 * can move the cursor of a terminal or change its title; one of the set C1 does
 * so in a single character. A character that changes the direction of writing
 * makes a name look like another name. Plain text is UTF-8 without any of
 * these.
 *
 * Threads: any.
 */
#ifndef COMMON_PLAIN_H
#define COMMON_PLAIN_H

#include <stdbool.h>
#include <stddef.h>

/**
 * plain_bytes() - length of the character at @s; 0 if it is not plain, or at
 * the end.
 */
size_t plain_bytes(const char *s);

/** plain_is() - does the text consist of plain characters only? */
bool plain_is(const char *s);

/**
 * plain_copy() - copy @from to @to, with `?` for each byte that is not plain;
 * if it is too long it is cut between two characters. @to may be @from.
 */
void plain_copy(char *to, size_t room, const char *from);

#endif /* COMMON_PLAIN_H */
