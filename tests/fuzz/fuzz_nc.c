/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_nc.c - read any bytes with the NC reader
 *
 * If the text is accepted, it must be a sound program.  If it is refused, the
 * refusal must have a place inside the text, and words.
 */
#include "interp/nc.h"
#include "fuzz_help.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	/* Small travel, for point-by-point arcs are walked once when built. */
	const struct interp_machine m = fuzz_machine(5);
	const struct interp_wire wire = {
		.guides = (int)(size / 2 % INTERP_NGUIDES),
		.z_lower_mm = -20, .z_upper_mm = 80, .z_second_mm = 40,
		.angle_max_deg = 45, .corner_angle_deg = size % 5 ? 180 : 30,
		.corner_feed_percent = 50, .corner_before_mm = 0.2,
		.corner_dwell_s = 0.1,
	};
	const struct interp_nc_options o = {
		.wire = size % 3 ? &wire : NULL, .offset_mm = { [1] = 0.11 },
		.tech = size % 7 ? fuzz_tech() : NULL,
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
	struct interp_program p;
	struct interp_build *b;
	int rc;

	b = interp_build_create(&bo);
	assert(b);
	rc = interp_nc_compile(&(struct interp_text) {
		.at = (const char *)data, .bytes = size },
		&o, b, &result, &diag);
	if (rc)
		fuzz_check_refusal(rc, &diag, size);
	else
		free(fuzz_lay_out(b, result.lines, &p));
	interp_build_destroy(b);
	return 0;
}
