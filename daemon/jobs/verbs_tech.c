/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs_tech.c - the technology table: values changed, saved, and taken back
 *
 * The file that the machine file names is written anew as a whole, and only if
 * what it becomes is a good table.  Each version is in the store.
 */
#include "verbs_tech.h"

#include "act.h"
#include "compiling.h"
#include "jobs.h"
#include "store_tech.h"
#include "store_text.h"
#include "output.h"

#include "interp/tech_table.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

#define WHY_MAX		900
#define TEXT_MAX	60000		/* of a table that fits a message */
#define PART_MAX	20000		/* of a version that is shown, as hex */

static const struct config_tech none;

/* -- The file -------------------------------------------------------------- */

/* Who may read @like may read it: edmsim, the panel.  Its owner stays as far as
 * this service may give files away. */
static int write_all(const char *path, const char *text, const char *like)
{
	FILE *f = fopen(path, "we");
	struct stat was;
	int err;

	if (!f)
		return -errno;
	if (stat(like, &was) == 0) {
		if (fchown(fileno(f), was.st_uid, was.st_gid) < 0 &&
		    fchown(fileno(f), (uid_t)-1, was.st_gid) < 0)
			was.st_mode &= ~(mode_t)(S_ISUID | S_ISGID);
		fchmod(fileno(f), was.st_mode & 07777);
	}
	fputs(text, f);
	fflush(f);
	fsync(fileno(f));
	err = output_close(f);
	if (err < 0)
		unlink(path);
	return err;
}

/* @beside takes the place of @path, also after a power failure. */
static int replace(const char *beside, const char *path)
{
	return rename(beside, path) < 0 ? -errno :
	       store_text_sync_folder(path);
}

/* Is it one that jobs can be compiled with?  @beside: a name beside the file,
 * with the same ending. */
static int check(struct jobs *j, const char *beside, char why[WHY_MAX])
{
	struct config_tech t = none;
	const int err = config_tech_load(&t, j->config, beside);

	if (err == -EINVAL)
		snprintf(why, WHY_MAX, "%u:%u: %s; %s", t.diag.line,
			 t.diag.column, t.diag.found, t.diag.wanted);
	else if (err)
		config_tech_why(&t, err, why, WHY_MAX);
	config_tech_free(&t);
	return err;
}

static int keep(struct jobs *j, const struct config_tech *was,
		const char *text, const struct jobs_lcm_command *c,
		const char *what)
{
	char *before = strndup(was->text, was->bytes);
	int err = before ? store_tech_add(j->store, before, "", "as it was "
					  "found") : -ENOMEM;

	free(before);
	return err ? err : store_tech_add(j->store, text, c->by ? c->by->name :
					  "", what);
}

/* A whole file takes the place of the old one, which is in the store. */
static int put(struct jobs *j, const struct jobs_lcm_command *c,
	       const char *text, const char *what, char why[WHY_MAX])
{
	struct config_tech now = none;
	char beside[600], *path;
	int err = config_tech_load(&now, j->config, NULL);

	if (err != 0 && err != -EINVAL) {
		config_tech_why(&now, err, why, WHY_MAX);
		config_tech_free(&now);
		return -EIO;
	}
	/* A link goes on to name the file. */
	path = realpath(now.path, NULL);
	snprintf(beside, sizeof(beside), "%s.new.tech", path ? path : now.path);
	err = path ? write_all(beside, text, path) : -errno;
	if (err)
		snprintf(why, WHY_MAX, "%s: %s; a table in a folder where "
			 "edmd-jobs may write, as /var/lib/edmd", beside,
			 strerror(-err));
	else if (check(j, beside, why) < 0)
		err = -EINVAL;
	else if (keep(j, &now, text, c, what))
		err = -EAGAIN;
	else
		err = replace(beside, path);
	if (err == -EAGAIN)
		snprintf(why, WHY_MAX, "the store failed, so nothing was "
			 "saved");
	else if (err && err != -EINVAL && !*why)
		snprintf(why, WHY_MAX, "%s: %s", now.path, strerror(-err));
	if (err)
		unlink(beside);
	free(path);
	config_tech_free(&now);
	return err;
}

