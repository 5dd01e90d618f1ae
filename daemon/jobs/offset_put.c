/* SPDX-License-Identifier: Apache-2.0 */
/* offset_put.c - what was felt goes into an offset or an electrode */
#include "offset_put.h"

#include "compiling.h"
#include "keys.h"

#include <stdio.h>
#include <string.h>

const char *offset_name(int work)
{
	return config_section[SECTION_WORK].instance[work];
}

static void of_config(const struct machine_config *c,
		      double mm[INTERP_NC_NWORK][WORK_NROWS])
{
	memset(mm, 0, INTERP_NC_NWORK * sizeof(*mm));
	for (int i = 0; i < INTERP_NC_NWORK; i++)
		memcpy(mm[i], c->work_offset_mm[i],
		       sizeof(c->work_offset_mm[i]));
}

/* Those of job @n; 0: those in force. */
int offset_read(struct jobs *j, uint32_t n,
		    double mm[INTERP_NC_NWORK][WORK_NROWS],
		    uint32_t set[INTERP_NC_NWORK])
{
	of_config(j->config, mm);
	return store_work_read(j->store, n, mm, set);
}

/* -- Written down, and told ------------------------------------------------ */

static const char *const row_names[] = {
	[WORK_TURN] = "turn from X toward Y",
	[WORK_TILT_X] = "tilt along X",
	[WORK_TILT_Y] = "tilt along Y",
};

static bool is_beyond(const struct jobs *j, int row, double is)
{
	const struct interp_axis_limits *a = &j->config->axes.axis[row];

	return row < INTERP_NAXES &&
	       (is < a->travel_min_mm || is > a->travel_max_mm);
}

/* Of every axis, and how it lies: what it was, and what it is. */
static void tell(const struct jobs *j, int work, const double *was,
		 const double *is, char to[TOUCH_WHY_MAX])
{
	const size_t size = TOUCH_WHY_MAX;
	size_t n = (size_t)snprintf(to, size, "%s:", offset_name(work));

	for (int i = 0; i < WORK_NROWS && n < size; i++) {
		const char letter[] = { INTERP_AXIS_LETTERS
					[i < INTERP_NAXES ? i : 0], '\0' };

		if (was[i] == is[i])
			continue;
		n += (size_t)snprintf(to + n, size - n, "%s %s was %.4f, is "
				      "%.4f%s%s", to[n - 1] == ':' ? "" : ";",
				      i < INTERP_NAXES ? letter : row_names[i],
				      was[i], is[i], i < INTERP_NAXES ? "" :
				      " degrees", is_beyond(j, i, is[i]) ?
				      ", beyond the travel" : "");
	}
	if (n < size && to[n - 1] == ':')
		snprintf(to + n, size - n, " as it was");
}

/* Does C turn the electrode, and not the work? */
bool offset_has_c(const struct jobs *j)
{
	struct interp_kinematics k;
	struct interp_diag none;

	return j->config->axes.present >> INTERP_C & 1 &&
	       (config_kinematics(j->config, &k, &none) < 0 ||
		!interp_kin_turns_work(&k, INTERP_C));
}

/* By what an electrode is turned where C stands. */
static struct interp_turn turn_by_c(const struct jobs *j, double c_deg)
{
	return interp_turn_of(offset_has_c(j) ? c_deg : 0, false);
}

/* The electrode in the holder, with C where it stands. */
static void by_electrode(struct jobs *j, double c_deg,
			 double ret[INTERP_NAXES])
{
	const uint32_t held = electrode_held(j);
	const struct interp_turn c = turn_by_c(j, c_deg);
	struct store_electrode e;

	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	if (held == 0 || store_electrode_find(j->store, held, &e) < 0)
		return;
	store_electrode_by(&e, ret);
	interp_turn_to(&c, ret, ret);
}

