/* SPDX-License-Identifier: Apache-2.0 */
/* screen_draw.c - edmctl watch on a whole terminal: where what stands */
#define _XOPEN_SOURCE_EXTENDED 1
#include "screen.h"

#include "faults.h"

#include <curses.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <wchar.h>

#define TEXT_MAX	512
#define ROOMY		20		/* rows from which there are blank
					 * ones */
#define NAME_EDGE	30		/* behind the name of the job */
#define LABEL		9		/* columns in front of a chart */
#define BAR_MOST	50
#define OPEN_V		100.0		/* as long as it is not known */

/*
 * Write one line of text, cut at @edge.  What the locale of the terminal cannot
 * show is a question mark.
 */
static void put_within(int y, int x, int edge, attr_t how, const char *text)
{
	wchar_t wide[TEXT_MAX];
	mbstate_t state = { 0 };
	int room = (edge < COLS ? edge : COLS) - x, n = 0;

	while (*text && n < TEXT_MAX - 1) {
		wchar_t w = L'?';
		size_t bytes = mbrtowc(&w, text, strlen(text), &state);
		int wide_by;

		if (bytes == (size_t)-1 || bytes == (size_t)-2) {
			state = (mbstate_t) { 0 };
			w = L'?';
			bytes = 1;
		}
		wide_by = wcwidth(w);
		if (wide_by < 0)
			w = L'?';
		room -= wide_by < 0 ? 1 : wide_by;
		if (room < 0)
			break;
		wide[n++] = w;
		text += bytes;
	}
	wide[n] = L'\0';
	attron(how);
	mvaddwstr(y, x, wide);
	attroff(how);
}

static void put(int y, int x, attr_t how, const char *text)
{
	put_within(y, x, COLS, how, text);
}

__attribute__((format(printf, 4, 5)))
static void say(int y, int x, attr_t how, const char *format, ...)
{
	char text[TEXT_MAX];
	va_list ap;

	va_start(ap, format);
	vsnprintf(text, sizeof(text), format, ap);
	va_end(ap);
	put(y, x, how, text);
}

/* -- The head: state and why ----------------------------------------------- */

static void draw_title(const struct talk_status *t)
{
	char clock[16] = "";
	time_t now = time(NULL);
	struct tm tm;

	if (localtime_r(&now, &tm))
		strftime(clock, sizeof(clock), "%H:%M:%S", &tm);
	attron(A_REVERSE);
	mvhline(0, 0, ' ', COLS);
	attroff(A_REVERSE);
	say(0, 1, A_REVERSE | A_BOLD, "%s  %s%s%s", t->machine,
	    strcmp(t->daemon, "ok") == 0 ? t->state : "edmd is ",
	    strcmp(t->daemon, "ok") == 0 ? "" : t->daemon,
	    *t->job || strcmp(t->state, "idle") != 0 ? "" : ", no job");
	if (COLS >= 60)
		say(0, COLS - 30, A_REVERSE, "%-8s %s  %s",
		    *t->condition ? t->condition : "",
		    strcmp(t->store, "ok") == 0 ? "store ok" : "store BAD",
		    clock);
}

static const struct fault_row *fault_of(const struct talk_status *t)
{
	for (int i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++)
		if (strcmp(fault_table[i].name, t->fault) == 0)
			return &fault_table[i];
	return NULL;
}

/* Two lines; a text that is longer goes on in the second one. */
static int draw_why(int y, const struct screen *s, const struct talk_status *t)
{
	const struct fault_row *fault = fault_of(t);
	char text[2 * TEXT_MAX] = "";
	size_t n = 0;

	if (fault) {
		say(y, 0, A_BOLD, "FAULT %s: %s", t->faults, fault->what);
		say(y + 1, 0, A_NORMAL, "%s", fault->clear);
		return y + 2;
	}
	if (strcmp(t->store, "ok") != 0)
		n = (size_t)snprintf(text, sizeof(text), "store %s. ",
				     t->store);
	if (*t->lost)
		n += (size_t)snprintf(text + n, sizeof(text) - n,
				      "The place of %s is not certain. ",
				      t->lost);
	if (t->hunts > 0)
		n += (size_t)snprintf(text + n, sizeof(text) - n,
				      "The gap servo hunts: edmctl alarms. ");
	if (*s->why && n < sizeof(text))
		snprintf(text + n, sizeof(text) - n, "%s", s->why);
	put(y, 0, A_BOLD, text);
	if (strlen(text) > (size_t)COLS && COLS > 0)
		put(y + 1, 0, A_BOLD, text + COLS);
	return y + 2;
}

static int draw_places(int y, const struct talk_status *t)
{
	const int wide = 19, in_row = COLS / wide < 1 ? 1 :
		COLS / wide > 4 ? 4 : COLS / wide;
	int n = 0;

	for (int i = 0; i < TALK_NAXES; i++) {
		if (!strchr(t->axes, "XYZABCUV"[i]))
			continue;
		say(y + n / in_row, n % in_row * wide, A_BOLD, "%c%12.4f",
		    "XYZABCUV"[i], t->pos_mm[i]);
		n++;
	}
	return y + (n + in_row - 1) / in_row;
}

/* -- The job --------------------------------------------------------------- */

static void draw_bar(int y, double done)
{
	const int wide = COLS - 9 > 0 ? COLS - 9 : 0;
	const int full = (int)(fmin(fmax(done, 0), 1) * wide);

	mvaddch(y, 0, '[');
	for (int i = 0; i < wide; i++)
		addch(i < full ? '=' : i == full ? '>' : ' ');
	printw("]%5.1f%%", fmin(fmax(done, 0), 1) * 100);
}

