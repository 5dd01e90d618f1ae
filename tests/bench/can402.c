/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402.c - how full a bus of drives is, and what its master takes
 *
 *	can402			the table of docs/can402.md
 *	can402 INTERFACE	drives of our own on it, 2, 4, 6 and 8 of them:
 *				the master's part of a period, and how evenly
 *				its SYNC comes
 */
#include "bench.h"

#include "can402.h"
#include "can_socket.h"
#include "config.h"
#include "interp/diag.h"
#include "io.h"

#include <errno.h>
#include <math.h>
#include <sched.h>
#include <string.h>
#include <unistd.h>

#define PERIOD_NS	2000000
#define PERIODS		1000
#define NODES		8
#define OBJECTS		128
#define PLACES_MODE	8

/* -- The table ------------------------------------------------------------ */

static struct can402_bus bus_of(uint32_t axes, bool frames)
{
	return (struct can402_bus) {
		.bitrate = 1000000, .axes = axes, .heartbeat_ms = 100,
		.gap = frames, .generator = frames
	};
}

static void load_row(double us, bool frames)
{
	printf("| %g ms |", us / 1000);
	for (uint32_t axes = 2; axes <= NODES; axes += 2) {
		const struct can402_bus b = bus_of(axes, frames);
		const double load = can402_load(&b, us);

		printf(load > CAN402_LOAD_MAX ? " (%.0f %%) |" : " %.0f %% |",
		       100 * load);
	}
	printf("\n");
}

static void table(bool frames)
{
	static const double periods_us[] = { 1000, 2000, 3000, 4000, 5000 };

	printf("\n| %s | 2 drives | 4 | 6 | 8 |\n|---|---|---|---|---|\n",
	       frames ? "with gap and generator" : "drives alone");
	for (size_t i = 0; i < sizeof(periods_us) / sizeof(double); i++)
		load_row(periods_us[i], frames);
	printf("| shortest |");
	for (uint32_t axes = 2; axes <= NODES; axes += 2) {
		const struct can402_bus b = bus_of(axes, frames);

		printf(" %g ms |", can402_period_us(&b) / 1000);
	}
	printf("\n");
}

/* -- Drives of our own ---------------------------------------------------- */

/* What a drive has in an object: what was written there. */
struct object {
	uint32_t at;		/* index * 256 + sub index; 0: free */
	uint8_t bytes;
	uint32_t value;
};

/* A drive that has every object of four bytes, and says zero in most. */
static const struct object at_first[] = {
	{ 0x100000, 4, 0x20192 },	/* servo drive of CiA 402 */
	{ 0x650200, 4, 0x80 },		/* it knows cyclic places */
};

struct peer {
	int fd;
	bool running[NODES + 1];
	struct object object[NODES + 1][OBJECTS];
	double synced_s, longest_s, shortest_s;
	uint32_t syncs;
};

static void on_sync(struct peer *p, double now_s)
{
	const double since_s = now_s - p->synced_s;

	if (p->syncs++ > 0) {
		p->longest_s = fmax(p->longest_s, since_s);
		p->shortest_s = fmin(p->shortest_s, since_s);
	}
	p->synced_s = now_s;
	for (uint32_t i = 1; i <= NODES; i++) {
		struct can_msg m = { .id = (uint16_t)(CAN_TPDO1 + i), .len = 7,
				     .data = { 0x50, 0x02,
					       [6] = PLACES_MODE } };

		if (p->running[i])
			can_socket_send(p->fd, &m);
	}
}

/* Where there is none yet, it is made. */
static struct object *object_of(struct object *o, uint32_t at)
{
	for (size_t i = 0; i < sizeof(at_first) / sizeof(at_first[0]); i++)
		o[i] = at_first[i];
	while (o->at && o->at != at)
		o++;
	if (!o->at)
		*o = (struct object) { .at = at, .bytes = 4 };
	return o;
}

