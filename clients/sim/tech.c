/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tech.c - the technology table: read, printed, documented
 */
#include "sim.h"

#include "interp/tech_table.h"

#include <errno.h>
#include <string.h>
#include <sysexits.h>

int edmsim_tech_load(struct config_tech *ret, const struct sim_options *o,
		  const struct machine_config *c)
{
	const int err = config_tech_load(ret, c, o->tech);

	if (err == 0)
		return 0;
	if (err == -EINVAL && ret->diag.line) {
		interp_diag_tell(&ret->diag, ret->path);
		return EX_CONFIG;
	}
	fprintf(stderr, "edmsim: %s: %s; a technology table\n", ret->path,
		strerror(-err));
	return err == -ENOMEM ? EX_OSERR : EX_NOINPUT;
}

static int put(void *arg, const char *text, size_t bytes)
{
	return fwrite(text, 1, bytes, arg) == bytes ? 0 : -EIO;
}

int edmsim_tech_print(const struct config_tech *t)
{
	const struct interp_sink to = { put, stdout };

	if (!t->table) {
		fprintf(stderr, "edmsim: no technology table; --tech FILE, or "
			"[tech] table in the machine file\n");
		return EX_USAGE;
	}
	/* standard_guard() says why it cannot be written. */
	return interp_tech_write(t->table, &to) ? EX_IOERR : 0;
}

void edmsim_tech_document(void)
{
	const struct interp_sink to = { put, stdout };

	interp_tech_document(&to);
}
