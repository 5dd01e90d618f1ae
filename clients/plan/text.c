/* SPDX-License-Identifier: Apache-2.0 */
/*
 * text.c - a way in as NC code
 */
#include "plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As many decimals as a pulse of any machine has, without zeros at the end.
 * The point stays: C120 calls a condition, and some dialects read X10 as ten
 * pulses. */
static void put_number(FILE *f, char axis, double v)
{
	char s[40];
	size_t n;

	snprintf(s, sizeof(s), "%.6f", v);
	for (n = strlen(s); s[n - 1] == '0'; n--)
		s[n - 1] = '\0';
	fprintf(f, " %c%s", axis, strcmp(s, "-0.") == 0 ? "0." : s);
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

/* F is that of the first cut of the dense program. */
static void put_way_in(FILE *f, const struct plan *p, const struct plan_way *w)
{
	const double feed = (double)p->dense.node[p->first + 1].feed_mm_s * 60;

	for (uint32_t i = 1; i < w->n; i++) {
		put_block(f, p, "G1", w->q[i - 1], w->q[i]);
		if (i == 1 && feed > 0)
			put_number(f, 'F', feed);
		fprintf(f, "\t(keeps %.3f mm)\n", w->proved_mm[i - 1]);
	}
}

static void put_head(FILE *f, const struct plan *p, const struct plan_way *w)
{
	fprintf(f, "(edm-plan " EDM_VERSION ": %u blocks for %u, proved to "
		"keep %.3f mm: %s)\n", w->n - 1, p->last - p->first,
		w->least_mm, w->how);
}

/* Its positioning and the blocks. */
static char *plain(const struct plan *p, const struct plan_way *w)
{
	const double *at = p->dense.node[0].q;
	char *text = NULL;
	size_t size;
	FILE *f = open_memstream(&text, &size);

	if (!f)
		return NULL;
	put_head(f, p, w);
	fputs("G21 G90 G94 G54 M5\n", f);
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

/* -- The program's other lines -------------------------------------------- */

static const char *line_at(const char *text, uint32_t line)
{
	for (; line > 1 && text; line--) {
		text = strchr(text, '\n');
		text += text != NULL;
	}
	return text;
}

/* A curve has the line of its G6.2; the lines of its other control points begin
 * with K. */
static const char *behind_curve(const char *text)
{
	while (text) {
		const char *s = text + strspn(text, " \t");

		if (*s == 'N' || *s == 'n')
			s += 1 + strspn(s + 1, "0123456789 \t");
		if (*s != 'K' && *s != 'k')
			break;
		text = line_at(text, 2);
	}
	return text;
}

/* The dense program with the blocks of @w instead of those of its way in.
 * @modes is written before them. */
static char *carried(const struct plan *p, const struct plan_way *w,
		     const char *modes)
{
	const char *text = p->dense.text;
	const char *from = line_at(text, p->dense.node[p->first + 1].line);
	const char *to = behind_curve(line_at(text,
					p->dense.node[p->last].line + 1));
	char *ret = NULL;
	size_t size;
	FILE *f;

	if (!from)
		return NULL;
	f = open_memstream(&ret, &size);
	if (!f)
		return NULL;
	fwrite(text, 1, (size_t)(from - text), f);
	put_head(f, p, w);
	fputs(modes, f);
	put_way_in(f, p, w);
	if (to)
		fputs(to, f);
	if (fclose(f)) {
		free(ret);
		return NULL;
	}
	return ret;
}

static bool is_at(const struct route_node *a, const struct plan *p,
		  const double q[INTERP_NAXES])
{
	for (int k = 0; k < INTERP_NAXES; k++)
		if (fabs(a->q[k] - q[k]) >
		    p->j->config.axes.axis[k].pulse_mm * 1.01)
			return false;
	return true;
}

/* Does @r go where the dense program goes, but along @w? */
static bool goes_same_way(const struct plan *p, const struct plan_way *w,
			  const struct route *r)
{
	const struct route *d = &p->dense;
	const uint32_t left = d->n - 1 - p->last;

	if (r->n != p->first + w->n + left)
		return false;
	for (uint32_t i = 0; i < r->n; i++) {
		const bool in = i >= p->first && i < p->first + w->n;
		const double *q = in ? w->q[i - p->first] :
				  i < p->first ? d->node[i].q :
				  d->node[d->n - (r->n - i)].q;

		if (!is_at(&r->node[i], p, q) ||
		    (i > p->first && in && (r->node[i].rapid ||
		     r->node[i].cond != d->node[p->first + 1].cond)))
			return false;
	}
	return true;
}

/* Is the end of @r the way @w? */
static bool ends_with(const struct plan *p, const struct plan_way *w,
		      const struct route *r)
{
	if (r->n < w->n)
		return false;
	for (uint32_t i = 0; i < w->n; i++) {
		const struct route_node *n = &r->node[r->n - w->n + i];

		if (!is_at(n, p, w->q[i]) || (i > 0 && n->rapid))
			return false;
	}
	return true;
}

/* Is @text, read in that dialect, what it is meant to be? */
static bool reads(struct plan *p, const struct plan_way *w, const char *text,
		  const char *dialect)
{
	const struct route_text from = {
		.path = p->carried ? p->j->o->program : p->j->o->output,
		.text = text, .dialect = dialect, .quiet = true,
	};
	struct route r = { 0 };
	const bool ok = route_read(&r, &p->j->config, &from) == 0 &&
			(p->carried ? goes_same_way(p, w, &r) :
				      ends_with(p, w, &r));

	route_free(&r);
	p->written_path = from.path;
	p->written_dialect = dialect;
	return ok;
}

/*
 * Lines are carried over as they stand, and what comes out is read back: where
 * inches, increments or subprograms give the blocks or the lines another sense,
 * it goes another way.  The same of a dialect that has other words than those
 * that plain() writes.
 */
char *text_write(struct plan *p, const struct plan_way *w)
{
	/* Not every dialect has the words of the second, or needs them. */
	static const char *const modes[] = { "", "G21 G90 G94\n" };
	char *text;

	p->carried = true;
	for (int i = 0; i < 2 && p->dense.text; i++) {
		text = carried(p, w, modes[i]);
		if (text && reads(p, w, text, p->j->o->dialect))
			return text;
		free(text);
	}
	p->carried = false;
	text = plain(p, w);
	if (text && !reads(p, w, text, p->j->o->dialect))
		reads(p, w, text, "generic");
	return text;
}
