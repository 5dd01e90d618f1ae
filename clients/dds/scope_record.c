/* SPDX-License-Identifier: Apache-2.0 */
/* scope_record.c - the cycles of a machine of the fleet, into a CSV */
#include "scope.h"
#include "tool.h"
#include "shm_csv.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

#define MS		1000000LL
#define TAKEN		16		/* samples at once */

struct record {
	const char *machine;
	dds_entity_t reader;
	FILE *f;
	uint64_t last, written, lost;	/* cycles */
	double t_s;			/* of the last one */
};

/* Cycles from the last row on.  Those of an edmd that was started anew begin at
 * 0 again. */
static uint64_t cycles_since(const struct record *r, uint64_t cycle)
{
	if (r->written == 0)
		return 0;
	return cycle > r->last ? cycle - r->last : 1;
}

static void write_row(struct record *r, const edm_Scope *m,
		      const edm_ScopeRow *row)
{
	struct shm_trace t = {
		.cycle = row->cycle, .place_mm = row->place_mm,
		.feed_mm_s = (double)row->feed_mm_s,
		.gap_v = (double)row->gap_v, .line = row->line,
		.state = row->state,
	};
	const uint64_t since = cycles_since(r, row->cycle);

	memcpy(t.pos, row->position, sizeof(t.pos));
	memcpy(t.actual, row->actual, sizeof(t.actual));
	r->lost += since > 1 ? since - 1 : 0;
	r->t_s += (double)since * m->period_s;
	r->last = row->cycle;
	r->written++;
	shm_csv_row(r->f, &t, r->t_s, m->pulse_mm);
}

/* Does it have numbers that a machine may have? */
static bool is_sane(const edm_Scope *m)
{
	bool sane = m->period_s > 0 && m->period_s <= 1;

	for (int i = 0; i < SHM_NAXES; i++)
		sane = sane && isfinite(m->pulse_mm[i]);
	return sane;
}

/* What another machine's partition, or another name, tells is not of it. */
static int take(struct record *r)
{
	dds_sample_info_t info[TAKEN];
	void *at[TAKEN] = { NULL };
	const int n = dds_take(r->reader, at, info, TAKEN, TAKEN);

	for (int i = 0; i < n; i++) {
		const edm_Scope *m = at[i];

		if (!info[i].valid_data || strcmp(m->machine, r->machine) ||
		    !is_sane(m) ||
		    !topic_is_of(r->reader, info[i].publication_handle,
				 r->machine))
			continue;
		for (uint32_t k = 0; k < m->rows._length; k++)
			write_row(r, m, &m->rows._buffer[k]);
	}
	if (n > 0)
		dds_return_loan(r->reader, at, n);
	return n;
}

static int follow(struct record *r, int epoll)
{
	bool stop;
	int n;

	do {
		stop = tool_wait(epoll, 50 * MS);
		do
			n = take(r);
		while (n == TAKEN);
		fflush(r->f);
	} while (n >= 0 && !stop && !ferror(r->f));
	return n < 0 ? n : 0;
}

static int report(const struct record *r, const char *path, bool is_whole)
{
	if (!is_whole) {
		fprintf(stderr, "edm-fleet: error: %s: %s\n", path,
			strerror(errno));
		return EX_IOERR;
	}
	fprintf(stderr, "edm-fleet: %s: %llu cycles of %s, %llu lost%s\n", path,
		(unsigned long long)r->written, r->machine,
		(unsigned long long)r->lost, r->written ? "" :
		"; its edm-dds, and an edmd beside it, must run");
	return r->written ? EX_OK : 1;
}

int scope_record(dds_entity_t participant, int epoll, const char *machine,
		 const char *path)
{
	struct record r = { .machine = machine, .f = fopen(path, "we") };
	int err;
	bool is_whole;

	if (!r.f) {
		fprintf(stderr, "edm-fleet: error: %s: %s; a file for the "
			"cycles\n", path, strerror(errno));
		return EX_CANTCREAT;
	}
	shm_csv_head(r.f);
	r.reader = topic_reader_create(
		topic_part_create(participant, false, machine), TOPIC_SCOPE);
	err = r.reader < 0 ? r.reader : follow(&r, epoll);
	is_whole = !ferror(r.f);
	is_whole = fclose(r.f) == 0 && is_whole;
	return err < 0 ? err : report(&r, path, is_whole);
}
