/* SPDX-License-Identifier: Apache-2.0 */
/*
 * spark.c - from a change of condition to the first spark, by the interface
 * that reaches the generator
 *
 * A whole cycle at the pace of the clock, 1 ms a period, with a generator in
 * front of it that has what it was asked for at once: what is left is the way
 * there and back, and settle_ms where it tells nothing.  A serial line takes
 * the time of its bytes: 11 bits each, at 19,200 a second.
 *
 * Prints the median and the worst of CHANGES, in ms.
 */
#include "bench.h"
#include "generator_help.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/can.h>
#include <modbus.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>

#define CHANGES		60
#define BAUD		19200
#define CHANGE_S	10		/* the most that one is waited for */

/* -- Generators ------------------------------------------------------------ */

/* One on CAN that tells what it was sent: fd -1, it does not. */
static int far_fd = -1;

static void can_tell(void)
{
	struct can_frame f, told = { .can_id = 1011, .can_dlc = 8 };
	bool any = false;

	while (far_fd >= 0 && read(far_fd, &f, sizeof(f)) == sizeof(f)) {
		memcpy(told.data, f.data, 8);
		any = true;
	}
	if (any && write(far_fd, &told, sizeof(told)) != sizeof(told))
		exit(1);
}

/* A slave of libmodbus' own server. */
struct slave {
	modbus_t *link;
	modbus_mapping_t *map;
	int listens;			/* -1: a serial port */
};

static void *serve(void *arg)
{
	struct slave *s = arg;
	uint8_t ask[MODBUS_TCP_MAX_ADU_LENGTH];
	int fd = s->listens, n;

	if (fd < 0 ? modbus_connect(s->link) < 0 :
		     modbus_tcp_accept(s->link, &fd) < 0)
		exit(1);
	while ((n = modbus_receive(s->link, ask)) >= 0 || fd < 0)
		if (n > 0)
			modbus_reply(s->link, ask, n, s->map);
	return NULL;
}

static void slave_begin(struct slave *s)
{
	pthread_t t;

	s->map = modbus_mapping_new(0, 0, 8, 0);
	pthread_create(&t, NULL, serve, s);
	pthread_detach(t);
}

/* -- A serial line --------------------------------------------------------- */

struct wire {
	int from, to;
};

/* What came together is there when its last bit is. */
static void *carry(void *arg)
{
	const struct wire *w = arg;
	uint8_t bytes[300];
	ssize_t n;

	while ((n = read(w->from, bytes, sizeof(bytes))) > 0) {
		usleep((useconds_t)((double)n * 11e6 / BAUD));
		if (write(w->to, bytes, (size_t)n) != n)
			break;
	}
	return NULL;
}

static int end_of(char *ret, size_t size)
{
	const int fd = posix_openpt(O_RDWR | O_NOCTTY);
	struct termios t;
	int slave;

	if (fd < 0 || grantpt(fd) < 0 || unlockpt(fd) < 0 ||
	    ptsname_r(fd, ret, size) != 0)
		exit(1);
	/* Held open, so that the master never hangs up. */
	slave = open(ret, O_RDWR | O_NOCTTY);
	tcgetattr(slave, &t);
	cfmakeraw(&t);
	tcsetattr(slave, TCSANOW, &t);
	return fd;
}

static void serial_line(char near[64], char far[64])
{
	static struct wire way[2];
	const int a = end_of(near, 64), b = end_of(far, 64);
	pthread_t t;

	way[0] = (struct wire) { a, b };
	way[1] = (struct wire) { b, a };
	for (int i = 0; i < 2; i++) {
		pthread_create(&t, NULL, carry, &way[i]);
		pthread_detach(t);
	}
}

/* -- Changes --------------------------------------------------------------- */

static void sleep_until(double at_s)
{
	const struct timespec t = {
		.tv_sec = (time_t)at_s,
		.tv_nsec = (long)((at_s - floor(at_s)) * 1e9),
	};

	clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL);
}

static void period(struct shop *s, double *at_s)
{
	s->axes.read(s->axes.self, &s->r.in);
	step(&s->r, asking_waits(&s->r.c) ? 0 : SPARKING_V + 5);
	s->axes.write(s->axes.self, &s->r.out);
	can_tell();
	*at_s += 1e-3;
	sleep_until(*at_s);
}

