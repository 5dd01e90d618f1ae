/* SPDX-License-Identifier: Apache-2.0 */
/*
 * gpio.c - step pulses a second through libgpiod, period by period with no
 * sleep
 *
 *	gpio CHIP	lines 0 and 1 of it are step and direction of X
 */
#include "bench.h"

#include "config.h"
#include "interp/diag.h"
#include "io.h"

#include <string.h>

#define RUN_S	0.5

/* A pulse up, then one down; what the cycle itself takes is not in it. */
static double pulses_s(const struct io_machine *m)
{
	const double from_s = bench_now_s();
	struct io_outputs out = { .path = 1 };
	struct io_inputs in;
	double took_s;

	do {
		for (int n = 0; n < 100; n++) {
			m->read(m->self, &in);
			out.target[0] += !in.busy;
			m->write(m->self, &out);
		}
		took_s = bench_now_s() - from_s;
	} while (took_s < RUN_S && !in.lost);
	return in.lost ? 0 : in.actual[0] / took_s;
}

int main(int argc, char **argv)
{
	static struct machine_config c;
	double runs[BENCH_RUNS];
	struct interp_diag diag;
	struct io_machine m;

	if (argc != 2)
		return 64;
	config_defaults(&c);
	snprintf(c.gpio.chip, sizeof(c.gpio.chip), "%s", argv[1]);
	strcpy(c.gpio.line[LINE_STEP], "0");
	strcpy(c.gpio.line[LINE_DIR], "1");
	if (io_gpio_open(&m, &c, &diag) < 0) {
		fprintf(stderr, "gpio: %s; %s\n", diag.found, diag.wanted);
		return 69;
	}
	for (int i = 0; i < BENCH_RUNS; i++)
		runs[i] = pulses_s(&m);
	m.close(m.self);
	bench_say("pulses_s", bench_median(runs, BENCH_RUNS));
	return 0;
}
