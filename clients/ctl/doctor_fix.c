/* SPDX-License-Identifier: Apache-2.0 */
/*
 * doctor_fix.c - edmctl doctor --fix: set a host up for the real-time threads
 * that a machine file asks for
 *
 * Files of systemd stay; what the kernel forgets at its end is set again by
 * edmd-realtime.service, which runs this program.  What only the boot loader
 * can say is printed.
 */
#include "doctor_rt.h"

#include "config.h"
#include "output.h"

#include <errno.h>
#include <glob.h>
#include <limits.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

#define UNITS		"/etc/systemd/system"
#define CORES_MOST	64		/* a mask of interrupts has so many */

struct mend {
	const char *root, *file;	/* of the machine */
	struct machine_config config;
	int core, edges_core;		/* < 0: none */
	int cores;			/* of the host */
	int failed;
};

/* Write @text to a file below the root.  A file of the kernel is not made. */
static void put(struct mend *m, const char *path, bool is_kernel,
		const char *text, const char *worth)
{
	char whole[PATH_MAX];
	FILE *f;
	int err;

	snprintf(whole, sizeof(whole), "%s%s", m->root, path);
	if (is_kernel && access(whole, F_OK) < 0) {
		printf("not there   %s\n", path);
		return;
	}
	for (char *at = whole + strlen(m->root) + 1; !is_kernel &&
	     (at = strchr(at, '/')); at++) {
		*at = '\0';
		mkdir(whole, 0755);
		*at = '/';
	}
	f = fopen(whole, is_kernel ? "r+e" : "we");
	if (f)
		fputs(text, f);
	err = f ? output_close(f) : -errno;
	m->failed += err < 0;
	printf("%-11s %s: %.*s\n            %s\n", err < 0 ? strerror(-err) :
	       "written", path, (int)strcspn(text, "\n"), text, worth);
}

static bool is_ours(const struct mend *m, int core)
{
	return core == m->core || core == m->edges_core;
}

/* "0-1,3", of the cores that are not edmd's. */
static void others(const struct mend *m, char *to, size_t size)
{
	size_t n = 0;

	*to = '\0';
	for (int i = 0; i < m->cores && n < size; i++)
		if (!is_ours(m, i))
			n += (size_t)snprintf(to + n, size - n, "%s%d",
					      n ? "," : "", i);
}

static void ours(const struct mend *m, char to[32])
{
	if (m->edges_core >= 0 && m->edges_core != m->core)
		snprintf(to, 32, "%d,%d", m->core, m->edges_core);
	else
		snprintf(to, 32, "%d", m->core);
}

/* -- Units ----------------------------------------------------------------- */

/* A word of a unit: systemd takes % and blanks for its own. */
static void quote(const char *word, char *to, size_t size)
{
	size_t n = 0;

	to[n++] = '"';
	for (; *word && n + 4 < size; word++) {
		if (*word == '%')
			to[n++] = '%';
		if (*word == '"' || *word == '\\')
			to[n++] = '\\';
		to[n++] = *word;
	}
	to[n++] = '"';
	to[n] = '\0';
}

static void fix_units(struct mend *m)
{
	char text[2 * PATH_MAX + 600], file[PATH_MAX], word[2 * PATH_MAX];

	put(m, UNITS "/edmd.service.d/realtime.conf", false,
	    "[Service]\nLimitMEMLOCK=infinity\nLimitRTPRIO=99\n",
	    "without it edmd's pages may be swapped out, and its threads have "
	    "no priority");
	if (!realpath(m->file, file))
		snprintf(file, sizeof(file), "%s", m->file);
	quote(file, word, sizeof(word));
	snprintf(text, sizeof(text), "[Unit]\nDescription=real time for edmd\n"
		 "Before=edmd.service\n\n[Service]\nType=oneshot\n"
		 "RemainAfterExit=yes\nExecStart=/usr/bin/env edmctl doctor "
		 "--fix %s\n\n[Install]\nWantedBy=edmd.service\n", word);
	put(m, UNITS "/edmd-realtime.service", false, text,
	    "sets again, at each boot, what the kernel forgets");
}

/* An adapter that is plugged in later has its thread of interrupts then. */
static void fix_udev(struct mend *m)
{
	const char *bus = m->config.can402.interface;
	char text[400];

	if (!config_machine_is(&m->config, MACHINE_DRIVES))
		return;
	snprintf(text, sizeof(text), "SUBSYSTEM==\"net\", KERNEL==\"%s\", "
		 "ACTION==\"add\", ATTR{tx_queue_len}=\"100\", "
		 "RUN+=\"/usr/bin/systemctl --no-block try-restart "
		 "edmd-realtime.service\"\n", bus);
	put(m, "/etc/udev/rules.d/61-edmd-realtime.rules", false, text,
	    "without it an adapter that is plugged in later has neither room "
	    "for a period's frames nor its priority");
}

/* -- The kernel ------------------------------------------------------------ */

static void fix_core(struct mend *m, int core)
{
	char path[160];

	snprintf(path, sizeof(path),
		 "/sys/devices/system/cpu/cpu%d/cpufreq/scaling_governor",
		 core);
	put(m, path, true, "performance\n",
	    "a core that was slowed down takes longer for a period");
	snprintf(path, sizeof(path), "/sys/devices/system/cpu/cpu%d/power/"
		 "pm_qos_resume_latency_us", core);
	put(m, path, true, "n/a\n",
	    "a core that sleeps deeply wakes late by the time that "
	    "cpuidle/state*/latency tells, in us");
}

