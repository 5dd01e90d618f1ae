/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission_axis.c - the steps that are taken for each axis
 */
#include "commission.h"

#include "drives.h"

#include "interp/identify.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HAIR_MM		0.1
#define SHORT_MM	1.0		/* degrees of A B C */
#define LONG_MM		10.0
#define PLOT_POINTS	400
#define SCALE_OFF	0.002		/* a dial is read so well */
#define FINE		1e6		/* increments that a ratio is told in */
#define PULSES_MOST	1e8
#define HOMES		10
#define WAVE_HZ		1.0		/* the first of */
#define WAVES		4		/* ... so many, each twice the last */
#define WAVE_TIMES	5.0		/* in a motion */
#define HALF_POWER	0.7071

static const struct interp_axis_limits *limits_of(const struct tour *w)
{
	return &w->config.axes.axis[w->axis];
}

/* @mm, or a tenth of the travel. */
static double way(struct tour *w, double mm)
{
	const struct interp_axis_limits *l = limits_of(w);

	return fmin(mm, (l->travel_max_mm - l->travel_min_mm) / 10);
}

static void axis_section(const struct tour *w, char to[16])
{
	snprintf(to, 16, "axis.%c", tour_letter(w));
}

static void number(struct tour_key *key, double value)
{
	snprintf(key->value, sizeof(key->value), "%.10g", value);
}

static bool write_numbers(struct tour *w, const struct tour_key *key, size_t n)
{
	char section[16];

	axis_section(w, section);
	return tour_write(w, section, key, n);
}

static bool write_number(struct tour *w, const char *key, double value)
{
	struct tour_key one = { .key = key };

	number(&one, value);
	return write_numbers(w, &one, 1);
}

static bool has_drives(const struct tour *w)
{
	return config_machine_is(&w->config, MACHINE_DRIVES);
}

void tour_power(struct tour *w)
{
	if (!isnan(tour_move(w, HAIR_MM, SLOWLY, NULL)) &&
	    !isnan(tour_move(w, -HAIR_MM, SLOWLY, NULL)))
		tour_good(w, "%c has power and moves", tour_letter(w));
}

/* -- Direction ------------------------------------------------------------- */

/* The other way round, where the machine file can say that. */
static bool turn(struct tour *w)
{
	const struct config_drive *d = &w->config.drive[w->axis];
	const char *line = w->config.gpio.line[LINE_DIR + w->axis];
	struct tour_key one;
	char key[16];

	if (has_drives(w))
		return write_number(w, "drive_increments", -d->increments);
	if (config_machine_is(&w->config, MACHINE_NO_WIRES))
		return false;
	snprintf(key, sizeof(key), "dir_%c", tour_letter(w));
	one.key = key;
	snprintf(one.value, sizeof(one.value), "%s%s", *line == '!' ? "" : "!",
		 line + (*line == '!'));
	return tour_write(w, "gpio", &one, 1);
}

static void tell_swapped(struct tour *w, char other)
{
	const char axis = tour_letter(w);

	if (has_drives(w))
		tour_wrong(w, "what is %c moves %c: they are swapped; swap "
			   "can402.node_%c and node_%c, or their plugs", axis,
			   other, axis, other);
	else
		tour_wrong(w, "what is %c moves %c: they are swapped; swap "
			   "their lines step_ and dir_, or their plugs", axis,
			   other);
}

void tour_direction(struct tour *w)
{
	char words[32] = "+ - none", word[WORD_MAX];
	const double mm = tour_move(w, way(w, SHORT_MM), SLOWLY, NULL);
	size_t n = strlen(words);

	if (isnan(mm))
		return;
	for (int i = 0; i < INTERP_NAXES && n + 3 < sizeof(words); i++)
		if (w->config.axes.present >> i & 1 && i != w->axis)
			n += (size_t)snprintf(words + n, sizeof(words) - n,
					      " %c", INTERP_AXIS_LETTERS[i]);
	if (!tour_choose(w, words, word, "which way did %c go, or what else "
			 "moved: %s", tour_letter(w), words))
		return;
	if (strcmp(word, "+") == 0)
		tour_good(w, "%c goes toward + where it is sent to",
			  tour_letter(w));
	else if (strcmp(word, "-") == 0)
		tour_wrong(w, "%c goes the wrong way%s", tour_letter(w),
			   turn(w) ? "; it is turned in the machine file" : "");
	else if (strcmp(word, "none") == 0)
		tour_wrong(w, "nothing moved: the coupling of %c, its brake, "
			   "its enable input, or its step line",
			   tour_letter(w));
	else
		tell_swapped(w, word[0]);
}

