/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycles.c - orbits: G130 ... G135, and the way out: G140 ... G143
 *
 * The words are collected and checked here, so that an error is reported at its
 * column.  interp/orbit.h makes the path.
 */
#include "code/reader.h"
#include "interp/orbit.h"
#include "wire/to_build.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define NOTHING_MM	1e-9

void nc_take_cycle(struct nc_reader *r)
{
	struct nc_block *b = &r->block;

	b->angles = 0;
	if (!nc_has_group(r, NC_CYCLE))
		return;
	b->angles = b->words & (NC_BIT(NC_A) | NC_BIT(NC_B));
	b->words &= ~b->angles;
}

void nc_set_lift(struct nc_reader *r)
{
	interp_build_lift(r->build, r->escape == INTERP_ESCAPE_PATH ? -1 :
				    (int)nc_planes[r->plane].normal);
}

int nc_run_escape(struct nc_reader *r)
{
	/* Lines that were held back still leave by the previous way out. */
	const int err = interp_build_flush(r->build, r->diag);

	r->escape = r->block.code[NC_ESCAPE]->value;
	nc_set_lift(r);
	return err;
}

/* -- Words ---------------------------------------------------------------- */

struct nc_orbit {
	struct nc_reader *r;
	struct interp_orbit orbit;
	const uint8_t *at;		/* position of its G word */
	const uint8_t *radius_at;
	bool is_sink;			/* G86: there is no orbit */
	uint32_t dwell_ms, most_ms;
};

static double length_of(const struct nc_reader *r, enum nc_slot slot)
{
	return nc_has(r, slot) ? r->block.value[slot] * r->unit_mm : 0;
}

static int refuse_machine(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;

	if (r->tool.on)
		return nc_refuse(r, c->at, "G49 before it", "%s under G43.4",
				 nc_quote_word(r, c->at).s);
	if (nc_has_guides(r) || r->offset_side || r->taper_side)
		return nc_refuse(r, c->at, "G40 G50, and a machine that sinks",
				 "an orbit of a wire, or under its offset");
	return nc_refuse(r, c->at, "a plane of axes the machine has, and one "
			 "to sink along",
			 "an orbit in the plane %s", nc_planes[r->plane].name);
}

static int take_plane(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	const struct nc_plane *p = &nc_planes[r->plane];
	const uint32_t axes = NC_BIT(p->a) | NC_BIT(p->b) | NC_BIT(p->normal);
	struct interp_orbit *o = &c->orbit;

	if (nc_has_guides(r) || r->offset_side || r->taper_side ||
	    r->absent & axes || r->tool.on)
		return refuse_machine(c);
	if (interp_turn_is_on(&r->contour.guides.turn) &&
	    p->normal != INTERP_Z)
		return nc_refuse(r, c->at, "G17 before it, or a work system "
				 "that is not turned", "an orbit in the plane "
				 "%s, where the work is turned by %g degrees",
				 p->name, r->contour.guides.turn.deg);
	o->a = p->a;
	o->b = p->b;
	o->sink = p->normal;
	memcpy(o->start_mm, nc_here(r), sizeof(o->start_mm));
	for (int i = INTERP_X; i <= INTERP_Z; i++) {
		char wanted[96];

		if (!(r->block.words & NC_BIT(i)) || i == (int)p->normal)
			continue;
		snprintf(wanted, sizeof(wanted), "%c, along which it sinks "
			 "under %s", INTERP_AXIS_LETTERS[p->normal], p->name);
		return nc_refuse(r, r->block.at[i], wanted,
				 "%s of an orbit in the plane %s",
				 nc_quote_word(r, r->block.at[i]).s, p->name);
	}
	return 0;
}

static int take_depth(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	struct interp_orbit *o = &c->orbit;
	const char axis = INTERP_AXIS_LETTERS[o->sink];
	double end_mm[INTERP_NAXES];
	char wanted[96];

	nc_target(r, end_mm);
	o->end_mm = end_mm[o->sink];
	o->c_end_deg = end_mm[INTERP_C];
	if (nc_check_eccentric(r, end_mm))
		return -EINVAL;
	if (fabs(o->end_mm - o->start_mm[o->sink]) > NOTHING_MM)
		return 0;
	snprintf(wanted, sizeof(wanted), "%c, the bottom, away from where it "
		 "begins", axis);
	if (o->shape == INTERP_ORBIT_SPHERE || o->shape == INTERP_ORBIT_CONE)
		return nc_refuse(r, c->at, wanted, "%s without a depth",
				 nc_quote_word(r, c->at).s);
	if (nc_has(r, NC_Q) && o->shape != INTERP_ORBIT_EXPAND)
		return nc_refuse(r, r->block.at[NC_Q], wanted,
				 "a step of depth, and no depth");
	if (nc_has(r, NC_C))
		return nc_refuse(r, r->block.at[NC_C], wanted,
				 "C turns as it sinks, and it does not sink");
	return 0;
}

