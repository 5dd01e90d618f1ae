/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_link.c - the PLC of a machine: plc.h over a CAN interface
 */
#include "plc_link.h"

#include "can_socket.h"
#include "config.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* -- Open ----------------------------------------------------------------- */

static int refuse(const struct machine_config *c, int err,
		  struct interp_diag *d)
{
	const char *name = c->plc.interface;

	snprintf(d->found, sizeof(d->found), "plc.interface %s: %s", name,
		 strerror(-err));
	switch (err) {
	case -ENODEV:
		snprintf(d->wanted, sizeof(d->wanted), "a CAN interface that "
			 "is there; ip -brief link show type can lists them");
		break;
	case -ENETDOWN:
		snprintf(d->wanted, sizeof(d->wanted), "one that is up; ip "
			 "link set %s up type can bitrate 500000", name);
		break;
	case -EAFNOSUPPORT:
		snprintf(d->wanted, sizeof(d->wanted),
			 "a kernel with CAN; modprobe can-raw");
		break;
	default:
		snprintf(d->wanted, sizeof(d->wanted),
			 "a CAN interface, up, that may be used");
	}
	return err;
}

static uint32_t cycles_of(double ms, int64_t period_ns)
{
	return (uint32_t)fmax(1, round(ms * 1e6 / (double)period_ns));
}

static void time_by(struct plc *p, const struct machine_config *c)
{
	const int64_t period_ns = config_period_ns(c);

	p->cycles_per_ms = 1e6 / (double)period_ns;
	plc_beat(p, p->beat_ms);
	p->send_cycles = cycles_of(c->plc.cycle_ms, period_ns);
	p->alive_cycles = cycles_of(c->plc.alive_ms, period_ns);
}

int plc_link_open(struct plc_link *l, const struct machine_config *c,
		  struct interp_diag *diag)
{
	const uint16_t node = (uint16_t)c->plc.node;
	const struct can_hear hear[] = {
		{ CAN_NMT, 0x7ff }, { (uint16_t)(CAN_RPDO1 + node), 0x7ff },
		{ (uint16_t)(CAN_SDO_ASK + node), 0x7ff },
		{ (uint16_t)(CAN_TPDO1 + node), 0x7ff },
		{ (uint16_t)(CAN_HEARTBEAT + node), 0x7ff },
		{ (uint16_t)(CAN_RPDO2 + node), 0x7ff },
		{ (uint16_t)(CAN_RPDO3 + node), 0x7ff },
	};

	size_t n = sizeof(hear) / sizeof(hear[0]);

	*l = (struct plc_link) { .fd = -1, .before = 0xff };
	if (!config_has_plc(c))
		return 0;
	plc_init(&l->plc, (uint8_t)node);
	time_by(&l->plc, c);
	l->plc.sets = config_generator_interface(c) == GENERATOR_PLC;
	memcpy(l->interface, c->plc.interface, sizeof(l->interface));
	/* The last two are of a generator that it sets. */
	l->fd = can_socket_open(c->plc.interface, hear,
				l->plc.sets ? n : n - 2);
	if (l->fd < 0)
		return refuse(c, l->fd, diag);
	can_socket_queue(l->fd, 2 * PLC_EMITS);
	return 0;
}

void plc_link_close(struct plc_link *l)
{
	if (l->fd >= 0)
		close(l->fd);
	l->fd = -1;
}

/* -- Once a period -------------------------------------------------------- */

static void count(struct plc_link *l, enum plc_count i, uint32_t n)
{
	__atomic_store_n(&l->count[i], n, __ATOMIC_RELAXED);
}

static void add(struct plc_link *l, enum plc_count i)
{
	count(l, i, l->count[i] + 1);
}

/* An interface that is down or off the bus brings nothing: the PLC dies. */
static void receive(struct plc_link *l)
{
	struct can_msg m;

	for (int i = 0; i < PLC_LINK_FRAMES; i++) {
		switch (can_socket_receive(l->fd, &m)) {
		case CAN_FRAME:
			plc_receive(&l->plc, &m);
			break;
		case CAN_ODD:
			l->plc.malformed++;
			break;
		case CAN_WARNING:
			add(l, PLC_WARNINGS);
			break;
		case CAN_PASSIVE:
			add(l, PLC_PASSIVE);
			break;
		case CAN_BUS_OFF:
			add(l, PLC_BUS_OFF);
			break;
		case CAN_DOWN:
			if (!l->is_down)
				add(l, PLC_DOWN);
			l->is_down = true;
			return;
		default:
			return;
		}
	}
}

