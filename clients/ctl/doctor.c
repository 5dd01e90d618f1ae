/* SPDX-License-Identifier: Apache-2.0 */
/*
 * doctor.c - what this host has and lacks, and the command that helps
 *
 * There is one function for each thing.  It says what it found and judges it.
 * Only --fix changes something.  The limits are those of a living
 * edmd, or else those of this process.
 */
#include "ctl.h"
#include "doctor_rt.h"

#include "shm.h"

#include <arpa/inet.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

#define GROUP		"239.255.76.67"	/* of the default URL */
#define ARPHRD_CAN	280

struct finding {
	enum verdict verdict;
	char found[320];
	const char *mend;		/* BAD only */
};

struct host {
	struct ctl *ctl;
	const struct shm_status *status;	/* NULL: no edmd has run here */
	bool alive;
	char limits[64];		/* the file of the limits, and whose
					 * they are */
};

static void say(struct finding *f, enum verdict v, const char *found,
		const char *mend)
{
	f->verdict = v;
	snprintf(f->found, sizeof(f->found), "%s", found);
	f->mend = v == BAD ? mend : "";
}

/* The first line of a file; empty if there is no such file. */
static void line_of(const char *path, char *to, int size)
{
	FILE *f = fopen(path, "re");

	to[0] = '\0';
	if (!f)
		return;
	if (!fgets(to, size, f))
		to[0] = '\0';
	to[strcspn(to, "\n")] = '\0';
	fclose(f);
}

static void look_kernel(const struct host *h, struct finding *f)
{
	struct utsname u;
	char flag[8];

	(void)h;
	uname(&u);
	line_of("/sys/kernel/realtime", flag, sizeof(flag));
	say(f, strcmp(flag, "1") == 0 || strstr(u.version, "PREEMPT_RT") ?
	    GOOD : BAD, u.version,
	    "apt-get install linux-image-rt-amd64, and boot it");
}

static void look_rt(const struct host *h, struct finding *f,
		    doctor_rt_fn *look, const char *mend)
{
	const struct doctor_rt d = {
		.root = "", .pid = h->alive ? h->status->head.pid : 0,
	};

	f->verdict = look(&d, f->found, sizeof(f->found));
	f->mend = f->verdict == BAD ? mend : "";
}

static void look_core(const struct host *h, struct finding *f)
{
	look_rt(h, f, doctor_rt_core,
		"boot with isolcpus=N nohz_full=N rcu_nocbs=N, and [machine] "
		"cpu = N; another N for [gpio] edges_cpu");
}

static void look_governor(const struct host *h, struct finding *f)
{
	look_rt(h, f, doctor_rt_governor,
		"cpupower -c N frequency-set -g performance");
}

static void look_throttle(const struct host *h, struct finding *f)
{
	look_rt(h, f, doctor_rt_throttle,
		"sysctl -w kernel.sched_rt_runtime_us=-1");
}

static void look_irqs(const struct host *h, struct finding *f)
{
	look_rt(h, f, doctor_rt_irqs,
		"chrt -f -p N PID of this thread, N above the others' and "
		"below edmd-cycle's; and another core than edmd's");
}

/* The soft limit, from its column of /proc/PID/limits. */
static void limit_of(const struct host *h, const char *name, char to[32])
{
	FILE *f = fopen(h->limits, "re");
	char text[160];

	snprintf(to, 32, "?");
	while (f && fgets(text, sizeof(text), f))
		if (strncmp(text, name, strlen(name)) == 0)
			sscanf(text + strlen(name), " %31s", to);
	if (f)
		fclose(f);
}

static void look_limit(const struct host *h, struct finding *f,
		       const char *name, const char *mend)
{
	char value[32], found[96];
	bool enough;

	limit_of(h, name, value);
	enough = strcmp(value, "unlimited") == 0 ||
		 (strcmp(name, "Max realtime priority") == 0 &&
		  strtol(value, NULL, 10) >= 80);
	snprintf(found, sizeof(found), "%s, of %s", value,
		 h->alive ? "edmd" : "this shell");
	say(f, enough ? GOOD : BAD, found, mend);
}

static void look_memory(const struct host *h, struct finding *f)
{
	look_limit(h, f, "Max locked memory",
		   "ulimit -l unlimited, or LimitMEMLOCK=infinity in "
		   "edmd.service");
}

static void look_priority(const struct host *h, struct finding *f)
{
	look_limit(h, f, "Max realtime priority",
		   "ulimit -r 99, or LimitRTPRIO=99 in edmd.service");
}

/* Find the interface by which a packet to the group leaves. */
static bool route_find(char interface[16])
{
	const uint32_t group = inet_addr(GROUP);
	FILE *f = fopen("/proc/net/route", "re");
	unsigned int to, mask;
	char text[256];
	bool found = false;

	while (f && !found && fgets(text, sizeof(text), f))
		found = sscanf(text, "%15s %x %*x %*x %*d %*d %*d %x",
			       interface, &to, &mask) == 3 &&
			(group & mask) == to;
	if (f)
		fclose(f);
	return found;
}

