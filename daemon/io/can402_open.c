/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_open.c - the master as the machine file wants it, or why not
 */
#include "can402_bus.h"
#include "drive_steps.h"
#include "drives.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LIMITED_US	100000	/* bit 11 may be 1 for so long */
#define BEATS_MISSED	2.5
#define STOP_AND_OFF	2		/* quick stop options, object 605A */
#define STOP_AND_HOLD	6

static int refuse(struct interp_diag *diag, int err, const char *interface)
{
	snprintf(diag->found, sizeof(diag->found), "can402.interface %s: %s",
		 interface, strerror(-err));
	if (err == -ENODEV)
		snprintf(diag->wanted, sizeof(diag->wanted),
			 "a CAN interface of this host: ip -br link show "
			 "type can");
	else if (err == -ENETDOWN)
		snprintf(diag->wanted, sizeof(diag->wanted),
			 "it up: ip link set %s up type can bitrate 1000000",
			 interface);
	else if (err == -EAFNOSUPPORT)
		snprintf(diag->wanted, sizeof(diag->wanted),
			 "a kernel with CAN: modprobe can-raw");
	else
		snprintf(diag->wanted, sizeof(diag->wanted),
			 "an interface that may be opened");
	return err;
}

/* On the drives' own bus. */
static bool has_plc(const struct machine_config *c)
{
	return config_has_plc(c) &&
	       strcmp(c->plc.interface, c->can402.interface) == 0;
}

static bool reads_inputs(const struct machine_config *c, int axis)
{
	struct config_input input[CONFIG_NINPUTS];
	struct interp_diag none;

	return c->can402.node[axis] > 0 &&
	       config_drive_inputs(c->drive[axis].inputs, input, &none) > 0;
}

static int check_load(const struct machine_config *c, struct interp_diag *diag)
{
	struct can402_bus b = {
		.bitrate = (uint32_t)(c->can402.bitrate_kbit * 1000),
		.heartbeat_ms = (uint32_t)c->can402.heartbeat_ms,
		.gap = c->can402.gap_id > 0,
		.generator = config_generator_frames(c, c->can402.interface),
	};
	const double us = (double)config_period_ns(c) * 1e-3;
	double load;

	if (has_plc(c))
		b.plc_us = c->plc.cycle_ms * 1e3;
	for (int i = 0; i < IO_NAXES; i++) {
		b.axes += c->can402.node[i] > 0;
		b.inputs += reads_inputs(c, i);
	}
	load = can402_load(&b, us);
	if (load <= CAN402_LOAD_MAX)
		return 0;
	return interp_diag_say(diag, "%u drives%s every %.0f us take %.0f %% "
			       "of %.0f kbit/s; at most %.0f %%: "
			       "machine.period_us %.0f or more", b.axes,
			       b.plc_us > 0 ? " and the PLC" : "", us,
			       100 * load, c->can402.bitrate_kbit,
			       100 * CAN402_LOAD_MAX, can402_period_us(&b));
}

static void want(struct drive_config *d, struct drive_write w)
{
	if (d->nwrites < DRIVE_WRITES)
		d->write[d->nwrites++] = w;
}

static uint32_t whole(double x)
{
	return x < 0 ? 0 : x > UINT32_MAX ? UINT32_MAX : (uint32_t)(x + 0.5);
}

/* Until its brake is closed, if it has one. */
static bool is_held(const struct config_drive *c)
{
	return c->brake == BRAKE_NONE || c->brake == BRAKE_LINE;
}

/* What it is to do by itself, and what its maker or ours wants besides. */
static void add_writes(struct drive_config *d, const struct config_drive *c,
		       double increments_mm)
{
	struct config_object own[CONFIG_SDO_MAX];
	struct interp_diag none;
	const int n = config_drive_sdo(c->sdo, own, &none);

	want(d, (struct drive_write) { 0x605a, 0, 2,
		is_held(c) ? STOP_AND_HOLD : STOP_AND_OFF,
		c->brake != BRAKE_NONE });
	if (c->connection_lost >= 0)
		want(d, (struct drive_write) { 0x6007, 0, 2,
			(uint32_t)c->connection_lost, true });
	if (c->fault_reaction >= 0)
		want(d, (struct drive_write) { 0x605e, 0, 2,
			(uint32_t)c->fault_reaction, false });
	if (c->window_mm > 0)
		want(d, (struct drive_write) { 0x6065, 0, 4,
			whole(c->window_mm * increments_mm), false });
	if (c->quick_stop_mm_s2 > 0)
		want(d, (struct drive_write) { 0x6085, 0, 4,
			whole(c->quick_stop_mm_s2 * increments_mm), false });
	for (int i = 0; i < n; i++)
		want(d, (struct drive_write) { own[i].index, own[i].sub,
			own[i].bytes, own[i].value, false });
}

