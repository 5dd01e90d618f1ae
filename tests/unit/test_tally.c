/* SPDX-License-Identifier: Apache-2.0 */
/* test_tally.c - daemon/jobs/tally.h: what a job comes to */
#include "seed.h"

#include "tally.c"

#define PERIOD_NS	1000000

/* -- The rest of edmd-jobs ------------------------------------------------- */

static struct jobs j;
static struct tally stored;		/* as the store has it */
static bool resumed;
static double ground_mm;		/* where a resumed job goes on */
static int used_writes, trail_writes, faults;
static struct store_fault fault;

int inside_read(struct jobs *jobs, uint32_t n, struct inside *ret)
{
	(void)jobs, (void)n;
	*ret = (struct inside) { .from_mm = ground_mm };
	return resumed ? 0 : -1;
}

void inside_whole(const struct inside *a, struct shm_snapshot *s)
{
	s->place_mm += a->from_mm;
}

int store_fault(struct store *s, uint32_t n, const struct store_fault *f)
{
	(void)s, (void)n;
	fault = *f;
	faults++;
	return 0;
}

void tally_read(struct jobs *jobs, struct tally *t)
{
	(void)jobs;
	if (stored.n == t->n)
		*t = stored;
}

void calls_write(struct jobs *jobs)
{
	jobs->calls.n = 0;
}

void tally_write_used(struct jobs *jobs, const struct tally *t)
{
	(void)jobs;
	used_writes++;
	stored = *t;
}

void tally_write_trail(struct jobs *jobs, const struct tally *t)
{
	(void)jobs, (void)t;
	trail_writes++;
}

static uint32_t draw(uint64_t *seed)
{
	*seed = *seed * UINT64_C(6364136223846793005) + 1442695040888963407;
	return (uint32_t)(*seed >> 33);
}

/* -- A job ----------------------------------------------------------------- */

static int setup(void **state)
{
	(void)state;
	memset(&j, 0, sizeof(j));
	memset(&stored, 0, sizeof(stored));
	used_writes = trail_writes = faults = 0;
	resumed = false;
	ground_mm = 0;
	j.queue.job.n = 7;
	j.queue.snap = (struct shm_snapshot) {
		.program = 7, .period_ns = PERIOD_NS, .state = SHM_ERODE,
		.length_mm = 100, .cond_letter = 'C', .cond_number = 100,
		.pulse_mm = { 1e-3, 1e-3, 1e-3 },
	};
	return 0;
}

static void look(double s)
{
	j.queue.snap.job_cycles += (uint64_t)(s * 1e9 / PERIOD_NS);
	tally_look(&j, (int64_t)((double)j.queue.snap.job_cycles * PERIOD_NS /
				 1e3));
}

static struct tally_sums sum_of_rows(void)
{
	struct tally_sums sum = { .job_s = 0 };

	for (uint32_t i = 0; i < j.tally.nrows; i++) {
		const struct tally_sums *r = &j.tally.row[i].sums;

		sum.job_s += r->job_s;
		sum.energy_j += r->energy_j;
		sum.retracts += r->retracts;
		sum.shorts += r->shorts;
	}
	return sum;
}

static void rows_are_the_sums(void)
{
	const struct tally_sums sum = sum_of_rows();
	const struct shm_snapshot *s = &j.queue.snap;

	assert_true(fabs(sum.job_s - (double)s->job_cycles * PERIOD_NS / 1e9) <
		    1e-3);
	assert_true(fabs(sum.energy_j - s->energy_j) < 1e-3);
	assert_int_equal(sum.retracts, s->retracts);
	assert_int_equal(sum.shorts, s->shorts);
}

/* -- Sums ------------------------------------------------------------------ */

/* The service is killed at any time and finds what was stored; now and then the
 * host dies, and the sums go on from an older checkpoint. */
static void the_rows_add_up_whatever_happens(void **state)
{
	uint64_t seed = seed_take();
	struct shm_snapshot checkpoint;

	(void)state;
	look(1);
	checkpoint = j.queue.snap;
	for (int i = 0; i < 20000; i++) {
		struct shm_snapshot *s = &j.queue.snap;
		const uint32_t what = draw(&seed) % 100;

		s->cond_number = 100 + draw(&seed) % 130;
		s->retracts += what < 20;
		s->shorts += what < 30;
		s->energy_j += what;
		if (what == 0)
			tally_forget(&j);
		if (what == 1)
			checkpoint = *s;
		if (what == 2) {
			tally_forget(&j);
			*s = checkpoint;
		}
		look(0.02 * what);
	}
	/* It has caught up with what was seen before. */
	look(1e6);
	j.queue.snap.retracts += 100000;
	j.queue.snap.shorts += 100000;
	j.queue.snap.energy_j += 1e9;
	look(1);
	rows_are_the_sums();
	assert_int_equal(j.tally.nrows, TALLY_CONDITIONS);
	assert_string_equal(j.tally.row[TALLY_CONDITIONS - 1].condition,
			    "others");
}