static void follow(struct plc_link *l)
{
	const bool alive = plc_alive(&l->plc);

	if (alive != l->was_alive)
		add(l, alive ? PLC_CAME : PLC_WENT);
	if (alive)
		l->is_down = false;
	l->was_alive = alive;
	count(l, PLC_MALFORMED, l->plc.malformed);
	count(l, PLC_REFUSED, l->plc.refused);
	count(l, PLC_TWINS, l->plc.twins);
}

void plc_link_read(struct plc_link *l, struct io_plc *ret)
{
	const struct plc_ask *a = &l->plc.ask;
	uint8_t edges;

	*ret = (struct io_plc) { .present = l->fd >= 0 };
	if (l->fd < 0)
		return;
	receive(l);
	plc_period(&l->plc);
	follow(l);
	edges = (uint8_t)(a->command & ~l->before);
	l->before = plc_alive(&l->plc) ? a->command : 0xff;
	if (!plc_alive(&l->plc))
		return;
	ret->alive = true;
	ret->permit = a->command & PLC_PERMIT;
	ret->hold = a->command & PLC_HOLD;
	ret->start = edges & PLC_START;
	ret->reset = edges & PLC_RESET;
	ret->confirm = edges & PLC_DONE;
	ret->door_closed = a->locks & PLC_DOOR;
	ret->level_ok = a->locks & PLC_LEVEL;
	ret->temperature_ok = a->locks & PLC_TEMPERATURE;
	ret->no_fire = a->locks & PLC_FIRE;
	ret->wire_whole = a->locks & PLC_WIRE;
	ret->mcode_done = a->mcode_done;
	ret->program = a->program;
	ret->override = a->override * 0.001;
	ret->axes_c = a->axes_c * 0.25;
}

void plc_link_write(struct plc_link *l, const struct plc_tell *tell)
{
	struct can_msg out[PLC_EMITS];
	size_t n;

	if (l->fd < 0)
		return;
	l->plc.tell = *tell;
	n = plc_emit(&l->plc, out);
	/* A number never goes out without the frame that it is of. */
	for (size_t i = 0; i < n; i++)
		if (can_socket_send(l->fd, &out[i]) < 0) {
			add(l, PLC_UNSENT);
			return;
		}
}

/* -- The other thread ----------------------------------------------------- */

static void say(const struct plc_link *l, enum plc_count i, uint32_t n,
		char *buf, size_t size)
{
	static const char *const texts[PLC_NCOUNTS] = {
		[PLC_CAME] = "the PLC is there",
		[PLC_WENT] = "the PLC is gone: its toggle does not turn",
		[PLC_MALFORMED] = "frames of a wrong length or kind for us",
		[PLC_REFUSED] = "values out of range, objects there are not, "
				"or writes while PDOs come",
		[PLC_TWINS] = "frames of another device that has our node",
		[PLC_UNSENT] = "frames not sent: is anything else on the bus? "
			       "else its queue, txqueuelen 100",
		[PLC_WARNINGS] = "many errors on the bus (error warning); "
				 "check cable and termination",
		[PLC_PASSIVE] = "the controller is error passive; bus off is "
				"next; check cable, termination and bit rate",
		[PLC_BUS_OFF] = "bus off; check cable and termination, then "
				"restart the interface",
		[PLC_DOWN] = "the interface is down",
	};

	snprintf(buf, size, "plc %s: %s (%u in all)", l->interface, texts[i],
		 n);
}

bool plc_link_note(struct plc_link *l, char *buf, size_t size)
{
	for (int i = 0; i < PLC_NCOUNTS; i++) {
		const uint32_t n = __atomic_load_n(&l->count[i],
						   __ATOMIC_RELAXED);

		if (n == 0 || n < 2 * l->told[i] || n == l->told[i])
			continue;
		l->told[i] = n;
		say(l, (enum plc_count)i, n, buf, size);
		return true;
	}
	return false;
}
