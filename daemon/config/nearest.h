/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nearest.h - which known word was meant by a misspelt one
 *
 * Offer every known word; afterwards `word` is the nearest by edit distance,
 * or "" if none is so near that it can have been meant.
 *
 * Threads: any thread, not in the cycle; one object belongs to one thread.
 */
#ifndef CONFIG_NEAREST_H
#define CONFIG_NEAREST_H

#include <stddef.h>

#define NEAREST_MAX	32		/* of a known word, with its NUL */

struct nearest {
	const char *misspelt;
	size_t distance;		/* of `word`; at first one more than is
					 * near enough */
	char word[NEAREST_MAX];
};

/** nearest_init() - look for @misspelt, lent until the last offer. */
void nearest_init(struct nearest *n, const char *misspelt);

/** nearest_offer() - @word is one that is known. */
void nearest_offer(struct nearest *n, const char *word);

#endif /* CONFIG_NEAREST_H */