static bool has_table(struct jobs *j, const struct jobs_lcm_command *c)
{
	const char *name = j->config->tech_table;
	const size_t n = strlen(name);

	if (strcmp(name, "none") == 0)
		verbs_answer(j, c, REFUSED, "the machine file names no table; "
			     "[tech] table = NAME.tech");
	else if (n > 4 && strcasecmp(name + n - 4, ".enc") == 0)
		verbs_answer(j, c, REFUSED, "a table of an .enc file is not "
			     "written; edmsim --tech makes a .tech of it");
	else
		return true;
	return false;
}

static void save(struct jobs *j, const struct jobs_lcm_command *c,
		 const char *text, const char *what)
{
	char why[WHY_MAX] = "";
	const int err = put(j, c, text, what, why);

	if (err) {
		verbs_answer(j, c, err == -EINVAL ? EX_DATAERR : EX_IOERR, why);
		return;
	}
	jobs_note(j, &(struct jobs_note) { .kind = "tech" }, "the technology "
		  "table was saved by %s: %s", c->by ? c->by->name : "?", what);
	verbs_answer(j, c, 0, "saved; jobs that are loaded from now on have "
		     "it");
}

/* -- Single values --------------------------------------------------------- */

static int refuse(char why[WHY_MAX], uint32_t line, const char *word,
		  const char *wanted)
{
	snprintf(why, WHY_MAX, "line %u: '%.60s'; %s", line, word, wanted);
	return -EINVAL;
}

/* C120 in front of the point. */
static struct interp_tech_row *row_of(struct interp_tech_table *t,
				      const char *word, size_t n)
{
	char name[16];

	for (uint32_t i = 0; i < t->nrows; i++) {
		interp_tech_name(t->row[i].letter, t->row[i].number, name,
				 sizeof(name));
		if (strlen(name) == n && strncmp(name, word, n) == 0)
			return &t->row[i];
	}
	return NULL;
}

/* C120.servo_v=30; - takes the value out of the row. */
static int change(struct interp_tech_table *t, const char *word, uint32_t line,
		  char why[WHY_MAX])
{
	const size_t n = strcspn(word, ".");
	const size_t m = word[n] ? strcspn(word + n + 1, "=") : 0;
	struct interp_tech_row *row = row_of(t, word, n);
	char field[32], range[120], *end;
	double value = NAN;
	int id;

	if (!row || !word[n] || word[n + 1 + m] != '=')
		return refuse(why, line, word, "C120.servo_v=30, of a "
			      "condition of the table, or C120.servo_v=-");
	snprintf(field, sizeof(field), "%.*s", (int)m, word + n + 1);
	id = interp_tech_find(field);
	if (id < 0)
		return refuse(why, line, word, "a field of docs/technology.md, "
			      "as servo_v");
	if (strcmp(word + n + m + 2, "-") != 0) {
		value = strtod(word + n + m + 2, &end);
		if (end == word + n + m + 2 || *end ||
		    !interp_tech_value_ok((enum interp_tech_id)id, value))
			return refuse(why, line, word, interp_tech_range(
				(enum interp_tech_id)id, range, sizeof(range)));
	}
	row->tech.v[id] = value;
	return 0;
}

static int change_all(struct interp_tech_table *t, const char *text,
		      char why[WHY_MAX])
{
	uint32_t line = 0;
	char word[96];
	int err = 0;

	for (const char *at = text; err == 0 && *at;) {
		const size_t n = strcspn(at, "\n");

		snprintf(word, sizeof(word), "%.*s", (int)n, at);
		line++;
		if (n)
			err = change(t, word, line, why);
		at += n + (at[n] != '\0');
	}
	return err || line ? err : refuse(why, 1, "", "C120.servo_v=30");
}

