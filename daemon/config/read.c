/* SPDX-License-Identifier: Apache-2.0 */
/*
 * read.c - reads a machine file into a struct machine_config
 *
 * libinih knows the syntax.  It gets its lines from take_line(), which counts
 * them, because libinih does not tell a handler where it is.  take_line() also
 * refuses what libinih would ignore: text behind a heading, lines that are too
 * long for it, and NUL bytes.
 */
#include "keys.h"
#include "nearest.h"

#include <assert.h>
#include <errno.h>
#include <ini.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES	1024		/* of a line, with its end and a NUL */
#define BLANK		" \t\r\n\v\f"
#define BOM		"\xef\xbb\xbf"	/* some editors begin UTF-8 files with
					 * it */

struct reading {
	FILE *f;
	struct machine_config config;
	struct config_lines lines;
	struct interp_diag *diag;
	uint32_t line;			/* of text, from 1 */
	char text[LINE_BYTES];		/* as it stands in the file */
	int err;			/* the first thing refused ends it */
};

/* A list of the accepted words.  With the text before it, it fits a diag. */
struct list {
	char text[104];
	bool full;
};

/* Append a word: "a, b, c", or as many as fit and ", ...". */
static void append_word(struct list *l, const char *word)
{
	size_t n = strlen(l->text), left = sizeof(l->text) - n;

	if (l->full)
		return;
	l->full = strlen(word) + sizeof(", , ...") > left;
	snprintf(l->text + n, left, "%s%s", n ? ", " : "",
		 l->full ? "..." : word);
}

static void refuse(struct reading *r, size_t column)
{
	r->diag->line = r->line;
	r->diag->column = (uint32_t)column;
	r->err = -EINVAL;
}

/* @list: what is accepted; @near: what was probably meant. */
static void want_one_of(struct reading *r, const struct nearest *near,
			const struct list *list)
{
	if (near->word[0])
		snprintf(r->diag->wanted, sizeof(r->diag->wanted),
			 "did you mean %s? one of %s", near->word, list->text);
	else
		snprintf(r->diag->wanted, sizeof(r->diag->wanted),
			 "one of %s", list->text);
}

static void refuse_section(struct reading *r, const char *name, size_t column)
{
	char buf[NEAREST_MAX], range[NEAREST_MAX];
	struct list list = { "", false };
	struct nearest near;

	nearest_init(&near, name);
	for (int s = 0; s < CONFIG_NSECTIONS; s++) {
		const struct config_section *sec = &config_section[s];
		int last = sec->ninstances - 1;

		for (int i = 0; i <= last; i++)
			nearest_offer(&near, config_section_name(
				(enum config_section_id)s, i, buf,
				sizeof(buf)));
		snprintf(range, sizeof(range), "%s", sec->name);
		if (sec->instance)
			snprintf(range, sizeof(range), "%s.%s to %s.%s",
				 sec->name, sec->instance[0], sec->name,
				 sec->instance[last]);
		append_word(&list, range);
	}
	snprintf(r->diag->found, sizeof(r->diag->found),
		 "unknown section [%.60s]", name);
	want_one_of(r, &near, &list);
	refuse(r, column);
}

static void refuse_key(struct reading *r, const char *section,
		       enum config_section_id s, const char *name)
{
	struct list list = { "", false };
	const struct config_key *k;
	struct nearest near;

	nearest_init(&near, name);
	for (int i = 0; (k = config_key(i)); i++) {
		if (k->section != s)
			continue;
		nearest_offer(&near, k->name);
		append_word(&list, k->name);
	}
	snprintf(r->diag->found, sizeof(r->diag->found),
		 "unknown key %s.%.60s", section, name);
	want_one_of(r, &near, &list);
	refuse(r, strspn(r->text, BLANK) + 1);
}

static void refuse_syntax(struct reading *r, const char *found,
			  const char *wanted)
{
	interp_diag_say(r->diag, "%s; %s", found, wanted);
	refuse(r, strspn(r->text, BLANK) + 1);
}

static void check_heading(struct reading *r, const char *bracket)
{
	size_t n = strcspn(bracket + 1, "]");
	const char *rest = bracket + 1 + n;
	size_t column = (size_t)(bracket - r->text) + 2;
	char name[LINE_BYTES];
	int instance;

	if (*rest != ']') {
		refuse_syntax(r, "a section without its ]", "[section]");
		return;
	}
	snprintf(name, sizeof(name), "%.*s", (int)n, bracket + 1);
	rest += 1 + strspn(rest + 1, BLANK);
	if (config_section_find(name, &instance) < 0)
		refuse_section(r, name, column);
	else if (*rest && *rest != ';' && *rest != '#')
		refuse_syntax(r, "text behind a section",
			      "its keys from the next line on");
}

/* Lines end in LF, in CR LF, or in CR alone, as those of NC code.  To libinih,
 * a comment before such lines would go on over all of them. */
static int next_char(FILE *f)
{
	const int ch = getc(f);
	int next;

	if (ch != '\r')
		return ch;
	next = getc(f);
	if (next != '\n' && next != EOF)
		ungetc(next, f);
	return '\n';
}

