/* SPDX-License-Identifier: Apache-2.0 */
/*
 * doctor_rt.c - what a host does with the real-time threads of a living edmd
 *
 * The core that counts is the one that a thread may really run on, whatever
 * the machine file says: /proc/PID/task/TID.
 */
#include "doctor_rt.h"

#include <dirent.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CORES_MAX	1024
#define PATH_ROOM	300

struct cores {
	uint64_t word[CORES_MAX / 64];
};

struct rt_thread {
	char name[32];
	struct cores on;
	char list[64];			/* the same in words: "2-3,5" */
	int priority;			/* SCHED_FIFO or SCHED_RR; 0: neither */
};

/* A text for a person, in pieces. */
struct said {
	char *to;
	size_t size, n;
};

static __attribute__((format(printf, 2, 3))) void
say(struct said *s, const char *text, ...)
{
	va_list args;
	int n;

	va_start(args, text);
	n = vsnprintf(s->to + s->n, s->size - s->n, text, args);
	va_end(args);
	s->n += (size_t)n;
	if (s->n >= s->size)
		s->n = s->size - 1;
}

static bool has_core(const struct cores *c, long core)
{
	return core >= 0 && core < CORES_MAX &&
	       c->word[core / 64] >> core % 64 & 1;
}

static void cores_read(const char *list, struct cores *ret)
{
	char *end;

	*ret = (struct cores) { .word = { 0 } };
	for (const char *at = list; *at; at = *end == ',' ? end + 1 : end) {
		const long from = strtol(at, &end, 10);
		long to = from;

		if (end == at)
			return;
		if (*end == '-')
			to = strtol(end + 1, &end, 10);
		for (long i = from; i <= to && i >= 0 && i < CORES_MAX; i++)
			ret->word[i / 64] |= 1ull << i % 64;
	}
}

static int cores_count(const struct cores *c)
{
	int n = 0;

	for (int i = 0; i < CORES_MAX / 64; i++)
		n += __builtin_popcountll(c->word[i]);
	return n;
}

static bool cores_within(const struct cores *c, const struct cores *of)
{
	for (int i = 0; i < CORES_MAX / 64; i++)
		if (c->word[i] & ~of->word[i])
			return false;
	return true;
}

static bool cores_meet(const struct cores *a, const struct cores *b)
{
	for (int i = 0; i < CORES_MAX / 64; i++)
		if (a->word[i] & b->word[i])
			return true;
	return false;
}

/* The first line of a file; empty if there is none. */
static void line_of(const char *path, char *to, int size)
{
	FILE *f = fopen(path, "re");

	to[0] = '\0';
	if (f && !fgets(to, size, f))
		to[0] = '\0';
	to[strcspn(to, "\n")] = '\0';
	if (f)
		fclose(f);
}

static void value_of(const char *path, const char *key, char *to, size_t size)
{
	FILE *f = fopen(path, "re");
	char text[512];
	const size_t n = strlen(key);

	to[0] = '\0';
	while (f && fgets(text, sizeof(text), f))
		if (strncmp(text, key, n) == 0)
			snprintf(to, size, "%.*s",
				 (int)strcspn(text + n, "\n"), text + n);
	if (f)
		fclose(f);
}

/* Behind the name, which may have blanks, it is field 40 of proc(5). */
static int priority_of(const char *folder)
{
	char path[PATH_ROOM + 16], text[1024];
	const char *at;

	snprintf(path, sizeof(path), "%s/stat", folder);
	line_of(path, text, sizeof(text));
	at = strrchr(text, ')');
	for (int field = 2; at && field < 40; field++)
		at = strchr(at + 1, ' ');
	return at ? (int)strtol(at, NULL, 10) : 0;
}

static void thread_read(const char *folder, struct rt_thread *ret)
{
	char path[PATH_ROOM + 16], list[64];

	*ret = (struct rt_thread) { .priority = priority_of(folder) };
	snprintf(path, sizeof(path), "%s/comm", folder);
	line_of(path, ret->name, sizeof(ret->name));
	snprintf(path, sizeof(path), "%s/status", folder);
	value_of(path, "Cpus_allowed_list:", list, sizeof(list));
	snprintf(ret->list, sizeof(ret->list), "%s",
		 list + strspn(list, " \t"));
	cores_read(ret->list, &ret->on);
}

/* All in a folder of /proc whose name is a number, one after another. */
static bool thread_next(DIR *d, const char *folder, struct rt_thread *ret)
{
	char path[PATH_ROOM];
	struct dirent *e;

	while (d && (e = readdir(d))) {
		if (e->d_name[0] < '0' || e->d_name[0] > '9')
			continue;
		snprintf(path, sizeof(path), "%s/%.20s", folder, e->d_name);
		thread_read(path, ret);
		return true;
	}
	return false;
}

static bool is_timed(const struct rt_thread *t)
{
	return strcmp(t->name, "edmd-cycle") == 0 ||
	       strcmp(t->name, "edmd-edges") == 0;
}

/* The threads of edmd whose time counts, at most two. */
static int timed_threads(const struct doctor_rt *d, struct rt_thread ret[2])
{
	char folder[PATH_ROOM];
	struct rt_thread t;
	int n = 0;
	DIR *tasks;

	snprintf(folder, sizeof(folder), "%s/proc/%d/task", d->root, d->pid);
	tasks = d->pid > 0 ? opendir(folder) : NULL;
	while (n < 2 && thread_next(tasks, folder, &t))
		if (is_timed(&t))
			ret[n++] = t;
	if (tasks)
		closedir(tasks);
	return n;
}