static int add_text(void *arg, const char *text, size_t n)
{
	return fwrite(text, 1, n, arg) == n ? 0 : -EIO;
}

/* The table as a text; to be freed. */
static char *text_of(const struct interp_tech_table *t)
{
	char *text = NULL;
	size_t n;
	FILE *f = open_memstream(&text, &n);

	if (!f)
		return NULL;
	if (interp_tech_write(t, &(struct interp_sink) { add_text, f }) < 0) {
		fclose(f);
		free(text);
		return NULL;
	}
	return fclose(f) == 0 ? text : NULL;
}

/* The lines as words. */
static const char *one_line(const char *text, char *to, size_t size)
{
	size_t n = (size_t)snprintf(to, size, "%s", text);

	n = n < size ? n : size - 1;
	while (n > 0 && to[n - 1] == '\n')
		to[--n] = '\0';
	for (char *at = to; (at = strchr(at, '\n'));)
		*at = ' ';
	return to;
}

void verbs_tech_set(struct jobs *j, const struct verb *v,
		    const struct jobs_lcm_command *c)
{
	struct config_tech now = none;
	char why[WHY_MAX] = "", what[4096], *text = NULL;
	int err;

	(void)v;
	if (!has_table(j, c))
		return;
	err = config_tech_load(&now, j->config, NULL);
	if (err)
		config_tech_why(&now, err, why, sizeof(why));
	else
		err = change_all(now.table, c->text, why);
	if (err == 0)
		text = text_of(now.table);
	if (err)
		verbs_answer(j, c, EX_DATAERR, why);
	else if (!text)
		verbs_answer(j, c, EX_SOFTWARE, "no memory");
	else
		save(j, c, text, one_line(c->text, what, sizeof(what)));
	free(text);
	config_tech_free(&now);
}

/* -- Whole texts ----------------------------------------------------------- */

void verbs_tech_save(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c)
{
	(void)v;
	if (!has_table(j, c))
		return;
	if (strlen(c->text) > TEXT_MAX)
		verbs_answer(j, c, EX_DATAERR, "the table has more than 60000 "
			     "bytes; change its file by hand");
	else
		save(j, c, c->text, "a whole table");
}

static char *version(struct jobs *j, const struct jobs_lcm_command *c)
{
	char *text = c->arg >= 1 && c->arg < 1e9 && c->arg == floor(c->arg) ?
		     store_tech_text(j->store, (uint32_t)c->arg) : NULL;

	if (!text)
		verbs_answer(j, c, EX_NOINPUT, "no such version; edmctl tech "
			     "versions has them");
	return text;
}

void verbs_tech_back(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c)
{
	char what[40], *text;

	(void)v;
	if (!has_table(j, c))
		return;
	text = version(j, c);
	if (!text)
		return;
	snprintf(what, sizeof(what), "version %.0f again", c->arg);
	save(j, c, text, what);
	free(text);
}

/* A version may be longer than a message, and its comments in any encoding. */
void verbs_tech_text(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c)
{
	char *text = version(j, c), hex[2 * PART_MAX + 1];
	const size_t bytes = text ? strlen(text) : 0;
	const size_t from = strtoul(c->text, NULL, 10);
	size_t n = from < bytes ? bytes - from : 0;

	(void)v;
	if (!text)
		return;
	n = n < PART_MAX ? n : PART_MAX;
	sodium_bin2hex(hex, sizeof(hex), (unsigned char *)text +
		       (n ? from : 0), n);
	verbs_answer_json(j, c, json_pack("{s:s, s:I}", "hex", hex, "bytes",
					  (json_int_t)bytes));
	free(text);
}

void verbs_tech_versions(struct jobs *j, const struct verb *v,
			 const struct jobs_lcm_command *c)
{
	char *rows = store_tech_json(j->store);

	(void)v;
	if (rows)
		verbs_answer_json(j, c, json_loads(rows, 0, NULL));
	else
		verbs_answer(j, c, EX_IOERR, "the store failed");
	free(rows);
}
