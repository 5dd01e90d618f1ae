/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission_machine.c - the steps that are taken once for the machine
 */
#include "commission.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define UP_S		15.0		/* until drives are up */
#define STEADY_S	2.0		/* ... and for as long */
#define LATENCY_S	600
#define NOISE		0.1		/* of the step from open to touching */
#define LOADS_MOST	64
#define LOAD_BYTES	(4 << 20)

struct load {
	int n;
	pid_t pid[LOADS_MOST];
};

static bool is_stopped(struct tour *w, double seconds)
{
	const struct talk_status *s = tour_state(w, "fault", seconds);

	return strcmp(s->state, "fault") == 0 &&
	       strstr(s->faults, "e-stop") != NULL;
}

void tour_estop(struct tour *w)
{
	char word[WORD_MAX];

	if (is_stopped(w, 0.5) && !tour_reset(w)) {
		tour_wrong(w, "the e-stop is on while nobody presses it: its "
			   "input is inverted (!), or its wire is cut");
		return;
	}
	if (!tour_choose(w, "pressed none", word, "press the e-stop; none: "
			 "there is none"))
		return;
	if (strcmp(word, "none") == 0) {
		tour_wrong(w, "there is no e-stop: gpio.estop = a line, or "
			   "estop:BIT in drive_inputs; it must also cut the "
			   "power by itself");
		return;
	}
	if (!is_stopped(w, 3)) {
		tour_wrong(w, "the e-stop was pressed, and edmd did not see "
			   "it: gpio.estop, or estop:BIT in drive_inputs, is "
			   "not what it is wired to");
		return;
	}
	if (!tour_says_yes(w, "let it go; is it free"))
		return;
	if (tour_reset(w))
		tour_good(w, "the e-stop is seen, and its fault ends by reset");
	else
		tour_wrong(w, "the e-stop stays on when it is let go");
}

/* -- Drives ---------------------------------------------------------------- */

static const char *why_ill(json_t *d)
{
	return strcmp(ctl_text_of(d, "trouble"), "well") != 0 ?
	       ctl_text_of(d, "trouble") :
	       strcmp(ctl_text_of(d, "phase"), "up") != 0 ?
	       ctl_text_of(d, "phase") : NULL;
}

/* Return: the first that is ill; NULL: none, or edmd does not tell. */
static json_t *first_ill(json_t *o)
{
	json_t *d;
	size_t i;

	json_array_foreach(json_object_get(o, "drives"), i, d)
		if (why_ill(d))
			return d;
	return NULL;
}

static void put_ill(char to[SAID_CHARS], json_t *d)
{
	json_t *all = json_object_get(d, "history");
	json_t *last = json_array_get(all, json_array_size(all) - 1);

	snprintf(to, SAID_CHARS, "drive %s (node %.0f): %s%s%s %s",
		 ctl_text_of(d, "axis"), ctl_number_of(d, "node"), why_ill(d),
		 last ? "; emergency " : "", ctl_text_of(last, "code"),
		 ctl_text_of(last, "text"));
}

void tour_ill(struct tour *w, char to[SAID_CHARS])
{
	json_t *o = NULL, *ill;

	*to = '\0';
	if (!config_machine_is(&w->config, MACHINE_DRIVES) ||
	    ctl_ask_json(w->ctl, &(struct talk_question) {
		.verb = "drives" }, &o) != 0)
		return;
	ill = first_ill(o);
	if (ill)
		put_ill(to, ill);
	json_decref(o);
}

void tour_drives(struct tour *w)
{
	const double until_s = talk_now_s() + UP_S;
	double well_s = talk_now_s();
	char ill[SAID_CHARS];

	do {
		talk_wait(w->ctl->talk, 200);
		tour_ill(w, ill);
		well_s = *ill ? talk_now_s() : well_s;
	} while (talk_now_s() < (*ill ? until_s : well_s + STEADY_S) &&
		 !talk_interrupted());
	if (*ill)
		tour_wrong(w, "%s; edmctl alarms and the log tell more", ill);
	else
		tour_good(w, "all drives are up");
}

/* -- The gap --------------------------------------------------------------- */

struct gap_read {
	double open_v, open_sigma, touch_v, touch_sigma;
};

