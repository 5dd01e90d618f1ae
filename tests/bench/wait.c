/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wait.c - what waiting alone costs: a thread that is set up as edmd's cycle
 * is, waits as it does, and does nothing else
 *
 *	build/bench/wait PERIOD_US PERIODS
 */
#include "bench.h"

#include "clock.h"
#include "rt.h"

int main(int argc, char **argv)
{
	const struct setup_wanted wanted = { .cpu = -1, .priority = 80 };
	const int periods = argc == 3 ? atoi(argv[2]) : 0;
	struct setup_report report = { .item = { { .what = NULL } } };
	struct setup_clock clock;
	struct timespec t;

	if (periods < 1 || atoi(argv[1]) < 1)
		return 64;
	setup_process(&report);
	setup_thread(&report, &wanted);
	setup_clock_start(&clock, atoi(argv[1]) * 1000LL);
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	const double from_s = (double)t.tv_sec + (double)t.tv_nsec * 1e-9;

	for (int n = 0; n < periods; n++)
		setup_clock_wait(&clock);
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	bench_say("wait_us", ((double)t.tv_sec + (double)t.tv_nsec * 1e-9 -
			      from_s) * 1e6 / periods);
	return 0;
}
