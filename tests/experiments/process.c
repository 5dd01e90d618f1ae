/* SPDX-License-Identifier: Apache-2.0 */
/*
 * process.c - the simulated gap, one relation after another, as data to plot
 *
 *	process RELATION [MACHINE-FILE]		process: names the relations
 *
 * The electrode is put where the relation wants it, with no servo between; the
 * rows are what the backend then says.  Columns are named in the first line.
 */
#include "config.h"
#include "io.h"
#include "make_program.h"

#include <string.h>

#define WARM	200		/* cycles before a reading */
#define READ	400

struct rig {
	struct machine_config k;
	struct io_machine m;
	struct io_outputs out;
	struct io_inputs in;
};

static struct machine_config base;	/* the machine file, without chance */
static double bridge_per_s;		/* of the machine file */

static void rig_open(struct rig *r)
{
	if (io_sim_open_seed(&r->m, &r->k, 1))
		abort();
	r->out = (struct io_outputs) { .path = 1, .power = true };
	io_pulse_own(&r->out);
	r->m.write(r->m.self, &r->out);
}

static void rig_close(struct rig *r)
{
	r->m.close(r->m.self);
}

static struct io_sim_result result(const struct rig *r)
{
	struct io_sim_result v;

	io_sim_result(&r->m, &v);
	return v;
}

static void period(struct rig *r)
{
	r->m.write(r->m.self, &r->out);
	r->m.read(r->m.self, &r->in);
}

/* Follow the front at @gap_mm, clear of the debris, for @n periods. */
static void follow(struct rig *r, double gap_mm, int n)
{
	for (int i = 0; i < n; i++) {
		const struct io_sim_result v = result(r);

		r->out.place_mm += v.gap_mm - gap_mm -
				   r->k.sim.debris_gap_mm * v.debris;
		r->out.target[INTERP_Z] = -(int32_t)lround(1000 *
							   r->out.place_mm);
		period(r);
	}
}

static double rate(struct rig *r, double gap_mm)
{
	const double before = result(r).removed_mm3;

	follow(r, gap_mm, READ);
	return (result(r).removed_mm3 - before) / READ * 60 * 1e6 /
	       (r->k.period_us > 0 ? r->k.period_us : 1000);
}

static double rate_of(const struct rig *how, double gap_mm)
{
	struct rig r = { .k = how->k };
	double v;

	rig_open(&r);
	memcpy(r.out.pulse, how->out.pulse, sizeof(r.out.pulse));
	v = rate(&r, gap_mm);
	rig_close(&r);
	return v;
}

static struct rig plain(void)
{
	struct rig r = { .k = base };

	io_pulse_own(&r.out);
	return r;
}

/* -- Relations over the gap ----------------------------------------------- */

static void gap(void)
{
	printf("gap_um volts open spark arc short mm3_min\n");
	for (double um = 0; um <= 70; um += 0.5) {
		struct rig r = plain();

		rig_open(&r);
		follow(&r, um * 1e-3, 1);
		printf("%g %.4f %.5f %.5f %.5f %.5f %.4f\n", um, r.in.gap_v,
		       (double)r.in.shares.open, (double)r.in.shares.spark,
		       (double)r.in.shares.arc, (double)r.in.shares.shorted,
		       rate(&r, um * 1e-3));
		rig_close(&r);
	}
}

/* As above, with the gap full of debris: distances are electrode to front. */
static void dirty(void)
{
	printf("gap_um clean_volts dirty_volts\n");
	for (double um = 0; um <= 70; um += 0.5) {
		struct rig r = plain(), d = plain();

		rig_open(&r);
		follow(&r, um * 1e-3, 1);
		d.k.sim.debris_per_mm = 1e4;
		rig_open(&d);
		follow(&d, d.k.sim.best_gap_mm, WARM);
		d.out.power = false;
		d.out.place_mm += result(&d).gap_mm - um * 1e-3;
		period(&d);
		printf("%g %.4f %.4f\n", um, r.in.gap_v, d.in.gap_v);
		rig_close(&r);
		rig_close(&d);
	}
}