/* Read one line into r->text; false at the end of the file. */
static bool get_line(struct reading *r)
{
	size_t n = 0;
	int ch;

	while ((ch = next_char(r->f)) != EOF) {
		if (ch == '\0') {
			refuse_syntax(r, "a NUL byte", "a text file");
			return false;
		}
		if (n + 2 > sizeof(r->text)) {
			refuse_syntax(r, "a line too long",
				      "1022 bytes at most");
			return false;
		}
		r->text[n++] = (char)ch;
		r->text[n] = '\0';
		if (ch == '\n')
			break;
	}
	return n > 0;
}

static char *take_line(char *str, int num, void *stream)
{
	struct reading *r = stream;
	const char *first;

	r->line++;
	r->text[0] = '\0';
	if (!get_line(r))
		return NULL;

	first = r->text;
	if (r->line == 1 && strncmp(first, BOM, strlen(BOM)) == 0)
		first += strlen(BOM);
	first += strspn(first, BLANK);
	if (*first == '[')
		check_heading(r, first);
	if (r->err)
		return NULL;
	snprintf(str, (size_t)num, "%s", r->text);
	return str;
}

static size_t value_column(const struct reading *r)
{
	size_t n = strcspn(r->text, "=:");

	if (r->text[n])
		n++;
	return n + strspn(r->text + n, " \t") + 1;
}

static void set_key(struct reading *r, int row, int instance,
		    const char *value)
{
	uint32_t *at = &r->lines.at[row][instance];
	const struct config_key *k = config_key(row);
	char section[NEAREST_MAX], found[128];

	if (*at) {
		config_section_name(k->section, instance, section,
				    sizeof(section));
		snprintf(found, sizeof(found),
			 "%s.%s again, first in line %u", section, k->name,
			 *at);
		refuse_syntax(r, found, "each key once");
		return;
	}
	*at = r->line;
	if (config_key_parse(k, instance, value, &r->config, r->diag))
		refuse(r, value_column(r));
}

/* libinih calls this; a return value that is not 0 means: go on. */
static int take_key(void *user, const char *section, const char *name,
		    const char *value)
{
	struct reading *r = user;
	int instance, s, row;

	s = config_section_find(section, &instance);
	if (s < 0) {
		refuse_syntax(r, "a key before any section",
			      "a [section] above it");
		return 0;
	}
	row = config_key_find((enum config_section_id)s, name);
	if (row < 0)
		refuse_key(r, section, (enum config_section_id)s, name);
	else
		set_key(r, row, instance, value);
	return !r->err;
}

/* The options of libinih are global variables of the library. */
static void set_syntax(void)
{
	static char comment[] = ";#";

	ini_inline_comment_prefixes = comment;
	ini_allow_multiline = false;	/* an indented key is a key */
	ini_stop_on_first_error = true;
	ini_use_stack = false;		/* its stack buffer is 200 bytes */
	ini_initial_alloc = LINE_BYTES;
	ini_max_line = LINE_BYTES;
}

/* What is not written has other defaults on a wire machine: of [sim] process
 * first, which the others depend on. */
static void take_wire_defaults(struct reading *r)
{
	const int process = config_key_find(SECTION_SIM, "process");

	if (r->config.gap.process == PROCESS_WIRE && !r->lines.at[process][0])
		r->config.sim.process = PROCESS_WIRE;
	if (r->config.sim.process != PROCESS_WIRE)
		return;
	for (int i = 0; config_key(i); i++) {
		const struct config_key *k = config_key(i);

		if (!k->def_wire || r->lines.at[i][0])
			continue;
		r->err = config_key_parse(k, 0, k->def_wire, &r->config,
					  r->diag);
		assert(!r->err);
	}
}

static int read_all(struct reading *r)
{
	int n;

	set_syntax();
	n = ini_parse_stream(take_line, r, take_key, r);
	if (r->err)
		return r->err;
	if (ferror(r->f))
		return errno == EISDIR ? -EISDIR : -EIO;
	if (n < 0)
		return -ENOMEM;
	if (n > 0) {
		refuse_syntax(r, "neither a key nor a section",
			      "key = value, [section], or ; and a comment");
		return r->err;
	}
	r->config.contour.line = r->lines.at[
		config_key_find(SECTION_CONTOUR, "method")][0];
	r->config.kinematics.line = r->lines.at[
		config_key_find(SECTION_KINEMATICS, "chain")][0];
	take_wire_defaults(r);
	r->err = config_check(&r->config, &r->lines, r->diag);
	return r->err ? r->err :
	       config_maps_read(&r->config, &r->lines, r->diag);
}

/* The folder with its /.  If it does not fit, the current folder is used. */
static void set_folder(struct machine_config *c, const char *path)
{
	const char *slash = strrchr(path, '/');
	const size_t n = slash ? (size_t)(slash - path) + 1 : 0;

	if (n < sizeof(c->folder))
		snprintf(c->folder, sizeof(c->folder), "%.*s", (int)n, path);
}

/* What the file says is nearer. */
static void take_environment(struct machine_config *c)
{
	const char *url = getenv("LCM_DEFAULT_URL");

	if (url && *url)
		snprintf(c->lcm_url, sizeof(c->lcm_url), "%s", url);
}

int config_read(struct machine_config *c, const char *path,
		struct interp_diag *diag)
{
	struct reading r = { .diag = diag };
	int err;

	memset(diag, 0, sizeof(*diag));
	config_defaults(&r.config);
	r.f = fopen(path, "re");
	if (!r.f)
		return -errno;
	set_folder(&r.config, path);
	take_environment(&r.config);

	err = read_all(&r);
	fclose(r.f);
	if (!err)
		*c = r.config;
	return err;
}
