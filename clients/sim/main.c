/* SPDX-License-Identifier: Apache-2.0 */
/* main.c - edmsim: does what the options ask for */
#include "plot.h"
#include "sim.h"
#include "tune_servo.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* Options about pulses replace the values of the machine file. */
static void configure_pulses(struct machine_config *c,
			     const struct sim_options *o)
{
	if (o->strategy >= 0)
		c->strategy = o->strategy;
	if (o->coupling >= 0)
		c->coupling = o->coupling;
	if (o->tolerance_given)
		c->tolerance_pulses = o->tolerance_pulses;
	if (o->fit_given)
		c->fit_um = o->fit_um;
	if (o->perpendicular)
		c->perpendicular = 1;
}

/* Without axes that lag there is nothing to compensate, so nothing is tried. */
static void say_no_contouring(const struct machine_config *c)
{
	if (strcmp(c->contour.method, "none") != 0 && !c->sim.loops)
		fprintf(stderr,
			"edmsim: [contour] method %s has no effect: the "
			"simulated axes do not lag; [sim] loops = yes gives "
			"them the models of [axis.*]\n",
			c->contour.method);
}

static int configure(struct machine_config *c, const struct sim_options *o)
{
	struct interp_diag d = { 0 };
	int err = 0;

	config_defaults(c);
	if (o->machine_file)
		err = config_read(c, o->machine_file, &d);
	if (err == 0)
		err = config_check_kinematics(c, &d);
	/* If the cycle leads the axes, the limits of the cycle apply. */
	if (err == 0 && c->sim.loops && !o->tune)
		err = config_check_contouring(c, &d);
	if (err == -EINVAL) {
		interp_diag_tell(&d, o->machine_file);
		return EX_CONFIG;
	}
	if (err < 0) {
		fprintf(stderr, "edmsim: %s: %s; a machine file\n",
			o->machine_file, strerror(-err));
		return EX_NOINPUT;
	}
	if (o->period_us > 0)
		c->period_us = o->period_us;
	configure_pulses(c, o);
	if (!o->tune && !o->quiet)
		say_no_contouring(c);
	if (o->unit_um > 0)
		c->threeb_unit_um = o->unit_um;
	if (o->offset_um >= 0)
		c->fourb_offset_um = o->offset_um;
	return 0;
}

static FILE *for_person(const struct sim_options *o)
{
	return o->report && strcmp(o->report, "-") == 0 ? stderr : stdout;
}

static int finish(struct sim_run *r)
{
	int err = 0;

	if (!r->o->quiet)
		report_print(r, for_person(r->o));
	if (r->o->report)
		err = report_write(r);
	if (err == 0 && r->o->plot)
		err = plot_finish(r->plot) < 0 ? EX_CANTCREAT : 0;
	return err ? err : strcmp(r->result.outcome, "done") != 0;
}

static int print_tech(const struct sim_options *o,
		      const struct machine_config *c)
{
	struct config_tech t;
	int err = edmsim_tech_load(&t, o, c);

	if (err == 0)
		err = edmsim_tech_print(&t);
	config_tech_free(&t);
	return err;
}

static int run_whole(struct sim_run *r)
{
	const bool wanted = r->o->report && r->o->dry_run;
	const bool looks = wanted && edmsim_contour_look(r);
	int err;

	if (wanted && !looks)
		tune_contour_watch(r);
	err = run_job(r);
	if (looks)
		edmsim_contour_looked(r);
	else
		tune_contour_measure(r);
	return err ? err : finish(r);
}

/* Files are those of a dry run, of which nothing more is printed. */
static int check(struct sim_run *r, struct sim_options *o)
{
	int err;

	job_describe(&r->job, for_person(o));
	err = plan_print(&r->job, r->config, for_person(o));
	o->quiet = true;
	return err || !(o->report || o->plot || o->trace || o->pulses) ?
		       err : run_whole(r);
}

int main(int argc, char **argv)
{
	static struct machine_config config;
	static struct sim_run run;
	struct sim_options o;
	int err = edmsim_options_read(&o, argc, argv);

	if (err >= 0)
		return err;
	err = configure(&config, &o);
	if (err)
		return err;
	if (o.print_config) {
		config_print(&config, stdout);
		return 0;
	}
	if (o.print_tech)
		return print_tech(&o, &config);
	if (o.plot && plot_check("edmsim", o.plot) < 0)
		return EX_CANTCREAT;
	run.o = &o;
	run.config = &config;
	err = job_load(&run.job, &o, &config);
	if (err == 0 && o.check)
		err = check(&run, &o);
	else if (err == 0 && o.tune)
		err = tune_contour(&run);
	else if (err == 0 && o.emit)
		err = job_emit(&run.job, &o, &config);
	else if (err == 0 && o.tune_servo)
		err = tune_servo(&o, &config, &run.job);
	else if (err == 0)
		err = run_whole(&run);
	free(run.spent);
	job_unload(&run.job);
	return err;
}
