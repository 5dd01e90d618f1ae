/* SPDX-License-Identifier: Apache-2.0 */
/* files.c - the files that a job depends on */
#include "files.h"

#include "compiling.h"

#include <stdio.h>
#include <string.h>

static void add_file(crypto_hash_sha256_state *h, const char *path)
{
	unsigned char part[4096];
	FILE *f = fopen(path, "re");
	size_t n;

	if (!f) {
		crypto_hash_sha256_update(h, (const uint8_t *)path,
					  strlen(path));
		return;
	}
	while ((n = fread(part, 1, sizeof(part), f)) > 0)
		crypto_hash_sha256_update(h, part, n);
	fclose(f);
}

/* @name: as the machine file has it. */
static void add_named(const struct jobs *j, crypto_hash_sha256_state *h,
		      const char *name)
{
	char path[sizeof(j->config->folder) + 256];

	if (strcmp(name, "none") == 0)
		return;
	snprintf(path, sizeof(path), "%s%s",
		 name[0] == '/' ? "" : j->config->folder, name);
	add_file(h, path);
}

void files_read(struct jobs *j, const char *path)
{
	crypto_hash_sha256_init(&j->files);
	add_file(&j->files, path);
	for (int i = 0; i < INTERP_NAXES; i++)
		add_named(j, &j->files, j->config->pitch_map[i]);
	add_named(j, &j->files, j->config->maps);
	files_hash(j, j->config_hash);
}

void files_hash(const struct jobs *j, uint8_t ret[32])
{
	crypto_hash_sha256_state h = j->files;

	if (config_dialect_is_file(j->config->dialect))
		add_named(j, &h, j->config->dialect);
	crypto_hash_sha256_final(&h, ret);
}
