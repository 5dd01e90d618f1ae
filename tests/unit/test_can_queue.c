/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_can_queue.c - frames that could not be sent are not kept for later
 *
 * The sockets of the drives and of the PLC are pairs of local sockets here, and
 * the kernel says how much may wait in them.
 */
#include "can402_bus.h"
#include "can_socket.h"
#include "config.h"
#include "plc_link.h"

#include "interp/diag.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

/* The kernel doubles what it is asked for, and a frame takes up to 1 KiB. */
#define FRAME_BYTES	1024

static int pair[2];

int __wrap_can_socket_open(const char *interface, const struct can_hear *hear,
			   size_t n);

/* In the place of the interface's. */
int __wrap_can_socket_open(const char *interface, const struct can_hear *hear,
			   size_t n)
{
	(void)interface;
	(void)hear;
	(void)n;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    pair), 0);
	return pair[0];
}

static int room(void)
{
	int bytes;
	socklen_t size = sizeof(bytes);

	assert_int_equal(getsockopt(pair[0], SOL_SOCKET, SO_SNDBUF, &bytes,
				    &size), 0);
	return bytes;
}

/* An end of a job sends three frames to each drive and four more. */
static void frames_to_drives_wait_only_as_many_as_are_sent_at_once(void **st)
{
	(void)st;
	for (int n = 1; n <= IO_NAXES; n++) {
		struct machine_config c;
		struct interp_diag d;
		struct io_machine m;

		config_defaults(&c);
		c.backend = BACKEND_CAN402;
		c.period_us = 10000;
		strcpy(c.can402.interface, "pair");
		for (int i = 0; i < IO_NAXES; i++)
			c.can402.node[i] = i < n ? 10 + i : 0;
		assert_int_equal(can402_open(&m, &c, &d), 0);
		assert_in_range(room(), FRAME_BYTES, (3 * n + 4) * FRAME_BYTES);
		m.close(m.self);
		close(pair[1]);
	}
}

static void frames_to_a_plc_wait_for_two_periods_at_most(void **st)
{
	struct machine_config c;
	struct interp_diag d;
	struct plc_link l;

	(void)st;
	config_defaults(&c);
	strcpy(c.plc.interface, "pair");
	assert_int_equal(plc_link_open(&l, &c, &d), 0);
	assert_in_range(room(), FRAME_BYTES, 2 * PLC_EMITS * FRAME_BYTES);
	plc_link_close(&l);
	close(pair[1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_to_drives_wait_only_as_many_as_are_sent_at_once),
		cmocka_unit_test(frames_to_a_plc_wait_for_two_periods_at_most),
	};

	return cmocka_run_group_tests_name("io/can_socket", tests, NULL, NULL);
}