static void look_route(const struct host *h, struct finding *f)
{
	char interface[16] = "";
	bool there = route_find(interface);

	(void)h;
	/* Clients of this host do without. */
	say(f, there ? GOOD : UNUSED, there ? interface : "no way to " GROUP,
	    "ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo");
}

static void look_gpio(const struct host *h, struct finding *f)
{
	char found[sizeof(f->found)] = "";
	size_t n = 0;
	bool shut = false;
	glob_t g;

	(void)h;
	if (glob("/dev/gpiochip*", 0, NULL, &g) != 0) {
		say(f, UNUSED, "no /dev/gpiochip*", "");
		return;
	}
	for (size_t i = 0; i < g.gl_pathc && n < sizeof(found); i++) {
		const bool ok = access(g.gl_pathv[i], R_OK | W_OK) == 0;

		shut = shut || !ok;
		n += (size_t)snprintf(found + n, sizeof(found) - n, "%s%s%s",
				      i ? ", " : "", g.gl_pathv[i],
				      ok ? "" : " not permitted");
	}
	globfree(&g);
	say(f, shut ? BAD : GOOD, found,
	    "install systemd/edmd.rules as a udev rule, usermod -aG edm USER");
}

static bool is_can(const char *folder)
{
	char path[300], type[16];

	snprintf(path, sizeof(path), "%s/type", folder);
	line_of(path, type, sizeof(type));
	return strtol(type, NULL, 10) == ARPHRD_CAN;
}

static void look_can(const struct host *h, struct finding *f)
{
	char found[sizeof(f->found)] = "", path[300], state[16];
	size_t n = 0;
	bool down = false;
	glob_t g;

	(void)h;
	if (glob("/sys/class/net/*", 0, NULL, &g) != 0)
		g.gl_pathc = 0;
	for (size_t i = 0; i < g.gl_pathc && n < sizeof(found); i++) {
		if (!is_can(g.gl_pathv[i]))
			continue;
		snprintf(path, sizeof(path), "%s/operstate", g.gl_pathv[i]);
		line_of(path, state, sizeof(state));
		down = down || strcmp(state, "down") == 0;
		n += (size_t)snprintf(found + n, sizeof(found) - n, "%s%s %s",
				      n ? ", " : "",
				      strrchr(g.gl_pathv[i], '/') + 1, state);
	}
	globfree(&g);
	say(f, n == 0 ? UNUSED : down ? BAD : GOOD,
	    n ? found : "no CAN interface",
	    "ip link set can0 up type can bitrate 1000000");
}

static void look_objects(const struct host *h, struct finding *f)
{
	char found[sizeof(f->found)], path[SHM_PATH_MAX];

	shm_path(path, h->ctl->machine, "status");
	snprintf(found, sizeof(found), "%s %s", path, h->status ? "is there" :
		 "is not there, or not for this user");
	say(f, h->status ? GOOD : BAD, found,
	    "systemctl start edmd; usermod -aG edm USER");
}

static void look_edmd(const struct host *h, struct finding *f)
{
	char found[sizeof(f->found)] = "not running";
	struct shm_snapshot s;

	if (h->alive)
		snprintf(found, sizeof(found), "pid %d", h->status->head.pid);
	if (h->alive && shm_snapshot(h->status, &s))
		snprintf(found, sizeof(found), "pid %d, %s, period %g us, "
			 "woken late by %g us at most", h->status->head.pid,
			 shm_state_name(s.state), (double)s.period_ns / 1e3,
			 (double)s.wake_late_max_ns / 1e3);
	say(f, h->alive ? GOOD : BAD, found, "systemctl start edmd");
}

static void look_jobs(const struct host *h, struct finding *f)
{
	const bool heard = h->ctl->talk && ctl_first_status(h->ctl);

	say(f, heard ? GOOD : BAD, heard ? "its STATUS is heard" :
	    "no STATUS is heard", "systemctl start edmd-jobs");
}

