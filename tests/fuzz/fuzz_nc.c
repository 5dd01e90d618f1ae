/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_nc.c - any bytes at all through the NC reader
 *
 * What it takes must be a sound program; what it refuses must be refused with
 * a place inside the text and in words.
 */
#include "interp/nc.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Small travel, for point-by-point arcs are walked once when built. */
static const struct interp_axis_limits limits = {
	.pulse_mm = 0.001, .travel_min_mm = -5, .travel_max_mm = 5,
	.v_max_mm_s = 50, .a_max_mm_s2 = 500, .j_max_mm_s3 = 5000,
};

/* A small table, for conditions, sequences and definitions. */
static const struct interp_tech_table *tech(void)
{
	static const char text[] =
		"condition, servo_v, on_us, allowance_mm\n"
		"C001,20,8,0\nC120,15,40,0.1\nE001,15,-,-\n"
		"sequence Q1 = C120 C001\ninline E = - on_us servo_v\n";
	static struct interp_tech_table *t;
	struct interp_diag d;

	if (!t)
		assert(interp_tech_read(&t, text, sizeof(text) - 1, &d) == 0);
	return t;
}

static void check_program(struct interp_build *b, uint32_t lines)
{
	const struct interp_build_about about = { .lines = lines };
	const size_t bytes = interp_build_bytes(b);
	void *block = malloc(bytes);
	struct interp_program p;

	assert(block);
	interp_build_write(b, &about, block);
	assert(interp_program_map(&p, block, bytes) == 0);
	for (uint32_t i = 0; i < p.head->nsegs; i++) {
		assert(interp_program_seg_ok(&p, i, &p.segs[i]));
		assert(p.segs[i].line <= lines);
	}
	free(block);
}

static void check_refusal(int rc, const struct interp_diag *d, size_t size)
{
	assert(rc == -EINVAL);
	assert(d->line <= size + 1 && d->column <= size + 1);
	assert(d->found[0] && memchr(d->found, 0, sizeof(d->found)));
	assert(d->wanted[0] && memchr(d->wanted, 0, sizeof(d->wanted)));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct interp_machine m = { .present = (1 << INTERP_NAXES) - 1 };
	const struct interp_wire wire = {
		.guides = (int)(size / 2 % INTERP_NGUIDES),
		.z_lower_mm = -20, .z_upper_mm = 80, .z_second_mm = 40,
		.angle_max_deg = 45, .corner_angle_deg = size % 5 ? 180 : 30,
		.corner_feed_percent = 50, .corner_before_mm = 0.2,
		.corner_dwell_s = 0.1,
	};
	const struct interp_nc_options o = {
		.wire = size % 3 ? &wire : NULL, .offset_mm = { [1] = 0.11 },
		.tech = size % 7 ? tech() : NULL,
		.machine = &m, .segs_max = 1000, .executed_max = 10000,
	};
	const struct interp_build_options bo = {
		.machine = &m,
		.strategy = (enum interp_strategy)(size % INTERP_NSTRATEGIES),
		.tolerance_milli = 1500, .fit_mm = size % 4 ? 0 : 0.01,
		.coupling = (enum interp_coupling)(size / INTERP_NSTRATEGIES %
						   INTERP_NCOUPLINGS),
	};
	struct interp_diag diag = { .found = "" };
	struct interp_nc_result result;
	struct interp_build *b;
	int rc;

	for (int i = 0; i < INTERP_NAXES; i++)
		m.axis[i] = limits;
	b = interp_build_create(&bo);
	assert(b);
	rc = interp_nc_compile((const char *)data, size, &o, b, &result, &diag);
	if (rc)
		check_refusal(rc, &diag, size);
	else
		check_program(b, result.lines);
	interp_build_destroy(b);
	return 0;
}
