/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_doctor_rt.c - what edmctl doctor finds on a host that is a folder
 */
#include "doctor_rt.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#define PID	4711

static char root[] = "/tmp/test_doctor.XXXXXX";

static int make_root(void **state)
{
	(void)state;
	return mkdtemp(root) ? 0 : -1;
}

static int remove_root(void **state)
{
	char command[64];

	(void)state;
	snprintf(command, sizeof(command), "rm -r %s", root);
	return system(command);
}

static void put(const char *path, const char *text)
{
	char whole[200];
	FILE *f;

	snprintf(whole, sizeof(whole), "%s%s", root, path);
	for (char *at = whole + strlen(root) + 1; (at = strchr(at, '/'));
	     at++) {
		*at = '\0';
		mkdir(whole, 0700);
		*at = '/';
	}
	f = fopen(whole, "w");
	assert_non_null(f);
	fputs(text, f);
	fclose(f);
}

/* As proc(5) has it: the priority is field 40. */
static void thread(const char *folder, const char *name, const char *cores,
		   int priority)
{
	char path[160], text[300];

	snprintf(path, sizeof(path), "%s/comm", folder);
	snprintf(text, sizeof(text), "%s\n", name);
	put(path, text);
	snprintf(path, sizeof(path), "%s/status", folder);
	snprintf(text, sizeof(text), "Name:\tx\nCpus_allowed:\tff\n"
		 "Cpus_allowed_list:\t%s\nMems:\t1\n", cores);
	put(path, text);
	snprintf(path, sizeof(path), "%s/stat", folder);
	snprintf(text, sizeof(text), "1 (a b) c) S 1 2 3 4 5 6 7 8 9 10 11 12 "
		 "13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32 "
		 "33 34 35 36 %d 1 0\n", priority);
	put(path, text);
}

#define TASK	"/proc/4711/task"

static void host(const char *isolated, const char *cycle, const char *edges)
{
	put("/sys/devices/system/cpu/isolated", isolated);
	thread(TASK "/4711", "edmd", "0-3", 0);
	thread(TASK "/4712", "edmd-cycle", cycle, 80);
	thread(TASK "/4713", "edmd-edges", edges, 79);
}

static enum verdict look(doctor_rt_fn *fn, const char *part)
{
	const struct doctor_rt d = { root, PID };
	char found[320];
	const enum verdict v = fn(&d, found, sizeof(found));

	if (!strstr(found, part))
		fail_msg("'%s' has no '%s'", found, part);
	return v;
}

static void the_cores_in_use_are_judged(void **state)
{
	static const struct {
		const char *isolated, *cycle, *edges;
		enum verdict v;
	} rows[] = {
		{ "2-3\n", "3", "2", GOOD },
		{ "2-3\n", "3", "3", BAD },	/* one core for both */
		{ "2-3\n", "2-3", "1", BAD },	/* not its own */
		{ "2\n", "3", "2", BAD },	/* another one is isolated */
		{ "2-3\n", "3", "1", BAD },	/* the edges' is not */
		{ "\n", "3", "2", BAD },
		{ "1,3\n", "3", "1", GOOD },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		host(rows[i].isolated, rows[i].cycle, rows[i].edges);
		assert_int_equal(look(doctor_rt_core, "edmd-cycle may run on"),
				 rows[i].v);
	}
}

static void the_governor_of_these_cores_is_judged(void **state)
{
	(void)state;
	host("2-3\n", "3", "2");
	assert_int_equal(look(doctor_rt_governor, "no steps of frequency"),
			 UNUSED);
	put("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor",
	    "powersave\n");
	put("/sys/devices/system/cpu/cpu3/cpufreq/scaling_governor",
	    "performance\n");
	assert_int_equal(look(doctor_rt_governor, "core 3 performance"), GOOD);
	put("/sys/devices/system/cpu/cpu2/cpufreq/scaling_governor",
	    "schedutil\n");
	assert_int_equal(look(doctor_rt_governor, "core 2 schedutil"), BAD);
}

static void throttled_threads_are_told(void **state)
{
	(void)state;
	put("/proc/sys/kernel/sched_rt_period_us", "1000000\n");
	put("/proc/sys/kernel/sched_rt_runtime_us", "950000\n");
	assert_int_equal(look(doctor_rt_throttle, "950000 of 1000000"), BAD);
	put("/proc/sys/kernel/sched_rt_runtime_us", "-1\n");
	assert_int_equal(look(doctor_rt_throttle, "never"), GOOD);
}

static void interrupts_of_the_bus_are_above_those_of_others(void **st)
{
	static const struct {
		const char *cores;
		int priority;
		enum verdict v;
	} rows[] = {
		{ "0-1", 50, BAD },		/* as every other one */
		{ "0-1", 70, GOOD },
		{ "0-3", 70, GOOD },		/* below the cycle */
		{ "0-3", 90, BAD },		/* interrupts the cycle */
		{ "0-1", 90, GOOD },
	};

	(void)st;
	host("2-3\n", "3", "2");
	thread("/proc/60", "irq/16-nvme0q1", "0-3", 50);
	assert_int_equal(look(doctor_rt_irqs, "no thread of an interrupt"),
			 UNUSED);
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		thread("/proc/61", "irq/55-can0", rows[i].cores,
		       rows[i].priority);
		assert_int_equal(look(doctor_rt_irqs, "irq/55-can0 at"),
				 rows[i].v);
	}
	thread("/proc/62", "irq/90-pinctrl-", "0-1", 50);
	assert_int_equal(look(doctor_rt_irqs, "pinctrl"), BAD);
}

static void without_edmd_there_is_nothing_to_judge(void **state)
{
	const struct doctor_rt d = { root, 0 };
	char found[320];

	(void)state;
	put("/sys/devices/system/cpu/isolated", "2-3\n");
	assert_int_equal(doctor_rt_governor(&d, found, sizeof(found)),
			 UNUSED);
	assert_int_equal(doctor_rt_irqs(&d, found, sizeof(found)), UNUSED);
	assert_int_equal(doctor_rt_core(&d, found, sizeof(found)), GOOD);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_cores_in_use_are_judged),
		cmocka_unit_test(the_governor_of_these_cores_is_judged),
		cmocka_unit_test(throttled_threads_are_told),
		cmocka_unit_test(
			interrupts_of_the_bus_are_above_those_of_others),
		cmocka_unit_test(without_edmd_there_is_nothing_to_judge),
	};

	return cmocka_run_group_tests(tests, make_root, remove_root);
}
