/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What io/plc_link.h promises, over a pair of sockets in place of a bus.
 */
#include "plc_link.h"

#include "config.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/can.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

#define NODE	32

static int refused;		/* so many frames on, one is; 0: none */

int __real_can_socket_send(int fd, const struct can_msg *m);
int __wrap_can_socket_send(int fd, const struct can_msg *m);

int __wrap_can_socket_send(int fd, const struct can_msg *m)
{
	if (refused > 0 && --refused == 0)
		return -ENOBUFS;
	return __real_can_socket_send(fd, m);
}

struct rig {
	struct plc_link l;
	struct io_plc in;
	int bus;			/* the other end */
	uint8_t toggle;
};

static void begin(struct rig *r)
{
	int ends[2];

	*r = (struct rig) { .l.before = 0xff };
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    ends), 0);
	plc_init(&r->l.plc, NODE);
	r->l.plc.alive_cycles = 20;
	r->l.plc.send_cycles = 5;
	r->l.plc.beat_cycles = 50;
	r->l.fd = ends[0];
	r->bus = ends[1];
}

static void end(struct rig *r)
{
	plc_link_close(&r->l);
	close(r->bus);
}

static void put(struct rig *r, uint32_t id, uint8_t len, const uint8_t *data)
{
	struct can_frame f = { .can_id = id, .can_dlc = len };

	memcpy(f.data, data, len <= 8 ? len : 8);
	assert_int_equal(write(r->bus, &f, sizeof(f)), sizeof(f));
}

static void period(struct rig *r)
{
	const struct plc_tell tell = { .state = 2 };
	struct can_frame f;

	plc_link_read(&r->l, &r->in);
	plc_link_write(&r->l, &tell);
	while (read(r->bus, &f, sizeof(f)) > 0)
		;
}

static void request(struct rig *r, uint8_t command, uint8_t locks)
{
	r->toggle ^= PLC_ALIVE;
	put(r, 0x200 + NODE, 8, (const uint8_t[8]) {
		(uint8_t)(command | r->toggle), locks, 0xe8, 3, 12, 0, 60 });
	period(r);
}

static void begin_alive(struct rig *r)
{
	begin(r);
	put(r, 0, 2, (const uint8_t[2]) { 1, NODE });
	request(r, PLC_PERMIT, PLC_LOCKS);
	assert_true(r->in.alive);
}

static void what_it_asks_is_read(void **state)
{
	struct rig r;

	(void)state;
	begin_alive(&r);
	assert_true(r.in.present && r.in.permit && r.in.door_closed &&
		    r.in.level_ok && r.in.temperature_ok && r.in.no_fire &&
		    r.in.wire_whole);
	assert_false(r.in.hold || r.in.start || r.in.reset);
	assert_true(r.in.override == 1);
	assert_int_equal(r.in.program, 12);
	assert_int_equal(r.in.mcode_done, 60);
	request(&r, PLC_HOLD, PLC_LOCKS & ~PLC_DOOR);
	assert_true(r.in.hold && !r.in.permit && !r.in.door_closed);
	end(&r);
}

static void start_and_reset_are_edges(void **state)
{
	struct rig r;

	(void)state;
	begin_alive(&r);
	request(&r, PLC_PERMIT | PLC_START | PLC_RESET, PLC_LOCKS);
	assert_true(r.in.start && r.in.reset);
	for (int i = 0; i < 5; i++) {
		request(&r, PLC_PERMIT | PLC_START, PLC_LOCKS);
		assert_false(r.in.start || r.in.reset);
	}
	request(&r, PLC_PERMIT, PLC_LOCKS);
	request(&r, PLC_PERMIT | PLC_START, PLC_LOCKS);
	assert_true(r.in.start);
	end(&r);
}

/* The bit was set when it came, or came back: that is no order to start. */
static void a_plc_that_comes_back_starts_nothing(void **state)
{
	struct rig r;

	(void)state;
	begin(&r);
	put(&r, 0, 2, (const uint8_t[2]) { 1, NODE });
	for (int round = 0; round < 2; round++) {
		for (int i = 0; i < 5; i++) {
			request(&r, PLC_PERMIT | PLC_START, PLC_LOCKS);
			assert_true(r.in.alive);
			assert_false(r.in.start);
		}
		for (int i = 0; i < 30; i++)
			period(&r);
		assert_false(r.in.alive || r.in.permit || r.in.start);
	}
	end(&r);
}

/* Whichever frame the queue does not take: neither a number of values that were
 * not sent, nor an M code of an electrode that was not. */
