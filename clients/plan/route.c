/* SPDX-License-Identifier: Apache-2.0 */
/*
 * route.c - compile a program and follow it
 */
#include "route.h"

#include "compiling.h"
#include "route_curve.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TEXT_BYTES_MAX	(1u << 30)

/* How far an arc's axes stray from its chords. */
#define ARC_STRAYS	0.001

void route_free(struct route *w)
{
	free(w->node);
	free(w->lift);
	free(w->text);
	*w = (struct route) { 0 };
}

int route_add(struct route *w, const struct route_node *node)
{
	if (w->n == w->room && grow_array(&w->node, &w->room, sizeof(*w->node)))
		return -ENOMEM;
	w->node[w->n++] = *node;
	return 0;
}

void route_lattice(const struct machine_config *c, double ret[INTERP_NAXES])
{
	double pulses = 0.5;

	if (c->strategy == INTERP_POINT_BY_POINT ||
	    c->strategy == INTERP_CENTRED)
		pulses = 1;
	else if (interp_strategy_takes_tolerance(
			 (enum interp_strategy)c->strategy))
		pulses = 1 + c->tolerance_pulses;
	for (int i = 0; i < INTERP_NAXES; i++)
		ret[i] = pulses * c->axes.axis[i].pulse_mm;
}

/* -- Segments ------------------------------------------------------------- */

static void node_of(const struct interp_program *p, uint32_t node,
		    double q[INTERP_NAXES])
{
	const struct interp_program_head *h = p->head;

	for (int i = 0; i < INTERP_NAXES; i++)
		q[i] = h->start_pulses[i] * h->pulse_mm[i];
	for (uint32_t j = 0; j < h->naxes; j++)
		q[h->column[j]] = (double)p->nodes[(uint64_t)node * h->naxes +
						   j] / INTERP_SUB *
				  h->pulse_mm[h->column[j]];
}

/* Of the pieces of one motion from node @first on, only the first has the words
 * before it. */
static void act_once(struct route *w, uint32_t first)
{
	for (uint32_t i = first + 1; i < w->n; i++)
		w->node[i].act_line = 0;
}

/*
 * Over a piece dp of the parameter, a motion whose second derivative is at
 * most d2 strays from its chord by dp^2 d2 / 8 at most.
 */
static int follow_arc(struct route *w, const struct interp_arc *a,
		      const struct route_node *end)
{
	const struct route_node from = w->node[w->n - 1];
	const uint32_t first = w->n;
	const double r = fabs(a->r_mm) + fabs(a->dr_mm);
	const double bend = r * a->sweep * a->sweep +
			    2 * fabs(a->dr_mm * a->sweep);
	const double pieces = ceil(sqrt(bend / 8 / ARC_STRAYS));
	const uint32_t n = pieces < 1 ? 1 : (uint32_t)fmin(pieces, 1e6);
	struct route_node at = *end;
	int rc = 0;

	at.strays = (float)(bend / 8 / n / n * (1 + 1e-6));
	for (uint32_t i = 1; i <= n && rc == 0; i++) {
		const double p = (double)i / n;
		const double angle = a->theta + a->sweep * p;

		for (int k = 0; k < INTERP_NAXES; k++)
			at.q[k] = from.q[k] + p * (end->q[k] - from.q[k]);
		if (i < n) {
			at.q[a->axis_a] = a->a_mm + (a->r_mm + a->dr_mm * p) *
						    cos(angle);
			at.q[a->axis_b] = a->b_mm + (a->r_mm + a->dr_mm * p) *
						    sin(angle);
		}
		rc = route_add(w, &at);
	}
	act_once(w, first);
	return rc;
}

static int follow_curve(struct route *w, const struct interp_program *p,
			const struct interp_seg *s,
			const struct route_node *end)
{
	const struct interp_piece *piece = &p->pieces[s->arg];
	const struct interp_nurbs_stop *stop = p->stops + piece->stops_at;
	struct route_curve k = {
		.axis = p->curves[piece->curve].axis, .at = *end,
		.from = stop[0].u, .to = stop[piece->nstops - 1].u,
	};
	const uint32_t first = w->n;
	int err;

	if (!interp_program_curve(p, piece->curve, &k.curve))
		return -EINVAL;
	err = route_curve(w, &k);
	/* The node is rounded, the curve is not. */
	if (err == 0)
		err = route_add(w, end);
	act_once(w, first);
	return err;
}

static int refuse_seg(const struct route_text *from, uint32_t line,
		      const char *found, const char *wanted)
{
	if (!from->quiet)
		fprintf(stderr, "%s:%u: error: %s; %s\n", from->path, line,
			found, wanted);
	return EX_DATAERR;
}

static int note_action(struct route *w, const struct interp_seg *s)
{
	if (s->kind != INTERP_BEGIN && s->kind != INTERP_END)
		w->act_line = s->line;
	return 0;
}

static int follow_seg(struct route *w, const struct interp_program *p,
		      uint32_t i, const struct route_text *from)
{
	const struct interp_seg *s = &p->segs[i];
	struct route_node end = { .line = s->line,
				.feed_mm_s = s->feed_mm_s,
				.rapid = s->flags & INTERP_SEG_RAPID,
				.cond = s->cond, .act_line = w->act_line };
	int err;

	if (s->flags & INTERP_SEG_SENSED)
		return refuse_seg(from, s->line, "a move that ends at a "
				  "contact", "a program without: where it "
				  "goes on is not known before it is run");
	if (!interp_program_seg_ok(p, i, s))
		return refuse_seg(from, s->line, "a segment that is not sound",
				  "another text");
	if (s->kind == INTERP_PAIR)
		return refuse_seg(from, s->line, "two contours at once",
				  "motion of one rigid electrode, on X Y Z A "
				  "B C");
	node_of(p, i + 1, end.q);
	if (s->kind == INTERP_LINE)
		err = route_add(w, &end);
	else if (s->kind == INTERP_ARC)
		err = follow_arc(w, &p->arcs[s->arg], &end);
	else if (s->kind == INTERP_CURVE)
		err = follow_curve(w, p, s, &end);
	else
		return note_action(w, s);
	w->act_line = 0;
	if (err == -EINVAL)
		return refuse_seg(from, s->line, "a curve that cannot be cut "
				  "into chords", "a curve without a cusp");
	return err ? EX_OSERR : 0;
}

