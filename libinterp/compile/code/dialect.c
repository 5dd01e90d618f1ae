/* SPDX-License-Identifier: Apache-2.0 */
/* dialect.c - chooses the dialect of a text, and reads the text */
#include "code/dialect.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <threads.h>

#define NDIALECTS_MAX	24

static struct interp_dialect dialects[NDIALECTS_MAX];
static struct nc_dialect tables[NDIALECTS_MAX];
static size_t ndialects;
static once_flag built = ONCE_FLAG_INIT;

/* A test has read the built-in files, so they are correct. */
static void build(void)
{
	struct interp_diag diag;

	for (; nc_dialect_files[ndialects].name; ndialects++) {
		const struct dialect_file *f = &nc_dialect_files[ndialects];
		struct interp_dialect *d = &dialects[ndialects];
		int err;

		assert(ndialects < NDIALECTS_MAX);
		d->nc = &tables[ndialects];
		snprintf(d->name, sizeof(d->name), "%s", f->name);
		err = nc_dialect_read(d, f->text, strlen(f->text), &diag);
		assert(err == 0);
		(void)err;
	}
}

const struct interp_dialect *interp_dialect_base(const char *name)
{
	for (size_t i = 0; i < ndialects; i++) {
		if (strcmp(dialects[i].name, name) == 0 ||
		    strcmp(dialects[i].also, name) == 0)
			return &dialects[i];
	}
	return NULL;
}

const struct interp_dialect *interp_dialect_by_name(const char *name)
{
	call_once(&built, build);
	return name[0] ? interp_dialect_base(name) : NULL;
}

const struct interp_dialect *interp_dialect_by_suffix(const char *path)
{
	const size_t n = strlen(path);

	call_once(&built, build);
	for (size_t i = 0; i < ndialects; i++) {
		const char *s = dialects[i].suffix;

		if (*s && n >= strlen(s) &&
		    strcasecmp(path + n - strlen(s), s) == 0)
			return &dialects[i];
	}
	return NULL;
}

bool interp_dialect_is_nc(const struct interp_dialect *d)
{
	return d->reads == DIALECT_NC;
}

const char *interp_dialect_word(int i)
{
	call_once(&built, build);
	return i >= 0 && i < (int)ndialects ? dialects[i].name : NULL;
}

static int compile_nc(const struct interp_text *text,
		      const struct interp_nc_options *o,
		      struct interp_build *b, uint32_t *ret_lines,
		      struct interp_diag *diag)
{
	struct interp_nc_result done = { 0 };
	const int err = interp_nc_compile(text, o, b, &done, diag);

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
		.machine = o->nc.machine, .wire = o->nc.wire,
		.options = &threeb,
		.feed_mm_s = o->nc.feed_mm_s, .segs_max = o->nc.segs_max,
	};
	struct interp_threeb_result done = { 0 };
	int err;

	threeb.fourb = text->dialect->reads == DIALECT_4B;
	err = interp_threeb_compile(text, &read, b, &done, diag);
	*ret_lines = done.lines;
	return err;
}

struct source {
	const struct interp_text *text;
	const struct interp_compile_options *o;
};

static int compile(const struct source *s, struct interp_build *b,
		   uint32_t *ret_lines, struct interp_diag *diag)
{
	const bool records = s->text->dialect &&
			     s->text->dialect->reads != DIALECT_NC;
	const int err = records ?
		compile_records(s->text, s->o, b, ret_lines, diag) :
		compile_nc(s->text, &s->o->nc, b, ret_lines, diag);

	return err == 0 ? interp_build_flush(b, diag) : err;
}

/* Who listens has heard it already. */
static int compile_again(void *arg, struct interp_build *b,
			 struct interp_diag *diag)
{
	const struct source *s = arg;
	struct interp_compile_options o = *s->o;
	uint32_t lines;

	o.nc.notes = NULL;
	o.nc.refused = NULL;
	return compile(&(struct source) { s->text, &o }, b, &lines, diag);
}

void nc_dialect_place(struct interp_diag *d)
{
	if (d->line == 0)
		d->line = 1;
	if (d->column == 0)
		d->column = 1;
}

int interp_compile(const struct interp_text *text,
		   const struct interp_compile_options *o,
		   struct interp_build *b, uint32_t *ret_lines,
		   struct interp_diag *diag)
{
	struct source s = { text, o };
	int err;

	interp_build_again(b, compile_again, &s);
	err = compile(&s, b, ret_lines, diag);
	if (err == -E2BIG) {
		err = interp_build_refused(b, diag);
		if (o->nc.refused)
			o->nc.refused->say(o->nc.refused->arg, diag);
	}
	interp_build_again(b, NULL, NULL);
	if (err == -EINVAL)
		nc_dialect_place(diag);
	return err;
}
