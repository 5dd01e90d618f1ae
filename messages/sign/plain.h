/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plain.h - text that does nothing but show
 *
 * Names and reasons come from files and packets of others.  A control
 * character moves a terminal's cursor or changes its title, one of C1 does so
 * in a single character, and one that turns the direction of writing makes a
 * name look like another.  Plain text is UTF-8 without all these.
 *
 * Threads: any.
 */
#ifndef EDM_PLAIN_H
#define EDM_PLAIN_H

#include <stdbool.h>
#include <stddef.h>

/** plain_bytes() - of the character at @s; 0 if it is not plain, or the end. */
size_t plain_bytes(const char *s);

/** plain_is() - nothing but plain characters? */
bool plain_is(const char *s);

/** plain_copy() - @from to @to, `?` for each byte that is not plain; cut
 *  between two characters.  @to may be @from. */
void plain_copy(char *to, size_t room, const char *from);

#endif /* EDM_PLAIN_H */