/* Lifts from @first on to the last node, of segment @s. */
static int note_lift(struct route *w, const struct interp_program *p,
		     const struct interp_seg *s, uint32_t first)
{
	const struct interp_escape *way = &p->escapes[s->escape];
	struct route_lift *last = w->nlifts ? &w->lift[w->nlifts - 1] : NULL;

	if (!s->escape || s->flags & INTERP_SEG_RAPID)
		return 0;
	if (last && last->last == first &&
	    memcmp(&last->way, way, sizeof(*way)) == 0) {
		last->last = w->n - 1;
		return 0;
	}
	if (w->nlifts == w->lifts_room &&
	    grow_array(&w->lift, &w->lifts_room, sizeof(*w->lift)))
		return EX_OSERR;
	w->lift[w->nlifts++] = (struct route_lift) {
		.first = first, .last = w->n - 1, .way = *way,
	};
	return 0;
}

static int follow(struct route *w, const struct interp_program *p,
		  const struct route_text *from)
{
	struct route_node start = { .line = 0 };
	int err = 0;

	node_of(p, 0, start.q);
	if (route_add(w, &start))
		return EX_OSERR;
	for (uint32_t i = 0; i < p->head->nsegs && err == 0; i++) {
		const uint32_t first = w->n - 1;

		err = follow_seg(w, p, i, from);
		if (err == 0)
			err = note_lift(w, p, &p->segs[i], first);
	}
	return err;
}

/* -- Text ----------------------------------------------------------------- */

static int read_file(const char *path, char **text, size_t *bytes)
{
	const bool standard = strcmp(path, "-") == 0;
	FILE *f = standard ? stdin : fopen(path, "rb");
	int err;

	*text = NULL;
	*bytes = 0;
	err = f ? grow_read(f, TEXT_BYTES_MAX, text, bytes) : -errno;
	if (f && !standard)
		fclose(f);
	if (err == 0)
		return 0;
	fprintf(stderr, "edm-plan: %s: %s; a file of NC code of at most 1 "
		"GiB\n", path, strerror(-err));
	return err == -EFBIG ? EX_DATAERR :
	       err == -ENOMEM ? EX_OSERR : EX_NOINPUT;
}

static int lay_out(struct interp_build *b, const struct route_text *from,
		   struct route *w)
{
	const struct interp_build_about about = { .lines = w->lines,
						  .name = from->path };
	struct interp_program p;
	size_t bytes;
	void *block = interp_build_take(b, &about, &bytes);
	int err;

	if (!block)
		return EX_OSERR;
	err = interp_program_map(&p, block, bytes) ? EX_SOFTWARE :
						   follow(w, &p, from);
	free(block);
	return err;
}

static int compile(struct route *w, const struct machine_config *c,
		   const struct route_text *from,
		   const struct interp_text *text)
{
	struct config_compiling of;
	struct interp_diag diag = { 0 };
	struct config_tech tech;
	struct interp_build *b;
	int err;

	if (config_tech_load(&tech, c, NULL)) {
		config_tech_free(&tech);
		fprintf(stderr, "edm-plan: %s: the technology table cannot be "
			"read; [tech] table of the machine file\n", tech.path);
		return EX_CONFIG;
	}
	config_compiling(c, &tech, &of);
	if (from->start)
		memcpy(of.build.start_mm, from->start,
		       sizeof(of.build.start_mm));
	b = interp_build_create(&of.build);
	err = b ? interp_compile(text, &of.text, b, &w->lines, &diag) : -ENOMEM;
	if (err == -EINVAL) {
		if (!from->quiet)
			interp_diag_tell(&diag, from->path);
		err = EX_DATAERR;
	} else {
		err = err ? EX_OSERR : lay_out(b, from, w);
	}
	interp_build_destroy(b);
	config_tech_free(&tech);
	return err;
}

static int dialect_load(struct config_dialect *d,
			const struct machine_config *c,
			const struct route_text *from)
{
	const int err = config_dialect_load(d, c, from->dialect, from->path);
	char why[1024];

	if (err == 0)
		return 0;
	config_dialect_why(d, err, why, sizeof(why));
	fprintf(stderr, "edm-plan: %s\n", why);
	return from->dialect ? EX_USAGE : EX_CONFIG;
}

int route_read(struct route *w, const struct machine_config *c,
	     const struct route_text *from)
{
	struct interp_text text = {
		.at = from->text,
	};
	struct config_dialect d;
	char *mine = NULL;
	int err = dialect_load(&d, c, from);

	text.dialect = d.use;
	*w = (struct route) { 0 };
	route_lattice(c, w->lattice);
	if (err) {
		config_dialect_free(&d);
		return err;
	}
	if (from->text) {
		text.bytes = strlen(from->text);
	} else {
		err = read_file(from->path, &mine, &text.bytes);
		text.at = mine;
	}
	if (err == 0)
		err = compile(w, c, from, &text);
	if (err == EX_OSERR)
		fprintf(stderr, "edm-plan: %s: out of memory\n", from->path);
	config_dialect_free(&d);
	if (mine)
		mine[text.bytes] = '\0';
	w->text = mine;
	if (err)
		route_free(w);
	return err;
}
