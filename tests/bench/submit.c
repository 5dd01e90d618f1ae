/* SPDX-License-Identifier: Apache-2.0 */
/*
 * submit.c - the time from `edmctl submit` to the first pulse of the job
 *
 * It starts both daemons on the simulated machine, sends a short job a few
 * times, and asks the trace ring in which cycle an axis first moved.  Run it
 * inside a network namespace (tests/netns), from the top folder.
 */
#include "shm.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define RUNS	7

static char machine[32];
static const char *build;

static int64_t now_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_REALTIME, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

static void nap(void)
{
	nanosleep(&(struct timespec) { 0, 200000 }, NULL);
}

static pid_t start(const char *program, char *const argv[])
{
	char path[256];
	const pid_t pid = fork();

	if (pid != 0)
		return pid;
	snprintf(path, sizeof(path), "%s/%s", build, program);
	if (!freopen("/dev/null", "w", stdout) ||
	    !freopen("/dev/null", "w", stderr))
		_exit(70);
	execv(path, argv);
	_exit(70);
}

static bool moved(const struct shm_trace *t, const struct shm_trace *was)
{
	return memcmp(t->pos, was->pos, sizeof(t->pos)) != 0;
}

/* Wall time of the first record whose position differs; 0 after 5 s. */
static int64_t first_pulse_ns(const struct shm_status *s, struct shm_follow *f)
{
	const int64_t until = now_ns() + INT64_C(5000000000);
	struct shm_trace t, was = { 0 };
	struct shm_snapshot snap;
	bool any = false;

	while (now_ns() < until) {
		if (!shm_trace_next(s, f, &t)) {
			nap();
			continue;
		}
		if (any && moved(&t, &was) && shm_snapshot(s, &snap))
			return snap.time_ns - (int64_t)(snap.cycle - t.cycle) *
			       snap.period_ns;
		was = t;
		any = true;
	}
	return 0;
}

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void wait_idle(const struct shm_status *s)
{
	struct shm_snapshot snap;

	for (int i = 0; i < 25000; i++) {
		if (shm_snapshot(s, &snap) && snap.state == SHM_IDLE &&
		    snap.program == 0)
			return;
		nap();
	}
}

static double one(const struct shm_status *s, const char *job)
{
	char *const argv[] = { "edmctl", "--machine", machine, "submit",
			       (char *)job, NULL };
	struct shm_follow f = { .next = s->trace_next };
	const int64_t from = now_ns();
	const pid_t pid = start("edmctl", argv);
	const int64_t at = first_pulse_ns(s, &f);

	waitpid(pid, NULL, 0);
	wait_idle(s);
	return at ? (double)(at - from) * 1e-6 : -1;
}

static int measure(const char *job)
{
	const struct shm_status *s = NULL;
	double ms[RUNS];

	for (int i = 0; i < 5000 && shm_status_open(&s, machine) < 0; i++)
		nap();
	if (!s)
		return 1;
	sleep(1);
	for (int i = 0; i < RUNS; i++)
		ms[i] = one(s, job);
	if (getenv("BENCH_VERBOSE"))
		for (int i = 0; i < RUNS; i++)
			fprintf(stderr, "%.1f\n", ms[i]);
	qsort(ms, RUNS, sizeof(ms[0]), by_value);
	printf("submit to first pulse   median %.1f ms, %.1f to %.1f of %d\n",
	       ms[RUNS / 2], ms[0], ms[RUNS - 1], RUNS);
	return ms[0] < 0;
}

static void end(pid_t pid)
{
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
}

int main(void)
{
	char dir[] = "/tmp/edmd-bench-XXXXXX", job[64], ini[64], cmd[128];
	char *const edmd[] = {
		"edmd", "--config", ini, "--name", machine, NULL
	};
	char *const jobs[] = { "edmd-jobs", "--config", ini, "--name", machine,
			       "--store", dir, NULL };
	pid_t a, b;
	FILE *f;
	int r;

	build = getenv("EDM_BUILD") ? getenv("EDM_BUILD") : "build";
	snprintf(machine, sizeof(machine), "bench-%d", (int)getpid());
	if (!mkdtemp(dir))
		return 1;
	snprintf(job, sizeof(job), "%s/job.ngc", dir);
	snprintf(ini, sizeof(ini), "%s/machine.ini", dir);
	f = fopen(job, "w");
	fputs("G0 X0.05\nX0\nM2\n", f);
	fclose(f);
	f = fopen(ini, "w");
	fputs("[machine]\noverrun_limit = 0\n", f);
	fclose(f);
	a = start("edmd", edmd);
	b = start("edmd-jobs", jobs);
	r = measure(job);
	end(b);
	end(a);
	snprintf(cmd, sizeof(cmd), "rm -rf %s", dir);
	return system(cmd) != 0 || r;
}