/* The undersize of the electrode: I, or the register D. */
static int take_undersize(struct nc_orbit *c, double *ret_mm)
{
	struct nc_reader *r = c->r;
	const struct nc_register *g = &r->registers[r->selected];

	if (nc_has(r, NC_I) == nc_has(r, NC_D))
		return nc_refuse(r, c->at, "R, the radius; or I or D, the "
				 "undersize, with J and K",
				 nc_has(r, NC_I) ? "an orbit with I and D" :
				 "an orbit without a radius");
	c->radius_at = r->block.at[nc_has(r, NC_I) ? NC_I : NC_D];
	*ret_mm = length_of(r, NC_I);
	if (nc_has(r, NC_I))
		return 0;
	if (!g->known)
		return nc_refuse(r, c->radius_at, "a register filled before, "
				 "as in D1=0.25",
				 "an undersize by register %u, which is not "
				 "defined", r->selected);
	*ret_mm = g->mm;
	return 0;
}

static int refuse_small(struct nc_orbit *c, double least_mm)
{
	struct nc_reader *r = c->r;
	char wanted[96];

	snprintf(wanted, sizeof(wanted), "a radius of a pulse, %g mm, or more",
		 least_mm);
	if (nc_has(r, NC_R))
		return nc_refuse(r, c->radius_at, wanted,
				 "an orbit of radius %g mm",
				 c->orbit.radius_mm);
	return nc_refuse(r, c->radius_at, wanted,
			 "an undersize that leaves a radius of %.6g mm",
			 c->orbit.radius_mm);
}

/* R; or the undersize minus the gap (J) and the allowance (K), all on one
 * side. */
static int take_radius(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	const struct interp_axis_limits *l = r->o->machine->axis;
	struct interp_orbit *o = &c->orbit;
	const double least = fmax(l[o->a].pulse_mm, l[o->b].pulse_mm);
	const uint32_t parts = r->block.words & (NC_CENTRE | NC_BIT(NC_D));
	double under_mm = 0;
	int err = 0;

	c->radius_at = r->block.at[NC_R];
	if (nc_has(r, NC_R) && parts)
		return nc_refuse(r, r->block.at[__builtin_ctz(parts)],
				 "R, or undersize, gap and allowance",
				 "R beside an undersize");
	if (nc_has(r, NC_R)) {
		o->radius_mm = length_of(r, NC_R);
	} else {
		err = take_undersize(c, &under_mm);
		o->radius_mm = under_mm - length_of(r, NC_J) -
			       length_of(r, NC_K);
	}
	return err ? err : o->radius_mm >= least - NOTHING_MM ? 0 :
	       refuse_small(c, least);
}

static int take_steps(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	struct interp_orbit *o = &c->orbit;
	const double p = nc_has(r, NC_P) ? r->block.value[NC_P] : 1;
	const bool needs = o->shape == INTERP_ORBIT_SPHERE ||
			   o->shape == INTERP_ORBIT_CONE ||
			   o->shape == INTERP_ORBIT_EXPAND;
	const double pulse = r->o->machine->axis[o->sink].pulse_mm;

	o->step_mm = length_of(r, NC_Q);
	if (needs && !nc_has(r, NC_Q))
		return nc_refuse(r, c->at, "Q, as in Q0.02",
				 "%s without a step",
				 nc_quote_word(r, c->at).s);
	if (nc_has(r, NC_Q) && !(o->step_mm >= pulse - NOTHING_MM))
		return nc_refuse(r, r->block.at[NC_Q], "a pulse or more",
				 "a step of %g mm a turn", o->step_mm);
	if (p != floor(p) || p < 0 || p > 9999 ||
	    (p < 1 && o->shape == INTERP_ORBIT_VECTOR))
		return nc_refuse(r, r->block.at[NC_P], "a whole number of "
				 "turns, up to 9999", "%g turns", p);
	o->turns = (uint32_t)p;
	if (nc_has(r, NC_C) && nc_has(r, NC_Q) &&
	    o->shape != INTERP_ORBIT_EXPAND)
		return nc_refuse(r, r->block.at[NC_C],
				 "C without Q: it turns as the electrode sinks "
				 "in the centre", "C in an orbit that sinks as "
				 "it goes round");
	return 0;
}