/* -- Scale ----------------------------------------------------------------- */

/* The axis goes @times as far as it is sent. */
static bool rescale(struct tour *w, double times)
{
	const struct config_drive *d = &w->config.drive[w->axis];
	struct tour_key key[] = { { .key = "drive_pulses" },
				  { .key = "drive_increments" } };
	double more = 1;

	if (!has_drives(w))
		return write_number(w, "pulse_mm",
				    limits_of(w)->pulse_mm * times);
	while (fabs(d->increments / times) * more < FINE &&
	       d->pulses * more * 10 <= PULSES_MOST)
		more *= 10;
	number(&key[0], d->pulses * more);
	number(&key[1], round(d->increments / times * more));
	return write_numbers(w, key, 2);
}

void tour_scale(struct tour *w)
{
	const double mm = tour_move(w, way(w, LONG_MM), FASTER, NULL);
	double is, times;

	if (isnan(mm) || !tour_number(w, mm, &is, "%c was sent by %.4f; how "
				      "far did it go, by a dial or a gauge",
				      tour_letter(w), mm))
		return;
	times = is / mm;
	if (!(times > 1e-4 && times < 1e4))
		tour_wrong(w, "%c went by %g in place of %g: not its scale; "
			   "take `direction` again", tour_letter(w), is, mm);
	else if (fabs(times - 1) <= SCALE_OFF)
		tour_good(w, "%c was sent by %.4f and went by %.4f: %.2f %%",
			  tour_letter(w), mm, is, 100 * times);
	else
		tour_wrong(w, "%c goes %.6g times as far as it is sent%s",
			   tour_letter(w), times, rescale(w, times) ?
			   "; its scale is corrected in the machine file" : "");
}

/* -- Limit switches -------------------------------------------------------- */

static bool has_limit(const struct tour *w)
{
	struct config_input input[CONFIG_NINPUTS];
	struct config_line_at at;
	struct interp_diag none;

	config_drive_inputs(w->config.drive[w->axis].inputs, input, &none);
	config_line_read(w->config.gpio.line[LINE_LIMIT + w->axis], &at);
	return has_drives(w) ? input[INPUT_LIMIT_LOW].wired &&
			       input[INPUT_LIMIT_HIGH].wired : at.wired;
}

static bool is_pressed(struct tour *w)
{
	struct shm_snapshot s;

	return shm_snapshot(w->status, &s) && s.limit >> w->axis & 1;
}

/* The fault is what is wanted; and back again, if it is at this end. */
static bool try_limit(struct tour *w, double mm)
{
	const char toward = mm < 0 ? '-' : '+';
	double went;

	fprintf(stderr, "press the limit switch of %c at its %c end while it "
		"moves\n", tour_letter(w), toward);
	w->fault_wanted = true;
	went = tour_move(w, mm, SLOWLY, NULL);
	w->fault_wanted = false;
	if (!isnan(went)) {
		tour_wrong(w, "%c did not stop for its switch at %c: it is "
			   "not wired to what the machine file says",
			   tour_letter(w), toward);
		return false;
	}
	if (strcmp(tour_state(w, "fault", 1)->fault, "limit-switch") != 0)
		return false;
	if (!is_pressed(w)) {
		tour_wrong(w, "the switch at %c of %c stopped it, and edmd "
			   "takes it for another axis's, or it was let go too early",
			   toward, tour_letter(w));
		return false;
	}
	tour_reset(w);
	fprintf(stderr, "keep it pressed: %c goes away from it\n",
		tour_letter(w));
	if (isnan(tour_move(w, -copysign(HAIR_MM, mm), SLOWLY, NULL))) {
		tour_wrong(w, "%c may not leave its switch at %c: limit_low "
			   "and limit_high are swapped", tour_letter(w),
			   toward);
		return false;
	}
	return tour_says_yes(w, "let it go; is it off");
}

