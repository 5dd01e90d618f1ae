/* SPDX-License-Identifier: Apache-2.0 */
/*
 * torture-help.c - what guest/torture.sh needs beside edmd and its clients
 *
 *	torture-help reseed	draw new random numbers from here on
 *	torture-help plc IFACE	a PLC that permits everything, and answers
 *				each M code after a while
 *	torture-help watch NAME	one line for each 20 ms of edmd's snapshot
 *
 * What it prints goes out line by line, because it ends when the power fails.
 */
#include "shm.h"

#include <fcntl.h>
#include <net/if.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <linux/can.h>
#include <linux/random.h>

enum {
	NODE = 32,
	TURN_MS = 20,
	ANSWER_TURNS = 15,	/* that an M code takes */
	LOCKS = 0x1f,
	PERMIT = 0x01, ALIVE = 0x80,
};

/*
 * Every boot goes on from the same memory, so the kernel would draw the same
 * numbers in each.
 */
static int reseed(void)
{
	int fd = open("/dev/urandom", O_RDWR);
	int ret;

	if (fd < 0)
		return -1;
	ret = ioctl(fd, RNDRESEEDCRNG);
	close(fd);
	return ret;
}

static int can_open(const char *interface)
{
	struct sockaddr_can at = { .can_family = AF_CAN };
	int fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);

	at.can_ifindex = (int)if_nametoindex(interface);
	if (fd < 0 || !at.can_ifindex ||
	    bind(fd, (struct sockaddr *)&at, sizeof(at)) < 0)
		return -1;
	return fd;
}

static void can_put(int fd, uint32_t id, const uint8_t *data, uint8_t len)
{
	struct can_frame f = { .can_id = id, .can_dlc = len };

	memcpy(f.data, data, len);
	/* A frame that is lost is followed by the next one. */
	if (write(fd, &f, sizeof(f)) != sizeof(f))
		perror("torture-help: CAN");
}

/* The M code that edmd waits for, of its last EdmdStatus. */
static uint8_t waiting(int fd, uint8_t before)
{
	struct can_frame f;

	while (recv(fd, &f, sizeof(f), MSG_DONTWAIT) == sizeof(f))
		if (f.can_id == 0x180 + NODE && f.can_dlc == 8)
			before = f.data[3];
	return before;
}

static int plc(const char *interface)
{
	const uint8_t start[2] = { 1, NODE };
	uint8_t ask[8] = { PERMIT, LOCKS, 1000 & 0xff, 1000 >> 8 };
	uint8_t code = 0, was = 0;
	int fd = can_open(interface), turns = 0;

	if (fd < 0)
		return -1;
	for (unsigned i = 0;; i++, was = code) {
		/* edmd forgets it when it starts anew. */
		if (i % 16 == 0)
			can_put(fd, 0, start, sizeof(start));
		ask[0] ^= ALIVE;
		can_put(fd, 0x200 + NODE, ask, sizeof(ask));
		usleep(TURN_MS * 1000);
		code = waiting(fd, code);
		turns = code == was ? turns + 1 : 0;
		if (code && !turns)
			printf("ask %u\n", code);
		if (code && turns == ANSWER_TURNS)
			printf("done %u\n", code);
		ask[6] = code && turns >= ANSWER_TURNS ? code : 0;
	}
}

#define NAME_OF(id, name, power, running) [STATE_##id] = name,
static const char *const states[] = { "?", STATE_ROWS(NAME_OF) };

static int watch(const char *machine)
{
	const struct shm_status *s;
	struct shm_snapshot n;

	if (shm_status_open(&s, machine))
		return -1;
	for (;; usleep(TURN_MS * 1000))
		if (shm_snapshot(s, &n))
			printf("%llu %s %u %d %.6f %.6f %.6f %.6f %d %d %d\n",
			       (unsigned long long)n.cycle, states[n.state],
			       n.fault, n.loaded, n.place_mm, n.far_mm,
			       n.length_mm, n.feed_mm_s, n.pos[0], n.pos[1],
			       n.pos[2]);
}

int main(int argc, char **argv)
{
	int ret = -1;

	setvbuf(stdout, NULL, _IOLBF, 0);
	if (argc == 2 && !strcmp(argv[1], "reseed"))
		ret = reseed();
	else if (argc == 3 && !strcmp(argv[1], "plc"))
		ret = plc(argv[2]);
	else if (argc == 3 && !strcmp(argv[1], "watch"))
		ret = watch(argv[2]);
	if (ret)
		perror("torture-help");
	return ret ? 1 : 0;
}
