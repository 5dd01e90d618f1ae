/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_dialect.c - read any bytes as the file of a dialect
 *
 * If the file is refused, the refusal must have a place inside the text, and
 * words.  If it is accepted, it must be able to read a program.
 */
#include "interp/compile.h"
#include "fuzz_help.h"

static const char program[] = "O1\nT1 M6 G43 H1\nG90 G1 F5 X1 Y1. (x)\n"
	"G4 P1\nG2 X2 Y2 I1 J0 C120 E1\nQ1 K2 L3; x\nM98 P2\nM2\nO2\nM99\n";

static void read_program(const struct interp_dialect *d)
{
	const struct interp_machine m = fuzz_machine(5);
	const struct interp_build_options bo = { .machine = &m };
	const struct interp_compile_options o = {
		.nc = { .machine = &m, .segs_max = 100, .executed_max = 100 },
	};
	const struct interp_text text = { program, sizeof(program) - 1, d };
	struct interp_build *b = interp_build_create(&bo);
	struct interp_diag diag = { .found = "" };
	uint32_t lines;
	int rc;

	assert(b);
	rc = interp_compile(&text, &o, b, &lines, &diag);
	if (rc)
		fuzz_check_refusal(rc, &diag, sizeof(program));
	interp_build_destroy(b);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct interp_text text = { (const char *)data, size, NULL };
	struct interp_diag diag = { .found = "" };
	struct interp_dialect *d;
	const int rc = interp_dialect_read(&d, "fuzz", &text, &diag);

	if (rc) {
		fuzz_check_refusal(rc, &diag, size);
		return 0;
	}
	read_program(d);
	interp_dialect_free(d);
	return 0;
}
