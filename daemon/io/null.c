/* SPDX-License-Identifier: Apache-2.0 */
/*
 * null.c - no machine: axes follow at once, there is no gap
 *
 * For dry runs, and the template for the next backend: open fills the struct,
 * read and write touch nothing but self, close gives it back.
 */
#include "io.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct null {
	int32_t at[IO_NAXES];		/* pulses, as last written */
};

static void null_read(void *self, struct io_inputs *in)
{
	const struct null *n = self;

	*in = (struct io_inputs) { .gap_v = 0, .gap_valid = false };
	memcpy(in->actual, n->at, sizeof(in->actual));
}

static void null_write(void *self, const struct io_outputs *out)
{
	struct null *n = self;

	memcpy(n->at, out->target, sizeof(n->at));
}

static void null_close(void *self)
{
	free(self);
}

int io_null_open(struct io_machine *m, const struct machine_config *c,
		 struct interp_diag *diag)
{
	struct null *n = calloc(1, sizeof(*n));

	(void)c;
	(void)diag;
	if (!n)
		return -ENOMEM;
	*m = (struct io_machine) {
		.name = "null",
		.self = n,
		.read = null_read,
		.write = null_write,
		.close = null_close,
		.stays = true,
	};
	return 0;
}