static void what_was_missed_goes_to_the_condition_in_force(void **state)
{
	(void)state;
	look(3);
	j.queue.snap.cond_number = 200;
	tally_end(&j, &j.queue.snap, true);
	assert_int_equal(j.tally.nrows, 1);
	tally_forget(&j);
	look(5);
	assert_string_equal(j.tally.row[1].condition, "C200");
	assert_true(fabs(j.tally.row[1].sums.job_s - 5) < 1e-9);
	rows_are_the_sums();
}

static void energy_that_was_not_counted_stays_unknown(void **state)
{
	(void)state;
	j.queue.snap.energy_j = 5;
	look(1);
	assert_true(j.tally.row[0].sums.energy_j == 5);
	j.queue.snap.energy_j = NAN;
	look(1);
	j.queue.snap.energy_j = NAN;
	look(1);
	assert_true(isnan(j.tally.row[0].sums.energy_j));
	assert_true(fabs(j.tally.row[0].sums.job_s - 3) < 1e-9);
}

/* -- Trail ----------------------------------------------------------------- */

static void a_trail_of_any_length_has_room(void **state)
{
	struct shm_snapshot *s = &j.queue.snap;
	const struct tally_point *p = j.tally.point;

	(void)state;
	s->length_mm = 1e4;
	s->job_cycles = 0;
	tally_look(&j, 0);
	for (int i = 1; i <= 1000000; i++) {
		s->pos[0] = i * 10;
		s->place_mm = i * 0.01;
		look(0.02);
	}
	tally_end(&j, s, true);
	assert_true(j.tally.npoints > TALLY_POINTS / 4);
	assert_true(j.tally.npoints <= TALLY_POINTS);
	assert_true(p[0].place_mm == 0 && p[0].mm[0] == 0);
	assert_true(p[j.tally.npoints - 1].place_mm == 1e4);
	for (uint32_t i = 1; i < j.tally.npoints; i++) {
		assert_true(p[i].place_mm > p[i - 1].place_mm);
		assert_true(p[i].place_mm - p[i - 1].place_mm < 200);
		assert_true(fabs(p[i].mm[0] - p[i].place_mm) < 1e-6);
	}
}

static void ways_back_are_no_part_of_the_trail(void **state)
{
	struct shm_snapshot *s = &j.queue.snap;
	uint32_t n;

	(void)state;
	for (int i = 1; i <= 100; i++) {
		s->pos[0] = i * 100;
		s->place_mm = i * 0.1;
		look(0.02);
	}
	n = j.tally.npoints;
	s->state = SHM_RETRACT;
	for (int i = 100; i > 50; i--) {
		s->pos[0] = i * 100;
		s->place_mm = i * 0.1;
		look(0.02);
	}
	s->state = SHM_APPROACH;
	look(0.02);
	assert_int_equal(j.tally.npoints, n);
}

static struct shm_event event(uint32_t kind, int code, int64_t time_ns)
{
	return (struct shm_event) {
		.kind = kind, .code = code, .program = 7, .time_ns = time_ns,
		.place_mm = 50, .line = 12,
	};
}

static uint32_t retracts(void)
{
	uint32_t n = 0;

	for (int i = 0; i < TALLY_SPOTS; i++)
		n += j.tally.spot[i].retracts;
	return n;
}

static void an_event_that_comes_again_is_counted_once(void **state)
{
	struct shm_event e = event(SHM_EV_STATE, SHM_RETRACT, 1000);

	(void)state;
	look(1);
	tally_event(&j, &e, false);
	tally_event(&j, &e, true);
	assert_int_equal(retracts(), 1);
	assert_int_equal(j.tally.spot[TALLY_SPOTS / 2].line, 12);
	/* A new one, while the clock jumped back. */
	e.time_ns = 500;
	tally_event(&j, &e, false);
	assert_int_equal(retracts(), 2);
	e.program = 8;
	tally_event(&j, &e, false);
	assert_int_equal(retracts(), 2);
}

static void places_are_those_of_the_whole_program(void **state)
{
	const struct shm_event e = event(SHM_EV_FAULT, FAULT_ESTOP, 1000);

	(void)state;
	resumed = true;
	ground_mm = 30;
	look(1);
	tally_event(&j, &e, false);
	assert_int_equal(faults, 1);
	assert_true(fault.place_mm == 80 && fault.line == 12);
	assert_string_equal(fault.fault, "e-stop");
}

/* -- Disk ------------------------------------------------------------------ */

static void a_cut_that_never_ends_writes_seldom(void **state)
{
	(void)state;
	for (int s = 0; s < 86400; s++)
		look(1);
	assert_true(used_writes <= 1);
	assert_true(trail_writes <= 48);
	used_writes = 0;
	for (int s = 0; s < 86400; s++) {
		j.queue.snap.cond_number = 100 + (uint32_t)s % 2;
		look(1);
	}
	assert_true(used_writes <= 480);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
#define T(f) cmocka_unit_test_setup(f, setup)
		T(the_rows_add_up_whatever_happens),
		T(what_was_missed_goes_to_the_condition_in_force),
		T(energy_that_was_not_counted_stays_unknown),
		T(a_trail_of_any_length_has_room),
		T(ways_back_are_no_part_of_the_trail),
		T(an_event_that_comes_again_is_counted_once),
		T(places_are_those_of_the_whole_program),
		T(a_cut_that_never_ends_writes_seldom),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
