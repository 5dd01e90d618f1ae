/* SPDX-License-Identifier: Apache-2.0 */
/* work.c - work that the panel does in a process of its own */
#include "work.h"
#include "child.h"
#include "flat.h"
#include "page_tech.h"

#include "compiling.h"
#include "config.h"
#include "interp/build.h"
#include "shm.h"
#include "standard.h"

#include <errno.h>
#include <jansson.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TEXT_MAX	(64u << 20)

static int put_refusal(const char *where, const struct interp_diag *d)
{
	json_t *o = json_pack("{s:b,s:s,s:i,s:i,s:s,s:s}", "ok", 0, "where",
			      where, "line", (int)d->line, "column",
			      (int)d->column, "found", d->found, "wanted",
			      d->wanted);

	json_dumpf(o, stdout, JSON_COMPACT);
	json_decref(o);
	return 1;
}

static int put_failure(const char *found, const char *wanted)
{
	struct interp_diag d = { .line = 0 };

	interp_diag_say(&d, "%s; %s", found, wanted);
	return put_refusal("panel", &d);
}

static json_t *three(const double v[3])
{
	return json_pack("[f,f,f]", v[0], v[1], v[2]);
}

static void put_head(const struct flat *f, const struct interp_program *p)
{
	json_t *o = json_pack(
		"{s:b,s:i,s:i,s:f,s:f,s:f,s:f,s:b,s:o,s:o,s:o,s:s}",
		"ok", 1, "points", (int)f->n, "lines", (int)p->head->lines,
		"length", p->head->length_mm, "cut", f->cut_mm, "rapid",
		f->rapid_mm, "tolerance", f->tolerance_mm, "upper",
		(int)f->has_upper, "origin", three(f->origin_mm), "min",
		three(f->min_mm), "max", three(f->max_mm), "name",
		p->head->name);
	char *text = json_dumps(o, JSON_COMPACT | JSON_REAL_PRECISION(12));
	const size_t n = text ? strlen(text) : 0;

	fwrite(text, 1, n, stdout);
	for (size_t i = n; (i + 1) % 8; i++)
		putchar(' ');
	putchar('\n');
	free(text);
	json_decref(o);
}

static int put_path(const struct machine_config *c,
		    const struct interp_program *p, double tolerance_mm)
{
	struct flat f;
	int err = flat_make(&f, p, c->wire.guides, tolerance_mm);

	if (err == 0) {
		put_head(&f, p);
		fwrite(f.s_mm, sizeof(*f.s_mm), f.n, stdout);
		fwrite(f.at_mm, 3 * sizeof(*f.at_mm), f.n, stdout);
		fwrite(f.line, sizeof(*f.line), f.n, stdout);
		if (f.has_upper)
			fwrite(f.upper_mm, 2 * sizeof(*f.upper_mm), f.n,
			       stdout);
		fwrite(f.kind, 1, f.n, stdout);
		err = fflush(stdout) ? -EIO : 0;
	}
	flat_fini(&f);
	if (err == 0)
		return 0;
	return put_failure("the path cannot be drawn", strerror(-err));
}

static void read_start(const char *text, double start_mm[INTERP_NAXES])
{
	char *end;

	for (int i = 0; text && i < INTERP_NAXES; i++) {
		const double v = strtod(text, &end);

		if (end == text)
			return;
		start_mm[i] = v;
		text = end + (*end == ',');
	}
}

static int lay_out(const struct machine_config *c, struct interp_build *b,
		   uint32_t lines, const struct work *w)
{
	const struct interp_build_about about = { .lines = lines,
						  .name = w->name };
	struct interp_program p;
	size_t bytes;
	void *block = interp_build_take(b, &about, &bytes);
	int err;

	if (!block)
		return put_failure("the program is too large",
				   "a smaller one, or in parts");
	err = interp_program_map(&p, block, bytes) == 0 ?
	     put_path(c, &p, w->tolerance_mm) : EX_SOFTWARE;
	free(block);
	return err;
}

static int compile(const struct machine_config *c, const struct work *w,
		   const struct interp_text *text)
{
	struct interp_diag d = { .line = 0 };
	struct config_compiling of;
	struct config_tech tech;
	struct interp_build *b = NULL;
	uint32_t lines = 0;
	int err = config_tech_load(&tech, c, NULL), rc = EX_SOFTWARE;

	if (err < 0) {
		rc = err == -EINVAL ? put_refusal(tech.path, &tech.diag) :
		     put_failure("the technology table cannot be read",
				 "a table that [tech] table names");
		config_tech_free(&tech);
		return rc;
	}
	config_compiling(c, &tech, &of);
	read_start(w->start, of.build.start_mm);
	err = config_compiling_set(&of, w->setting, &d);
	b = err ? NULL : interp_build_create(&of.build);
	if (!err)
		err = b ? interp_compile(text, &of.text, b, &lines, &d) :
			  -ENOMEM;
	if (err == -EINVAL)
		rc = put_refusal(w->name, &d);
	else if (err == 0)
		rc = lay_out(c, b, lines, w);
	else
		rc = put_failure("reading it takes more memory than the panel "
				 "allows", "a smaller program");
	interp_build_destroy(b);
	config_tech_free(&tech);
	return rc;
}

static int work_check(const struct machine_config *c, const struct work *w)
{
	struct interp_text text = { .bytes = 0 };
	char *at = child_read(0, TEXT_MAX, &text.bytes);
	struct config_dialect d;
	int err;

	if (!at)
		return put_failure("the text cannot be read",
				   "at most 64 MiB of NC code");
	err = config_dialect_load(&d, c, NULL, w->name);
	text.at = at;
	text.dialect = d.use;
	if (err == -EINVAL)
		err = put_refusal(d.path, &d.diag);
	else
		err = err ? put_failure("the dialect's file cannot be read",
					"a file that [nc] dialect names") :
			    compile(c, w, &text);
	config_dialect_free(&d);
	free(at);
	return err;
}

static int work_path(const struct machine_config *c, const struct work *w)
{
	struct interp_program p;
	const void *block;
	size_t bytes;
	int err;

	if (shm_program_open(&block, &bytes, w->machine,
			     (uint32_t)w->program) < 0)
		return put_failure("the program is not there any more",
				   "the one that is loaded");
	err = interp_program_map(&p, block, bytes) == 0 ?
	     put_path(c, &p, w->tolerance_mm) :
	     put_failure("the program is damaged", "stop; send it again");
	shm_program_unmap(block, bytes);
	return err;
}

static int work_verify(void)
{
	size_t bytes;
	char *text = child_read(0, 1024, &bytes);
	char *password = text ? strchr(text, '\n') : NULL;
	int err = 1;

	if (password) {
		*password++ = '\0';
		if (sodium_init() >= 0 &&
		    crypto_pwhash_str_verify(text, password,
					     strlen(password)) == 0)
			err = 0;
		sodium_memzero(text, bytes);
	}
	free(text);
	return err;
}

int work_run(const struct work *w)
{
	static struct machine_config c;
	struct interp_diag d = { .line = 0 };

	standard_raw();
	if (strcmp(w->what, "verify") == 0)
		return work_verify();
	if (config_read(&c, w->config, &d) < 0)
		return put_refusal(w->config, &d);
	if (strcmp(w->what, "check") == 0)
		return work_check(&c, w);
	if (strcmp(w->what, "tech") == 0)
		return page_tech_put(&c);
	return work_path(&c, w);
}
