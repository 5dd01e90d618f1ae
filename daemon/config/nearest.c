/* SPDX-License-Identifier: Apache-2.0 */
/* nearest.c - edit distance of Levenshtein, ignoring case */
#include "nearest.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static size_t least(size_t a, size_t b, size_t c)
{
	size_t ab = a < b ? a : b;

	return ab < c ? ab : c;
}

/* One row of the table at a time: d[j] is the distance to the first j bytes of
 * @b. */
static size_t distance(const char *a, const char *b)
{
	size_t d[NEAREST_MAX], nb = strlen(b);

	for (size_t j = 0; j <= nb; j++)
		d[j] = j;
	for (size_t i = 1; a[i - 1]; i++) {
		size_t corner = d[0];

		d[0] = i;
		for (size_t j = 1; j <= nb; j++) {
			int x = tolower((unsigned char)a[i - 1]);
			int y = tolower((unsigned char)b[j - 1]);
			size_t above = d[j];

			d[j] = least(d[j - 1] + 1, above + 1,
				     corner + (x != y));
			corner = above;
		}
	}
	return d[nb];
}

void nearest_init(struct nearest *n, const char *misspelt)
{
	size_t half = strlen(misspelt) / 2;

	/* If more than half of it changed, it is another word. */
	*n = (struct nearest) {
		.misspelt = misspelt,
		.distance = half + 1,
	};
}

void nearest_offer(struct nearest *n, const char *word)
{
	size_t d;

	if (strlen(word) >= sizeof(n->word))
		return;
	d = distance(n->misspelt, word);
	if (d < n->distance) {
		n->distance = d;
		snprintf(n->word, sizeof(n->word), "%s", word);
	}
}