static void timing(void)
{
	printf("gap_um iso frequency\n");
	for (double um = 0; um <= 70; um += 0.5) {
		struct rig iso = plain(), fixed = plain();

		fixed.k.sim.iso = 0;
		printf("%g %.4f %.4f\n", um, rate_of(&iso, um * 1e-3),
		       rate_of(&fixed, um * 1e-3));
	}
}

/* -- Relations over the pulse --------------------------------------------- */

static double best_rate(const struct rig *r)
{
	double best = 0;

	for (double um = 2; um < 80; um += 1)
		best = fmax(best, rate_of(r, um * 1e-3));
	return best;
}

static void pulse(void)
{
	static const double ons[] = { 2, 4, 8, 16, 32, 64, 128, 256 };
	static const double offs[] = { 10, 20, 50, 100 };

	printf("on_us off10 off20 off50 off100\n");
	for (size_t i = 0; i < COUNT(ons); i++) {
		printf("%g", ons[i]);
		for (size_t j = 0; j < COUNT(offs); j++) {
			struct rig r = plain();

			r.out.pulse[INTERP_TECH_ON_US] = ons[i];
			r.out.pulse[INTERP_TECH_OFF_US] = offs[j];
			r.out.pulse[INTERP_TECH_ISO] = true;
			printf(" %.4f", best_rate(&r));
		}
		printf("\n");
	}
}

static void peak(void)
{
	printf("peak_a mm3_min negative\n");
	for (double a = 1; a <= 40; a++) {
		struct rig r = plain();
		double v;

		r.out.pulse[INTERP_TECH_PEAK_A] = a;
		v = best_rate(&r);
		r.out.pulse[INTERP_TECH_POLARITY] = -1;
		printf("%g %.4f %.4f\n", a, v, best_rate(&r));
	}
}

/* -- Debris and arcs ------------------------------------------------------ */

/* Erode for @every_s, lift, come back; debris left after ten of them. */
static double after_jumps(struct rig *r, double height_mm, double v_mm_s)
{
	const int n = (int)(height_mm / v_mm_s * 1000) + 1;

	for (int jump = 0; jump < 10; jump++) {
		const double from = r->out.place_mm;

		r->out.power = true;
		follow(r, r->k.sim.best_gap_mm, 2000);
		r->out.power = false;
		for (int i = 1; i <= 2 * n && height_mm > 0; i++) {
			const int up = i <= n ? i : 2 * n - i;

			r->out.place_mm = from - height_mm * up / n;
			period(r);
		}
	}
	return result(r).debris;
}

static void jump(void)
{
	static const double depths[] = { 0, 5, 20, 50 };

	printf("height_mm d0 d5 d20 d50\n");
	for (double h = 0; h <= 6; h += 0.0625) {
		printf("%g", h);
		for (size_t i = 0; i < COUNT(depths); i++) {
			struct rig r = plain();

			r.k.sim.depth_mm = depths[i];
			rig_open(&r);
			printf(" %.6f", after_jumps(&r, h, 50));
			rig_close(&r);
		}
		printf("\n");
	}
}

static void speed(void)
{
	static const double depths[] = { 0, 5, 20, 50 };

	printf("mm_s d0 d5 d20 d50\n");
	for (double v = 1; v <= 129; v *= sqrt(sqrt(2))) {
		printf("%g", v);
		for (size_t i = 0; i < COUNT(depths); i++) {
			struct rig r = plain();

			r.k.sim.depth_mm = depths[i];
			rig_open(&r);
			printf(" %.6f", after_jumps(&r, 2, v));
			rig_close(&r);
		}
		printf("\n");
	}
}

