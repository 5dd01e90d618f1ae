/* SPDX-License-Identifier: Apache-2.0 */
/*
 * support.c - one archive with everything that a helper far away wants to see
 *
 * If a file cannot be made, it says why instead, and the others are made.
 */
#include "support.h"

#include "file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <sysexits.h>
#include <tar.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

static const char what_is_not_in_it[] =
	"No keys, no passwords, no users of the panel, no programs of jobs.";

struct pack {
	struct support s;
	struct ctl_file file;
	gzFile gz;
	char folder[96];
	char path[128];			/* if none was named */
	time_t now;
	struct line line;
};

void support_ready(struct support *s)
{
	const struct talk_question q = { .verb = "store" };
	struct talk_answer a;

	if (s->ctl->talk &&
	    talk_ask(s->ctl->talk, &q, s->ctl->timeout_s, &a) == 0) {
		s->store = a.code == 0 && a.body ?
			   json_loads(a.body, 0, NULL) : NULL;
		talk_answer_free(&a);
	}
	support_learn(s);
}

void support_fini(struct support *s)
{
	json_decref(s->store);
	free(s->secrets.at);
}

static void fill_readme(const struct pack *p, struct support_text *to)
{
	char when[32];
	struct utsname u = { .nodename = "?" };
	struct tm tm;

	uname(&u);
	gmtime_r(&p->now, &tm);
	strftime(when, sizeof(when), "%Y-%m-%d %H:%M:%S UTC", &tm);
	support_say(to, "Support archive of machine %s, host %s, %s.\n%s\nIt "
		    "has names of jobs, of files, of this host and of those "
		    "who command.\n\n", p->s.ctl->machine, u.nodename, when,
		    what_is_not_in_it);
	for (int i = 0; i < support_nfiles; i++)
		support_say(to, "%-18s %s\n", support_files[i].name,
			    support_files[i].what);
}

/* -- The archive: POSIX ustar, packed by gzip ------------------------------ */

#define BLOCK	512

/* The head of a file in it, as POSIX has it; numbers are octal digits. */
struct head {
	char name[100], mode[8], uid[8], gid[8], size[12], mtime[12];
	char sum[8], type, linkname[100], magic[TMAGLEN], version[TVERSLEN];
	char uname[32], gname[32], devmajor[8], devminor[8], prefix[155];
	char fill[12];
};

_Static_assert(sizeof(struct head) == BLOCK, "a head is one block");

static void fill_head(const struct pack *p, const char *name, size_t bytes,
		      struct head *h)
{
	unsigned int sum = 0;

	*h = (struct head) {
		.mode = "0000644", .uid = "0000000", .gid = "0000000",
		.sum = { ' ', ' ', ' ', ' ', ' ', ' ', ' ', ' ' },
		.type = REGTYPE, .magic = TMAGIC,
		.devmajor = "0000000", .devminor = "0000000",
	};
	memcpy(h->version, TVERSION, TVERSLEN);
	snprintf(h->name, sizeof(h->name), "%s", name);
	snprintf(h->prefix, sizeof(h->prefix), "%s", p->folder);
	snprintf(h->size, sizeof(h->size), "%011zo", bytes);
	snprintf(h->mtime, sizeof(h->mtime), "%011llo",
		 (unsigned long long)p->now);
	for (size_t i = 0; i < sizeof(*h); i++)
		sum += ((const unsigned char *)h)[i];
	snprintf(h->sum, sizeof(h->sum), "%06o", sum);
}

static int failed(const struct pack *p)
{
	fprintf(stderr, "edmctl: %s: %s\n", p->file.path, strerror(errno));
	return EX_IOERR;
}

static int pack_open(struct pack *p)
{
	const int fd = dup(fileno(p->file.f));

	p->gz = fd < 0 ? NULL : gzdopen(fd, "w");
	if (p->gz)
		return 0;
	close(fd);
	return failed(p);
}