void tour_limits(struct tour *w)
{
	const double mm = way(w, LONG_MM);

	if (!has_limit(w)) {
		tour_wrong(w, "the machine file has no limit switches of %c: "
			   "%s", tour_letter(w), has_drives(w) ?
			   "drive_inputs = limit_low:BIT limit_high:BIT" :
			   "gpio.limit_ = a line");
		return;
	}
	if (is_pressed(w)) {
		tour_wrong(w, "the limit switch of %c is on while nobody "
			   "presses it: it is inverted, or its wire is cut",
			   tour_letter(w));
		return;
	}
	if (try_limit(w, mm) && try_limit(w, -mm))
		tour_good(w, "%c stops for each of its switches and can leave "
			  "it", tour_letter(w));
}

/* -- Homing ---------------------------------------------------------------- */

static bool home(struct tour *w)
{
	char axis[2] = { tour_letter(w), '\0' };
	struct ctl sub = *w->ctl;

	if (w->by_hand)
		return tour_home_held(w);
	sub.verb = "home";
	sub.arg = axis;
	sub.wait = true;
	return ctl_home(&sub) == 0;
}

/* Which way it went tells what the switch said. */
static void tell_unfound(struct tour *w, double from_mm)
{
	const double gone = tour_place(w) - from_mm;
	const double toward = w->config.home_dir[w->axis] ? 1 : -1;
	const struct talk_status *s = tour_state(w, "fault", 1);
	const char *fault = s->fault;

	if (strcmp(s->state, "fault") != 0)
		tour_wrong(w, "%c was not homed to its end", tour_letter(w));
	else if (w->config.manual[w->axis].method > HOME_SWITCH_INDEX)
		tour_wrong(w, "%c was not homed: fault %s", tour_letter(w),
			   fault);
	else if (gone * toward < 0)
		tour_wrong(w, "%c left a home switch that did not go off: it "
			   "is inverted (!), or its wire is cut; fault %s",
			   tour_letter(w), fault);
	else
		tour_wrong(w, "%c went by %.3f, and its home switch did not "
			   "come on: it is not wired, or home_dir is the other "
			   "way; fault %s", tour_letter(w), gone, fault);
}

static double shift_mm(struct tour *w)
{
	struct shm_snapshot s;

	return shm_snapshot(w->status, &s) ? s.home_shift[w->axis] *
					     s.pulse_mm[w->axis] : NAN;
}

/* The edge is read once a period. */
static double expected_mm(struct tour *w)
{
	const double period_s = (double)config_period_ns(&w->config) * 1e-9;

	return 2 * (w->config.manual[w->axis].home_slow_mm_s * period_s +
		    limits_of(w)->pulse_mm);
}

void tour_home(struct tour *w)
{
	const double away = w->config.home_dir[w->axis] ? -SHORT_MM : SHORT_MM;
	double often = HOMES, low = INFINITY, high = -INFINITY, from, first = 0;
	json_t *y = json_array();
	char word[WORD_MAX];

	if (!tour_choose(w, "no go", word, "%c homes by itself",
			 tour_letter(w)) || strcmp(word, "go") != 0 ||
	    !tour_number(w, HOMES, &often, "how often")) {
		json_decref(y);
		return;
	}
	for (int i = 0; i < often && !talk_interrupted(); i++) {
		from = tour_place(w);
		if (!home(w)) {
			tell_unfound(w, from);
			break;
		}
		first = i == 0 ? shift_mm(w) : first;
		json_array_append_new(y, json_real(1e3 * (shift_mm(w) -
							  first)));
		low = fmin(low, shift_mm(w));
		high = fmax(high, shift_mm(w));
		if (i + 1 < often && isnan(tour_move(w, away, FASTER, NULL)))
			break;
	}
	if ((double)json_array_size(y) >= often) {
		const double um = 1e3 * (high - low);

		if (high - low <= expected_mm(w))
			tour_good(w, "%.0f homes of %c are within %.2f um",
				  often, tour_letter(w), um);
		else
			tour_wrong(w, "%.0f homes of %c are %.2f um apart, "
				   "more than a period's way: the switch is loose, "
				   "or bounces", often, tour_letter(w), um);
	}
	tour_plot(w, &(struct tour_plot) { "home, um from the first",
					   "homing", 1, y });
}