#define HERE_OLD	35		/* homing methods: where it stands */
#define HERE		37

/*
 * What it does when it homes by itself.  Without an offset its count is 0 where
 * its zero is: drives do not agree on the sign of one.
 */
static void add_homing(struct drive_config *d, const struct machine_config *c,
		       int axis, double increments_mm)
{
	const struct config_drive *k = &c->drive[axis];
	const struct manual_axis *a = &c->manual[axis];
	const double v = increments_mm / k->velocity_unit;

	want(d, (struct drive_write) { 0x6098, 0, 1,
		(uint8_t)(int8_t)k->home, false });
	want(d, (struct drive_write) { 0x607c, 0, 4, 0, true });
	if (k->velocity_unit > 0) {
		want(d, (struct drive_write) { 0x6099, 1, 4,
			whole(a->home_fast_mm_s * v), false });
		want(d, (struct drive_write) { 0x6099, 2, 4,
			whole(a->home_slow_mm_s * v), false });
	}
	if (k->acceleration_unit > 0)
		want(d, (struct drive_write) { 0x609a, 0, 4,
			whole(c->axes.axis[axis].a_max_mm_s2 * increments_mm /
			      k->acceleration_unit), true });
}

/* The whole travel and what is searched beyond it, there and back, fast and
 * slowly. */
static double home_ms(const struct machine_config *c, int axis)
{
	const struct interp_axis_limits *l = &c->axes.axis[axis];
	const struct manual_axis *a = &c->manual[axis];
	const double mm = l->travel_max_mm - l->travel_min_mm +
			  2 * a->home_search_mm;

	return 1e3 * fmin(1e6, mm / a->home_fast_mm_s +
			       mm / a->home_slow_mm_s);
}

static uint32_t cycles_of(double ms, double period_us)
{
	return (uint32_t)(ms * 1e3 / period_us);
}

static struct drive_config drive_of(const struct machine_config *c, int axis)
{
	const struct config_can402 *k = &c->can402;
	const struct config_drive *d = &c->drive[axis];
	const double pulse_mm = c->axes.axis[axis].pulse_mm;
	const double period_us = (double)config_period_ns(c) * 1e-3;
	const double increments_mm = fabs(d->increments / d->pulses) /
				     pulse_mm;
	struct interp_diag none;
	struct drive_config ret = {
		.node = (uint8_t)k->node[axis],
		.master = (uint8_t)k->master_node,
		.increments = (int32_t)d->increments,
		.pulses = (int32_t)d->pulses,
		.period_us = (uint32_t)period_us,
		.heartbeat_ms = (uint32_t)k->heartbeat_ms,
		.beat_cycles = cycles_of(BEATS_MISSED * k->heartbeat_ms,
					 period_us),
		.answer_cycles = cycles_of(k->sdo_ms, period_us),
		.missing_max = (uint32_t)k->missing_max,
		.following_max = (int32_t)(k->following_mm / pulse_mm),
		.lag_cycles = k->following_s * 1e6 / period_us,
		.limited_cycles = (uint32_t)(LIMITED_US / period_us),
		.absolute = d->absolute, .held = is_held(d),
		.no_follow_bit = !d->follow_bit,
		.interpolates = d->mode == DRIVE_IP,
		.reads_inputs = reads_inputs(c, axis),
		.latches = c->manual[axis].method == HOME_SWITCH_INDEX,
		.homes = c->manual[axis].method == HOME_DRIVE,
		.homes_here = (int)d->home == HERE || (int)d->home == HERE_OLD,
		.home_cycles = cycles_of(home_ms(c, axis), period_us),
		.enable_cycles = cycles_of(1e3 * k->enable_s, period_us),
	};

	config_drive_identity(d->identity, ret.identity, &ret.identified,
			      &none);
	ret.nleaves = (uint32_t)config_drive_leave(d->leave, ret.leave, &none);
	if (ret.homes)
		add_homing(&ret, c, axis, increments_mm);
	add_writes(&ret, d, increments_mm);
	return ret;
}

