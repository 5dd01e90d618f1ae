/* SPDX-License-Identifier: Apache-2.0 */
/*
 * support_secrets.c - what must not leave the machine
 *
 * No file with a secret goes into the archive.  But a person may have written a
 * password into the machine file, and a program may have printed what it should
 * not.  So every text is searched for each word of the files that hold secrets,
 * as far as this user can read them; the machine file and the logs also for
 * lines that name a password.
 */
#include "support.h"

#include <ctype.h>
#include <glob.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORD_MIN	16		/* shorter ones are no secrets */

static void learn_file(struct support *s, const char *path)
{
	FILE *f = fopen(path, "re");
	char word[512];

	while (f && fscanf(f, "%511s", word) == 1)
		if (strlen(word) >= WORD_MIN)
			support_add(&s->secrets, word, strlen(word) + 1);
	if (f)
		fclose(f);
}

static void learn_files(struct support *s, const char *pattern)
{
	glob_t g;

	if (glob(pattern, 0, NULL, &g) != 0)
		return;
	for (size_t i = 0; i < g.gl_pathc; i++)
		learn_file(s, g.gl_pathv[i]);
	globfree(&g);
}

/* In the machine file: KEY = FILE. */
static void learn_named(struct support *s, const char *machine_file,
			const char *key)
{
	char line[1024], path[1024], format[32];
	FILE *f = fopen(machine_file, "re");

	snprintf(format, sizeof(format), " %s = %%1023s", key);
	while (f && fgets(line, sizeof(line), f))
		if (sscanf(line, format, path) == 1)
			learn_file(s, path);
	if (f)
		fclose(f);
}

void support_learn(struct support *s)
{
	static const char *const suffixes[] = { "key", "machine-key" };
	const char *file = ctl_text_of(s->store, "machine_file");
	const char *named = s->ctl->key ? s->ctl->key : getenv("EDM_KEY");
	char pattern[1200], folder[1024];

	if (named)
		learn_file(s, named);
	snprintf(folder, sizeof(folder), "%s", ctl_text_of(s->store, "path"));
	dirname(folder);
	for (int i = 0; i < 2; i++) {
		snprintf(pattern, sizeof(pattern), "%s/*.%s", folder,
			 suffixes[i]);
		learn_files(s, pattern);
		snprintf(pattern, sizeof(pattern), "/var/lib/edmd/*.%s",
			 suffixes[i]);
		learn_files(s, pattern);
	}
	learn_files(s, "/dev/shm/edmd*.key");
	learn_files(s, "/dev/shm/edmd*/*.key");
	learn_files(s, "/etc/edmd/panel.users");
	learn_named(s, file, "users");
	learn_named(s, file, "key");
}

static void blot(char *at, size_t n)
{
	memset(at, 'x', n);
}

static void blot_word(struct support_text *t, const char *word)
{
	const size_t n = strlen(word);
	char *at = t->at;

	while ((at = memmem(at, t->bytes - (size_t)(at - t->at), word, n))) {
		blot(at, n);
		at += n;
	}
}

static bool names_a_secret(const char *line, size_t n)
{
	static const char *const words[] = {
		"password", "passwd", "passwort", "secret", "token",
	};
	char low[256];

	n = n < sizeof(low) - 1 ? n : sizeof(low) - 1;
	for (size_t i = 0; i < n; i++)
		low[i] = (char)tolower((unsigned char)line[i]);
	low[n] = '\0';
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (strstr(low, words[i]))
			return true;
	return false;
}

/* All of such a line that stands behind its first `=` or `:`. */
static void blot_line(char *line, size_t n)
{
	size_t from = 0;

	while (from < n && line[from] != '=' && line[from] != ':')
		from++;
	if (from < n)
		blot(line + from + 1, n - from - 1);
	else
		blot(line, n);
}

void support_scrub(const struct support *s, struct support_text *t)
{
	for (size_t i = 0; i < s->secrets.bytes && t->at;
	     i += strlen(s->secrets.at + i) + 1)
		blot_word(t, s->secrets.at + i);
}

void support_scrub_lines(struct support_text *t)
{
	char *at = t->at;

	while (at && at < t->at + t->bytes) {
		char *end = memchr(at, '\n', t->bytes - (size_t)(at - t->at));
		const size_t n = end ? (size_t)(end - at) :
				 t->bytes - (size_t)(at - t->at);

		if (names_a_secret(at, n))
			blot_line(at, n);
		at += n + 1;
	}
}