static int pack_bytes(struct pack *p, const void *at, size_t bytes)
{
	/* zlib takes 0 bytes for an error. */
	if (bytes == 0 || gzfwrite(at, bytes, 1, p->gz) == 1)
		return 0;
	return failed(p);
}

static int pack_text(struct pack *p, const char *name,
		     const struct support_text *t)
{
	static const char zeros[BLOCK];
	struct head h;
	int err;

	fill_head(p, name, t->bytes, &h);
	err = pack_bytes(p, &h, sizeof(h));
	if (err == 0)
		err = pack_bytes(p, t->at, t->bytes);
	if (err == 0)
		err = pack_bytes(p, zeros, -t->bytes % BLOCK);
	return err;
}

/* Two blocks of zeros are the end. */
static int pack_close(struct pack *p, int err)
{
	static const char zeros[2 * BLOCK];

	if (!p->gz)
		return err;
	if (err == 0)
		err = pack_bytes(p, zeros, sizeof(zeros));
	if (gzclose(p->gz) != Z_OK && err == 0)
		err = failed(p);
	return err;
}

static int pack_one(struct pack *p, int i)
{
	const struct support_file *f = &support_files[i];
	struct support_text t = { .at = NULL };
	int err;

	if (!p->s.ctl->json)
		line_bar(&p->line, (double)i / support_nfiles, f->name);
	f->fill(&p->s, &t);
	support_scrub(&p->s, &t);
	err = pack_text(p, f->name, &t);
	free(t.at);
	return err ? err : talk_interrupted() ? EX_TEMPFAIL : 0;
}

static int pack_all(struct pack *p)
{
	struct support_text readme = { .at = NULL };
	int err = pack_open(p);

	fill_readme(p, &readme);
	if (err == 0)
		err = pack_text(p, "README.txt", &readme);
	free(readme.at);
	for (int i = 0; i < support_nfiles && err == 0; i++)
		err = pack_one(p, i);
	return pack_close(p, err);
}

/* -- The verb -------------------------------------------------------------- */

static void name_it(struct pack *p)
{
	struct tm tm;
	char when[32];

	p->now = time(NULL);
	localtime_r(&p->now, &tm);
	strftime(when, sizeof(when), "%Y%m%d-%H%M%S", &tm);
	snprintf(p->folder, sizeof(p->folder), "edmd-support-%s-%s",
		 p->s.ctl->machine, when);
	snprintf(p->path, sizeof(p->path), "%s.tar.gz", p->folder);
}

static void tell(const struct pack *p, const char *path)
{
	if (p->s.ctl->json) {
		json_t *o = json_pack("{s:s,s:i}", "file", path, "files",
				      support_nfiles + 1);

		ctl_put_json(o);
		json_decref(o);
		return;
	}
	printf("%s: %d files:\n", path, support_nfiles + 1);
	for (int i = 0; i < support_nfiles; i++)
		printf("  %-18s %s\n", support_files[i].name,
		       support_files[i].what);
	printf("%s\nLook into it before you send it: it has names of jobs, of "
	       "files, of this host and\nof those who command.\n",
	       what_is_not_in_it);
}

int ctl_support(struct ctl *c)
{
	struct pack p = { .s.ctl = c };
	const char *path;
	int err;

	name_it(&p);
	path = c->arg ? c->arg : p.path;
	err = ctl_file_open(&p.file, path, false);
	if (err)
		return err;
	line_init(&p.line);
	if (!c->json)
		line_bar(&p.line, 0, "asking edmd-jobs");
	support_ready(&p.s);
	err = talk_interrupted() ? EX_TEMPFAIL : pack_all(&p);
	err = ctl_file_close(&p.file, err);
	line_end(&p.line);
	if (err == 0)
		tell(&p, path);
	else if (err == EX_TEMPFAIL)
		fprintf(stderr, "edmctl: support: interrupted; nothing is "
			"written\n");
	support_fini(&p.s);
	return err;
}
