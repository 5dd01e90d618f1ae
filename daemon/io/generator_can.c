/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_can.c - a generator's values in CAN frames
 */
#include "generator_own.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define RX_MAX	64		/* frames taken in a period */

static struct generator_frame *frame_of(struct generator *g, uint16_t id)
{
	for (uint32_t i = 0; i < g->nframes; i++)
		if (g->frame[i].sent.id == id)
			return &g->frame[i];
	return NULL;
}

static uint64_t mask_of(const struct config_way *w)
{
	return ((UINT64_C(1) << w->bits) - 1) << w->bit;
}

static uint64_t bytes_get(const uint8_t data[8])
{
	return can_get(data, 4) | (uint64_t)can_get(data + 4, 4) << 32;
}

static void bytes_put(uint8_t data[8], uint64_t x)
{
	can_put(data, (uint32_t)x, 4);
	can_put(data + 4, (uint32_t)(x >> 32), 4);
}

void generator_can_init(struct generator *g, const struct machine_config *c)
{
	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		const struct config_way *w = &g->way[i];
		const uint8_t len = (uint8_t)((w->bit + w->bits + 7) / 8);
		struct generator_frame *f;

		if (w->kind != WAY_CAN)
			continue;
		f = frame_of(g, w->id);
		if (!f) {
			f = &g->frame[g->nframes++];
			f->sent.id = w->id;
			f->counts = w->id == (uint16_t)c->generator.can_id;
			f->sent.len = f->counts ? 8 : 1;
			f->age = g->refresh;
		}
		f->sent.len = len > f->sent.len ? len : f->sent.len;
	}
}

/* The frame with this identifier as it is to be, but for the count. */
static uint64_t content(const struct generator *g, uint16_t id)
{
	uint64_t x = 0;

	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		const struct config_way *w = &g->way[i];

		if (w->kind == WAY_CAN && w->id == id)
			x |= generator_count(w, i, g->value[i]) << w->bit &
			     mask_of(w);
	}
	return x;
}

static void bus_is(struct generator *g, bool down)
{
	if (down == g->down)
		return;
	g->down = down;
	generator_tell(g, &(struct generator_note) {
		.kind = down ? GENERATOR_BUS_DOWN : GENERATOR_BUS_BACK
	});
}

#define COUNT_MASK	UINT64_C(0xff00)

static void frame_write(struct generator *g, struct generator_frame *f)
{
	const uint64_t counted = f->counts ? COUNT_MASK : 0;
	const uint64_t was = bytes_get(f->sent.data);
	uint64_t x = content(g, f->sent.id);
	int err;

	f->owed = f->owed || x != (was & ~counted);
	if (++f->age < g->refresh && !f->owed)
		return;
	x |= (was + 0x100) & counted;
	bytes_put(f->sent.data, x);
	err = can_socket_send(g->fd, &f->sent);
	if (f->owed && (err < 0 || f->full > 0))
		g->settling = g->settle;
	f->owed = f->owed && err < 0;
	/* What the queue did not take is sent in the next period. */
	f->age = err < 0 ? g->refresh : 0;
	f->full = err == -ENOBUFS ? f->full + 1 : 0;
	if (err != -ENOBUFS || f->full > g->silent)
		bus_is(g, err < 0);
}

void generator_can_write(struct generator *g)
{
	for (uint32_t i = 0; i < g->nframes; i++)
		frame_write(g, &g->frame[i]);
}

static void hear(struct generator *g, const struct can_msg *m)
{
	for (int i = 0; i < PROCESS_NTOLD; i++) {
		const struct config_way *w = &g->told[i];

		if (w->kind != WAY_CAN || w->id != m->id ||
		    w->bit + w->bits > 8 * m->len)
			continue;
		generator_hears(g, i, (bytes_get(m->data) & mask_of(w)) >>
				      w->bit);
	}
}

void generator_can_read(struct generator *g)
{
	struct can_msg m = { 0 };

	for (int i = 0; i < RX_MAX; i++) {
		switch (can_socket_receive(g->fd, &m)) {
		case CAN_NOTHING:
			return;
		case CAN_FRAME:
			hear(g, &m);
			break;
		case CAN_BUS_OFF:
		case CAN_DOWN:
			bus_is(g, true);
			return;
		default:
			break;
		}
	}
}
