/* SPDX-License-Identifier: Apache-2.0 */
/*
 * latency.c - how late the cycle woke, and how long a period took: edmd's own
 * histograms
 *
 * They are read from shared memory, on the machine's own host.
 */
#include "ctl.h"
#include "shm.h"

#include <stdio.h>
#include <stdlib.h>
#include <sysexits.h>
#include <time.h>

#define BINS_MAX	256

_Static_assert(SHM_LATENCY_BINS <= BINS_MAX, "a histogram has room");
_Static_assert(SHM_TOOK_BINS <= BINS_MAX, "a histogram has room");

struct histogram {
	const char *what;		/* of what is counted: "wakes" */
	unsigned int nbins;
	double bin_us;			/* the last bin has all above too */
	const uint32_t *from;
	uint32_t bin[BINS_MAX];
	uint64_t n;
	double min_us, mean_us, max_us;	/* where the bins begin */
	bool above;			/* there are some in the last bin */
};

/* Take what came into the histogram since it was taken last. */
static void take(struct histogram *h)
{
	double sum = 0;

	h->n = 0;
	h->min_us = h->max_us = 0;
	for (unsigned int i = 0; i < h->nbins; i++) {
		h->bin[i] = __atomic_load_n(&h->from[i], __ATOMIC_RELAXED) -
			    h->bin[i];
		if (h->bin[i] == 0)
			continue;
		if (h->n == 0)
			h->min_us = i * h->bin_us;
		h->max_us = i * h->bin_us;
		h->n += h->bin[i];
		sum += (double)h->bin[i] * i * h->bin_us;
	}
	h->above = h->bin[h->nbins - 1] > 0;
	h->mean_us = h->n ? sum / (double)h->n : 0;
}

static void wait_for(double s)
{
	const struct timespec t = {
		.tv_sec = (time_t)s,
		.tv_nsec = (long)((s - (double)(time_t)s) * 1e9),
	};

	nanosleep(&t, NULL);
}

static void print(const struct histogram *h)
{
	for (unsigned int i = 0; i < h->nbins; i++)
		if (h->bin[i])
			printf("%5.7g us%s %10u\n", i * h->bin_us,
			       i == h->nbins - 1 ? "+" : " ", h->bin[i]);
	printf("%s %llu, min %.7g us, mean %.2f us, max %.7g us%s\n", h->what,
	       (unsigned long long)h->n, h->min_us, h->mean_us, h->max_us,
	       h->above ? " or more" : "");
}

static json_t *json_of(const struct histogram *h)
{
	json_t *bins = json_array();

	for (unsigned int i = 0; i < h->nbins; i++)
		json_array_append_new(bins, json_integer(h->bin[i]));
	return json_pack("{sI sf sf sf sf so}", h->what, (json_int_t)h->n,
			 "min_us", h->min_us, "mean_us", h->mean_us, "max_us",
			 h->max_us, "bin_us", h->bin_us, "bins_us", bins);
}

static int print_json(const struct histogram *late,
		      const struct histogram *took)
{
	json_t *all = json_of(late);

	json_object_set_new(all, "took", json_of(took));
	json_dumpf(all, stdout, JSON_COMPACT);
	putchar('\n');
	json_decref(all);
	return EX_OK;
}

/* The period of an edmd that has not published yet is not known. */
static double period_us(const struct shm_status *s)
{
	struct shm_snapshot now;

	return shm_snapshot(s, &now) ? (double)now.period_ns / 1e3 : 0;
}

static int print_both(const struct ctl *c, const struct shm_status *s,
		      double wait_s)
{
	struct histogram late = {
		.what = "wakes", .nbins = SHM_LATENCY_BINS, .bin_us = 1,
		.from = s->latency_us,
	}, took = {
		.what = "periods", .nbins = SHM_TOOK_BINS,
		.bin_us = period_us(s) / SHM_TOOK_PARTS, .from = s->took,
	};

	if (wait_s > 0) {
		for (unsigned int i = 0; i < BINS_MAX; i++) {
			late.bin[i] = late.from[i];
			took.bin[i] = took.from[i];
		}
		wait_for(wait_s);
	}
	take(&late);
	take(&took);
	if (c->json)
		return print_json(&late, &took);
	puts("how late it woke");
	print(&late);
	puts("\nwhat a period took");
	print(&took);
	return EX_OK;
}

int ctl_latency(struct ctl *c)
{
	const struct shm_status *s;
	double wait_s = 0;
	char *end;
	int err;

	if (c->arg) {
		wait_s = strtod(c->arg, &end);
		if (*end || !(wait_s > 0 && wait_s <= 86400)) {
			fprintf(stderr, "edmctl: latency %s; seconds above 0, "
				"at most 86400\n", c->arg);
			return EX_USAGE;
		}
	}
	err = ctl_shm_open(c, &s);
	return err ? err : print_both(c, s, wait_s);
}
