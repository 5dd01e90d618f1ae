/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_macro.c - read any bytes with variables, expressions and jumps
 *
 * The first byte chooses the macros of Fanuc or of LinuxCNC.  Every loop must
 * end.
 */
#include "interp/compile.h"
#include "fuzz_help.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct interp_machine m = fuzz_machine(5);
	const struct interp_build_options bo = { .machine = &m };
	const struct interp_compile_options o = {
		.nc = { .machine = &m, .segs_max = 200, .executed_max = 2000 },
	};
	struct interp_text text = { (const char *)data, size, NULL };
	struct interp_build *b = interp_build_create(&bo);
	struct interp_diag diag = { .found = "" };
	struct interp_program p;
	uint32_t lines = 0;
	int err;

	assert(b);
	text.dialect = interp_dialect_by_name(size && data[0] % 2 ?
					      "linuxcnc" : "fanuc-sinker");
	err = interp_compile(&text, &o, b, &lines, &diag);
	if (err)
		fuzz_check_refusal(err, &diag, size);
	else
		free(fuzz_lay_out(b, lines, &p));
	interp_build_destroy(b);
	return 0;
}
