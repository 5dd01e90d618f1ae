/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_machine.c - keys of the controller, its files and messages
 */
#include "keys_rows.h"

#include "interp/program.h"

static const char *strategy_word(int i)
{
	if (i < 0 || i >= INTERP_NSTRATEGIES)
		return NULL;
	return interp_strategy_name((enum interp_strategy)i);
}

static const char *nodes_word(int i)
{
	return i == 0 ? "pass" : i == 1 ? "stop" : NULL;
}

static const char *coupling_word(int i)
{
	if (i < 0 || i >= INTERP_NCOUPLINGS)
		return NULL;
	return interp_coupling_name((enum interp_coupling)i);
}

/* clang-format off */
static const struct config_key row[] = {
	NAME(MACHINE, "name", "edm", name,
	     "name of the machine, in shared memory and in names of "
	       "channels"),
	NUMBER(MACHINE, "period_us", "us", "0", 0, 20000, AT(period_us),
	       "cycle period, at least 20; 0: that of the backend: 1000, "
	       "gpio 50, can402 2000"),
	WORDS(MACHINE, "backend", "sim", AT(backend), config_backend_name,
	      "kind of machine that the cycle reads and writes"),
	WORDS(MACHINE, "strategy", "simultaneous", AT(strategy), strategy_word,
	      "rule by which a path becomes pulses"),
	NUMBER(MACHINE, "tolerance_pulses", "pulses", "2", 0,
	       INTERP_TOLERANCE_MAX / 1000, AT(tolerance_pulses),
	       "mu: how far main-direction and min-switch may be off the "
	       "path"),
	BIT(MACHINE, "perpendicular", "no", AT(perpendicular),
	    "mu is measured square to the path instead of along the "
	       "shorter axis"),
	WORDS(MACHINE, "coupling", "star", AT(coupling), coupling_word,
	      "how three and more axes are coupled when one axis pulses "
	       "at a time"),
	NUMBER(MACHINE, "fit_um", "um", "0", 0, 1000, AT(fit_um),
	       "lines that are cut one after another are joined into "
	       "curves no farther off than this; 0: they stay lines"),
	NUMBER(MACHINE, "feed_default_mm_min", "mm/min", "0", 0, 60000,
	       AT(feed_default_mm_min),
	       "feed before the first F; 0: a program must give F"),
	BIT(MACHINE, "optional_stop", "no", AT(optional_stop),
	    "M1 holds as M0 does"),
	NUMBER(MACHINE, "threeb_unit_um", "um", "1", 0.001, 1000,
	       AT(threeb_unit_um), "unit of the lengths in 3B and 4B programs"),
	NUMBER(MACHINE, "fourb_offset_um", "um", "0", 0, 10000,
	       AT(fourb_offset_um),
	       "wire radius plus gap, by which arcs of 4B programs grow or "
	       "shrink"),
	WHOLE(MACHINE, "cpu", "", "-1", -1, 1023, AT(cpu),
	      "processor core that the cycle is pinned to; -1: none"),
	WHOLE(MACHINE, "priority", "", "80", 1, 99, AT(priority),
	      "SCHED_FIFO priority of the cycle"),
	WHOLE(MACHINE, "overrun_limit", "periods", "100", 0, 1e6,
	      AT(overrun_limit),
	       "this many missed periods in a row are fault overrun; 0: no "
	       "fault"),
	BIT(MACHINE, "require_home", "no", AT(require_home),
	    "no job starts before every axis with a home_method is "
	       "homed"),

	NUMBER(SPEED, "corner_um", "um", "5", 0.01, 1000, AT(corner_um),
	       "a corner is passed at the speed of an arc that comes this "
	       "near to it"),
	NUMBER(SPEED, "tolerance_um", "um", "1", 0.001, 100, AT(tolerance_um),
	       "rounding of the end points in programs: a change of "
	       "direction that is no larger than this is not slowed down "
	       "for"),
	NUMBER(SPEED, "rotary_radius_mm", "mm", "57.3", 0.01, 10000,
	       AT(rotary_radius_mm),
	       "radius at which tolerance_um is measured on a rotary axis"),
	WORDS(SPEED, "nodes", "pass", AT(nodes), nodes_word,
	      "stop: a jump stops at every node; for comparisons only"),

	STRING(NC, "dialect", "generic", dialect,
	       "what programs are written in, by name, or a file beside this "
	       "one that ends in .ini; .3b and .4b files go by their names"),

	STRING(TECH, "table", "none", tech_table,
	       "file of the technology table, beside this file"),

	BIT(ELECTRODE, "measure", "no", AT(measure.there),
	    "there is a reference to measure electrodes at"),
	NUMBER(ELECTRODE, "measure_x_mm", "mm", "0", -1e5, 1e5,
	       AT(measure.x_mm), "where it is, in machine coordinates"),
	NUMBER(ELECTRODE, "measure_y_mm", "mm", "0", -1e5, 1e5,
	       AT(measure.y_mm), "where it is, in machine coordinates"),
	NUMBER(ELECTRODE, "clear_z_mm", "mm", "0", -1e5, 1e5,
	       AT(measure.clear_z_mm),
	       "Z at which every electrode is clear of everything"),
	NUMBER(ELECTRODE, "measure_from_z_mm", "mm", "0", -1e5, 1e5,
	       AT(measure.from_z_mm),
	       "Z to which it goes down rapidly, over the reference"),
	NUMBER(ELECTRODE, "measure_to_z_mm", "mm", "-10", -1e5, 1e5,
	       AT(measure.to_z_mm),
	       "Z to which it feels down at most"),
	NUMBER(ELECTRODE, "reference_z_mm", "mm", "0", -1e5, 1e5,
	       AT(measure.reference_z_mm),
	       "Z at which an electrode of length 0 would touch it"),

	STRING(LCM, "url", "udpm://239.255.76.67:7667?ttl=0", lcm_url,
	       "address of the messages for other hosts and programs of LCM; "
	       "with ttl=0 they stay on this host; $LCM_DEFAULT_URL is the "
	       "default where it is set"),

	WHOLE(DDS, "domain", "", "0", 0, 230, AT(dds_domain),
	      "DDS domain of the fleet"),
	NUMBER(DDS, "hz", "Hz", "10", 2, 100, AT(dds_hz),
	       "samples of the state per second"),

	WHOLE(JOBS, "keep_jobs", "", "10000", 20, 10000000, AT(keep_jobs),
	      "ended jobs that are kept in the history, with their texts"),
	WHOLE(JOBS, "keep_days", "", "0", 0, 36500, AT(keep_days),
	      "days that an ended job is kept; 0: without end"),
	STRING(JOBS, "store", "/var/lib/edmd", store_dir,
	       "folder of jobs, history and checkpoints"),
};
/* clang-format on */

const struct config_keys config_keys_machine = { row, ROWS_IN(row) };
