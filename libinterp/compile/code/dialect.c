/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dialect.c - pick the dialect of a text, and read it
 */
#include "code/dialect.h"

#include <errno.h>
#include <string.h>
#include <strings.h>

static const struct interp_dialect dialects[] = {
	{ .name = "generic", .nc = &nc_generic },
	{ .name = "robofil", .nc = &nc_robofil },
	{ .name = "skd2", .nc = &nc_skd2 },
	{ .name = "sodick", .nc = &nc_sodick },
	{ .name = "chmer", .nc = &nc_chmer },
	{ .name = "fanuc", .nc = &nc_fanuc },
	{ .name = "agie", .nc = &nc_agie },
	{ .name = "3b", .suffix = ".3b" },
	{ .name = "4b", .suffix = ".4b", .fourb = true },
};

#define NDIALECTS	(sizeof(dialects) / sizeof(dialects[0]))

const struct interp_dialect *interp_dialect_by_name(const char *name)
{
	for (size_t i = 0; i < NDIALECTS; i++) {
		if (strcmp(dialects[i].name, name) == 0)
			return &dialects[i];
	}
	return NULL;
}

const struct interp_dialect *interp_dialect_by_file(const char *path)
{
	const size_t n = strlen(path);

	for (size_t i = 0; i < NDIALECTS; i++) {
		const char *s = dialects[i].suffix;

		if (s && n >= strlen(s) &&
		    strcasecmp(path + n - strlen(s), s) == 0)
			return &dialects[i];
	}
	return &dialects[0];
}

const char *interp_dialect_name(const struct interp_dialect *d)
{
	return d->name;
}

const char *interp_dialect_word(int i)
{
	return i >= 0 && i < (int)NDIALECTS ? dialects[i].name : NULL;
}

static int compile_nc(const struct interp_text *text,
		      const struct interp_nc_options *options,
		      struct interp_build *b, uint32_t *ret_lines,
		      struct interp_diag *diag)
{
	struct interp_nc_options o = *options;
	struct interp_nc_result done = { 0 };
	int err;

	o.dialect = text->dialect;
	err = interp_nc_compile(text->at, text->bytes, &o, b, &done, diag);
	*ret_lines = done.lines;
	return err;
}

static int compile_records(const struct interp_text *text,
			   const struct interp_compile_options *o,
			   struct interp_build *b, uint32_t *ret_lines,
			   struct interp_diag *diag)
{
	struct interp_threeb_options threeb = o->threeb;
	const struct interp_threeb_read read = {
		.machine = o->nc.machine, .options = &threeb,
		.feed_mm_s = o->nc.feed_mm_s, .segs_max = o->nc.segs_max,
	};
	struct interp_threeb_result done = { 0 };
	int err;

	threeb.fourb = text->dialect->fourb;
	err = interp_threeb_compile(text->at, text->bytes, &read, b, &done,
				   diag);
	*ret_lines = done.lines;
	return err;
}

int interp_compile(const struct interp_text *text,
		   const struct interp_compile_options *o,
		   struct interp_build *b, uint32_t *ret_lines,
		   struct interp_diag *diag)
{
	const bool records = text->dialect && !text->dialect->nc;
	int err = records ? compile_records(text, o, b, ret_lines, diag) :
			   compile_nc(text, &o->nc, b, ret_lines, diag);

	if (err == 0)
		err = interp_build_flush(b, diag);
	/* The whole line is at its first column, the whole input at 1:1. */
	if (err == -EINVAL && diag->line == 0)
		diag->line = 1;
	if (err == -EINVAL && diag->column == 0)
		diag->column = 1;
	return err;
}
