/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_plc.c - a generator that the PLC sets
 *
 * What is asked for goes out with a number, and the PLC answers with that
 * number when the generator has it.  A PLC or an edmd that was started anew may
 * still have a number of before.  So 0 is sent first, of nothing, and only when
 * the PLC has answered 0 there is a number again.
 */
#include "generator_own.h"

#include <math.h>

#define AT(S, id, i, tpdo, rpdo, ...)	[i] = { INTERP_TECH_##id, rpdo },

static const struct {
	uint8_t field, rpdo;
} value_of[PLC_NPULSES] = { PLC_PULSE_ROWS(AT, 0) };

/* Never 0. */
static uint16_t number_of(uint32_t asked)
{
	return (uint16_t)(asked % UINT16_MAX + 1);
}

static bool is_by_plc(const struct generator *g, int field)
{
	return g->way[field].kind == WAY_PLC;
}

static bool is_on(const struct generator *g, int field)
{
	return is_by_plc(g, field) &&
	       generator_count(&g->way[field], field, g->value[field]);
}

static void begin_anew(struct generator *g)
{
	g->plc_empty = false;
	g->taken_version = g->asked - 1;
}

void generator_plc_write(struct generator *g)
{
	struct plc_pulse *p = &g->plc->tell.pulse;

	if (g->anew)
		begin_anew(g);
	p->number = g->plc_empty ? number_of(g->asked) : 0;
	p->bits = (uint8_t)((is_on(g, INTERP_TECH_POLARITY) ?
			     PLC_ASKED_NEGATIVE : 0) |
			    (is_on(g, INTERP_TECH_ISO) ? PLC_ASKED_ISO : 0));
	for (int i = 0; i < PLC_NPULSES; i++) {
		const int field = value_of[i].field;

		p->value[i] = !is_by_plc(g, field) ? UINT16_MAX :
			      (uint16_t)generator_count(&g->way[field], field,
							g->value[field]);
	}
}

static void hear(struct generator *g, int field, uint64_t count)
{
	if (g->told[field].kind == WAY_PLC)
		generator_hears(g, field, count);
	else if (field < PROCESS_NFIELDS && is_by_plc(g, field))
		g->age[field] = 0;
}

static void hear_generator(struct generator *g)
{
	const struct plc_pulse *p = &g->plc->ask.pulse;

	g->plc_empty = g->plc_empty || p->number == 0;
	g->taken_version = g->plc_empty && p->number == number_of(g->asked) ?
			   g->asked : g->asked - 1;
	hear(g, INTERP_TECH_POLARITY, p->bits & PLC_TOLD_NEGATIVE);
	hear(g, INTERP_TECH_ISO, (p->bits & PLC_TOLD_ISO) != 0);
	hear(g, PROCESS_PUMP, 0);
	hear(g, PROCESS_FAULT, g->plc->ask.pulse_fault);
}

/* Takes the values of frame @n.  Return: is it a new one? */
static bool hear_values(struct generator *g, int n)
{
	const bool is_new = g->plc->heard[n] != g->plc_heard[n];

	g->plc_heard[n] = g->plc->heard[n];
	for (int i = 0; i < PLC_NPULSES && is_new && plc_alive(g->plc); i++)
		if (value_of[i].rpdo == n)
			hear(g, value_of[i].field,
			     g->plc->ask.pulse.value[i]);
	return is_new;
}

void generator_plc_read(struct generator *g)
{
	const bool generator = hear_values(g, 2);

	hear_values(g, 3);
	/* One that comes back is asked from the beginning. */
	if (!plc_alive(g->plc))
		begin_anew(g);
	else if (generator)
		hear_generator(g);
}
