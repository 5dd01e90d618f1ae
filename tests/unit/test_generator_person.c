/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_generator_person.c - a whole cycle with a generator on CAN that has all
 * of it later, tells some currents alike, and is switched off and on, while a
 * person holds, retracts, steps, resets, sets values and takes them back
 */
#include "generator_help.h"

#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#define LATE_MOST	15		/* periods; settle_ms is 20 */
#define WAYS_MOST	64
#define CUTS		60
#define NCONDS		6
#define CUT_MM		0.02
#define OWN		0xffff		/* as the frame has it */
#define FIELDS		3		/* current, on, off */

static const char machine[] =
	"[machine]\nbackend = null\nperiod_us = 1000\n"
	"[generator]\ninterface = can\ncan_id = 1009\n"
	"told_peak_a = can 1011 byte 0 bits 8 scale 0.5\n"
	"told_polarity = can 1011 byte 1 bit 0\n"
	"told_on_us = can 1011 byte 2 bits 16 scale 0.1\n"
	"told_off_us = can 1011 byte 4 bits 16 scale 0.1\n"
	"settle_ms = 20\npolarity_ms = 3\nsilent_ms = 20\nconfirm_s = 0.1\n";

static const enum interp_tech_id field[FIELDS] = {
	INTERP_TECH_PEAK_A, INTERP_TECH_ON_US, INTERP_TECH_OFF_US
};

struct has {
	uint16_t tenths[FIELDS];
	bool negative;
};

struct far {
	struct has has, way[WAYS_MOST];
	int due[WAYS_MOST], n, now, late;
	bool sparks;			/* at once */
	int hurt;			/* turns since it lost all */
};

struct scene {
	struct shop s;
	struct far far;
	struct interp_tech tech[NCONDS];
	double over[NCONDS][INTERP_NTECH];	/* what was set; NAN */
	double far_mm;
	uint64_t seed, sparks, sets, losses, back;	/* back: turns */
	int fd;
};

static double any_of(uint64_t *seed, const double *v, uint64_t n)
{
	return v[rnd(seed) % n];
}

static double any_value(uint64_t *seed, enum interp_tech_id id)
{
	static const double peak[] = { 6, 6.2, 9, 12, 12.1, (double)NAN };
	static const double us[] = { 8, 20, 50, (double)NAN };
	static const double turn[] = { 1, -1, (double)NAN };

	return id == INTERP_TECH_PEAK_A ? any_of(seed, peak, 6) :
	       id == INTERP_TECH_POLARITY ? any_of(seed, turn, 3) :
					    any_of(seed, us, 4);
}

/* -- The generator --------------------------------------------------------- */

static void far_takes(struct far *f, const struct can_frame *m)
{
	const int last = f->n ? f->due[f->n - 1] : 0;
	const int due = f->now + f->late;
	struct has h = { .negative = m->data[0] >> 2 & 1 };

	for (int i = 0; i < FIELDS; i++)
		h.tenths[i] = (uint16_t)can_get(m->data + 2 + 2 * i, 2);
	assert_true(f->n < WAYS_MOST);
	f->due[f->n] = due > last ? due : last;
	f->way[f->n++] = h;
	f->sparks = m->data[0] & 1;
}

static void far_loses(struct scene *w)
{
	w->far.has = (struct has) { { OWN, OWN, OWN }, false };
	w->far.n = 0;
	w->far.hurt = 1;		/* until it has what it is asked */
	w->losses++;
}

static void far_turn(struct far *f)
{
	int n = 0;

	f->now++;
	while (n < f->n && f->due[n] <= f->now)
		f->has = f->way[n++];
	f->n -= n;
	memmove(f->way, f->way + n, (size_t)f->n * sizeof(f->way[0]));
	memmove(f->due, f->due + n, (size_t)f->n * sizeof(f->due[0]));
}

static void far_tells(const struct scene *w)
{
	const struct has *h = &w->far.has;
	struct can_frame m = { .can_id = 1011, .can_dlc = 8 };

	m.data[0] = (uint8_t)(h->tenths[0] / 5);
	m.data[1] = h->negative;
	can_put(m.data + 2, h->tenths[1], 2);
	can_put(m.data + 4, h->tenths[2], 2);
	assert_int_equal(write(w->fd, &m, sizeof(m)), sizeof(m));
}

/* -- What the place asks for ----------------------------------------------- */

static double of_place(const struct scene *w, enum interp_tech_id id)
{
	const uint32_t i = cond_cut(&w->s.r.c.cursor)->number;

	return isnan(w->over[i][id]) ? w->tech[i].v[id] : w->over[i][id];
}

static bool has_the_places(const struct scene *w)
{
	bool all = w->far.has.negative ==
		   (of_place(w, INTERP_TECH_POLARITY) < 0);

	for (int i = 0; i < FIELDS; i++) {
		const double v = of_place(w, field[i]);

		all = all && w->far.has.tenths[i] ==
			     (isnan(v) ? OWN : lround(10 * v));
	}
	return all;
}

/* It tells what it lost in that period, and the frame that ends the sparks goes
 * out. */
static void check_spark(struct scene *w)
{
	const bool has = has_the_places(w);

	w->far.hurt = has || !w->far.hurt ? 0 : w->far.hurt + 1;
	if (!w->far.sparks)
		return;
	w->sparks++;
	assert_true(has || w->far.hurt == 2);
}

/* -- The person ------------------------------------------------------------ */

/* The condition at the farthest place, where no other is beside it. */
static int cond_set(const struct scene *w)
{
	const double cut = w->far_mm / CUT_MM;
	const double in = cut - floor(cut);

	return in < 0.3 || in > 0.7 ? -1 : (int)cut % NCONDS;
}