static void propose(struct tour *w, const struct gap_read *g)
{
	const double step = g->open_v - g->touch_v;
	struct tour_key key[] = { { .key = "short_v" }, { .key = "open_v" } };

	tour_good(w, "the gap reads %.1f V open and %.1f V touching, with a "
		  "noise of %.2f V; short_v %.1f and open_v %.1f are between",
		  g->open_v, g->touch_v, fmax(g->open_sigma, g->touch_sigma),
		  g->touch_v + 0.2 * step, g->touch_v + 0.8 * step);
	if (!tour_says_yes(w, "write these short_v and open_v"))
		return;
	for (int i = 0; i < 2; i++)
		snprintf(key[i].value, sizeof(key[i].value), "%.3g",
			 g->touch_v + (i ? 0.8 : 0.2) * step);
	tour_write(w, "gap", key, 2);
}

void tour_sense(struct tour *w)
{
	struct gap_read g = { .open_v = NAN };
	double noise, step;

	if (!tour_says_yes(w, "the electrode away from the work, and a voltage "
			   "on the gap; is it") ||
	    !tour_gap(w, &g.open_v, &g.open_sigma) ||
	    !tour_says_yes(w, "let the electrode touch the work; does it") ||
	    !tour_gap(w, &g.touch_v, &g.touch_sigma))
		return;
	step = g.open_v - g.touch_v;
	noise = fmax(g.open_sigma, g.touch_sigma);
	if (fabs(step) < 1)
		tour_wrong(w, "the gap reads %.1f V open and %.1f V touching, "
			   "each within %.1f V: no voltage is on it, or its "
			   "sensor is not wired", g.open_v, g.touch_v, noise);
	else if (noise > NOISE * fabs(step) && noise > 0.5)
		tour_wrong(w, "the gap is noisy: %.1f V open and %.1f V "
			   "touching, each within %.1f V; screen its wires, "
			   "filter it", g.open_v, g.touch_v, noise);
	else if (step < 0)
		tour_wrong(w, "the gap is inverted: %.1f V open, %.1f V "
			   "touching; turn its wires, or its lines", g.open_v,
			   g.touch_v);
	else
		propose(w, &g);
}

/* -- Generator, watchdog, real time, the first cut ------------------------- */

void tour_generator(struct tour *w)
{
	struct ctl sub = *w->ctl;

	sub.verb = "generator";
	sub.arg = "walk";
	sub.value = NULL;
	if (ctl_generator(&sub) == 0)
		tour_good(w, "the generator tells each value as it was asked "
			  "for");
	else
		tour_wrong(w, "the generator did not tell all values as asked; "
			   "edmctl generator walk lists them");
}

void tour_watchdog(struct tour *w)
{
	const bool killed = tour_says_yes(w, "systemctl kill -s KILL edmd; did "
		"sparks, pump and the axes' power go off within a second");
	const bool pulled = !w->over && tour_says_yes(w, "pull the cable of "
		"the drives or lines and put it back; did they go off too");

	if (w->over)
		return;
	if (killed && pulled)
		tour_good(w, "without edmd, and without its cable, all goes "
			  "off");
	else
		tour_wrong(w, "%s does not switch all off: a watchdog line, "
			   "6007 of the drives, or a relay must",
			   killed ? "a pulled cable" : "a dead edmd");
}

static void sleep_s(double seconds)
{
	const double until_s = talk_now_s() + seconds;
	const struct timespec pause = { .tv_nsec = 100000000 };

	while (talk_now_s() < until_s && !talk_interrupted())
		nanosleep(&pause, NULL);
}

/* Memory, system calls and a disk, until its parent kills it or dies. */
static void work_hard(pid_t parent)
{
	static char a[LOAD_BYTES], b[LOAD_BYTES];
	FILE *f = tmpfile();

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	while (getppid() == parent) {
		memcpy(a, b, sizeof(a));
		b[a[0] & 1] ^= 1;
		if (f && fwrite(a, sizeof(a), 1, f) == 1 && fflush(f) == 0)
			fdatasync(fileno(f));
		if (f)
			rewind(f);
	}
	_exit(0);
}

static void load_begin(struct load *l)
{
	const pid_t parent = getpid();

	l->n = (int)fmin(LOADS_MOST, (double)sysconf(_SC_NPROCESSORS_ONLN));
	for (int i = 0; i < l->n; i++) {
		l->pid[i] = fork();
		if (l->pid[i] == 0)
			work_hard(parent);
	}
}

static void load_end(const struct load *l)
{
	for (int i = 0; i < l->n; i++) {
		if (l->pid[i] <= 0)
			continue;
		kill(l->pid[i], SIGKILL);
		waitpid(l->pid[i], NULL, 0);
	}
}