static int draw_job(int y, const struct talk_status *t)
{
	char left[64], took[32], why[96], deep[64], sums[64];

	if (!*t->job) {
		say(y, 0, A_NORMAL, "no job is loaded, %d wait", t->queue_len);
		return y + 1;
	}
	ctl_left(left, sizeof(left), t);
	ctl_left_why(why, sizeof(why), t);
	ctl_deep(deep, sizeof(deep), t);
	ctl_sums(sums, sizeof(sums), t);
	ctl_duration(took, sizeof(took), t->job_s);
	put_within(y, 0, NAME_EDGE - 1, A_BOLD, t->job_name);
	say(y, NAME_EDGE, A_NORMAL, "%-8s line %d of %d   %d wait",
	    t->job_state, t->line, t->lines, t->queue_len);
	draw_bar(y + 1, t->progress);
	say(y + 2, 0, A_NORMAL, "time %s, left %s%s", took, left, why);
	say(y + 3, 0, A_NORMAL, "place %.3f of %.3f mm, %s %s", t->place_mm,
	    t->length_mm, ctl_deep_word(t), deep);
	say(y + 4, 0, A_NORMAL, "%s", sums);
	return y + 5;
}

/* -- The gap --------------------------------------------------------------- */

static double open_v(const struct screen *s)
{
	return s->open_v > 0 ? s->open_v * 1.25 : OPEN_V;
}

/* Filled up to the voltage; = is inside the window. */
static int draw_gap(int y, const struct screen *s)
{
	const double now_s = talk_now_s(), top_v = open_v(s);
	const double gap_v = mean_now(&s->gap, now_s);
	const int most = COLS - 40 > 0 ? COLS - 40 : 0;
	const int wide = most < BAR_MOST ? most : BAR_MOST;

	say(y, 0, A_BOLD, "gap %6.1f V ", gap_v);
	for (int i = 0; i < wide; i++) {
		const double v = (i + 0.5) * top_v / wide;
		const bool in = s->open_v > 0 && v >= s->low_v &&
				v <= s->high_v;

		mvaddch(y, 13 + i, (chtype)(in ? '=' : '.') |
			(v <= gap_v ? A_REVERSE : A_NORMAL));
	}
	if (s->open_v > 0)
		say(y, 14 + wide, A_NORMAL, "window %.3g to %.3g V", s->low_v,
		    s->high_v);
	say(y + 1, 0, A_BOLD, "feed %8.3f mm/min, the mean of a second",
	    mean_now(&s->feed, now_s));
	return y + 2;
}

/* -- The last minutes ------------------------------------------------------ */

struct chart {
	const float *of;		/* a ring of SCREEN_SECONDS */
	int n;
	double least, most;
	const char *unit;
	double low, high;		/* lines across it; equal: none */
};

static int row_of(const struct chart *c, int rows, double v)
{
	const double part = (v - c->least) / (c->most - c->least);

	return (int)lround((1 - fmin(fmax(part, 0), 1)) * (rows - 1));
}

static void draw_chart(int y, int rows, const struct chart *c)
{
	const int room = COLS - LABEL, kept = c->n < SCREEN_SECONDS ?
				       c->n : SCREEN_SECONDS;
	const int wide = kept < room ? kept : room;

	say(y, 0, A_NORMAL, "%6.3g %s", c->most, c->unit);
	say(y + rows - 1, 0, A_NORMAL, "%6.3g", c->least);
	for (int r = 0; r < rows; r++)
		mvaddch(y + r, LABEL - 1, '|');
	if (c->high > c->low) {
		mvhline(y + row_of(c, rows, c->low), LABEL, '-', room);
		mvhline(y + row_of(c, rows, c->high), LABEL, '-', room);
	}
	for (int i = 0; i < wide; i++) {
		const int at = (c->n - wide + i) % SCREEN_SECONDS;

		mvaddch(y + row_of(c, rows, c->of[at]), COLS - wide + i,
			'*' | A_BOLD);
	}
}

/* The least and the most of what is shown, and a little more. */
static void scale(struct chart *c)
{
	const int kept = c->n < SCREEN_SECONDS ? c->n : SCREEN_SECONDS;

	for (int i = 0; i < kept; i++) {
		c->least = fmin(c->least, c->of[i]);
		c->most = fmax(c->most, c->of[i]);
	}
	if (c->most - c->least < 1e-3)
		c->most = c->least + 1;
}

static void draw_charts(int y, const struct screen *s)
{
	const int rows = LINES - 1 - y;
	struct chart gap = {
		.of = s->gap_v, .n = s->seconds, .most = open_v(s),
		.unit = "V", .low = s->low_v, .high = s->high_v,
	};
	struct chart feed = {
		.of = s->feed_mm_min, .n = s->seconds, .unit = "mm",
	};

	if (rows < 3 || COLS < LABEL + 10)
		return;
	if (rows < 7) {
		scale(&gap);
		draw_chart(y, rows, &gap);
		return;
	}
	scale(&feed);
	scale(&gap);
	draw_chart(y, rows - rows * 2 / 5 - 1, &gap);
	draw_chart(LINES - 1 - rows * 2 / 5, rows * 2 / 5, &feed);
}

void screen_draw(const struct screen *s, const struct talk_status *t)
{
	const int blank = LINES >= ROOMY;
	int y;

	erase();
	draw_title(t);
	y = draw_why(1, s, t);
	y = draw_places(y, t) + blank;
	y = draw_job(y, t);
	y = draw_gap(y, s) + blank;
	draw_charts(y, s);
	if (LINES > 1) {
		move(LINES - 1, 0);
		clrtoeol();
		put(LINES - 1, 0, A_DIM, "q leaves, the machine goes on.  "
		    "Below: gap and feed, a column a second");
	}
	refresh();
}
