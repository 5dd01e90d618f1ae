/* SPDX-License-Identifier: Apache-2.0 */
/*
 * text.c - a way in as NC code
 */
#include "plan.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* As many decimals as a pulse of any machine has, and no zeros behind. */
static void put_number(FILE *f, char axis, double v)
{
	char s[40];
	size_t n;

	snprintf(s, sizeof(s), "%.6f", v);
	for (n = strlen(s); s[n - 1] == '0'; n--)
		s[n - 1] = '\0';
	if (s[n - 1] == '.')
		s[n - 1] = '\0';
	fprintf(f, " %c%s", axis, strcmp(s, "-0") == 0 ? "0" : s);
}

static void put_block(FILE *f, const struct plan *p, const char *word,
		      const double *from, const double *to)
{
	const double *offset = p->j->config.work_offset_mm[0];
	const uint32_t moves = motion_moves(&p->j->motion);

	fputs(word, f);
	for (int k = 0; k < INTERP_NAXES; k++)
		if (moves & 1u << k && (!from || from[k] != to[k]))
			put_number(f, INTERP_AXIS_LETTERS[k],
				   to[k] - offset[k]);
}

static bool same(const double *a, const double *b)
{
	return memcmp(a, b, INTERP_NAXES * sizeof(*a)) == 0;
}

/* F is the ceiling of the dense program's first cut. */
static void put_way_in(FILE *f, const struct plan *p, const struct plan_way *w)
{
	const double feed = (double)p->dense.node[p->first + 1].feed_mm_s * 60;

	for (uint32_t i = 1; i < w->n; i++) {
		put_block(f, p, "G1", w->q[i - 1], w->q[i]);
		if (i == 1 && feed > 0)
			fprintf(f, " F%.6g", feed);
		fprintf(f, "\t(keeps %.3f mm)\n", w->proved_mm[i - 1]);
	}
}

char *text_write(const struct plan *p, const struct plan_way *w)
{
	const double *at = p->dense.node[0].q;
	char *text = NULL;
	size_t size;
	FILE *f = open_memstream(&text, &size);

	if (!f)
		return NULL;
	fprintf(f, "(edm-plan " EDM_VERSION ": %u blocks for %u, proved to "
		"keep %.3f mm: %s)\nG21 G90 G94 G54 M5\n", w->n - 1,
		p->last - p->first, w->least_mm, w->how);
	for (uint32_t i = 1; i <= p->first; i++) {
		const double *to = i < p->first ? p->dense.node[i].q : w->q[0];

		if (!same(at, to)) {
			put_block(f, p, "G0", at, to);
			fputc('\n', f);
		}
		at = to;
	}
	fputs("M3\n", f);
	put_way_in(f, p, w);
	fputs("M2\n", f);
	if (fclose(f)) {
		free(text);
		return NULL;
	}
	return text;
}

int text_put(const char *path, const char *text)
{
	const bool standard = strcmp(path, "-") == 0;
	FILE *f = standard ? stdout : fopen(path, "w");

	if (!f) {
		fprintf(stderr, "edm-plan: %s: %s; a file to be written\n",
			path, strerror(errno));
		return EX_CANTCREAT;
	}
	fputs(text, f);
	if (standard ? fflush(f) : fclose(f)) {
		fprintf(stderr, "edm-plan: %s: %s\n", path, strerror(errno));
		return EX_IOERR;
	}
	return 0;
}