/* Beside edmd, on its core, a priority below it. */
static FILE *cyclictest_begin(const struct tour *w, double seconds)
{
	const long cpu = (long)w->config.cpu;
	char line[160], on[32] = "";

	if (cpu >= 0)
		snprintf(on, sizeof(on), "-a%ld", cpu);
	snprintf(line, sizeof(line), "exec cyclictest -q -m -t1 -p%d -i%d %s "
		 "-D%ds 2>/dev/null", (int)w->config.priority - 1,
		 (int)(config_period_ns(&w->config) / 1000), on,
		 (int)ceil(seconds));
	return popen(line, "re");
}

/* Return: us, of "... Max:  17"; -1: it is not there, or may not. */
static long cyclictest_end(FILE *f)
{
	char line[256];
	long most = -1;

	while (f && fgets(line, sizeof(line), f)) {
		const char *at = strstr(line, "Max:");

		most = at ? strtol(at + 4, NULL, 10) : most;
	}
	if (f)
		pclose(f);
	return most;
}

static void put_cyclictest(char to[100], long us)
{
	if (us < 0)
		snprintf(to, 100, "cyclictest (rt-tests) did not run");
	else
		snprintf(to, 100, "cyclictest, a priority below it, %ld us",
			 us);
}

void tour_latency(struct tour *w)
{
	uint32_t before[SHM_LATENCY_BINS], most = 0;
	double seconds = LATENCY_S, period_us;
	json_t *y = json_array();
	struct shm_snapshot s;
	struct load load;
	char other[100];
	FILE *f;

	if (!tour_number(w, LATENCY_S, &seconds, "the host works hard "
			 "meanwhile, on all cores, in memory and on the disk; "
			 "for how many seconds") ||
	    !shm_snapshot(w->status, &s)) {
		json_decref(y);
		return;
	}
	period_us = (double)s.period_ns / 1e3;
	for (int i = 0; i < SHM_LATENCY_BINS; i++)
		before[i] = w->status->latency_us[i];
	load_begin(&load);
	f = cyclictest_begin(w, seconds);
	sleep_s(seconds);
	put_cyclictest(other, cyclictest_end(f));
	load_end(&load);
	for (uint32_t i = 0; i < SHM_LATENCY_BINS; i++) {
		const uint32_t n = w->status->latency_us[i] - before[i];

		most = n ? i : most;
		json_array_append_new(y, json_real(log10(1.0 + n)));
	}
	tour_plot(w, &(struct tour_plot) { "log10 of wakes", "us late", 1, y });
	if (most < SHM_LATENCY_BINS - 1 && most < period_us / 2)
		tour_good(w, "edmd woke %u us late at most, of a period of "
			  "%.0f us; %s", most, period_us, other);
	else
		tour_wrong(w, "edmd woke %u us late%s, of a period of %.0f us; "
			   "%s; edmctl doctor tells what the host lacks", most,
			   most == SHM_LATENCY_BINS - 1 ? " or more" : "",
			   period_us, other);
}

/* Homed, or a person has seen that it is where it is shown. */
static bool settle(struct tour *w)
{
	char axis[2] = "", word[WORD_MAX];
	struct ctl sub = *w->ctl;

	sub.arg = axis;
	sub.value = "as-seen";
	sub.wait = true;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const char *lost = tour_state(w, "idle", 1)->lost;
		const bool homes = w->config.manual[i].method != HOME_NONE;

		axis[0] = INTERP_AXIS_LETTERS[i];
		if (!strchr(lost, axis[0]))
			continue;
		sub.verb = homes ? "home" : "place";
		if (!tour_choose(w, "no go", word, homes ? "%s homes" :
				 "%s stands where edmctl status shows it; go, "
				 "if it does", axis) ||
		    strcmp(word, "go") != 0 ||
		    (homes ? ctl_home(&sub) : ctl_place(&sub)) != 0)
			return false;
	}
	return true;
}

void tour_cut(struct tour *w)
{
	struct ctl sub = *w->ctl;
	char file[WORD_MAX], word[WORD_MAX];

	if (!settle(w) ||
	    !new_answer(&w->over, "a short program over a scrap of metal",
			"first.ngc", file) ||
	    !tour_choose(w, "no go", word, "%s begins", file) ||
	    strcmp(word, "go") != 0)
		return;
	sub.verb = "submit";
	sub.arg = file;
	sub.wait = true;
	if (ctl_submit(&sub) == 0)
		tour_good(w, "%s is cut", file);
	else
		tour_wrong(w, "%s did not come to its end", file);
}
