/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dialect.c - the dialect in which a job is written, and dialect files of users
 */
#include "compiling.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define FILE_BYTES_MAX	(1u << 20)

bool config_dialect_is_file(const char *name)
{
	const size_t n = strlen(name);

	return strchr(name, '/') ||
	       (n > 4 && strcmp(name + n - 4, ".ini") == 0);
}

static int read_file(struct config_dialect *d)
{
	FILE *f = fopen(d->path, "re");
	int err = 0;

	if (!f)
		return -errno;
	d->text = malloc(FILE_BYTES_MAX + 1);
	if (d->text)
		d->bytes = fread(d->text, 1, FILE_BYTES_MAX + 1, f);
	if (!d->text)
		err = -ENOMEM;
	else if (ferror(f))
		err = errno ? -errno : -EIO;
	else if (d->bytes > FILE_BYTES_MAX)
		err = -EFBIG;
	fclose(f);
	if (!err)
		err = interp_dialect_read(&d->own, "of a file",
					  &(struct interp_text) {
						.at = d->text,
						.bytes = d->bytes,
					  }, &d->diag);
	d->use = d->own;
	return err;
}

static int find_name(struct config_dialect *d)
{
	size_t n = 0;

	d->use = interp_dialect_by_name(d->path);
	if (d->use)
		return 0;
	d->diag = (struct interp_diag) { .line = 0 };
	snprintf(d->diag.found, sizeof(d->diag.found), "no dialect");
	for (int i = 0; interp_dialect_word(i); i++)
		n += (size_t)snprintf(d->diag.wanted + n,
				      n < sizeof(d->diag.wanted) ?
				      sizeof(d->diag.wanted) - n : 0, "%s ",
				      interp_dialect_word(i));
	if (n < sizeof(d->diag.wanted))
		snprintf(d->diag.wanted + n, sizeof(d->diag.wanted) - n,
			 "or a file .ini");
	return -EINVAL;
}

int config_dialect_load(struct config_dialect *ret,
			const struct machine_config *c, const char *asked,
			const char *job)
{
	const char *name = asked ? asked : c->dialect;
	const bool beside = !asked && name[0] != '/' &&
			    config_dialect_is_file(name);

	*ret = (struct config_dialect) {
		.use = asked ? NULL : interp_dialect_by_suffix(job),
	};
	snprintf(ret->path, sizeof(ret->path), "%s%s",
		 beside ? c->folder : "", name);
	if (ret->use)
		return 0;
	return config_dialect_is_file(name) ? read_file(ret) : find_name(ret);
}

void config_dialect_free(struct config_dialect *d)
{
	interp_dialect_free(d->own);
	free(d->text);
	d->own = NULL;
	d->text = NULL;
}

void config_dialect_why(const struct config_dialect *d, int err, char *buf,
			size_t size)
{
	if (err != -EINVAL)
		snprintf(buf, size, "dialect %s: %s", d->path, strerror(-err));
	else if (d->diag.line)
		interp_diag_full(&d->diag, d->path, buf, size);
	else
		snprintf(buf, size, "dialect %s: %s; %s", d->path,
			 d->diag.found, d->diag.wanted);
}