static void person_sets(struct scene *w)
{
	static const enum interp_tech_id id[] = {
		INTERP_TECH_PEAK_A, INTERP_TECH_ON_US, INTERP_TECH_OFF_US,
		INTERP_TECH_POLARITY
	};
	const enum interp_tech_id at = id[rnd(&w->seed) % 4];
	const struct cycle_command m = {
		.verb = CYCLE_SET, .arg = at, .arg_mm = any_value(&w->seed, at),
	};
	const int i = cond_set(w);

	if (i < 0 || cycle_command(&w->s.r.c, &m) != ANSWER_DONE)
		return;
	w->over[i][at] = m.arg_mm;
	w->sets++;
}

static void person(struct scene *w)
{
	struct rig *r = &w->s.r;

	switch (rnd(&w->seed) % 8) {
	case 0:
		tell(r, CYCLE_HOLD);
		break;
	case 1:
		tell_mm(r, CYCLE_RETRACT, 0.01 * (double)(rnd(&w->seed) % 8));
		break;
	case 2:
		tell_mm(r, CYCLE_STEP, rnd(&w->seed) % 2 ? 1 : -1);
		break;
	case 3:
		person_sets(w);
		break;
	default:
		tell(r, CYCLE_RESET);
		tell(r, CYCLE_START);
		break;
	}
}

/* -- Both ------------------------------------------------------------------ */

static void scene_load(struct scene *w, const struct cycle_config *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	double end[INTERP_NAXES];
	struct interp_diag d;

	for (int i = 0; i < NCONDS; i++) {
		interp_tech_clear(&w->tech[i]);
		for (int n = 0; n < FIELDS; n++)
			w->tech[i].v[field[n]] = any_value(&w->seed, field[n]);
		w->tech[i].v[INTERP_TECH_POLARITY] =
			any_value(&w->seed, INTERP_TECH_POLARITY);
		for (int n = 0; n < INTERP_NTECH; n++)
			w->over[i][n] = (double)NAN;
	}
	memcpy(end, interp_build_here(b), sizeof(end));
	for (int i = 0; i < CUTS; i++) {
		const struct interp_build_word word = {
			.line = 1, .feed_mm_s = 10,
			.tech = &w->tech[i % NCONDS],
			.cond_letter = 'C', .cond_number = (uint32_t)i % NCONDS,
		};

		end[INTERP_Z] = -CUT_MM * (i + 1);
		assert_int_equal(interp_build_line(b, end, &word, &d), 0);
	}
	rig_load(&w->s.r, b, k);
	w->far_mm = 0;
	assert_int_equal(tell(&w->s.r, CYCLE_START), ANSWER_DONE);
}

static void scene_open(struct scene *w)
{
	struct interp_diag d;
	int fd[2];

	memset(&w->s, 0, sizeof(w->s));
	w->far = (struct far) { .has = { { OWN, OWN, OWN }, false } };
	assert_int_equal(read_text(machine, &w->s.c, &d), 0);
	w->s.axes = (struct io_machine) { .read = no_read, .write = no_write,
					  .close = no_close };
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    fd), 0);
	assert_non_null(generator_attach(&w->s.axes, &w->s.c, fd[0]));
	w->fd = fd[1];
}

static void scene_close(struct scene *w)
{
	w->s.axes.close(w->s.axes.self);
	close(w->fd);
}

static void turn_of_edmd(struct scene *w, double gap_v)
{
	struct rig *r = &w->s.r;
	struct can_frame m;
	char line[160];

	w->s.axes.read(w->s.axes.self, &r->in);
	step(r, asking_waits(&r->c) ? 0 : gap_v);
	w->back += r->c.state == STATE_RETRACT || r->c.state == STATE_JUMP;
	w->far_mm = fmax(w->far_mm, place(r));
	w->s.axes.write(w->s.axes.self, &r->out);
	while (read(w->fd, &m, sizeof(m)) == sizeof(m))
		far_takes(&w->far, &m);
	while (w->s.axes.note(w->s.axes.self, line, sizeof(line)))
		;
}

static void any_turn(struct scene *w)
{
	if (rnd(&w->seed) % 50 == 0)
		w->far.late = (int)(rnd(&w->seed) % LATE_MOST);
	if (rnd(&w->seed) % 3000 == 0)
		far_loses(w);
	far_turn(&w->far);
	check_spark(w);
	far_tells(w);
	if (rnd(&w->seed) % 60 == 0)
		person(w);
	turn_of_edmd(w, rnd(&w->seed) % 200 ? SPARKING_V + 5 : SHORTED_V);
}

static void no_spark_has_another_condition_than_its_place(void **state)
{
	const int rounds = SEED_ROUNDS(1000000);
	const uint64_t turns = (uint64_t)rounds;
	struct scene w = { .seed = seed_take() };

	(void)state;
	for (int left = rounds; left > 0;) {
		struct cycle_config k;

		scene_open(&w);
		k = shop_config(&w.s);
		k.jump.height_mm = 0.06;
		scene_load(&w, &k);
		while (w.s.r.c.loaded && left-- > 0)
			any_turn(&w);
		rig_free(&w.s.r);
		scene_close(&w);
	}
	assert_in_range(w.sparks, turns / 1000, turns);
	assert_in_range(w.back, turns / 1000, turns);
	assert_in_range(w.sets, turns / 10000, turns);
	assert_in_range(w.losses, turns / 100000, turns);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_spark_has_another_condition_than_its_place),
	};

	return cmocka_run_group_tests_name("io/generator person", tests,
					   make_file, remove_file);
}
