/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_compile.h - compile a random text, with a table of conditions and the
 * planes of a wire
 */
#ifndef RANDOM_COMPILE_H
#define RANDOM_COMPILE_H

#include "random_program.h"

#include "interp/compile.h"

static inline const struct interp_tech_table *random_table(void)
{
	static const char text[] =
		"condition, servo_v, on_us, allowance_mm\n"
		"C001,40,8,0\nC120,35,40,0.01\nE001,45,-,-\n"
		"sequence Q1 = C120 C001\ninline E = - on_us servo_v\n";
	static struct interp_tech_table *t;
	struct interp_diag d;

	if (!t)
		assert_int_equal(interp_tech_read(&t, text, sizeof(text) - 1,
						  &d), 0);
	return t;
}

/* Return: NULL if it was not taken. */
static inline struct interp_build *random_build(const struct script *text,
		const char *dialect, const struct interp_build_options *bo)
{
	static const struct interp_wire wire = {
		.guides = INTERP_GUIDES_ABSOLUTE, .z_lower_mm = -20,
		.z_upper_mm = 80, .z_second_mm = 40, .angle_max_deg = 45,
		.corner_angle_deg = 30, .corner_feed_percent = 50,
		.corner_before_mm = 0.2,
	};
	const bool generic = strcmp(dialect, "generic") == 0;
	const struct interp_compile_options o = {
		.nc = {
			.machine = bo->machine, .wire = generic ? NULL : &wire,
			.tech = random_table(), .feed_mm_s = 20,
			.offset_mm = { [1] = 0.05 }, .executed_max = 100000,
		},
		.threeb.offset_um = 5,
	};
	const struct interp_text t = {
		text->at, (size_t)text->n, interp_dialect_by_name(dialect),
	};
	struct interp_build *b = interp_build_create(bo);
	struct interp_diag d = { 0 };
	uint32_t lines;

	assert_non_null(b);
	if (interp_compile(&t, &o, b, &lines, &d) != 0) {
		interp_build_destroy(b);
		return NULL;
	}
	return b;
}

/* Return: was it taken? */
static inline bool random_compile(const struct script *text,
				  const char *dialect,
				  const struct interp_build_options *bo,
				  struct made *ret)
{
	struct interp_build *b = random_build(text, dialect, bo);

	if (b)
		*ret = finish(b);
	return b != NULL;
}

#endif /* RANDOM_COMPILE_H */
