/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axis-sim - an axis with a motor on step and direction lines, and an encoder
 *
 *	axis-sim TRACE-PIPE STEP DIR PULL-A PULL-B COMMANDS PLACE
 *
 * The kernel's trace, events gpio_value, says what is driven on the lines STEP
 * and DIR.  The pulls of a simulated chip move A and B.  A pulse is two counts.
 * An order through the FIFO COMMANDS is a number: the axis slips back by so
 * many pulses; or "wall COUNTS": from now on it does not come farther than that
 * many counts from where it stands; or "open": nothing is in its way.  The
 * file PLACE has the true place of the axis and what was lost at the wall, in
 * counts.
 */
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNTS_A_PULSE	2
#define LOOK_US		20000		/* many rows in one look */
#define COUNT_US	250		/* 2 mm/s of 0.5 um: no axis moves at
					 * once, and the kernel keeps 16 edges
					 * of a line */

static const char *pull[2], *place_file;
static int level[2], high[2], number[2];	/* encoder; step and dir */
static long place, wall = LONG_MAX, pressed;

static void put(const char *path, const char *text, int flags)
{
	const int fd = open(path, O_WRONLY | flags, 0644);

	if (fd < 0 || write(fd, text, strlen(text)) < 0) {
		perror(path);
		exit(1);
	}
	close(fd);
}

/* A leads in the positive direction. */
static void count(int sign)
{
	const int line = (level[0] == level[1]) == (sign > 0) ? 0 : 1;

	if (sign > 0 && place >= wall) {
		pressed++;
		return;
	}
	level[line] ^= 1;
	put(pull[line], level[line] ? "pull-up" : "pull-down", 0);
	place += sign;
	usleep(COUNT_US);
}

static void move(int sign, long pulses)
{
	char text[64];

	for (long i = 0; i < COUNTS_A_PULSE * pulses; i++)
		count(sign);
	snprintf(text, sizeof(text), "%ld %ld\n", place, pressed);
	put(place_file, text, O_CREAT | O_TRUNC);
}

static void obey(const char *order)
{
	if (strncmp(order, "wall ", 5) == 0)
		wall = place + atol(order + 5);
	else if (strncmp(order, "open", 4) == 0)
		wall = LONG_MAX;
	else
		move(-1, atol(order));
}

static void driven(const char *row)
{
	const char *at = strstr(row, "gpio_value: ");
	int line, value;

	if (!at || sscanf(at, "gpio_value: %d set %d", &line, &value) != 2)
		return;
	if (line == number[0] && value && !high[0])
		move(high[1] ? 1 : -1, 1);
	for (int i = 0; i < 2; i++)
		if (line == number[i])
			high[i] = value;
}

int main(int argc, char **argv)
{
	char text[65536];
	struct pollfd p[2];
	size_t n = 0;

	if (argc != 8)
		return 2;
	p[0].fd = open(argv[1], O_RDONLY | O_NONBLOCK);
	p[1].fd = open(argv[6], O_RDWR | O_NONBLOCK);
	p[0].events = p[1].events = POLLIN;
	number[0] = atoi(argv[2]);
	number[1] = atoi(argv[3]);
	pull[0] = argv[4];
	pull[1] = argv[5];
	place_file = argv[7];
	while (poll(p, 2, -1) >= 0) {
		char order[64], *line = text, *end;
		ssize_t got = read(p[1].fd, order, sizeof(order) - 1);

		if (got > 0) {
			order[got] = '\0';
			obey(order);
		}
		usleep(LOOK_US);
		got = read(p[0].fd, text + n, sizeof(text) - 1 - n);
		n += got > 0 ? (size_t)got : 0;
		text[n] = '\0';
		for (; (end = strchr(line, '\n')); line = end + 1) {
			*end = '\0';
			driven(line);
		}
		n = strlen(line);
		memmove(text, line, n + 1);
	}
	return 1;
}
