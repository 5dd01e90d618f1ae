/* SPDX-License-Identifier: Apache-2.0 */
/* hall.c - the machines that are heard, and who tells their states */
#include "hall.h"
#include "topic.h"

#include <stdlib.h>
#include <string.h>

#define TAKE		128		/* samples at once */

int hall_open(struct hall *h, dds_entity_t participant)
{
	h->row = calloc(HALL_MAX, sizeof(*h->row));
	h->sample = calloc(TAKE, sizeof(*h->sample));
	if (!h->row || !h->sample)
		return DDS_RETCODE_OUT_OF_RESOURCES;
	h->reader = topic_reader_create(topic_part_create(participant, false,
							  TOPIC_ALL_PARTS),
					TOPIC_STATE);
	return h->reader < 0 ? h->reader : 0;
}

void hall_close(struct hall *h)
{
	free(h->row);
	free(h->sample);
}

static int by_name(const void *key, const void *row)
{
	return strcmp(key, ((const struct hall_machine *)row)->m.machine);
}

static struct hall_machine *find(const struct hall *h, const char *name)
{
	return bsearch(name, h->row, h->n, sizeof(*h->row), by_name);
}

/* Return: NULL if there is no room. */
static struct hall_machine *row_of(struct hall *h, const char *name)
{
	struct hall_machine *r = find(h, name);
	size_t at = 0;

	if (r || h->n == HALL_MAX)
		return r;
	while (at < h->n && strcmp(h->row[at].m.machine, name) < 0)
		at++;
	memmove(&h->row[at + 1], &h->row[at],
		(h->n++ - at) * sizeof(*h->row));
	h->row[at] = (struct hall_machine) { .gone = true };
	h->news++;
	return &h->row[at];
}

/* Another one writes than the last time. */
static void turn(struct hall_machine *r, dds_instance_handle_t writer)
{
	size_t at = 0;

	while (at < HALL_PAST - 1 && r->past[at] != writer && r->past[at])
		at++;
	r->disputed |= r->past[at] == writer;
	r->past[at] = r->writer;
	memcpy(r->rival, r->m.host, sizeof(r->rival));
}

static void heard(struct hall *h, const edm_MachineState *m,
		  const dds_sample_info_t *info)
{
	struct hall_machine *r = find(h, m->machine);

	if (!(r && r->writer == info->publication_handle) &&
	    !topic_is_of(h->reader, info->publication_handle, m->machine))
		return;
	r = row_of(h, m->machine);
	if (!r) {
		h->beyond++;
		return;
	}
	if (r->writer && r->writer != info->publication_handle)
		turn(r, info->publication_handle);
	r->writer = info->publication_handle;
	r->m = *m;
	r->heard_ns = info->source_timestamp;
	r->gone = info->instance_state != DDS_IST_ALIVE;
}

/* Only its key is known. */
static void left(struct hall *h, const char *name,
		 const dds_sample_info_t *info)
{
	struct hall_machine *r = find(h, name);

	if (r)
		r->gone = info->instance_state != DDS_IST_ALIVE;
}

static void settle(const struct hall *h, struct hall_machine *r)
{
	int others = 0;

	for (size_t i = 0; i < HALL_PAST; i++)
		others += r->past[i] && topic_has_writer(h->reader, r->past[i]);
	r->disputed = others && topic_has_writer(h->reader, r->writer);
}

int hall_look(struct hall *h)
{
	static dds_sample_info_t info[TAKE];
	static void *at[TAKE];
	int n;

	for (size_t i = 0; i < TAKE; i++)
		at[i] = &h->sample[i];
	do {
		n = dds_take(h->reader, at, info, TAKE, TAKE);
		for (int i = 0; i < n; i++) {
			const edm_MachineState *m = &h->sample[i];

			if (info[i].valid_data)
				heard(h, m, &info[i]);
			else
				left(h, m->machine, &info[i]);
		}
	} while (n == TAKE);
	for (size_t i = 0; i < h->n; i++)
		if (h->row[i].disputed)
			settle(h, &h->row[i]);
	return n < 0 ? n : 0;
}

size_t hall_known(const struct hall *h)
{
	size_t known = h->n;

	for (size_t i = 0; i < h->n; i++)
		if (h->row[i].m.known > known)
			known = h->row[i].m.known;
	return known < HALL_MAX ? known : HALL_MAX;
}
