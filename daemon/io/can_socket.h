/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can_socket.h - frames to and from a CAN interface of the kernel
 *
 * It uses raw SocketCAN and never waits. What the interface reports about
 * itself (bus off, down) is returned as a state and not as a frame.
 *
 * Threads: open and close are startup only; send and receive are RT-safe and
 * make one system call each.
 */
#ifndef CAN_SOCKET_H
#define CAN_SOCKET_H

#include "can_msg.h"

#include <stddef.h>

enum can_got {
	CAN_NOTHING,
	CAN_FRAME,
	CAN_ODD,			/* not a classic frame of 11 bits */
	CAN_BUS_OFF,			/* the controller left the bus, */
	CAN_RESTARTED,			/* ... and has come back to it */
	CAN_WARNING,			/* it counts many errors, */
	CAN_PASSIVE,			/* ... and more: bus off is next; */
	CAN_ACTIVE,			/* few again */
	CAN_RX_OVERFLOW,		/* it lost frames that came, */
	CAN_TX_OVERFLOW,		/* ... or that were sent */
	CAN_DOWN,			/* the interface is down or gone */
};

/* Identifiers to hear: those with id & mask == value & mask. */
struct can_hear {
	uint16_t value, mask;
};

/**
 * can_socket_open() - receive @n kinds of identifiers on @interface.
 *
 * Return: a descriptor; -ENODEV: there is no such interface; -ENETDOWN: it is
 * down; -EAFNOSUPPORT: the kernel has no CAN; -EPERM; or another -errno.
 */
int can_socket_open(const char *interface, const struct can_hear *hear,
		    size_t n);

/**
 * can_socket_queue() - let no more than about @frames wait to be sent.
 *
 * On a bus that takes no frames they would wait, and be out of date when they
 * are sent at last. The smallest queue of the kernel is about five frames.
 * Startup only.
 */
void can_socket_queue(int fd, size_t frames);

/** can_socket_receive() - the next frame, if one has come. */
enum can_got can_socket_receive(int fd, struct can_msg *ret);

/**
 * can_socket_send() - Return: 0; -ENOBUFS the queue is full and the frame is
 * lost; -ENETDOWN.
 */
int can_socket_send(int fd, const struct can_msg *m);

#endif /* CAN_SOCKET_H */