/* Prints @name with the times of the changes. */
static void measure(struct shop *s, const char *name)
{
	double at_s = bench_now_s(), from_s = 0, ms[CHANGES + 1];
	struct cycle_config k = shop_config(s);
	bool waited = false;
	int n = 0;

	shop_load(s, CHANGES + 1, &k);
	while (s->r.c.loaded && n <= CHANGES && !s->r.c.fault.latched) {
		const bool waits = asking_waits(&s->r.c);

		if (waits && !waited)
			from_s = bench_now_s();
		if (!waits && waited && s->r.out.power)
			ms[n++] = 1e3 * (bench_now_s() - from_s);
		waited = waits;
		period(s, &at_s);
		if (waits && bench_now_s() - from_s > CHANGE_S)
			break;
	}
	if (n < CHANGES) {
		fprintf(stderr, "spark: %s: %d of %d changes\n", name, n,
			CHANGES);
		exit(1);
	}
	/* The first one is from nothing. */
	printf("%s %.2f\n", name, bench_median(ms + 1, n - 1));
	printf("%s_worst %.2f\n", name, ms[n - 1]);
	fflush(stdout);
	rig_free(&s->r);
	s->axes.close(s->axes.self);
}

static struct generator *make(struct shop *s, const char *keys)
{
	char text[900];

	snprintf(text, sizeof(text), "[machine]\nbackend = null\n"
		 "period_us = 1000\n[generator]\npolarity_ms = 0\n"
		 "confirm_s = 10\n%s", keys);
	return shop_generator(s, text);
}

#define REGISTERS	"silent_ms = 5000\n" \
	"peak_a = register 0 scale 0.1\n" \
	"on_us = register 1 scale 0.1\noff_us = register 2 scale 0.1\n" \
	"ignition_v = register 3\npolarity = register 5 bit 0\n"

static void by_modbus(const char *name, const char *where, const char *more)
{
	struct interp_diag d;
	struct generator *g;
	struct shop s;
	char text[600];

	snprintf(text, sizeof(text), "interface = modbus\nmodbus = %s\n"
		 "modbus_timeout_ms = 200\n%s" REGISTERS, where, more);
	g = make(&s, text);
	if (generator_modbus_open(g, &s.c, &d) < 0)
		exit(1);
	measure(&s, name);
}

static void by_lines(void)
{
	struct shop s;

	make(&s, "interface = lines\npeak_a = lines 1 2 weights 3 6\n");
	measure(&s, "lines");
}

static void by_can(const char *name, const char *more)
{
	struct generator *g;
	struct shop s;
	char text[300];
	int fd[2];

	snprintf(text, sizeof(text), "interface = can\ncan_id = 1009\n"
		 "silent_ms = 5000\n%s", more);
	g = make(&s, text);
	if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, fd) < 0)
		exit(1);
	g->fd = fd[0];
	far_fd = fd[1];
	generator_can_init(g, &s.c);
	measure(&s, name);
	close(far_fd);
	far_fd = -1;
}

static void by_tcp(void)
{
	static struct slave s;
	char where[40];
	struct sockaddr_in at;
	socklen_t size = sizeof(at);

	s.link = modbus_new_tcp("127.0.0.1", 0);
	s.listens = modbus_tcp_listen(s.link, 1);
	if (s.listens < 0 ||
	    getsockname(s.listens, (struct sockaddr *)&at, &size) < 0)
		exit(1);
	slave_begin(&s);
	snprintf(where, sizeof(where), "127.0.0.1:%d", ntohs(at.sin_port));
	by_modbus("modbus_tcp", where, "");
}

static void by_rtu(void)
{
	static struct slave s = { .listens = -1 };
	char near[64], far[64];

	serial_line(near, far);
	s.link = modbus_new_rtu(far, BAUD, 'E', 8, 1);
	modbus_set_slave(s.link, 1);
	slave_begin(&s);
	by_modbus("modbus_rtu", near, "");
}

static void by_dac(void)
{
	char root[] = "/tmp/bench_spark.XXXXXX", file[80];
	struct interp_diag d;
	struct generator *g;
	struct shop s;

	if (!mkdtemp(root))
		exit(1);
	snprintf(file, sizeof(file), "%s/iio:device0", root);
	mkdir(file, 0700);
	snprintf(file, sizeof(file), "%s/iio:device0/out_voltage0_raw", root);
	close(open(file, O_CREAT | O_WRONLY, 0600));
	g = make(&s, "interface = lines\n"
		     "peak_a = dac iio:device0 voltage0 scale 6 to 10\n");
	if (generator_dac_open(g, root, &d) < 0)
		exit(1);
	measure(&s, "dac");
	unlink(file);
	*strrchr(file, '/') = '\0';
	rmdir(file);
	rmdir(root);
}

int main(void)
{
	make_file(NULL);
	by_lines();
	by_can("can_settled", "");
	by_can("can_told", "told_peak_a = can 1011 byte 2 scale 0.1\n"
	       "told_on_us = can 1011 byte 4 scale 0.1\n"
	       "told_off_us = can 1011 byte 6 scale 0.1\n"
	       "told_polarity = can 1011 byte 0 bit 2\n");
	by_tcp();
	by_rtu();
	by_dac();
	remove_file(NULL);
	return 0;
}