static void no_frame_goes_out_before_what_it_is_of(void **state)
{
	struct plc_tell tell = { .state = 2 };
	struct can_frame f;
	struct rig r;

	(void)state;
	for (uint16_t n = 1; n < 200; n++) {
		uint32_t value = 0, electrode = 0;

		begin_alive(&r);
		r.l.plc.sets = true;
		tell.pulse.number = tell.pulse.value[0] = n;
		tell.electrode = n;
		tell.mcode = (uint8_t)n;
		refused = n % 16 + 1;
		for (int i = 0; i < 20; i++) {
			plc_link_read(&r.l, &r.in);
			plc_link_write(&r.l, &tell);
			while (read(r.bus, &f, sizeof(f)) > 0) {
				if (f.can_id == 0x680 + NODE)
					value = can_get(f.data, 2);
				if (f.can_id == 0x500 + NODE)
					electrode = can_get(f.data, 2);
				assert_true(f.can_id != 0x500 + NODE ||
					    can_get(f.data + 5, 2) == value);
				assert_true(f.can_id != 0x180 + NODE ||
					    f.data[3] == electrode);
			}
		}
		assert_int_equal(value, n);
		assert_int_equal(refused, 0);
		end(&r);
	}
}

static void a_flood_is_taken_in_portions(void **state)
{
	struct rig r;
	const uint8_t data[8] = { 0 };

	(void)state;
	begin_alive(&r);
	for (int i = 0; i < 100; i++)
		put(&r, 0x200 + NODE, 3, data);
	period(&r);
	assert_int_equal(r.l.plc.malformed, PLC_LINK_FRAMES);
	for (int i = 0; i < 10; i++)
		period(&r);
	assert_int_equal(r.l.plc.malformed, 100);
	end(&r);
}

static void frames_of_another_kind_are_counted_not_believed(void **state)
{
	const uint8_t data[8] = { PLC_PERMIT, PLC_LOCKS };
	struct rig r;

	(void)state;
	begin_alive(&r);
	put(&r, (0x200 + NODE) | CAN_EFF_FLAG, 8, data);
	put(&r, (0x200 + NODE) | CAN_RTR_FLAG, 8, data);
	put(&r, 0x200 + NODE, 9, data);
	assert_int_equal(write(r.bus, data, 5), 5);
	period(&r);
	assert_int_equal(r.l.plc.malformed, 4);
	assert_true(r.in.alive);
	end(&r);
}

static void what_repeats_is_said_ever_more_rarely(void **state)
{
	struct rig r;
	char note[160];
	const uint8_t data[8] = { 0 };
	int said = 0;

	(void)state;
	begin_alive(&r);
	assert_true(plc_link_note(&r.l, note, sizeof(note)));
	assert_non_null(strstr(note, "is there"));
	assert_false(plc_link_note(&r.l, note, sizeof(note)));
	for (int i = 0; i < 1000; i++) {
		put(&r, 0x200 + NODE, 2, data);
		request(&r, PLC_PERMIT, PLC_LOCKS);
		while (plc_link_note(&r.l, note, sizeof(note))) {
			assert_non_null(strstr(note, "wrong length"));
			said++;
		}
	}
	assert_in_range(said, 5, 11);
	end(&r);
}

static void a_full_queue_is_counted(void **state)
{
	const struct plc_tell tell = { .state = 2 };
	struct rig r;

	(void)state;
	begin_alive(&r);
	for (int i = 0; i < 100000 && r.l.count[PLC_UNSENT] == 0; i++)
		plc_link_write(&r.l, &tell);
	assert_true(r.l.count[PLC_UNSENT] > 0);
	end(&r);
}

static void without_an_interface_there_is_no_plc(void **state)
{
	struct machine_config c;
	struct interp_diag d;
	struct plc_link l;
	struct io_plc in;
	char note[160];

	(void)state;
	config_defaults(&c);
	assert_int_equal(plc_link_open(&l, &c, &d), 0);
	plc_link_read(&l, &in);
	assert_false(in.present);
	plc_link_write(&l, &(struct plc_tell) { .state = 1 });
	assert_false(plc_link_note(&l, note, sizeof(note)));
	plc_link_close(&l);
}

static void an_interface_there_is_not_is_refused_with_a_remedy(void **state)
{
	struct machine_config c;
	struct interp_diag d = { 0 };
	struct plc_link l;

	(void)state;
	config_defaults(&c);
	strcpy(c.plc.interface, "can77");
	assert_true(plc_link_open(&l, &c, &d) < 0);
	assert_non_null(strstr(d.found, "plc.interface can77"));
	assert_true(strlen(d.wanted) > 10);
	plc_link_close(&l);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_it_asks_is_read),
		cmocka_unit_test(start_and_reset_are_edges),
		cmocka_unit_test(a_plc_that_comes_back_starts_nothing),
		cmocka_unit_test(no_frame_goes_out_before_what_it_is_of),
		cmocka_unit_test(a_flood_is_taken_in_portions),
		cmocka_unit_test(frames_of_another_kind_are_counted_not_believed),
		cmocka_unit_test(what_repeats_is_said_ever_more_rarely),
		cmocka_unit_test(a_full_queue_is_counted),
		cmocka_unit_test(without_an_interface_there_is_no_plc),
		cmocka_unit_test(an_interface_there_is_not_is_refused_with_a_remedy),
	};

	return cmocka_run_group_tests_name("io/plc_link", tests, NULL, NULL);
}
