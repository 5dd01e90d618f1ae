/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can_socket.c - raw SocketCAN
 */
#include "can_socket.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#define HEAR_MAX	32

static int interface_up(int fd, const char *name)
{
	struct ifreq r = { .ifr_flags = 0 };

	strncpy(r.ifr_name, name, sizeof(r.ifr_name) - 1);
	if (ioctl(fd, SIOCGIFFLAGS, &r) < 0)
		return -errno;
	return r.ifr_flags & IFF_UP ? 0 : -ENETDOWN;
}

static int hear_only(int fd, const struct can_hear *hear, size_t n)
{
	const can_err_mask_t errors = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED |
				      CAN_ERR_CRTL;
	struct can_filter f[HEAR_MAX];

	if (n > HEAR_MAX)
		return -E2BIG;
	for (size_t i = 0; i < n; i++)
		f[i] = (struct can_filter) {
			.can_id = hear[i].value,
			.can_mask = hear[i].mask | CAN_EFF_FLAG | CAN_RTR_FLAG,
		};
	if (setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, f,
		       (socklen_t)(n * sizeof(f[0]))) < 0 ||
	    setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors,
		       sizeof(errors)) < 0)
		return -errno;
	return 0;
}

static int attach(int fd, const char *interface)
{
	struct sockaddr_can a = { .can_family = AF_CAN };

	a.can_ifindex = (int)if_nametoindex(interface);
	if (a.can_ifindex == 0)
		return -ENODEV;
	return bind(fd, (struct sockaddr *)&a, sizeof(a)) < 0 ? -errno : 0;
}

int can_socket_open(const char *interface, const struct can_hear *hear,
		    size_t n)
{
	const int fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC,
			      CAN_RAW);
	int err;

	if (fd < 0)
		return -errno;
	err = hear_only(fd, hear, n);
	if (err == 0)
		err = attach(fd, interface);
	if (err == 0)
		err = interface_up(fd, interface);
	if (err == 0)
		return fd;
	close(fd);
	return err;
}

/* Half of what the kernel counts for a waiting frame: it doubles SO_SNDBUF. */
#define FRAME_ROOM	512

void can_socket_queue(int fd, size_t frames)
{
	const int bytes = (int)(frames * FRAME_ROOM);

	setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes));
}

static enum can_got take_error(const struct can_frame *f)
{
	const uint8_t control = f->can_id & CAN_ERR_CRTL ? f->data[1] : 0;

	if (f->can_id & CAN_ERR_BUSOFF)
		return CAN_BUS_OFF;
	if (f->can_id & CAN_ERR_RESTARTED)
		return CAN_RESTARTED;
	if (control & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE))
		return CAN_PASSIVE;
	if (control & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING))
		return CAN_WARNING;
	if (control & CAN_ERR_CRTL_RX_OVERFLOW)
		return CAN_RX_OVERFLOW;
	if (control & CAN_ERR_CRTL_TX_OVERFLOW)
		return CAN_TX_OVERFLOW;
	return control & CAN_ERR_CRTL_ACTIVE ? CAN_ACTIVE : CAN_ODD;
}

static enum can_got take(const struct can_frame *f, struct can_msg *ret)
{
	if (f->can_id & CAN_ERR_FLAG)
		return take_error(f);
	if (f->can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG) || f->can_dlc > 8)
		return CAN_ODD;
	ret->id = (uint16_t)(f->can_id & CAN_SFF_MASK);
	ret->len = f->can_dlc;
	memcpy(ret->data, f->data, sizeof(ret->data));
	return CAN_FRAME;
}

enum can_got can_socket_receive(int fd, struct can_msg *ret)
{
	struct can_frame f;
	const ssize_t n = read(fd, &f, sizeof(f));

	if (n == (ssize_t)sizeof(f))
		return take(&f, ret);
	if (n >= 0)
		return CAN_ODD;
	return errno == EAGAIN || errno == EINTR ? CAN_NOTHING : CAN_DOWN;
}

int can_socket_send(int fd, const struct can_msg *m)
{
	struct can_frame f = { .can_id = m->id, .can_dlc = m->len };

	memcpy(f.data, m->data, sizeof(f.data));
	if (write(fd, &f, sizeof(f)) == (ssize_t)sizeof(f))
		return 0;
	return errno == EAGAIN ? -ENOBUFS : -errno;
}