static void area(void)
{
	static const int forms[] = { ELECTRODE_FLAT, ELECTRODE_BALL,
				     ELECTRODE_CONE };
	struct rig r[COUNT(forms)];

	printf("depth_mm flat ball cone\n");
	for (size_t i = 0; i < COUNT(forms); i++) {
		r[i] = plain();
		r[i].k.sim.electrode = forms[i];
		r[i].k.sim.standoff_mm = 0;
		r[i].k.sim.wear_ratio = 0;
		rig_open(&r[i]);
	}
	for (double mm = 0; mm <= 4; mm += 0.05) {
		printf("%g", mm);
		for (size_t i = 0; i < COUNT(forms); i++) {
			while (r[i].out.place_mm + result(&r[i]).gap_mm < mm)
				follow(&r[i], r[i].k.sim.best_gap_mm, 1);
			printf(" %.4f", result(&r[i]).area_mm2);
		}
		printf("\n");
	}
}

/* Share of arcs and removal over time, with no jump at all. */
static void arcs(void)
{
	static const double offs[] = { 20, 10, 5 };
	struct rig r[COUNT(offs)];

	printf("t_s debris20 arc20 debris10 arc10 debris5 arc5\n");
	for (size_t i = 0; i < COUNT(offs); i++) {
		r[i] = plain();
		r[i].k.sim.off_us = offs[i];
		rig_open(&r[i]);
	}
	for (int t = 0; t <= 120; t++) {
		printf("%g", t * 0.1);
		for (size_t i = 0; i < COUNT(offs); i++) {
			follow(&r[i], r[i].k.sim.best_gap_mm, 100);
			printf(" %.4f %.5f", result(&r[i]).debris,
			       (double)r[i].in.shares.arc);
		}
		printf("\n");
	}
}

/* At so much debris, made by erosion: what an off time does to arcs. */
static void off(void)
{
	static const double debris[] = { 0.2, 0.5, 0.8 };

	printf("off_us d02 d05 d08\n");
	for (double us = 1; us <= 65; us *= pow(2, 0.125)) {
		printf("%.3f", us);
		for (size_t i = 0; i < COUNT(debris); i++) {
			struct rig r = plain();

			/* Made until there is so much, then neither more
			 * nor less. */
			r.k.sim.off_us = us;
			r.k.sim.debris_settle_s = 1e5;
			rig_open(&r);
			while (result(&r).debris < debris[i])
				follow(&r, r.k.sim.best_gap_mm, 1);
			printf(" %.5f", (double)r.in.shares.arc);
			rig_close(&r);
		}
		printf("\n");
	}
}

/* Choked, then left alone: the debris that settles, and what the pump takes. */
static void settle(void)
{
	static const double depths[] = { 0, 0, 5, 20 };
	struct rig r[COUNT(depths)];

	printf("t_s still pump0 pump5 pump20\n");
	for (size_t i = 0; i < COUNT(depths); i++) {
		r[i] = plain();
		r[i].k.sim.debris_per_mm = 1e4;
		r[i].k.sim.depth_mm = depths[i];
		rig_open(&r[i]);
		follow(&r[i], r[i].k.sim.best_gap_mm, WARM);
		r[i].out.power = false;
		r[i].out.pump = i > 0;
	}
	for (int t = 0; t <= 60; t++) {
		printf("%d", t);
		for (size_t i = 0; i < COUNT(depths); i++) {
			printf(" %.5f", result(&r[i]).debris);
			for (int n = 0; n < 1000; n++)
				period(&r[i]);
		}
		printf("\n");
	}
}

/* Erode at the best gap until there is so much debris; it does not settle. */
static void fill(struct rig *r, double debris)
{
	while (result(r).debris < debris)
		follow(r, r->k.sim.best_gap_mm, 1);
}