/* As the system is turned, what was felt is a place along its own axes. */
static void origin_of(struct jobs *j, const struct touch *t,
		      const struct shm_snapshot *s,
		      const double was[WORK_NROWS], double ret_mm[INTERP_NAXES])
{
	const uint32_t counts = t->form ? t->felt : t->here;
	const struct interp_turn turn = interp_turn_of(was[WORK_TURN], false);
	double at[INTERP_NAXES], by[INTERP_NAXES];

	touch_at_mm(t, s, at);
	by_electrode(j, at[INTERP_C], by);
	for (int i = 0; i < INTERP_NAXES; i++)
		at[i] -= by[i];
	interp_turn_back(&turn, at, at);
	interp_turn_back(&turn, was, ret_mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		if (counts >> i & 1)
			ret_mm[i] = at[i] - touch_zero_mm(t, i);
	interp_turn_to(&turn, ret_mm, ret_mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		if (t->at >> i & 1)
			ret_mm[i] = t->mm[i];
}

static int put_axes(struct jobs *j, const struct touch *t,
		    const struct shm_snapshot *s, const double was[WORK_NROWS])
{
	uint32_t axes = t->at | (t->form ? t->felt : t->here);
	const uint32_t xy = 1u << INTERP_X | 1u << INTERP_Y;
	double is[WORK_NROWS];

	/* Along a turned axis both of the machine's move. */
	if (was[WORK_TURN] != 0 && axes & xy & ~t->at)
		axes |= xy;
	origin_of(j, t, s, was, is);
	return store_work_put(j->store, t->work, axes, is);
}

static int put_skew(struct jobs *j, const struct touch *t,
		    const struct shm_snapshot *s, const double was[WORK_NROWS])
{
	static const enum store_work_row rows[] = {
		[TOUCH_TURN] = WORK_TURN, [TOUCH_TILT_X] = WORK_TILT_X,
		[TOUCH_TILT_Y] = WORK_TILT_Y,
	};
	double is[WORK_NROWS], deg;
	const enum store_work_row row = rows[touch_angle(t, s, &deg)];
	uint32_t changes = 1u << row;

	is[row] = deg;
	/* The electrode goes with the work. */
	if (row == WORK_TURN && offset_has_c(j)) {
		is[INTERP_C] = was[INTERP_C] + deg - was[WORK_TURN];
		changes |= 1u << INTERP_C;
	}
	return store_work_put(j->store, t->work, changes, is);
}

static int change_work(struct jobs *j, const struct touch *t,
		       const struct shm_snapshot *s,
		       const double was[WORK_NROWS])
{
	if (t->clear)
		return store_work_clear(j->store, t->work);
	return t->form == TOUCH_SKEW ? put_skew(j, t, s, was) :
				       put_axes(j, t, s, was);
}

static int put_work(struct jobs *j, const struct touch *t,
		    const struct shm_snapshot *s, char told[TOUCH_WHY_MAX])
{
	double was[INTERP_NC_NWORK][WORK_NROWS];
	double is[INTERP_NC_NWORK][WORK_NROWS];
	int err = offset_read(j, 0, was, NULL);

	if (err == 0)
		err = change_work(j, t, s, was[t->work]);
	if (err == 0)
		err = offset_read(j, 0, is, NULL);
	if (err == 0)
		tell(j, t->work, was[t->work], is[t->work], told);
	return err;
}

/* The middle of the reference was found where the holder stands beside it by
 * what the electrode shifts X Y. */
static void middle_of(const struct jobs *j, const struct touch *t,
		      const struct shm_snapshot *s, struct store_electrode *e)
{
	const struct config_measure *m = &j->config->measure;
	double at[INTERP_NAXES], by[INTERP_NAXES] = { 0 };
	struct interp_turn c;

	touch_at_mm(t, s, at);
	by[INTERP_X] = at[INTERP_X] - (t->here >> INTERP_X & 1 ?
				       t->mm[INTERP_X] : m->x_mm);
	by[INTERP_Y] = at[INTERP_Y] - (t->here >> INTERP_Y & 1 ?
				       t->mm[INTERP_Y] : m->y_mm);
	c = turn_by_c(j, at[INTERP_C]);
	interp_turn_back(&c, by, by);
	if (t->felt >> INTERP_X & 1)
		e->x_mm = by[INTERP_X];
	if (t->felt >> INTERP_Y & 1)
		e->y_mm = by[INTERP_Y];
}

/* How the electrode sits: its middle, or its turn. */
static int put_seat(struct jobs *j, const struct touch *t,
		    const struct shm_snapshot *s, char told[TOUCH_WHY_MAX])
{
	struct store_electrode e, was;
	double deg;
	int err = store_electrode_find(j->store, t->electrode, &e);

	if (err < 0)
		return err;
	was = e;
	if (t->form == TOUCH_SKEW) {
		touch_angle(t, s, &deg);
		e.c_deg = s->pos[INTERP_C] * s->pulse_mm[INTERP_C] - deg;
		snprintf(told, TOUCH_WHY_MAX, "electrode %u: C was %.4f, is "
			 "%.4f degrees; its face was turned by %.4f degrees "
			 "where C stands", e.n, was.c_deg, e.c_deg, deg);
	} else {
		middle_of(j, t, s, &e);
		snprintf(told, TOUCH_WHY_MAX, "electrode %u: X was %.4f, is "
			 "%.4f mm; Y was %.4f, is %.4f mm", e.n, was.x_mm,
			 e.x_mm, was.y_mm, e.y_mm);
	}
	return store_electrode_put(j->store, &e);
}

/* Without a number the face is the reference of the machine file. */
static int put_electrode(struct jobs *j, const struct touch *t,
			 const struct shm_snapshot *s, char told[TOUCH_WHY_MAX])
{
	const double face_mm = t->here ? 0 : j->config->measure.reference_z_mm;
	double at[INTERP_NAXES];

	touch_at_mm(t, s, at);
	return electrode_put_length(j, t->electrode, at[INTERP_Z] -
				    touch_zero_mm(t, INTERP_Z) - face_mm,
				    t->is_new, told);
}

static bool is_seat(const struct touch *t)
{
	return t->work < 0 && t->form && t->form != TOUCH_EDGE;
}

int offset_put(struct jobs *j, const struct touch *t,
	       const struct shm_snapshot *s, char told[TOUCH_WHY_MAX])
{
	return t->work >= 0 ? put_work(j, t, s, told) :
	       is_seat(t) ? put_seat(j, t, s, told) :
			    put_electrode(j, t, s, told);
}

/* Where programs of a system count from, with the electrode in the holder: as
 * struct interp_origin has it. */
void offset_origin(struct jobs *j, int work,
			const double row[WORK_NROWS], struct interp_origin *ret)
{
	const struct shm_snapshot *s = &j->link.snap;
	const struct interp_turn t = interp_turn_of(row[WORK_TURN], false);

	*ret = (struct interp_origin) {
		.work = (uint16_t)work, .turn_deg = row[WORK_TURN],
	};
	by_electrode(j, s->pos[INTERP_C] * s->pulse_mm[INTERP_C], ret->mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		ret->mm[i] += row[i];
	interp_turn_back(&t, ret->mm, ret->mm);
}
