/* SPDX-License-Identifier: Apache-2.0 */
/* compiling.c - a machine file as the options with which a job is compiled */
#include "compiling.h"

#include "interp/setting_text.h"

#include <string.h>

static struct interp_build_options build_of(const struct machine_config *c)
{
	struct interp_build_options b = {
		.machine = &c->axes,
		.strategy = (enum interp_strategy)c->strategy,
		.tolerance_milli =
			(uint32_t)(c->tolerance_pulses * 1000 + 1e-6),
		.perpendicular = c->perpendicular,
		.coupling = (enum interp_coupling)c->coupling,
		.corner_mm = c->corner_um * 1e-3,
		.tolerance_mm = c->tolerance_um * 1e-3,
		.rotary_radius_mm = c->rotary_radius_mm,
		.points_per_s = config_points_s(c),
		.fit_mm = c->fit_um / 1000,
	};

	memcpy(b.start_mm, c->start_mm, sizeof(b.start_mm));
	return b;
}

static int takes(const void *arg, const struct interp_tech *t, const char *who,
		 struct interp_diag *why)
{
	return config_generator_takes(arg, t, who, why);
}

static bool reaches(const struct machine_config *c, int field)
{
	struct process_delivers d;

	config_delivers(c, field, &d);
	return d.there || d.by_hand;
}

static struct interp_delivery delivery_of(const struct machine_config *c)
{
	struct interp_delivery d = { .takes = takes, .arg = c };

	if (!reaches(c, PROCESS_PUMP) && !config_has_plc(c))
		d.no_pump = "[generator] or [gpio] pump = a line; a PLC; or "
			    "[generator] by_hand = pump, and a person does it";
	if (!reaches(c, PROCESS_SENSE) && c->probe_with == 0)
		d.no_sense = "[generator] sense = how it is reached; or "
			     "[probe] with = spark-off-voltage, if that is "
			     "what feels contact";
	return d;
}

void config_compiling(const struct machine_config *c,
		      const struct config_tech *tech,
		      struct config_compiling *ret)
{
	struct interp_compile_options *o = &ret->text;
	struct interp_diag none;

	ret->build = build_of(c);
	ret->wire = c->wire;
	*o = (struct interp_compile_options) {
		.nc = { .machine = &c->axes, .wire = &ret->wire,
			.feed_mm_s = c->feed_default_mm_min / 60,
			.escape = (enum interp_escape_mode)c->jump_escape,
			.tip_tolerance_mm =
				c->kinematics.tolerance_um / 1000,
			.tech = tech->table, .machine_tech = &ret->tech,
			.mcode = ret->mcodes },
		.threeb = { .unit_um = c->threeb_unit_um,
			    .offset_um = c->fourb_offset_um,
			    .set = c->set },
	};
	config_tech_base(c, &ret->tech);
	config_mcodes(c, ret->mcodes);
	memcpy(o->nc.work_offset_mm, c->work_offset_mm,
	       sizeof(o->nc.work_offset_mm));
	memcpy(o->nc.offset_mm, c->offset_mm, sizeof(o->nc.offset_mm));
	ret->delivery = delivery_of(c);
	if (config_generator_limits(c))
		o->nc.delivery = &ret->delivery;
	if (config_kinematics(c, &ret->kinematics, &none) == 0)
		o->nc.kinematics = &ret->kinematics;
}

int config_compiling_set(struct config_compiling *of, const char *setting,
			 struct interp_diag *diag)
{
	struct interp_compile_options *o = &of->text;
	const int err = interp_setting_read(setting, &o->threeb.set, &of->wire,
					    diag);

	return err ? err : interp_setting_read(setting, &o->nc.set, &of->wire,
					       diag);
}
