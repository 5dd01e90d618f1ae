/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stl_raw.c - read the triangles of an STL file
 *
 * A file is binary if its length is that of the number of triangles it states;
 * else it has to be text.  Many binary files begin with "solid", too.
 */
#include "stl_raw.h"

#include "mesh.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>

#define HEAD_BYTES	84
#define TRI_BYTES	50

struct source {
	const char *path;
	char *text;
	size_t bytes;
	/* While text is read: */
	char *at;
	uint32_t line;
};

static int refuse(const struct source *s, const char *why)
{
	fprintf(stderr, "edm-plan: %s: %s; an STL file, binary or text, of "
		"a closed body\n", s->path, why);
	return EX_DATAERR;
}

static int refuse_line(const struct source *s, const char *found,
		       const char *wanted)
{
	fprintf(stderr, "edm-plan: %s:%u: %s; %s\n", s->path, s->line, found,
		wanted);
	return EX_DATAERR;
}

static int slurp(struct source *s)
{
	FILE *f = fopen(s->path, "rb");
	struct stat st;
	int err = 0;

	if (!f || fstat(fileno(f), &st) < 0 || !S_ISREG(st.st_mode)) {
		fprintf(stderr, "edm-plan: %s: %s; an STL file\n", s->path,
			f ? "not a file" : strerror(errno));
		err = EX_NOINPUT;
	} else if ((uint64_t)st.st_size >
		   (uint64_t)MESH_TRIS_MAX * TRI_BYTES * 6) {
		err = refuse(s, "more than 20 million triangles");
	} else {
		s->bytes = (size_t)st.st_size;
		s->text = malloc(s->bytes + 1);
		if (!s->text)
			err = EX_OSERR;
		else if (fread(s->text, 1, s->bytes, f) != s->bytes)
			err = refuse(s, "cannot be read to its end");
	}
	if (f)
		fclose(f);
	if (err == 0)
		s->text[s->bytes] = '\0';
	return err;
}

static int check_finite(const struct source *s, const struct stl_raw *raw)
{
	for (uint32_t i = 0; i < raw->n; i++) {
		for (int k = 0; k < 9; k++) {
			char why[80];

			if (fabsf(raw->corner[i][k / 3][k % 3]) <= 1e7f)
				continue;
			snprintf(why, sizeof(why), "triangle %u has a corner "
				 "at %g", i + 1,
				 (double)raw->corner[i][k / 3][k % 3]);
			return refuse(s, why);
		}
	}
	return 0;
}

static int read_binary(const struct source *s, uint32_t n,
		       struct stl_raw *raw)
{
	raw->corner = malloc((size_t)n * sizeof(*raw->corner));
	if (!raw->corner)
		return EX_OSERR;
	raw->n = n;
	for (uint32_t i = 0; i < n; i++)
		memcpy(raw->corner[i], s->text + HEAD_BYTES + 12 +
		       (size_t)i * TRI_BYTES, sizeof(*raw->corner));
	return 0;
}

/* -- Text ----------------------------------------------------------------- */

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' ||
	       c == '\f';
}

static void skip_blanks(struct source *s)
{
	for (; is_blank(*s->at); s->at++)
		s->line += *s->at == '\n';
}

static void skip_line(struct source *s)
{
	s->at += strcspn(s->at, "\n");
}

/* Takes @word if it is next, in either case. */
static bool take_word(struct source *s, const char *word)
{
	const size_t n = strlen(word);

	skip_blanks(s);
	if (strncasecmp(s->at, word, n) != 0 ||
	    (s->at[n] != '\0' && !is_blank(s->at[n])))
		return false;
	s->at += n;
	return true;
}

static bool take_number(struct source *s, float *ret)
{
	char *end;

	skip_blanks(s);
	*ret = strtof(s->at, &end);
	if (end == s->at || (*end != '\0' && !is_blank(*end)))
		return false;
	s->at = end;
	return true;
}

