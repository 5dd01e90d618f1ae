/* SPDX-License-Identifier: Apache-2.0 */
/*
 * manual_help.h - a machine moved by hand, with switches and no job
 */
#ifndef MANUAL_HELP_H
#define MANUAL_HELP_H

#include "cycle_help.h"

#define Z_BIT	(1u << INTERP_Z)
#define X_BIT	(1u << INTERP_X)

/* A machine whose drives do not know where they are: pulses of its switches. */
struct bench {
	struct cycle c;
	struct io_inputs in;
	struct io_outputs out;
	int32_t home[INTERP_NAXES];	/* on at and below */
	int32_t own_more;		/* the drives' own zero lies there */
	int32_t index;			/* pulses from mark to mark */
	int latch_cycles;		/* until one is looked for */
	int latch_in[INTERP_NAXES];	/* ... from now on */
	int32_t limit_min, limit_max;
	bool ends_told, ends_swapped;	/* at which end each is */
	int32_t before[INTERP_NAXES];
	int32_t most;			/* pulses in one period, of any axis */
};

static inline struct cycle_config manual_config(void)
{
	struct cycle_config k = usual_config();

	k.press_cycles = 200;
	for (int i = 0; i < INTERP_NAXES; i++)
		k.axis[i] = (struct manual_axis) {
			.present = i < 3,
			.pulse_mm = PULSE_MM, .v_max_mm_s = 50,
			.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000,
			.jog_mm_s = 20, .home_toward = -1,
			.home_fast_mm_s = 20, .home_slow_mm_s = 1,
			.home_at_mm = -10, .home_back_mm = 0.5,
			.home_search_mm = 5,
		};
	return k;
}

static inline void bench_init(struct bench *b, const struct cycle_config *k)
{
	*b = (struct bench) {
		.index = 2000, .limit_min = -300000, .limit_max = 300000,
		.in = { .gap_valid = true, .gap_v = OPEN_V },
	};
	for (int i = 0; i < INTERP_NAXES; i++)
		b->home[i] = -50000;
	cycle_init(&b->c, k);
}

static inline bool passed(const struct bench *b, int i)
{
	return floor((double)b->out.target[i] / b->index) !=
	       floor((double)b->before[i] / b->index);
}

static inline void limit_is_on(struct bench *b, int i, bool high)
{
	b->in.limit |= 1u << i;
	if (b->ends_told)
		*(high ? &b->in.limit_high : &b->in.limit_low) |= 1u << i;
}

/* It takes a while until the mark is looked for. */
static inline void latch(struct bench *b, int i)
{
	const uint32_t bit = 1u << i;

	if (!(b->out.latch & bit)) {
		b->in.latching &= ~bit;
		b->in.latched &= ~bit;
		b->latch_in[i] = b->latch_cycles;
	} else if (b->latch_in[i] > 0) {
		b->latch_in[i]--;
	} else if (b->in.latching & bit && passed(b, i)) {
		b->in.latched_at[i] = b->out.target[i];
		b->in.latched |= bit;
		b->in.latching &= ~bit;
	} else if (!(b->in.latched & bit)) {
		b->in.latching |= bit;
	}
}

static inline void sense(struct bench *b)
{
	b->in.home = b->in.limit = 0;
	b->in.limit_low = b->in.limit_high = 0;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t at = b->out.target[i];

		b->in.home |= at <= b->home[i] ? 1u << i : 0;
		latch(b, i);
		if (at < b->limit_min)
			limit_is_on(b, i, b->ends_swapped);
		if (at > b->limit_max)
			limit_is_on(b, i, !b->ends_swapped);
		b->in.actual[i] = b->in.stands_at[i] = at;
		b->in.own[i] = at + b->own_more;
	}
}

static inline void period(struct bench *b)
{
	sense(b);
	memcpy(b->before, b->out.target, sizeof(b->before));
	cycle_step(&b->c, &b->in, &b->out);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t d = abs(b->out.target[i] - b->before[i]);

		b->most = d > b->most ? d : b->most;
	}
	assert_false(b->out.power);
}

static inline void run_out(struct bench *b, enum cycle_state s)
{
	for (int i = 0; i < 200000 && b->c.state != s; i++)
		period(b);
	assert_string_equal(state_duty[b->c.state].name, state_duty[s].name);
}

static inline enum cycle_answer ask(struct bench *b, enum cycle_verb v,
				    uint32_t axis,
			     double mm)
{
	const struct cycle_command m = { .verb = v, .arg = axis, .arg_mm = mm };

	return cycle_command(&b->c, &m);
}

static inline enum cycle_answer jog(struct bench *b, uint32_t axis, double mm)
{
	return ask(b, CYCLE_JOG, axis, mm);
}

#endif /* MANUAL_HELP_H */
