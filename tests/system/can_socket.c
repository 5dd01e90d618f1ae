/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can_socket.c - a library to preload: raw CAN sockets where the kernel has
 * none
 *
 * A raw CAN socket becomes a connection to $EDM_CAN, where can_bus.py hands
 * each frame to all others.  What it hears is sent first.  There is one bus,
 * whatever the interface is called.  Errors of a bus, and what a full bus does,
 * are for tests/vm.
 *
 * The bus is never late.  Who sends SYNC waits, before the next one, until all
 * that heard the last have read on until nothing was left: they have answered.
 * On a busy host the bus is slow, and nobody on it misses anything.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#define NFDS	256

#define SYNC	0x080

static struct hears {
	struct can_filter filter[32];
	size_t bytes;
	int synced;			/* it has read a SYNC, and not all
					 * that came with it */
	int sends;			/* it is on the bus */
} hears[NFDS];

static int pace = -1;			/* the bus says here that all have
					 * answered */

int socket(int domain, int type, int protocol)
{
	if (domain != PF_CAN)
		return (int)syscall(SYS_socket, domain, type, protocol);
	type = SOCK_SEQPACKET | (type & (SOCK_NONBLOCK | SOCK_CLOEXEC));
	return (int)syscall(SYS_socket, AF_UNIX, type, 0);
}

int setsockopt(int fd, int level, int name, const void *value, socklen_t bytes)
{
	if (level != SOL_CAN_RAW)
		return (int)syscall(SYS_setsockopt, fd, level, name, value,
				    bytes);
	if (name == CAN_RAW_FILTER && fd < NFDS &&
	    bytes <= sizeof(hears[0].filter)) {
		memcpy(hears[fd].filter, value, bytes);
		hears[fd].bytes = bytes;
	}
	return 0;
}

unsigned int if_nametoindex(const char *name)
{
	(void)name;
	return 1;
}

int ioctl(int fd, unsigned long what, ...)
{
	va_list more;
	void *arg;

	va_start(more, what);
	arg = va_arg(more, void *);
	va_end(more);
	if (what == SIOCGIFFLAGS) {
		((struct ifreq *)arg)->ifr_flags = IFF_UP;
		return 0;
	}
	if (what == SIOCGIFINDEX) {
		((struct ifreq *)arg)->ifr_ifindex = 1;
		return 0;
	}
	return (int)syscall(SYS_ioctl, fd, what, arg);
}

static int join(int fd, const void *first, size_t bytes)
{
	struct sockaddr_un bus = { .sun_family = AF_UNIX };

	strncpy(bus.sun_path, getenv("EDM_CAN"), sizeof(bus.sun_path) - 1);
	if (connect(fd, (struct sockaddr *)&bus, sizeof(bus)) < 0)
		return -1;
	return send(fd, first, bytes, 0) < 0;
}

int bind(int fd, const struct sockaddr *to, socklen_t bytes)
{
	static const struct can_filter all;

	if (to->sa_family != AF_CAN)
		return (int)syscall(SYS_bind, fd, to, bytes);
	if (fd >= NFDS)
		return -1;
	hears[fd].sends = 1;
	if (hears[fd].bytes > 0)
		return join(fd, hears[fd].filter, hears[fd].bytes);
	return join(fd, &all, sizeof(all));
}

static void wait_for_all(void)
{
	char all;

	if (pace < 0) {
		pace = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, 0);
		join(pace, "pace", 4);
	}
	(void)!syscall(SYS_read, pace, &all, sizeof(all));
}

/* So edmd sends. */
ssize_t write(int fd, const void *what, size_t bytes)
{
	const struct can_frame *f = what;

	if (fd >= 0 && fd < NFDS && hears[fd].sends && bytes == sizeof(*f) &&
	    f->can_id == SYNC)
		wait_for_all();
	return syscall(SYS_write, fd, what, bytes);
}

/* So the simulated drives hear. */
ssize_t recv(int fd, void *to, size_t bytes, int flags)
{
	const ssize_t n = syscall(SYS_recvfrom, fd, to, bytes, flags, NULL,
				  NULL);
	const struct can_frame *f = to;

	if (fd < 0 || fd >= NFDS || !hears[fd].sends)
		return n;
	if (n == sizeof(*f) && f->can_id == SYNC) {
		hears[fd].synced = 1;
	} else if (n < 0 && hears[fd].synced) {
		const int err = errno;

		hears[fd].synced = 0;
		send(fd, "read", 4, 0);
		errno = err;
	}
	return n;
}

int close(int fd)
{
	if (fd >= 0 && fd < NFDS)
		hears[fd] = (struct hears) { .bytes = 0 };
	return (int)syscall(SYS_close, fd);
}