static int refuse_letter(struct nc_orbit *c, enum nc_slot slot,
			 const char *where)
{
	struct nc_reader *r = c->r;

	return nc_refuse(r, r->block.at[slot], where,
			 "%s has no use on this line",
			 nc_quote_word(r, r->block.at[slot]).s);
}

/* A and B.  The cone must not close at its bottom or above it. */
static int take_angle(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	struct interp_orbit *o = &c->orbit;
	const double depth = fabs(o->end_mm - o->start_mm[o->sink]);

	if (r->block.angles & NC_BIT(NC_B) &&
	    o->shape != INTERP_ORBIT_SPHERE)
		return refuse_letter(c, NC_B, "B goes with G132");
	o->angle_given = r->block.angles & NC_BIT(NC_A);
	o->angle_deg = o->angle_given ? r->block.value[NC_A] : 0;
	if (!o->angle_given)
		return 0;
	if (o->shape == INTERP_ORBIT_VECTOR)
		return 0;
	if (o->shape != INTERP_ORBIT_CONE)
		return refuse_letter(c, NC_A, "A goes with G133 and G134");
	if (!(fabs(o->angle_deg) < 89))
		return nc_refuse(r, r->block.at[NC_A], "less than 89 degrees",
				 "a cone's wall at %g degrees", o->angle_deg);
	if (isnan(interp_orbit_radius_mm(o, depth)))
		return nc_refuse(r, r->block.at[NC_A], "a smaller angle, or a "
				 "larger R",
				 "a cone that closes %g mm over its bottom",
				 -o->radius_mm / tan(o->angle_deg *
						     M_PI / 180));
	return 0;
}

static int take_rest(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	struct interp_orbit *o = &c->orbit;
	const double pulse = r->o->machine->axis[o->a].pulse_mm;

	o->directions = nc_has(r, NC_L) ? (uint32_t)r->block.value[NC_L] : 1;
	o->bottom_mm = o->radius_mm;
	if (!(r->block.angles & NC_BIT(NC_B)) ||
	    o->shape != INTERP_ORBIT_SPHERE)
		return take_angle(c);
	o->bottom_mm = r->block.value[NC_B] * r->unit_mm;
	if (!(o->bottom_mm >= pulse && o->bottom_mm <= o->radius_mm))
		return nc_refuse(r, r->block.at[NC_B], "a pulse or more, up to "
				 "the radius of the orbit",
				 "a corner of radius %g mm", o->bottom_mm);
	return take_angle(c);
}

/* -- The way out
 * ------------------------------------------------------------ */

/* Point to the bottom word, if the bottom is what lies beyond the travel. */
static int placed(struct nc_orbit *c, int rc)
{
	struct nc_reader *r = c->r;
	const struct interp_orbit *o = &c->orbit;
	const struct interp_axis_limits *l = &r->o->machine->axis[o->sink];
	const bool deep = !(o->end_mm >= l->travel_min_mm &&
			    o->end_mm <= l->travel_max_mm);
	const uint8_t *at = deep && nc_has(r, (enum nc_slot)o->sink) ?
			    r->block.at[o->sink] : c->at;

	if (rc == -EINVAL && r->diag->line == r->line)
		r->diag->column = nc_column(r, at);
	return rc;
}

static int to_line(void *arg, const double end_mm[INTERP_NAXES], bool rapid)
{
	struct nc_orbit *c = arg;
	struct nc_reader *r = c->r;
	int err = nc_word(r, false, rapid);

	if (err == 0)
		err = nc_room(r);
	/* What an orbit positions has been cut by it. */
	r->word.out = rapid;
	if (err == 0)
		err = placed(c, contour_line(&r->contour, end_mm, &r->word,
					     r->diag));
	r->word.out = false;
	return err;
}

static int to_arc(void *arg, const double end_mm[INTERP_NAXES],
		  const struct interp_build_arc *arc)
{
	struct nc_orbit *c = arg;
	struct nc_reader *r = c->r;
	int err = nc_word(r, false, false);

	if (!err)
		err = nc_room(r);
	return err ? err : placed(c, contour_arc(&r->contour, end_mm, arc,
					       &r->word, r->diag));
}

