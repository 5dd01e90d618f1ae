/* SPDX-License-Identifier: Apache-2.0 */
/* line.c - progress in one line: redrawn on a terminal, repeated elsewhere */
#include "ctl.h"
#include "standard.h"

#include <math.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#define BAR_CHARS	24
#define BAR_LEAST	8
#define PLAIN_EVERY_S	1.0
#define WORDS_EVERY_S	5.0

void line_init(struct line *l)
{
	const char *term = getenv("TERM");

	/* A terminal that cannot erase takes lines, as a file does. */
	*l = (struct line) { .tty = isatty(STDOUT_FILENO) && term && *term &&
				    strcmp(term, "dumb") != 0 };
}

void ctl_duration(char *to, size_t size, double s)
{
	long n = s > 0 && s < 1e9 ? lround(s) : 0;

	if (n >= 3600)
		snprintf(to, size, "%ld h %02ld min %02ld s", n / 3600,
			 n / 60 % 60, n % 60);
	else if (n >= 60)
		snprintf(to, size, "%ld min %02ld s", n / 60, n % 60);
	else
		snprintf(to, size, "%ld s", n);
}

void ctl_left(char *to, size_t size, const struct talk_status *s)
{
	char from[32], until[32];

	if (s->eta_s < 0) {
		snprintf(to, size, "?");
	} else if (strcmp(s->eta_by, "cut") == 0) {
		ctl_duration(to, size, s->eta_s);
	} else {
		ctl_duration(from, sizeof(from), s->eta_min_s);
		ctl_duration(until, sizeof(until), s->eta_max_s);
		snprintf(to, size, "%s to %s", from, until);
	}
}

static void add_end(char *to, size_t size, double end_s)
{
	const time_t end = (time_t)end_s;
	const bool far = end_s - (double)time(NULL) > 20 * 3600;
	struct tm tm;

	if (end_s > 0 && localtime_r(&end, &tm))
		strftime(to, size, far ? ", ends %d %b %H:%M" : ", ends %H:%M",
			 &tm);
}

void ctl_left_why(char *to, size_t size, const struct talk_status *s)
{
	const char *what = *s->eta_condition ? s->eta_condition : "cutting";
	size_t n;

	*to = '\0';
	if (s->eta_s < 0)
		return;
	add_end(to, size, s->end_s);
	n = strlen(to);
	if (strcmp(s->eta_by, "forecast") == 0)
		snprintf(to + n, size - n, ", by forecast");
	else if (strcmp(s->eta_by, "learnt") == 0)
		snprintf(to + n, size - n, ", as learnt: %s takes %.2f times "
			 "its forecast", what, s->eta_factor);
	else if (fabs(s->eta_factor - 1) > 0.1)
		snprintf(to + n, size - n, ", %s takes %.2f times its forecast",
			 what, s->eta_factor);
}

/* \\r could not erase a line that wraps. */
static int columns(void)
{
	struct winsize w;

	if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &w) == 0 && w.ws_col > 20)
		return w.ws_col - 1;
	return isatty(STDOUT_FILENO) ? 79 : LINE_MAX_CHARS;
}

/* As wide as @room, within reason. */
static void bar(char ret[BAR_CHARS + 3], double done, int room)
{
	int wide = room < BAR_LEAST ? BAR_LEAST :
		   room > BAR_CHARS ? BAR_CHARS : room;
	int n = (int)(fmin(fmax(done, 0), 1) * wide);

	ret[0] = '[';
	memset(ret + 1, '=', (size_t)n);
	memset(ret + 1 + n, ' ', (size_t)(wide - n));
	if (n < wide)
		ret[1 + n] = '>';
	ret[wide + 1] = ']';
	ret[wide + 2] = '\0';
}

static void draw(struct line *l, const char *text)
{
	if (l->tty)
		standard_control(stdout, "\r\033[K");
	printf("%.*s", l->tty ? columns() : INT_MAX, text);
	if (!l->tty)
		putchar('\n');
	l->drawn = l->tty;
	fflush(stdout);
}

void line_bar(struct line *l, double done, const char *text)
{
	char b[BAR_CHARS + 3], whole[LINE_MAX_CHARS];
	double now_s = talk_now_s();

	if (!l->tty && now_s - l->told_s < PLAIN_EVERY_S)
		return;
	l->told_s = now_s;
	bar(b, done, columns() - 12 - (int)strlen(text));
	snprintf(whole, sizeof(whole), "%s %5.1f %%  %s", b, done * 100, text);
	draw(l, whole);
}