/* Sparks that strike debris, without arcs: removal at the best gap. */
static void secondary(void)
{
	static const double parts[] = { 0, 0.5, 0.9 };

	printf("debris s0 s05 s09\n");
	for (double d = 0; d < 0.96; d += 0.05) {
		printf("%.2f", d);
		for (size_t i = 0; i < COUNT(parts); i++) {
			struct rig r = plain();
			double before;

			r.k.sim.secondary = parts[i];
			r.k.sim.deion_us = 0.1;
			r.k.sim.debris_settle_s = 1e9;
			rig_open(&r);
			fill(&r, d);
			follow(&r, r.k.sim.best_gap_mm, 1);
			before = result(&r).removed_mm3;
			follow(&r, r.k.sim.best_gap_mm, 1);
			printf(" %.4f", (result(&r).removed_mm3 - before) *
			       60e3);
			rig_close(&r);
		}
		printf("\n");
	}
}

/* Shorts of an electrode held in the open, each a minute without one. */
static void bridge(void)
{
	printf("debris counted formula\n");
	for (double full = 0.1; full < 1; full += 0.1) {
		struct rig r = plain();
		int born = 0, clear = 0;
		double d;
		bool was = false;

		r.k.sim.bridge_per_s = bridge_per_s;
		r.k.sim.debris_settle_s = 1e9;
		r.k.sim.deion_us = 0.1;
		rig_open(&r);
		fill(&r, full);
		r.out.place_mm -= 2 * r.k.sim.open_gap_mm;
		for (int i = 0; i < 3000000; i++) {
			const bool is = (period(&r),
					 r.in.shares.shorted > 0.5f);

			born += is && !was;
			clear += !is;
			was = is;
		}
		d = result(&r).debris;
		printf("%.3f %.4f %.4f\n", d, born / (clear / 60e3),
		       bridge_per_s * d * d * 60);
		rig_close(&r);
	}
}

/* Breaks in an hour of cutting; the chance is raised, and counted so. */
static void wire(void)
{
	static const double offs[] = { 10, 20, 50 };
	const double raised = 1e7;

	printf("gap_um off10 off20 off50\n");
	for (double um = 5; um <= 30; um += 1) {
		printf("%g", um);
		for (size_t i = 0; i < COUNT(offs); i++) {
			struct rig r = plain();
			int breaks = 0;

			r.k.sim.process = PROCESS_WIRE;
			r.k.sim.off_us = offs[i];
			r.k.sim.debris_per_mm = 0;
			r.k.sim.rethread_s = 0;
			r.k.sim.break_per_j *= raised;
			rig_open(&r);
			for (int n = 0; n < 100000; n++) {
				follow(&r, um * 1e-3, 1);
				breaks += r.in.wire_broken;
				r.out.power = !r.in.wire_broken;
			}
			printf(" %.3e", breaks / raised / (100. / 3600));
			rig_close(&r);
		}
		printf("\n");
	}
}

/* -- The command ---------------------------------------------------------- */

static const struct relation {
	const char *name;
	void (*print)(void);
} relations[] = {
	{ "gap", gap }, { "dirty", dirty }, { "timing", timing },
	{ "pulse", pulse }, { "peak", peak }, { "jump", jump },
	{ "speed", speed }, { "area", area }, { "arcs", arcs }, { "off", off },
	{ "settle", settle }, { "secondary", secondary }, { "bridge", bridge },
	{ "wire", wire },
};

int main(int argc, char **argv)
{
	struct interp_diag d = { 0 };

	config_defaults(&base);
	if (argc > 2 && config_read(&base, argv[2], &d)) {
		fprintf(stderr, "%s:%u: %s; %s\n", argv[2], d.line, d.found,
			d.wanted);
		return 78;
	}
	base.sim.noise_v = 0;
	base.sim.counted = 0;
	bridge_per_s = base.sim.bridge_per_s;
	base.sim.bridge_per_s = 0;
	for (size_t i = 0; argc > 1 && i < COUNT(relations); i++) {
		if (strcmp(argv[1], relations[i].name) != 0)
			continue;
		relations[i].print();
		return 0;
	}
	fprintf(stderr, "process RELATION [MACHINE-FILE], one of");
	for (size_t i = 0; i < COUNT(relations); i++)
		fprintf(stderr, " %s", relations[i].name);
	fprintf(stderr, "\n");
	return 64;
}
