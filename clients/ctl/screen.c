/* SPDX-License-Identifier: Apache-2.0 */
/* screen.c - edmctl watch on a whole terminal: what comes, keys, the end */
#include "screen.h"

#include "plain.h"
#include "standard.h"

#include <curses.h>
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define COLUMNS_LEAST	20
#define ROWS_LEAST	4
#define ASK_S		0.5
#define DRAW_S		0.1

bool screen_can(void)
{
	const char *term = getenv("TERM");
	struct winsize w;

	if (!isatty(STDOUT_FILENO) || !term || !*term ||
	    strcmp(term, "dumb") == 0)
		return false;
	return ioctl(STDOUT_FILENO, TIOCGWINSZ, &w) < 0 || w.ws_col == 0 ||
	       (w.ws_col >= COLUMNS_LEAST && w.ws_row >= ROWS_LEAST);
}

/* -- What is asked beside STATUS ------------------------------------------- */

static void on_why(void *arg, int err, const struct talk_ack *a)
{
	struct screen *s = arg;
	json_t *o = err == 0 && a->code == 0 ? json_loads(a->body, 0, NULL) :
					       NULL;

	plain_copy(s->why, sizeof(s->why), ctl_text_of(o, "why"));
	json_decref(o);
}

static void on_values(void *arg, int err, const struct talk_ack *a)
{
	struct screen *s = arg;
	json_t *o = err == 0 && a->code == 0 ? json_loads(a->body, 0, NULL) :
					       NULL;
	json_t *v = json_object_get(o, "values");

	/* A limit of 0 stands for one that follows servo_v. */
	s->low_v = ctl_number_of(v, "window_low_v");
	if (!(s->low_v > 0))
		s->low_v = (ctl_number_of(v, "short_v") +
			    ctl_number_of(v, "servo_v")) / 2;
	s->high_v = ctl_number_of(v, "window_high_v");
	if (!(s->high_v > 0))
		s->high_v = ctl_number_of(v, "servo_v");
	s->open_v = ctl_number_of(v, "open_v");
	json_decref(o);
}

static void ask(struct screen *s, double now_s)
{
	const struct talk_question why = { .verb = "why" };
	const struct talk_question values = { .verb = "values" };

	if (now_s - s->asked_s < ASK_S)
		return;
	s->asked_s = now_s;
	if (s->turn++ % 2 == 0)
		talk_send(s->ctl->talk, &values, s->ctl->timeout_s, on_values,
			  s);
	else
		talk_send(s->ctl->talk, &why, s->ctl->timeout_s, on_why, s);
}

/* -- What comes ------------------------------------------------------------ */

static void take(struct screen *s, const struct talk_status *t, double now_s)
{
	mean_add(&s->gap, now_s, t->gap_v);
	line_feed(&s->feed, now_s, t);
}

static void second(struct screen *s, double now_s)
{
	const int i = s->seconds % SCREEN_SECONDS;

	if (now_s - s->second_s < 1)
		return;
	/* After a stop by Ctrl-Z, the time is not filled in. */
	s->second_s = now_s - s->second_s < 2 ? s->second_s + 1 : now_s;
	s->gap_v[i] = (float)mean_now(&s->gap, now_s);
	s->feed_mm_min[i] = (float)mean_now(&s->feed, now_s);
	s->seconds++;
}

/* Return: false: leave. */
static bool keys(void)
{
	for (int key; (key = getch()) != ERR; ) {
		if (key == 'q' || key == 'Q' || key == 3)
			return false;
		if (key == KEY_RESIZE || key == 12)
			clear();
	}
	return true;
}

static int run(struct screen *s)
{
	double heard_s = talk_now_s(), drawn_s = 0;
	uint64_t seen = 0, count;

	while (!talk_interrupted() && keys()) {
		const struct talk_status *t = talk_status(s->ctl->talk, &count);
		const double now_s = talk_now_s();

		if (count != seen) {
			take(s, t, now_s);
			heard_s = now_s;
			seen = count;
		}
		second(s, now_s);
		ask(s, now_s);
		if (now_s - drawn_s > DRAW_S) {
			screen_draw(s, t);
			drawn_s = now_s;
		}
		if (now_s - heard_s > s->ctl->timeout_s)
			return -ETIMEDOUT;
		talk_wait(s->ctl->talk, 50);
	}
	return 0;
}

int screen_watch(struct ctl *c)
{
	static struct screen s;
	SCREEN *on;
	int err;

	setlocale(LC_CTYPE, "");
	standard_raw();
	on = newterm(NULL, stdout, stdin);
	if (!on)
		return -ENOTTY;
	cbreak();
	noecho();
	nodelay(stdscr, TRUE);
	keypad(stdscr, TRUE);
	curs_set(0);
	s = (struct screen) { .ctl = c, .second_s = talk_now_s() };
	err = run(&s);
	endwin();
	delscreen(on);
	return err;
}