/* -- Following ------------------------------------------------------------- */

/* A place may belong to any of the last three targets: behind the nearest. */
static double behind_mm(const struct tour_trace *t, size_t i)
{
	double least = INFINITY;

	for (size_t k = 0; k < 3 && k <= i; k++) {
		const double mm = t->sent[i - k] - t->actual[i];

		least = fabs(mm) < fabs(least) ? mm : least;
	}
	return least;
}

static void plot_trace(struct tour *w, const struct tour_trace *t)
{
	const size_t stride = t->n / PLOT_POINTS + 1;
	const double step_s = t->period_s * (double)stride;
	json_t *at = json_array(), *behind = json_array();

	for (size_t i = 0; i < t->n; i += stride) {
		json_array_append_new(at, json_real(t->actual[i]));
		json_array_append_new(behind,
				      json_real(1e3 * behind_mm(t, i)));
	}
	tour_plot(w, &(struct tour_plot) { "place, mm", "s", step_s, at });
	tour_plot(w, &(struct tour_plot) { "behind its target, um", "s",
					   step_s, behind });
}

static double most_behind_mm(const struct tour_trace *t)
{
	double most = 0;

	for (size_t i = 0; i < t->n; i++)
		most = fmax(most, fabs(behind_mm(t, i)));
	return most;
}

/* Of the speed in so many samples; its ends count little (Hann), because what
 * an axis does there came from before. */
static double complex swing(const double *mm, size_t n, double step)
{
	double complex sum = 0;

	for (size_t i = 1; i < n; i++)
		sum += (mm[i] - mm[i - 1]) * cexp(-I * step * (double)i) *
		       (1 - cos(2 * M_PI * (double)i / (double)n));
	return sum;
}

/* What comes of what is asked for at so many Hz: 1 is all of it. */
static double complex response(const struct tour_trace *t, size_t from,
			       double hz)
{
	const double step = 2 * M_PI * hz * t->period_s;
	const size_t n = t->n - from;

	return swing(t->actual + from, n, step) /
	       swing(t->sent + from, n, step);
}

/* Where it goes HALF_POWER of what is asked, on a line between two of them. */
static double bandwidth_hz(const double hz[2], const double share[2])
{
	return hz[0] * pow(hz[1] / hz[0], (share[0] - HALF_POWER) /
					  (share[0] - share[1]));
}

static double fastest_mm_s(const struct tour_trace *t)
{
	double most = 0;

	for (size_t i = 10; i < t->n; i++)
		most = fmax(most, fabs(t->sent[i] - t->sent[i - 10]));
	return most / (10 * t->period_s);
}

/* To and fro in waves, ever faster.  Return: its bandwidth; 0: it is above. */
static double wave(struct tour *w, struct tour_trace *t)
{
	const double top_mm_s = fastest_mm_s(t) / (1 + WAVE);
	double share[2] = { 1, 1 }, hz[2] = { 0.1, WAVE_HZ }, found = 0;
	json_t *y = json_array();

	for (int i = 0; i < WAVES; i++, hz[0] = hz[1], hz[1] *= 2) {
		const double v_mm_s = fmin(top_mm_s, way(w, LONG_MM) / 2 *
						     hz[1] / WAVE_TIMES);
		const double mm = v_mm_s * WAVE_TIMES / hz[1];
		const struct tour_way go = {
			i % 2 ? -mm : mm, v_mm_s / limits_of(w)->v_max_mm_s,
			hz[1]
		};
		const size_t from = t->n;

		if (isnan(tour_go(w, &go, t))) {
			json_decref(y);
			return NAN;
		}
		share[0] = share[1];
		share[1] = cabs(response(t, from, hz[1]));
		json_array_append_new(y, json_real(100 * share[1]));
		if (found == 0 && share[1] < HALF_POWER)
			found = bandwidth_hz(hz, share);
	}
	tour_plot(w, &(struct tour_plot) { "what comes of 1 2 4 8 Hz, %",
					   "octaves", 1, y });
	return found;
}

