/* SPDX-License-Identifier: Apache-2.0 */
/* sink.c - what comes over DDS goes into a ledger */
#include "sink.h"

#include "clocks.h"
#include "topic.h"

#include <time.h>

#define NS		1000000000LL
#define SPENT_NS	NS		/* between two looks at the states */
#define STOOD_NS	(5 * NS)	/* the program itself did not run */
#define STORED_NS	(10 * NS)

enum { REPORTS, ALARMS };

int sink_open(struct sink *s, dds_entity_t participant, struct ledger *l)
{
	static const enum topic topics[] = { TOPIC_REPORT, TOPIC_ALARM };

	const dds_entity_t all = topic_part_create(participant, false,
						   TOPIC_ALL_PARTS);

	*s = (struct sink) { .ledger = l };
	for (int i = 0; i < SINK_LISTS; i++) {
		s->reader[i] = topic_reader_create(all, topics[i]);
		if (s->reader[i] < 0)
			return s->reader[i];
	}
	return 0;
}

static void take(struct sink *s, int list)
{
	if (s->n[list])
		return;
	s->at[list][0] = NULL;
	s->n[list] = dds_take(s->reader[list], s->at[list], s->info[list],
			      SINK_BATCH, SINK_BATCH);
	if (s->n[list] < 0)
		s->n[list] = 0;
	s->news += (uint64_t)s->n[list];
}

/* It was stored. */
static void give_back(struct sink *s, int list)
{
	if (s->n[list])
		dds_return_loan(s->reader[list], s->at[list], s->n[list]);
	s->n[list] = 0;
}

static bool is_his(const struct sink *s, int list, int at)
{
	const char *machine =
		list == REPORTS ? ((edm_JobReport *)s->at[list][at])->machine :
				  ((edm_Alarm *)s->at[list][at])->machine;

	return s->info[list][at].valid_data &&
	       topic_is_of(s->reader[list],
			   s->info[list][at].publication_handle, machine);
}

static int put(struct sink *s, int list)
{
	int err = 0;

	for (int i = 0; i < s->n[list] && err == 0; i++) {
		if (!is_his(s, list, i))
			continue;
		err = list == REPORTS ?
			      ledger_report(s->ledger, s->at[list][i]) :
			      ledger_alarm(s->ledger, s->at[list][i]);
	}
	return err;
}

static int store(struct sink *s)
{
	int err = ledger_begin(s->ledger);

	for (int i = 0; i < SINK_LISTS && err == 0; i++)
		err = put(s, i);
	err = ledger_end(s->ledger, err);
	for (int i = 0; i < SINK_LISTS && err == 0; i++)
		give_back(s, i);
	return err;
}

static void spend(struct sink *s, const struct hall *h, int64_t now)
{
	const int64_t ns = s->spent_ns ? now - s->spent_ns : 0;

	if (s->spent_ns && ns < SPENT_NS)
		return;
	s->spent_ns = now;
	if (ns == 0 || ns > STOOD_NS)
		return;
	for (size_t i = 0; i < h->n; i++)
		ledger_spend(s->ledger, &h->row[i], (double)ns / NS);
}

int sink_step(struct sink *s, const struct hall *h, bool all)
{
	const int64_t now = clock_ns(CLOCK_MONOTONIC);
	int err = 0;

	spend(s, h, now);
	do {
		take(s, REPORTS);
		take(s, ALARMS);
		all |= now - s->stored_ns > STORED_NS;
		if (!all && !s->n[REPORTS] && !s->n[ALARMS])
			break;
		s->stored_ns = now;
		all = false;
		err = store(s);
	} while (err == 0);
	return err;
}