static void file_of(const struct doctor_rt *d, const char *path, char *to,
		    int size)
{
	char whole[PATH_ROOM];

	snprintf(whole, sizeof(whole), "%s%s", d->root, path);
	line_of(whole, to, size);
}

enum verdict doctor_rt_core(const struct doctor_rt *d, char *found,
			    size_t size)
{
	struct said s = { found, size, 0 };
	struct rt_thread t[2];
	struct cores isolated;
	char list[128];
	const int n = timed_threads(d, t);
	bool good = true;

	file_of(d, "/sys/devices/system/cpu/isolated", list, sizeof(list));
	cores_read(list, &isolated);
	for (int i = 0; i < n; i++) {
		say(&s, "%s may run on %s; ", t[i].name, t[i].list);
		good = good && cores_count(&t[i].on) == 1 &&
		       cores_within(&t[i].on, &isolated);
	}
	good = good && !(n == 2 && cores_meet(&t[0].on, &t[1].on));
	say(&s, "isolated: %s", *list ? list : "none");
	return good && *list ? GOOD : BAD;
}

enum verdict doctor_rt_governor(const struct doctor_rt *d, char *found,
				size_t size)
{
	struct said s = { found, size, 0 };
	struct rt_thread t[2];
	char path[80], word[32];
	const int n = timed_threads(d, t);
	enum verdict v = UNUSED;

	for (int core = 0; core < CORES_MAX; core++) {
		if (!(n > 0 && has_core(&t[0].on, core)) &&
		    !(n > 1 && has_core(&t[1].on, core)))
			continue;
		snprintf(path, sizeof(path), "/sys/devices/system/cpu/cpu%d/"
			 "cpufreq/scaling_governor", core);
		file_of(d, path, word, sizeof(word));
		if (!*word)
			continue;
		say(&s, "%score %d %s", s.n ? ", " : "", core, word);
		v = v == BAD || strcmp(word, "performance") ? BAD : GOOD;
	}
	if (s.n == 0)
		say(&s, n ? "its cores have no steps of frequency" :
		    "edmd does not run");
	return v;
}

enum verdict doctor_rt_throttle(const struct doctor_rt *d, char *found,
				size_t size)
{
	struct said s = { found, size, 0 };
	char runtime[32], period[32];

	file_of(d, "/proc/sys/kernel/sched_rt_runtime_us", runtime,
		sizeof(runtime));
	file_of(d, "/proc/sys/kernel/sched_rt_period_us", period,
		sizeof(period));
	if (!*runtime || strcmp(runtime, "-1") == 0) {
		say(&s, "never");
		return GOOD;
	}
	say(&s, "after %s of %s us: a thread that never sleeps, as "
	    "edges_per_period makes one, then stands", runtime, period);
	return BAD;
}

/* Of a bus or of lines, by what drivers call their interrupts. */
static bool is_ours(const char *name)
{
	static const char *const words[] = {
		"can", "mcp25", "spi", "gpio", "pinctrl", "edmd",
	};

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (strstr(name, words[i]))
			return true;
	return false;
}

/* One that may interrupt the cycle, or wait for what others have to do. */
static bool irq_is_bad(const struct rt_thread *irq, int others,
		       const struct rt_thread *timed, int n)
{
	for (int i = 0; i < n; i++)
		if (irq->priority >= timed[i].priority &&
		    cores_meet(&irq->on, &timed[i].on))
			return true;
	return irq->priority <= others;
}

struct irqs {
	struct rt_thread ours[8];
	int n, others;			/* highest priority of the others */
};

static void irqs_find(const struct doctor_rt *d, struct irqs *ret)
{
	char folder[PATH_ROOM];
	struct rt_thread t;
	DIR *all;

	*ret = (struct irqs) { .n = 0 };
	snprintf(folder, sizeof(folder), "%s/proc", d->root);
	all = opendir(folder);
	while (thread_next(all, folder, &t)) {
		if (strncmp(t.name, "irq/", 4) != 0)
			continue;
		if (!is_ours(t.name))
			ret->others = t.priority > ret->others ? t.priority :
				      ret->others;
		else if (ret->n < 8)
			ret->ours[ret->n++] = t;
	}
	if (all)
		closedir(all);
}

enum verdict doctor_rt_irqs(const struct doctor_rt *d, char *found,
			    size_t size)
{
	struct said s = { found, size, 0 };
	struct rt_thread t[2];
	const int n = timed_threads(d, t);
	enum verdict v = GOOD;
	struct irqs q;

	irqs_find(d, &q);
	if (q.n == 0 || n == 0) {
		say(&s, n ? "no thread of an interrupt of CAN or of lines" :
		    "edmd does not run");
		return UNUSED;
	}
	for (int i = 0; i < q.n; i++) {
		say(&s, "%s%s at %d on %s", i ? ", " : "", q.ours[i].name,
		    q.ours[i].priority, q.ours[i].list);
		v = irq_is_bad(&q.ours[i], q.others, t, n) ? BAD : v;
	}
	say(&s, "; others at %d, %s at %d on %s", q.others, t[0].name,
	    t[0].priority, t[0].list);
	return v;
}