static void look_store(const struct host *h, struct finding *f)
{
	const struct talk_question q = { .verb = "store" };
	const char *path = "?", *why = "";
	json_int_t bytes = 0, jobs = 0, kept = 0;
	struct talk_answer a;
	char found[160];
	json_t *j;

	uint64_t heard;

	if (!h->ctl->talk || !talk_status(h->ctl->talk, &heard) ||
	    talk_ask(h->ctl->talk, &q, h->ctl->timeout_s, &a) < 0) {
		say(f, UNUSED, "edmd-jobs does not answer", "");
		return;
	}
	j = json_loads(a.body ? a.body : "", 0, NULL);
	json_unpack(j, "{s:s,s:s,s:I,s:I,s:I}", "path", &path, "why", &why,
		    "bytes", &bytes, "jobs", &jobs, "kept", &kept);
	snprintf(found, sizeof(found), "%.80s: %.1f MB, %lld jobs", path,
		 (double)bytes / 1e6, (long long)jobs);
	if (*why)
		snprintf(found, sizeof(found), "degraded: %.60s; %lld entries "
			 "wait in memory", why, (long long)kept);
	say(f, *why ? BAD : GOOD, found, "make room on the disk of [jobs] "
	    "store, or mend it; nothing else needs to be done");
	json_decref(j);
	talk_answer_free(&a);
}

static void look_place(const struct host *h, struct finding *f)
{
	const struct talk_question q = { .verb = "store" };
	json_int_t writes = 0, bytes = 0, slowest_us = 0;
	struct talk_answer a;
	const char *why = "";
	char found[160];
	uint64_t heard;
	json_t *j;

	if (!h->ctl->talk || !talk_status(h->ctl->talk, &heard) ||
	    talk_ask(h->ctl->talk, &q, h->ctl->timeout_s, &a) < 0) {
		say(f, UNUSED, "edmd-jobs does not answer", "");
		return;
	}
	j = json_loads(a.body ? a.body : "", 0, NULL);
	json_unpack(j, "{s:I,s:I,s:I,s:s}", "place_writes", &writes,
		    "place_bytes", &bytes, "place_slowest_us", &slowest_us,
		    "place_why", &why);
	snprintf(found, sizeof(found), "%lld written since the start, %.3f MB, "
		 "the slowest took %.1f ms", (long long)writes,
		 (double)bytes / 1e6, (double)slowest_us / 1e3);
	if (*why)
		snprintf(found, sizeof(found), "cannot be written: %.80s", why);
	say(f, *why ? BAD : GOOD, found, "mend the disk of [jobs] store: "
	    "until then a job cannot be found again after a power cut");
	json_decref(j);
	talk_answer_free(&a);
}

/* clang-format off */
static const struct {
	const char *what;
	void (*look)(const struct host *h, struct finding *f);
} things[] = {
	{ "kernel",		look_kernel },
	{ "isolated core",	look_core },
	{ "governor",		look_governor },
	{ "throttling",		look_throttle },
	{ "interrupts",		look_irqs },
	{ "memory lock",	look_memory },
	{ "priority",		look_priority },
	{ "multicast route",	look_route },
	{ "GPIO",		look_gpio },
	{ "CAN",		look_can },
	{ "shared memory",	look_objects },
	{ "edmd",		look_edmd },
	{ "edmd-jobs",		look_jobs },
	{ "store",		look_store },
	{ "checkpoint",		look_place },
};
/* clang-format on */

#define NTHINGS		(sizeof(things) / sizeof(things[0]))

static const char *const verdicts[] = {
	[GOOD] = "good", [UNUSED] = "unused", [BAD] = "lacking",
};

static void print_text(const char *what, const struct finding *f)
{
	printf("%-16s %-8s %s\n", what, verdicts[f->verdict], f->found);
	if (f->verdict == BAD)
		printf("%-16s %-8s %s\n", "", "  mend:", f->mend);
}

static void print_json(const char *what, const struct finding *f,
		       json_t *rows)
{
	json_array_append_new(rows, json_pack("{s:s,s:s,s:s,s:s}", "what",
		what, "verdict", verdicts[f->verdict], "found", f->found,
		"mend", f->mend));
}

static void meet(struct host *h)
{
	if (shm_status_open(&h->status, h->ctl->machine) < 0)
		h->status = NULL;
	h->alive = h->status && shm_alive(h->status);
	snprintf(h->limits, sizeof(h->limits), "/proc/self/limits");
	if (h->alive)
		snprintf(h->limits, sizeof(h->limits), "/proc/%d/limits",
			 h->status->head.pid);
}

int ctl_doctor(struct ctl *c)
{
	struct host h = { .ctl = c };
	json_t *rows = json_array();
	int lacking = 0;

	if (c->pulses || c->fix) {
		json_decref(rows);
		return c->pulses ? ctl_pulses(c->pulses) :
		       doctor_fix(&(struct doctor_fix) { c->fix, c->root });
	}
	meet(&h);
	for (size_t i = 0; i < NTHINGS; i++) {
		struct finding f;

		things[i].look(&h, &f);
		lacking += f.verdict == BAD;
		if (c->json)
			print_json(things[i].what, &f, rows);
		else
			print_text(things[i].what, &f);
	}
	if (c->json) {
		json_dumpf(rows, stdout, JSON_PRESERVE_ORDER);
		putchar('\n');
	}
	json_decref(rows);
	shm_close(h.status, sizeof(*h.status));
	return lacking > 0;
}
