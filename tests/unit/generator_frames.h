/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_frames.h - a generator on CAN before axes that do nothing, and the
 * frames that it is sent
 */
#ifndef GENERATOR_FRAMES_H
#define GENERATOR_FRAMES_H

#include "config_help.h"

#include "generator_own.h"

#include <linux/can.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct rig {
	struct machine_config c;
	struct io_machine m;
	struct io_inputs in;
	struct io_outputs out;
	int fd;
	struct can_frame usual, own;	/* the last ones */
	uint32_t frames;
};

static const char frames_machine[] =
	"[machine]\nbackend = null\nperiod_us = 1000\n"
	"[generator]\ninterface = can\ncan_id = 1009\n"
	"ignition_v = can 1010 byte 0 bits 12 scale 0.25\n"
	"servo_v = can 1010 byte 2 scale 0.1\n"
	"iso = can 1010 byte 1 bit 7\nsense = can 1010 byte 1 bit 6\n"
	"silent_ms = 20\nconfirm_s = 0.05\n";

static const char frames_tells[] =
	"told_peak_a = can 1011 byte 0 bits 8 scale 0.5\n"
	"told_polarity = can 1011 byte 1 bit 0\n";

static inline void make(struct rig *r, const char *more)
{
	struct interp_diag d;
	char text[1024];
	int fd[2];

	memset(r, 0, sizeof(*r));
	snprintf(text, sizeof(text), "%s%s", frames_machine, more);
	assert_int_equal(read_text(text, &r->c, &d), 0);
	assert_int_equal(io_null_open(&r->m, &r->c, &d), 0);
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    fd), 0);
	assert_non_null(generator_attach(&r->m, &r->c, fd[0]));
	r->fd = fd[1];
	io_pulse_own(&r->out);
}

static inline void take_frames(struct rig *r)
{
	struct can_frame f;

	while (read(r->fd, &f, sizeof(f)) == sizeof(f)) {
		*(f.can_id == 1009 ? &r->usual : &r->own) = f;
		r->frames++;
	}
}

static inline void frames_close(struct rig *r)
{
	r->m.close(r->m.self);
	take_frames(r);
	assert_int_equal(r->usual.data[0], 0);
	close(r->fd);
}

static inline void tell(struct rig *r, uint8_t halves, bool negative)
{
	struct can_frame f = { .can_id = 1011, .can_dlc = 2 };

	f.data[0] = halves;
	f.data[1] = negative;
	assert_int_equal(write(r->fd, &f, sizeof(f)), sizeof(f));
}

static inline void period(struct rig *r)
{
	r->m.read(r->m.self, &r->in);
	r->m.write(r->m.self, &r->out);
	r->out.reset = false;
	take_frames(r);
}

static inline void ask(struct rig *r, double peak_a)
{
	r->out.pulse[INTERP_TECH_PEAK_A] = peak_a;
	r->out.asked++;
}

static inline bool log_has(struct rig *r, const char *text)
{
	char line[160];
	bool any = false;

	while (r->m.note(r->m.self, line, sizeof(line)))
		any = any || strstr(line, text);
	return any;
}

#endif /* GENERATOR_FRAMES_H */