static void fix_affinity(struct mend *m)
{
	unsigned long long mask = 0;
	char text[64], list[256], pattern[PATH_MAX];
	glob_t g;

	for (int i = 0; i < m->cores; i++)
		mask |= is_ours(m, i) ? 0 : 1ull << i;
	snprintf(text, sizeof(text), "%llx\n", mask);
	put(m, "/proc/irq/default_smp_affinity", true, text,
	    "an interrupt on edmd's core delays its period");
	others(m, list, sizeof(list));
	strcat(list, "\n");
	snprintf(pattern, sizeof(pattern), "%s/proc/irq/*/smp_affinity_list",
		 m->root);
	if (glob(pattern, 0, NULL, &g) != 0)
		return;
	/* Some cannot be moved; those that can are enough. */
	for (size_t i = 0; i < g.gl_pathc; i++) {
		FILE *f = fopen(g.gl_pathv[i], "r+e");

		if (f && fputs(list, f) >= 0)
			output_close(f);
		else if (f)
			fclose(f);
	}
	globfree(&g);
}

/* The thread of an interrupt of the bus or of the chip of lines. */
static bool serves(const struct mend *m, const char *comm)
{
	const char *names[] = { m->config.can402.interface,
				m->config.gpio.chip };
	bool is = false;

	for (size_t i = 0; i < 2; i++)
		is = is || (*names[i] && strcmp(names[i], "none") != 0 &&
			    strstr(comm, names[i]));
	return strncmp(comm, "irq/", 4) == 0 && is;
}

static void raise(struct mend *m, int pid, const char *comm)
{
	const struct sched_param p = {
		.sched_priority = (int)m->config.priority - 1,
	};
	const bool real = *m->root == '\0';
	const int err = real && sched_setscheduler(pid, SCHED_FIFO, &p) < 0 ?
			errno : 0;

	m->failed += err != 0;
	printf("%-11s priority of %s (%d): %d\n            below it, other "
	       "interrupts delay what edmd waits for\n", err ? strerror(err) :
	       real ? "written" : "would be", comm, pid, p.sched_priority);
}

static void fix_threads(struct mend *m)
{
	char pattern[PATH_MAX], comm[64] = "";
	glob_t g;

	snprintf(pattern, sizeof(pattern), "%s/proc/[0-9]*/comm", m->root);
	if (glob(pattern, 0, NULL, &g) != 0)
		return;
	for (size_t i = 0; i < g.gl_pathc; i++) {
		FILE *f = fopen(g.gl_pathv[i], "re");

		if (f && fgets(comm, sizeof(comm), f)) {
			comm[strcspn(comm, "\n")] = '\0';
			if (serves(m, comm))
				raise(m, atoi(g.gl_pathv[i] + strlen(m->root) +
					      strlen("/proc/")), comm);
		}
		if (f)
			fclose(f);
	}
	globfree(&g);
}

/* -- The boot loader ------------------------------------------------------- */

static void tell_boot(const struct mend *m)
{
	char list[256], cores[32];

	others(m, list, sizeof(list));
	ours(m, cores);
	printf("\nfor the boot loader (GRUB_CMDLINE_LINUX of "
	       "/etc/default/grub, or cmdline.txt):\n"
	       "  isolcpus=%s       no other thread comes onto edmd's core\n"
	       "  nohz_full=%s      no tick of the kernel interrupts it\n"
	       "  rcu_nocbs=%s      the kernel's clean-up runs elsewhere\n"
	       "  irqaffinity=%s    interrupts begin elsewhere\n"
	       "then edmctl doctor and edmctl latency tell what it came to\n",
	       cores, cores, cores, list);
}

static int begin(struct mend *m, const struct doctor_fix *asked)
{
	struct interp_diag diag = { .line = 0 };
	const int err = config_read(&m->config, asked->file, &diag);

	if (err == -EINVAL)
		interp_diag_tell(&diag, asked->file);
	else if (err < 0)
		fprintf(stderr, "edmctl: doctor --fix %s: %s; a machine "
			"file\n", asked->file, strerror(-err));
	if (err < 0)
		return EX_CONFIG;
	m->cores = (int)sysconf(_SC_NPROCESSORS_CONF);
	m->cores = m->cores > CORES_MOST ? CORES_MOST : m->cores;
	m->core = (int)m->config.cpu;
	m->edges_core = (int)m->config.gpio.edges_cpu;
	if (m->core >= 0 && m->core < m->cores && m->cores > 1)
		return 0;
	fprintf(stderr, "edmctl: doctor --fix: machine.cpu %d of %d cores in "
		"%s; a core of its own for edmd, 0 to %d%s\n", m->core,
		m->cores, asked->file, m->cores - 1,
		m->cores > 1 ? "" : ": this host has one alone");
	return EX_CONFIG;
}

int doctor_fix(const struct doctor_fix *asked)
{
	static struct mend m;
	int err;

	m = (struct mend) { .root = asked->root ? asked->root : "",
			    .file = asked->file };
	err = begin(&m, asked);
	if (err)
		return err;
	fix_units(&m);
	fix_udev(&m);
	fix_core(&m, m.core);
	if (m.edges_core >= 0 && m.edges_core != m.core)
		fix_core(&m, m.edges_core);
	put(&m, "/proc/sys/kernel/sched_rt_runtime_us", true, "-1\n",
	    "or the kernel stops real-time threads for a part of each second");
	fix_affinity(&m);
	fix_threads(&m);
	printf("\nnow: systemctl daemon-reload; udevadm control --reload; "
	       "systemctl enable edmd-realtime; systemctl restart edmd\n");
	tell_boot(&m);
	return m.failed ? EX_NOPERM : 0;
}