/* Increments a period^2. */
static double brakes_by(const struct machine_config *c, int axis,
			const struct drive_config *d)
{
	const struct interp_axis_limits *l = &c->axes.axis[axis];
	const double period_s = (double)config_period_ns(c) * 1e-9;

	return fmax(1e-3, l->a_max_mm_s2 / l->pulse_mm * abs(d->increments) /
		    d->pulses * period_s * period_s);
}

static int check_eds(const struct machine_config *c, struct interp_diag *diag)
{
	for (int i = 0; i < IO_NAXES; i++) {
		struct drive_config d;

		if (c->can402.node[i] == 0 ||
		    strcmp(c->drive[i].eds, "none") == 0)
			continue;
		d = drive_of(c, i);
		if (drive_eds_check(c->drive[i].eds, &d, diag) < 0)
			return -EINVAL;
	}
	return 0;
}

static void add_drives(struct can402 *s, const struct machine_config *c)
{
	struct interp_diag none;

	for (int i = 0; i < IO_NAXES; i++) {
		struct drive_config d;

		if (c->can402.node[i] == 0)
			continue;
		d = drive_of(c, i);
		s->axis[s->n] = (uint8_t)i;
		if (c->drive[i].brake == BRAKE_LINE)
			s->braked |= 1u << i;
		config_drive_inputs(c->drive[i].inputs, s->input[s->n], &none);
		s->stop[s->n].a = brakes_by(c, i, &d);
		drive_init(&s->drive[s->n++], &d);
	}
}

/* Five kinds of frames of each drive, NMT, targets of others, and the gap. */
static int open_bus(const struct config_can402 *k)
{
	static const uint16_t kinds[] = {
		CAN_TPDO1, CAN_TPDO2, CAN_EMCY, CAN_HEARTBEAT, CAN_SDO_ANSWER
	};
	struct can_hear hear[3 + sizeof(kinds) / sizeof(kinds[0])] = {
		{ CAN_NMT, 0x7ff }, { CAN_RPDO1, 0x780 },
		{ k->gap_id > 0 ? (uint16_t)k->gap_id : CAN_NMT, 0x7ff },
	};

	/* Filtered by function code only; drive_receive() looks at the node. */
	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++)
		hear[3 + i] = (struct can_hear) { kinds[i], 0x780 };
	return can_socket_open(k->interface, hear,
			       sizeof(hear) / sizeof(hear[0]));
}

int can402_attach(struct io_machine *m, const struct machine_config *c, int fd)
{
	struct can402 *s = calloc(1, sizeof(*s));

	if (!s)
		return -ENOMEM;
	s->fd = fd;
	s->c = c->can402;
	s->gap_age = CAN402_STALE;
	s->period_ns = config_period_ns(c);
	s->brake_periods = cycles_of(c->gpio.brake_ms,
				     (double)s->period_ns * 1e-3) + 1;
	if (has_plc(c))
		s->plc_node = (int32_t)c->plc.node;
	add_drives(s, c);
	s->beat_every = (uint32_t)fmax(1, s->c.heartbeat_ms * 1e6 /
				       (double)config_period_ns(c));
	*m = (struct io_machine) {
		.name = "can402", .self = s, .read = can402_read,
		.write = can402_write, .close = can402_close,
		.note = can402_note, .origin = can402_origin,
		.originate = can402_originate,
		.drives = can402_drives, .object = can402_object,
	};
	return 0;
}

/*
 * So many frames are sent at once, at most: when edmd ends.  If more waited for
 * the bus, they would be too old when they go out.
 */
static size_t at_once(const struct can402 *s)
{
	return s->n * (1 + DRIVE_ENDS) + 4;
}

int can402_open(struct io_machine *m, const struct machine_config *c,
		struct interp_diag *diag)
{
	const struct config_can402 *k = &c->can402;
	int err = check_load(c, diag), fd;

	if (err == 0)
		err = check_eds(c, diag);
	if (err < 0)
		return err;
	fd = open_bus(k);
	if (fd < 0)
		return refuse(diag, fd, k->interface);
	err = can402_attach(m, c, fd);
	if (err < 0) {
		close(fd);
		return refuse(diag, err, k->interface);
	}
	can_socket_queue(fd, at_once(m->self));
	return 0;
}