static int take_corners(struct source *s, float ret[3][3])
{
	for (int k = 0; k < 3; k++) {
		if (!take_word(s, "vertex"))
			return refuse_line(s, "no vertex here", "a facet has "
					   "three of them, as in vertex 1 2 3");
		for (int i = 0; i < 3; i++) {
			if (!take_number(s, &ret[k][i]) ||
			    !(fabsf(ret[k][i]) <= 1e7f))
				return refuse_line(s, "not a place of a vertex",
						   "three numbers, at most "
						   "1e7 each");
		}
	}
	return 0;
}

static int take_facet(struct source *s, struct stl_raw *raw)
{
	static const char wanted[] = "facet normal, outer loop, three vertex, "
				     "endloop, endfacet";
	float normal;
	int err;

	if (raw->n == MESH_TRIS_MAX)
		return refuse(s, "more than 20 million triangles");
	if (raw->n == raw->room &&
	    grow_array(&raw->corner, &raw->room, sizeof(*raw->corner)))
		return EX_OSERR;
	if (!take_word(s, "normal"))
		return refuse_line(s, "a facet without its normal", wanted);
	/* Its direction is that of the corners; what stands here may be
	 * anything. */
	for (int i = 0; i < 3; i++)
		if (!take_number(s, &normal))
			return refuse_line(s, "not a normal", wanted);
	if (!take_word(s, "outer") || !take_word(s, "loop"))
		return refuse_line(s, "no outer loop here", wanted);
	err = take_corners(s, raw->corner[raw->n]);
	if (err == 0 && (!take_word(s, "endloop") || !take_word(s, "endfacet")))
		err = refuse_line(s, "a facet that does not end", wanted);
	raw->n += err == 0;
	return err;
}

/* It is not text, and not as long as a binary file has to be. */
static int refuse_length(const struct source *s)
{
	char why[120];
	uint32_t n = 0;

	if (s->bytes >= HEAD_BYTES)
		memcpy(&n, s->text + HEAD_BYTES - 4, 4);
	snprintf(why, sizeof(why), "not text, and %zu bytes where its %u "
		 "triangles take %llu", s->bytes, n,
		 (unsigned long long)HEAD_BYTES +
		 (unsigned long long)n * TRI_BYTES);
	return refuse(s, why);
}

static int read_text(struct source *s, struct stl_raw *raw)
{
	bool within = false;
	int err = 0;

	if (memchr(s->text, '\0', s->bytes))
		return refuse_length(s);
	/* Some programs begin a text with a byte order mark. */
	s->at = s->text + (strncmp(s->text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0);
	s->line = 1;
	while (err == 0) {
		if (take_word(s, within ? "endsolid" : "solid")) {
			within = !within;
			skip_line(s);
		} else if (within && take_word(s, "facet")) {
			err = take_facet(s, raw);
		} else {
			break;
		}
	}
	if (err == 0 && *s->at != '\0')
		return refuse_line(s, "not understood", within ?
				   "facet or endsolid" : "solid");
	if (err == 0 && within)
		return refuse_line(s, "the text ends inside its solid",
				   "endsolid: it may be cut short");
	return err;
}

int stl_raw_read(const char *path, struct stl_raw *ret)
{
	struct source s = { .path = path };
	uint32_t n = 0;
	int err = slurp(&s);

	*ret = (struct stl_raw) { 0 };
	if (err == 0 && s.bytes == 0)
		err = refuse(&s, "an empty file");
	if (err == 0 && s.bytes >= HEAD_BYTES)
		memcpy(&n, s.text + HEAD_BYTES - 4, 4);
	if (err == 0 && s.bytes >= HEAD_BYTES &&
	    s.bytes == HEAD_BYTES + (uint64_t)n * TRI_BYTES)
		err = read_binary(&s, n, ret);
	else if (err == 0)
		err = read_text(&s, ret);
	if (err == 0)
		err = check_finite(&s, ret);
	if (err == 0 && ret->n < 4)
		err = refuse(&s, "fewer than 4 triangles");
	if (err == EX_OSERR)
		fprintf(stderr, "edm-plan: %s: out of memory\n", path);
	free(s.text);
	if (err) {
		free(ret->corner);
		*ret = (struct stl_raw) { 0 };
	}
	return err;
}