static int to_escape(void *arg, const struct interp_escape *e)
{
	struct nc_orbit *c = arg;
	const int err = interp_build_flush(c->r->build, c->r->diag);

	return err ? err : guides_escape(&c->r->contour.guides, e);
}

/* The longest time that it may take: S, in seconds. */
static int take_time(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	const double s = r->block.value[NC_S];

	if (!nc_has(r, NC_S))
		return 0;
	if (!(s >= 0.001 && s <= 1000000))
		return nc_refuse(r, r->block.at[NC_S], "0.001 to 1000000 "
				 "seconds", "a time of %g s", s);
	c->most_ms = (uint32_t)(s * 1000 + 0.5);
	return 0;
}

/* Straight down, spark out, straight up. */
static int sink(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	const struct interp_orbit *o = &c->orbit;
	double end_mm[INTERP_NAXES];
	int err;

	memcpy(end_mm, o->start_mm, sizeof(end_mm));
	end_mm[o->sink] = o->end_mm;
	end_mm[INTERP_C] = o->c_end_deg;
	err = to_line(c, end_mm, false);
	if (!err && c->dwell_ms > 0)
		err = nc_action(r, INTERP_DWELL, c->dwell_ms, c->at);
	return err ? err : to_line(c, o->start_mm, true);
}

static int carry_out(struct nc_orbit *c)
{
	const struct interp_orbit_to to = { c, to_line, to_arc, to_escape };
	struct nc_reader *r = c->r;

	return c->is_sink ? sink(c) :
	       interp_orbit_walk(&c->orbit, r->o->machine, &to);
}

static int timed(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	int err;

	r->word.line = r->line;
	r->word.rapid = false;
	err = interp_build_timed(r->build, &r->word, r->diag);
	if (!err)
		err = carry_out(c);
	if (!err) {
		r->word.rapid = false;
		err = interp_build_timed_end(r->build, c->most_ms, &r->word,
					    r->diag);
	}
	return err;
}

static int walk(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	struct interp_orbit *o = &c->orbit;
	const int side = o->end_mm < o->start_mm[o->sink] ? 1 : -1;
	int err = contour_flush(&r->contour, r->diag);

	o->escape = r->escape;
	o->top_mm = interp_build_came_mm(r->build, (int)o->sink, side);
	if (!err)
		err = c->most_ms > 0 ? timed(c) : carry_out(c);
	r->moved |= NC_BIT(o->a) | NC_BIT(o->b) | NC_BIT(o->sink) |
		    (r->block.words & NC_BIT(NC_C));
	return err;
}

/* G86: P is the time to spark out. */
static int take_sink(struct nc_orbit *c)
{
	struct nc_reader *r = c->r;
	const double s = nc_has(r, NC_P) ? r->block.value[NC_P] : 0;

	if (c->orbit.end_mm == c->orbit.start_mm[c->orbit.sink])
		return nc_refuse(r, c->at, "the bottom, as in G86 Z-5",
				 "G86 without a depth");
	if (!(s >= 0 && s <= 1000000))
		return nc_refuse(r, r->block.at[NC_P], "0 to 1000000 seconds",
				 "a dwell of %g s", s);
	c->dwell_ms = (uint32_t)(s * 1000 + 0.5);
	return 0;
}

static int take_all(struct nc_orbit *c,
		    int (*const take[])(struct nc_orbit *))
{
	int err = 0;

	for (size_t i = 0; take[i] && !err; i++)
		err = take[i](c);
	return err;
}

int nc_run_cycle(struct nc_reader *r)
{
	static int (*const orbit[])(struct nc_orbit *) = {
		take_plane, take_depth, take_radius, take_steps, take_rest,
		take_time, walk, NULL,
	};
	static int (*const straight[])(struct nc_orbit *) = {
		take_plane, take_depth, take_angle, take_sink, take_time, walk,
		NULL,
	};
	const uint8_t shape = r->block.code[NC_CYCLE]->value;
	struct nc_orbit c = {
		.r = r, .at = r->block.code_at[NC_CYCLE],
		.orbit.shape = (enum interp_orbit_shape)shape,
		.is_sink = shape == INTERP_NORBITS,
	};

	r->curve.smooth = false;
	return take_all(&c, c.is_sink ? straight : orbit);
}
