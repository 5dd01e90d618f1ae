/* SPDX-License-Identifier: Apache-2.0 */
/*
 * latency.c - how late the cycle woke: edmd's own histogram
 *
 * It is read from shared memory, on the machine's own host.
 */
#include "ctl.h"
#include "shm.h"

#include <stdio.h>
#include <stdlib.h>
#include <sysexits.h>
#include <time.h>

struct latency {
	uint32_t bin[SHM_LATENCY_BINS];	/* of 1 us; the last: all above */
	uint64_t wakes;
	unsigned int min_us, max_us;
	double mean_us;
};

/* Take the histogram minus what was in it @before; NULL: all of it. */
static void take(const struct shm_status *s, const uint32_t *before,
		 struct latency *ret)
{
	double sum = 0;

	*ret = (struct latency) { .wakes = 0 };
	for (unsigned int i = 0; i < SHM_LATENCY_BINS; i++) {
		uint32_t n = __atomic_load_n(&s->latency_us[i],
					     __ATOMIC_RELAXED);

		n -= before ? before[i] : 0;
		ret->bin[i] = n;
		if (n == 0)
			continue;
		if (ret->wakes == 0)
			ret->min_us = i;
		ret->max_us = i;
		ret->wakes += n;
		sum += (double)n * i;
	}
	ret->mean_us = ret->wakes ? sum / (double)ret->wakes : 0;
}

static void wait_for(double s)
{
	const struct timespec t = {
		.tv_sec = (time_t)s,
		.tv_nsec = (long)((s - (double)(time_t)s) * 1e9),
	};

	nanosleep(&t, NULL);
}

static void print(const struct latency *l)
{
	for (unsigned int i = 0; i < SHM_LATENCY_BINS; i++)
		if (l->bin[i])
			printf("%5u us%s %10u\n", i,
			       i == SHM_LATENCY_BINS - 1 ? "+" : " ",
			       l->bin[i]);
	printf("wakes %llu, min %u us, mean %.2f us, max %u us%s\n",
	       (unsigned long long)l->wakes, l->min_us, l->mean_us, l->max_us,
	       l->max_us == SHM_LATENCY_BINS - 1 ? " or more" : "");
}

static void print_json(const struct latency *l)
{
	json_t *bins = json_array();

	for (unsigned int i = 0; i < SHM_LATENCY_BINS; i++)
		json_array_append_new(bins, json_integer(l->bin[i]));
	json_t *all = json_pack("{sI si sf si so}", "wakes",
				(json_int_t)l->wakes, "min_us",
				(int)l->min_us, "mean_us", l->mean_us,
				"max_us", (int)l->max_us, "bins_us", bins);

	json_dumpf(all, stdout, JSON_COMPACT);
	putchar('\n');
	json_decref(all);
}

int ctl_latency(struct ctl *c)
{
	const struct shm_status *s;
	struct latency before, l;
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
	if (err)
		return err;
	take(s, NULL, &before);
	if (c->arg) {
		wait_for(wait_s);
		take(s, before.bin, &l);
	} else {
		l = before;
	}
	if (c->json)
		print_json(&l);
	else
		print(&l);
	return EX_OK;
}