static void on_sdo(struct peer *p, const struct can_msg *m)
{
	const uint32_t at = (uint32_t)m->data[2] << 16 |
			    (uint32_t)m->data[1] << 8 | m->data[3];
	struct object *o = object_of(p->object[m->id - CAN_SDO_ASK], at);
	const uint8_t spare = (uint8_t)((4 - o->bytes) << 2);
	struct can_msg a = *m;

	a.id = (uint16_t)(m->id - CAN_SDO_ASK + CAN_SDO_ANSWER);
	if (m->data[0] == 0x40) {
		a.data[0] = 0x43 | spare;
		can_put(a.data + 4, o->value, 4);
	} else {
		o->bytes = (uint8_t)(4 - (m->data[0] >> 2 & 3));
		o->value = (uint32_t)m->data[4] | (uint32_t)m->data[5] << 8 |
			   (uint32_t)m->data[6] << 16 |
			   (uint32_t)m->data[7] << 24;
		a.data[0] = 0x60;
		can_put(a.data + 4, 0, 4);
	}
	can_socket_send(p->fd, &a);
}

static void answer(struct peer *p, double now_s)
{
	struct can_msg m;

	while (can_socket_receive(p->fd, &m) == CAN_FRAME) {
		if (m.id == CAN_SYNC)
			on_sync(p, now_s);
		else if (m.id == CAN_NMT && m.data[1] <= NODES)
			p->running[m.data[1]] = m.data[0] == 1;
		else if (m.id > CAN_SDO_ASK && m.id <= CAN_SDO_ASK + NODES)
			on_sdo(p, &m);
	}
}

/* -- The master ----------------------------------------------------------- */

static void sleep_until(struct timespec *t)
{
	t->tv_nsec += PERIOD_NS;
	if (t->tv_nsec >= 1000000000) {
		t->tv_nsec -= 1000000000;
		t->tv_sec++;
	}
	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, t, NULL) ==
	       EINTR)
		;
}

/* Return: seconds of the master's read and write in a period, mean. */
static double run(struct io_machine *m, struct peer *p)
{
	struct io_outputs out = { .path = 0 };
	struct timespec t;
	struct io_inputs in;
	double took_s = 0;

	clock_gettime(CLOCK_MONOTONIC, &t);
	for (int n = 0; n < 2 * PERIODS; n++) {
		double woke_s;

		sleep_until(&t);
		woke_s = bench_now_s();
		m->read(m->self, &in);
		m->write(m->self, &out);
		if (n >= PERIODS)
			took_s += bench_now_s() - woke_s;
		else
			p->syncs = 0;
		answer(p, woke_s);
	}
	return in.starting ? NAN : took_s / PERIODS;
}

static void say_why(const struct io_machine *m, uint32_t axes)
{
	char note[160];

	fprintf(stderr, "can402: %u drives do not start\n", axes);
	while (m->note(m->self, note, sizeof(note)))
		fprintf(stderr, "can402: %s\n", note);
}

static int measure(const char *interface, uint32_t axes)
{
	static const struct can_hear all[] = { { 0, 0 } };
	static struct machine_config c;
	static struct peer p;
	struct interp_diag diag;
	struct io_machine m;
	char name[32];
	double took_s;

	p = (struct peer) { .shortest_s = 1 };
	config_defaults(&c);
	c.period_us = PERIOD_NS / 1000;
	/* A bus without a limit: what is asked is the master's own time. */
	c.can402.bitrate_kbit = 1e6;
	c.can402.heartbeat_ms = 10000;
	snprintf(c.can402.interface, sizeof(c.can402.interface), "%s",
		 interface);
	for (uint32_t i = 0; i < axes; i++)
		c.can402.node[i] = i + 1;
	p.fd = can_socket_open(interface, all, 1);
	if (p.fd < 0 || io_can402_open(&m, &c, &diag) < 0) {
		fprintf(stderr, "can402: %s: %s\n", interface,
			p.fd < 0 ? strerror(-p.fd) : diag.found);
		return 69;
	}
	took_s = run(&m, &p);
	if (isnan(took_s))
		say_why(&m, axes);
	m.close(m.self);
	close(p.fd);
	if (isnan(took_s))
		return 69;
	snprintf(name, sizeof(name), "us_%u", axes);
	bench_say(name, took_s * 1e6);
	snprintf(name, sizeof(name), "spread_us_%u", axes);
	bench_say(name, (p.longest_s - p.shortest_s) * 1e6);
	return 0;
}

int main(int argc, char **argv)
{
	const struct sched_param fifo = { .sched_priority = 80 };
	int err = 0;

	if (argc == 1) {
		table(false);
		table(true);
		return 0;
	}
	sched_setscheduler(0, SCHED_FIFO, &fifo);
	for (uint32_t axes = 2; axes <= NODES && err == 0; axes += 2)
		err = measure(argv[1], axes);
	return err;
}
