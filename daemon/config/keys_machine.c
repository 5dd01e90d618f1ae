/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_machine.c - keys of the controller, its files and messages
 */
#include "keys_rows.h"

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
	     "of the machine, in shared memory and channel names"),
	NUMBER(MACHINE, "period_us", "us", "0", 0, 20000, AT(period_us),
	       "cycle period, 20 or more; 0: by backend, 1000, gpio 50, "
	       "can402 2000"),
	WORDS(MACHINE, "backend", "sim", AT(backend), config_backend_name,
	      "what the cycle reads and writes"),
	WORDS(MACHINE, "strategy", "simultaneous", AT(strategy), strategy_word,
	      "how a path becomes pulses"),
	NUMBER(MACHINE, "tolerance_pulses", "pulses", "2", 0,
	       INTERP_TOLERANCE_MAX / 1000, AT(tolerance_pulses),
	       "mu: how far main-direction and min-switch may stray"),
	BIT(MACHINE, "perpendicular", "no", AT(perpendicular),
	    "mu is square to the path, not along the shorter axis"),
	WORDS(MACHINE, "coupling", "star", AT(coupling), coupling_word,
	      "how three and more axes pulse one at a time"),
	NUMBER(MACHINE, "chord_error_um", "um", "1", 0, 1000,
	       AT(chord_error_um),
	       "of curves: a cycle's way is no farther off; 0: no limit"),
	NUMBER(MACHINE, "fit_um", "um", "0", 0, 1000, AT(fit_um),
	       "cut lines in a row are joined into curves this near to them; "
	       "0: not"),
	NUMBER(MACHINE, "feed_default_mm_min", "mm/min", "0", 0, 60000,
	       AT(feed_default_mm_min),
	       "feed before the first F; 0: a program must give F"),
	BIT(MACHINE, "optional_stop", "no", AT(optional_stop),
	    "M1 holds as M0 does"),
	NUMBER(MACHINE, "threeb_unit_um", "um", "1", 0.001, 1000,
	       AT(threeb_unit_um), "unit of the lengths in 3B and 4B programs"),
	NUMBER(MACHINE, "fourb_offset_um", "um", "0", 0, 10000,
	       AT(fourb_offset_um),
	       "wire radius and gap, by which 4B arcs grow or shrink"),
	WHOLE(MACHINE, "cpu", "", "-1", -1, 1023, AT(cpu),
	      "core the cycle is pinned to; -1: none"),
	WHOLE(MACHINE, "priority", "", "80", 1, 99, AT(priority),
	      "SCHED_FIFO priority of the cycle"),
	WHOLE(MACHINE, "overrun_limit", "periods", "100", 0, 1e6,
	      AT(overrun_limit), "missed in a row before a fault; 0: no fault"),
	BIT(MACHINE, "require_home", "no", AT(require_home),
	    "no start before each axis with a home_method is homed"),

	NUMBER(SPEED, "corner_um", "um", "5", 0.01, 1000, AT(corner_um),
	       "a node's speed is that of an arc so near its corner"),
	NUMBER(SPEED, "tolerance_um", "um", "1", 0.001, 100, AT(tolerance_um),
	       "what a program's ends are rounded to: no change of direction, "
	       "but for a pulse"),
	NUMBER(SPEED, "rotary_radius_mm", "mm", "57.3", 0.01, 10000,
	       AT(rotary_radius_mm),
	       "where a rotary axis's part of tolerance_um is measured"),
	WORDS(SPEED, "nodes", "pass", AT(nodes), nodes_word,
	      "stop: at every node of a jump, for comparison only"),

	STRING(TECH, "table", "none", tech_table,
	       "file of conditions, beside this one; none: there is none"),

	STRING(LCM, "url", "udpm://239.255.76.67:7667?ttl=0", lcm_url,
	       "where messages go; ttl=0 stays on this host"),

	WHOLE(DDS, "domain", "", "0", 0, 230, AT(dds_domain),
	      "DDS domain of the fleet"),
	NUMBER(DDS, "hz", "Hz", "10", 2, 100, AT(dds_hz),
	       "status samples a second"),

	WHOLE(JOBS, "keep_jobs", "", "10000", 20, 10000000, AT(keep_jobs),
	      "ended jobs that are kept in the history, with their texts"),
	WHOLE(JOBS, "keep_days", "", "0", 0, 36500, AT(keep_days),
	      "days that an ended job is kept; 0: without end"),
	STRING(JOBS, "store", "/var/lib/edmd", store_dir,
	       "folder of jobs, history and checkpoints"),
};
/* clang-format on */

const struct config_keys config_keys_machine = { row, ROWS_IN(row) };