/* What is told, into the machine file; its lost motion is a step of its own. */
static void write_loop(struct tour *w, const struct interp_identified *d)
{
	struct tour_key key[INTERP_IDENTIFY_BACKLASH];
	size_t n = 0;

	for (int i = 0; i < INTERP_IDENTIFY_BACKLASH; i++)
		if (d->told[i]) {
			key[n].key = ctl_identify_key[i];
			number(&key[n++], d->value[i]);
		}
	write_numbers(w, key, n);
}

static void tell_following(struct tour *w, const struct tour_trace *t,
			   double hz)
{
	const double most = most_behind_mm(t);
	char band[40] = "above 8 Hz";
	struct interp_identified d;

	if (hz > 0)
		snprintf(band, sizeof(band), "%.2g Hz", hz);
	if (interp_identify(&(struct interp_identify_trace) {
			.target_mm = t->sent, .actual_mm = t->actual,
			.n = t->n, .period_s = t->period_s }, &d) < 0 ||
	    !d.told[INTERP_IDENTIFY_GAIN]) {
		tour_good(w, "%c is behind by at most %.1f um, its bandwidth "
			  "is %s; the motion does not tell its loop",
			  tour_letter(w), 1e3 * most, band);
		return;
	}
	tour_good(w, "%c is behind by at most %.1f um, its bandwidth is %s; "
		  "the gain of its loop is %.3g 1/s, and its model is off by "
		  "%.2g um", tour_letter(w), 1e3 * most, band,
		  d.value[INTERP_IDENTIFY_GAIN], 1e3 * d.left_mm);
	write_loop(w, &d);
}

void tour_following(struct tour *w)
{
	const double mm = way(w, LONG_MM) / 2;
	struct tour_trace t = { .n = 0 };
	double went = 0, hz;

	for (int i = 0; i < 4 && !isnan(went); i++)
		went = tour_move(w, i % 2 ? -mm : mm, i < 2 ? SLOWLY : FASTER,
				 &t);
	if (!isnan(went) && t.n > 1 &&
	    most_behind_mm(&t) <= 2 * limits_of(w)->pulse_mm)
		tour_good(w, "%c is where it is sent, within %.2f um",
			  tour_letter(w), 1e3 * most_behind_mm(&t));
	else if (!isnan(went) && t.n > 1 && !isnan(hz = wave(w, &t)))
		tell_following(w, &t, hz);
	plot_trace(w, &t);
	free(t.sent);
	free(t.actual);
}

/* -- Backlash -------------------------------------------------------------- */

void tour_backlash(struct tour *w)
{
	const double mm = way(w, SHORT_MM);
	double um = 0, went, back;

	if (isnan(tour_move(w, mm, SLOWLY, NULL)) ||
	    !tour_says_yes(w, "set the dial to 0; is it"))
		return;
	went = tour_move(w, mm, SLOWLY, NULL);
	back = isnan(went) ? NAN : tour_move(w, -went, SLOWLY, NULL);
	if (isnan(back) || !tour_number(w, 0, &um, "%c is back within %.1f um; "
					"what does the dial read, um",
					tour_letter(w), 1e3 * (went + back)))
		return;
	um = fabs(um - 1e3 * (went + back));
	if (um < 2e3 * limits_of(w)->pulse_mm) {
		tour_good(w, "%c has no lost motion that the dial shows",
			  tour_letter(w));
		return;
	}
	um += w->config.backlash[w->axis].um;
	tour_good(w, "%c has a lost motion of %.1f um", tour_letter(w), um);
	write_number(w, "backlash_um", round(um * 10) / 10);
}
