/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_help.h - a whole cycle with a generator in front of axes that do
 * nothing, and a job whose cuts have different conditions
 */
#ifndef GENERATOR_HELP_H
#define GENERATOR_HELP_H

#include "config_help.h"
#include "cycle_help.h"
#include "seed.h"

#include "generator_own.h"

struct shop {
	struct machine_config c;
	struct io_machine axes;		/* what the generator stands before */
	struct rig r;
	uint64_t sparks, waits;
};

static inline void no_read(void *self, struct io_inputs *in)
{
	(void)self;
	(void)in;
}

static inline void no_write(void *self, const struct io_outputs *out)
{
	(void)self;
	(void)out;
}

static inline void no_close(void *self)
{
	(void)self;
}

static inline struct interp_tech tech_of(double peak_a, double off_us,
					 double polarity)
{
	struct interp_tech t;

	interp_tech_clear(&t);
	t.v[INTERP_TECH_PEAK_A] = peak_a;
	t.v[INTERP_TECH_ON_US] = 8;
	t.v[INTERP_TECH_OFF_US] = off_us;
	t.v[INTERP_TECH_IGNITION_V] = 180;
	t.v[INTERP_TECH_SERVO_V] = 2.5 * peak_a;
	t.v[INTERP_TECH_POLARITY] = polarity;
	return t;
}

static inline struct cycle_config shop_config(const struct shop *s)
{
	struct cycle_config k = usual_config(), of_file;

	config_cycle(&s->c, &of_file);
	k.gap.short_v = 10;
	k.asking = of_file.asking;
	k.asking.limited = true;
	return k;
}

/* The first one is C200 of the paper. */
static inline void shop_load(struct shop *s, int cuts,
			     const struct cycle_config *k)
{
	const struct interp_tech t[] = {
		tech_of(6, 20, NAN), tech_of(12, 50, -1), tech_of(9, 20, -1),
	};
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_diag d;

	for (int i = 0; i < cuts; i++) {
		const struct interp_build_word w = {
			.line = 1, .feed_mm_s = 10, .tech = &t[i % 3],
			.cond_letter = 'C', .cond_number = 200,
		};
		double end[INTERP_NAXES];

		memcpy(end, interp_build_here(b), sizeof(end));
		end[INTERP_Z] = -0.2 * (i + 1);
		assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	}
	rig_load(&s->r, b, k);
	assert_int_equal(tell(&s->r, CYCLE_START), ANSWER_DONE);
}

/** shop_generator() - as the machine file @text has it. */
static inline struct generator *shop_generator(struct shop *s, const char *text)
{
	struct interp_diag d;
	struct generator *g;

	memset(s, 0, sizeof(*s));
	assert_int_equal(read_text(text, &s->c, &d), 0);
	s->axes = (struct io_machine) { .read = no_read, .write = no_write,
					.close = no_close };
	g = generator_attach(&s->axes, &s->c, -1);
	assert_non_null(g);
	return g;
}

static inline const struct interp_tech *place_of(const struct shop *s)
{
	return &cond_cut(&s->r.c.cursor)->tech;
}

#endif /* GENERATOR_HELP_H */