void line_feed(struct mean *m, double now_s, const struct talk_status *s)
{
	if (strcmp(s->state, "jump") != 0 && strcmp(s->state, "retract") != 0)
		mean_add(m, now_s, s->feed_mm_s * 60);
}

static bool is_wire(const struct talk_status *s)
{
	return strcmp(s->process, "wire") == 0;
}

const char *ctl_deep_word(const struct talk_status *s)
{
	return is_wire(s) ? "wire" : "depth";
}

void ctl_deep(char *to, size_t size, const struct talk_status *s)
{
	if (is_wire(s))
		snprintf(to, size, "leans %.2f deg", s->lean_deg);
	else
		snprintf(to, size, "%.3f mm, deepest %.3f mm", s->depth_mm,
			 s->depth_far_mm);
}

void ctl_speed(char *to, size_t size, const struct talk_status *s,
	       double feed_mm_min)
{
	int n = snprintf(to, size, "%.2f mm/min", feed_mm_min);

	if (s->height_mm > 0)
		snprintf(to + n, size - (size_t)n, ", %.1f mm2/min",
			 feed_mm_min * s->height_mm);
}

void ctl_sums(char *to, size_t size, const struct talk_status *s)
{
	int n = is_wire(s) ? 0 : snprintf(to, size, "jumps %d, ", s->jumps);

	snprintf(to + n, size - (size_t)n, "retracts %d, shorts %d",
		 s->retracts, s->shorts);
}

static void describe(char *to, size_t size, const struct talk_status *s,
		     double feed_mm_min)
{
	char left[64], deep[64], sums[64], speed[64];
	char b[BAR_CHARS + 3], rest[LINE_MAX_CHARS - BAR_CHARS - 3];

	if (strcmp(s->daemon, "ok") != 0) {
		snprintf(to, size, "edmd is %s; job %s, %s, was at %.3f mm",
			 s->daemon, *s->job ? s->job_name : "none",
			 *s->job ? s->job_state : "-", s->place_mm);
		return;
	}
	if (!*s->job) {
		snprintf(to, size, "%s, no job, %d wait, fault %s", s->state,
			 s->queue_len, s->fault);
		return;
	}
	if (*s->asks) {
		snprintf(to, size, "%5.1f %% %s: %s", s->progress * 100,
			 s->state, s->asks);
		return;
	}
	ctl_left(left, sizeof(left), s);
	ctl_deep(deep, sizeof(deep), s);
	ctl_sums(sums, sizeof(sums), s);
	ctl_speed(speed, sizeof(speed), s, feed_mm_min);
	snprintf(rest, sizeof(rest), "%5.1f %% %-8s left %s, %s %s, gap %.0f "
		 "V, %s, feed %s", s->progress * 100, s->state, left,
		 ctl_deep_word(s), deep, s->gap_v, sums, speed);
	bar(b, s->progress, columns() - 3 - (int)strlen(rest));
	snprintf(to, size, "%s %s", b, rest);
}

/* The states of the gap come and go many times a second, so they are left
 * out. */
static void what_changes(char *to, size_t size, const struct talk_status *s)
{
	snprintf(to, size, "%s %s %s %s", s->daemon, s->job, s->job_state,
		 s->stand);
}

void line_status(struct line *l, const struct talk_status *s)
{
	char text[LINE_MAX_CHARS], state[sizeof(l->state)];
	double now_s = talk_now_s();

	line_feed(&l->feed, now_s, s);
	what_changes(state, sizeof(state), s);
	if (!l->tty && now_s - l->told_s < PLAIN_EVERY_S &&
	    strcmp(state, l->state) == 0)
		return;
	l->told_s = now_s;
	memcpy(l->state, state, sizeof(state));
	describe(text, sizeof(text), s, mean_now(&l->feed, now_s));
	/* What is not erased is told once. */
	if (!l->tty && strcmp(text, l->text) == 0)
		return;
	memcpy(l->text, text, sizeof(text));
	draw(l, text);
}

void line_words(struct line *l, const char *text)
{
	const double now_s = talk_now_s();

	if (!l->tty && now_s - l->told_s < WORDS_EVERY_S)
		return;
	l->told_s = now_s;
	draw(l, text);
}

void line_end(struct line *l)
{
	if (l->drawn)
		putchar('\n');
	l->drawn = false;
	fflush(stdout);
}
