/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tech.c - the file of the technology table, and the values that its conditions
 * replace
 */
#include "compiling.h"
#include "process.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define TABLE_BYTES_MAX	(4u << 20)

void config_tech_base(const struct machine_config *c, struct interp_tech *ret)
{
	process_base(ret, &c->gap, &c->jump);
}

static void path_of(struct config_tech *t, const struct machine_config *c,
		    const char *path)
{
	if (path)
		snprintf(t->path, sizeof(t->path), "%s", path);
	else
		snprintf(t->path, sizeof(t->path), "%s%s",
			 c->tech_table[0] == '/' ? "" : c->folder,
			 c->tech_table);
}

static int slurp(struct config_tech *t)
{
	FILE *f = fopen(t->path, "re");
	int err = 0;

	if (!f)
		return -errno;
	t->text = malloc(TABLE_BYTES_MAX + 1);
	if (t->text)
		t->bytes = fread(t->text, 1, TABLE_BYTES_MAX + 1, f);
	if (!t->text)
		err = -ENOMEM;
	else if (ferror(f))
		err = errno ? -errno : -EIO;
	else if (t->bytes > TABLE_BYTES_MAX)
		err = -EFBIG;
	fclose(f);
	return err;
}

static bool is_enc(const char *path)
{
	const size_t n = strlen(path);

	return n >= 4 && strcasecmp(path + n - 4, ".enc") == 0;
}

/* What would not reach the generator. */
static int check_delivery(struct config_tech *t, const struct machine_config *c)
{
	char name[16];

	for (uint32_t i = 0; i < t->table->nrows; i++) {
		const struct interp_tech_row *r = &t->table->row[i];

		interp_tech_name(r->letter, r->number, name, sizeof(name));
		t->diag.line = r->line;
		t->diag.column = 1;
		if (config_generator_takes(c, &r->tech, name, &t->diag) < 0)
			return -EINVAL;
	}
	return 0;
}

/* The same checks as those of [jump] in check.c. */
static int check_jumps(struct config_tech *t, const struct machine_config *c)
{
	char name[16];

	for (uint32_t i = 0; i < t->table->nrows; i++) {
		const struct interp_tech_row *r = &t->table->row[i];
		const double mm = r->tech.v[INTERP_TECH_JUMP_MM];

		if (config_jump_fits(c, mm, t->diag.wanted,
				     sizeof(t->diag.wanted)))
			continue;
		interp_tech_name(r->letter, r->number, name, sizeof(name));
		t->diag.line = r->line;
		t->diag.column = 1;
		snprintf(t->diag.found, sizeof(t->diag.found),
			 "%s: jump_mm %g mm is higher than any axis travels",
			 name, mm);
		return -EINVAL;
	}
	return 0;
}

int config_tech_load(struct config_tech *ret, const struct machine_config *c,
		     const char *path)
{
	struct interp_tech base;
	int err;

	*ret = (struct config_tech) { .table = NULL };
	if (!path && strcmp(c->tech_table, "none") == 0)
		return 0;
	path_of(ret, c, path);
	err = slurp(ret);
	if (err)
		return err;
	err = (is_enc(ret->path) ? interp_tech_read_enc : interp_tech_read)(
		&ret->table, ret->text, ret->bytes, &ret->diag);
	if (err)
		return err;
	config_tech_base(c, &base);
	err = interp_tech_table_fits(ret->table, &base, &ret->diag);
	if (err == 0)
		err = check_delivery(ret, c);
	return err ? err : check_jumps(ret, c);
}

void config_tech_why(const struct config_tech *t, int err, char *buf,
		     size_t size)
{
	if (err == -EINVAL)
		interp_diag_full(&t->diag, t->path, buf, size);
	else
		snprintf(buf, size, "[tech] table %s: %s", t->path,
			 strerror(-err));
}

void config_tech_free(struct config_tech *t)
{
	interp_tech_table_destroy(t->table);
	free(t->text);
	*t = (struct config_tech) { .table = NULL };
}
