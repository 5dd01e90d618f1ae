/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys.c - the table of machine file keys
 */
#include "keys.h"

static const char *backend_word(int i)
{
	static const char *const words[] = {
		[BACKEND_SIM] = "sim",
		[BACKEND_NULL] = "null",
	};

	return i >= 0 && i <= BACKEND_NULL ? words[i] : NULL;
}

static const char *source_word(int i)
{
	return i == 0 ? "sim" : NULL;
}

static const char *strategy_word(int i)
{
	if (i < 0 || i >= INTERP_NSTRATEGIES)
		return NULL;
	return interp_strategy_name((enum interp_strategy)i);
}

static const char *guides_word(int i)
{
	static const char *const words[INTERP_NGUIDES] = {
		[INTERP_GUIDES_OFF] = "off",
		[INTERP_GUIDES_ABSOLUTE] = "absolute",
		[INTERP_GUIDES_RELATIVE] = "relative",
	};

	return i >= 0 && i < INTERP_NGUIDES ? words[i] : NULL;
}

static const char *coupling_word(int i)
{
	if (i < 0 || i >= INTERP_NCOUPLINGS)
		return NULL;
	return interp_coupling_name((enum interp_coupling)i);
}

static const char *const axes[INTERP_NAXES] = {
	"X", "Y", "Z", "A", "B", "C", "U", "V"
};

static const char *const works[INTERP_NC_NWORK] = {
	"G54", "G55", "G56", "G57", "G58", "G59"
};

const struct config_section config_section[CONFIG_NSECTIONS] = {
	[SECTION_MACHINE] = { "machine", NULL, 1,
		"the controller and its cycle" },
	[SECTION_AXIS] = { "axis", axes, INTERP_NAXES,
		"one axis: its pulse, travel and limits; A B C are rotary" },
	[SECTION_WORK] = { "work", works, INTERP_NC_NWORK,
		"origin of a work coordinate system, in machine coordinates" },
	[SECTION_WIRE] = { "wire", NULL, 1,
		"a wire machine's guides, planes and corners; docs/taper.md" },
	[SECTION_GAP] = { "gap", NULL, 1,
		"the gap servo: feed from the mean gap voltage" },
	[SECTION_JUMP] = { "jump", NULL, 1,
		"the timed lift that flushes the gap" },
	[SECTION_SIM] = { "sim", NULL, 1,
		"the simulated machine of backend sim" },
	[SECTION_LCM] = { "lcm", NULL, 1,
		"messages on this machine" },
	[SECTION_DDS] = { "dds", NULL, 1,
		"messages to the fleet" },
	[SECTION_JOBS] = { "jobs", NULL, 1,
		"the job service" },
};

#define AT(field)	offsetof(struct machine_config, field)
#define ROOM(field)	.bytes = sizeof(((struct machine_config *)0)->field)
#define AXIS(field)	AT(axes.axis[0].field), \
			sizeof(struct interp_axis_limits)
#define WORK(axis)	AT(work_offset_mm[0][axis]), \
			sizeof(double[INTERP_NAXES])

/* clang-format off */
const struct config_key config_key[] = {
	/* section, name, kind, unit, default, min, max, place */

	{ SECTION_MACHINE, "name", KEY_NAME, "", "edm",
	  0, 0, AT(name), ROOM(name),
	  .help = "of the machine, in shared memory and channel names" },
	{ SECTION_MACHINE, "period_us", KEY_NUMBER, "us", "0",
	  0, 20000, AT(period_us),
	  .help = "cycle period, 20 or more; 0: by backend, 1000" },
	{ SECTION_MACHINE, "backend", KEY_ENUM, "", "sim",
	  0, 0, AT(backend), .word = backend_word,
	  .help = "what the cycle reads and writes" },
	{ SECTION_MACHINE, "strategy", KEY_ENUM, "", "simultaneous",
	  0, 0, AT(strategy), .word = strategy_word,
	  .help = "how a path becomes pulses" },
	{ SECTION_MACHINE, "tolerance_pulses", KEY_NUMBER, "pulses", "2",
	  0, INTERP_TOLERANCE_MAX / 1000, AT(tolerance_pulses),
	  .help = "mu: how far main-direction and min-switch may stray" },
	{ SECTION_MACHINE, "perpendicular", KEY_BIT, "", "no",
	  0, 0, AT(perpendicular),
	  .help = "mu is square to the path, not along the shorter axis" },
	{ SECTION_MACHINE, "coupling", KEY_ENUM, "", "star",
	  0, 0, AT(coupling), .word = coupling_word,
	  .help = "how three and more axes pulse one at a time" },
	{ SECTION_MACHINE, "feed_default_mm_min", KEY_NUMBER, "mm/min", "0",
	  0, 60000, AT(feed_default_mm_min),
	  .help = "feed before the first F; 0: a program must give F" },
	{ SECTION_MACHINE, "optional_stop", KEY_BIT, "", "no",
	  0, 0, AT(optional_stop),
	  .help = "M1 holds as M0 does" },
	{ SECTION_MACHINE, "threeb_unit_um", KEY_NUMBER, "um", "1",
	  0.001, 1000, AT(threeb_unit_um),
	  .help = "unit of the lengths in 3B and 4B programs" },
	{ SECTION_MACHINE, "fourb_offset_um", KEY_NUMBER, "um", "0",
	  0, 10000, AT(fourb_offset_um),
	  .help = "wire radius and gap, by which 4B arcs grow or shrink" },
	{ SECTION_MACHINE, "cpu", KEY_WHOLE, "", "-1",
	  -1, 1023, AT(cpu),
	  .help = "core the cycle is pinned to; -1: none" },
	{ SECTION_MACHINE, "priority", KEY_WHOLE, "", "80",
	  1, 99, AT(priority),
	  .help = "SCHED_FIFO priority of the cycle" },
	{ SECTION_MACHINE, "overrun_limit", KEY_WHOLE, "periods", "100",
	  0, 1e6, AT(overrun_limit),
	  .help = "missed in a row before a fault; 0: no fault" },

	{ SECTION_AXIS, "present", KEY_BIT, "", "yes",
	  0, 0, AT(axes.present),
	  .help = "the machine has this axis" },
	{ SECTION_AXIS, "pulse_mm", KEY_NUMBER, "mm", "0.001",
	  1e-6, 1, AXIS(pulse_mm),
	  .help = "worth of one pulse" },
	{ SECTION_AXIS, "travel_min_mm", KEY_NUMBER, "mm", "-200",
	  -1e7, 1e7, AXIS(travel_min_mm), .def_rotary = "-1000000",
	  .help = "lower soft limit, machine coordinates" },
	{ SECTION_AXIS, "travel_max_mm", KEY_NUMBER, "mm", "200",
	  -1e7, 1e7, AXIS(travel_max_mm), .def_rotary = "1000000",
	  .help = "upper soft limit, machine coordinates" },
	{ SECTION_AXIS, "v_max_mm_s", KEY_NUMBER, "mm/s", "80",
	  1e-3, 1e5, AXIS(v_max_mm_s), .def_rotary = "60",
	  .help = "fastest speed" },
	{ SECTION_AXIS, "a_max_mm_s2", KEY_NUMBER, "mm/s2", "1000",
	  1e-2, 1e6, AXIS(a_max_mm_s2),
	  .help = "largest acceleration" },
	{ SECTION_AXIS, "j_max_mm_s3", KEY_NUMBER, "mm/s3", "20000",
	  1, 1e9, AXIS(j_max_mm_s3),
	  .help = "largest jerk" },
	{ SECTION_AXIS, "start_mm", KEY_NUMBER, "mm", "0",
	  -1e7, 1e7, AT(start_mm), sizeof(double),
	  .help = "where a simulated machine begins" },

	{ SECTION_WORK, "x", KEY_NUMBER, "mm", "0",
	  -1e7, 1e7, WORK(INTERP_X), .help = "origin on X" },
	{ SECTION_WORK, "y", KEY_NUMBER, "mm", "0",
	  -1e7, 1e7, WORK(INTERP_Y), .help = "origin on Y" },
	{ SECTION_WORK, "z", KEY_NUMBER, "mm", "0",
	  -1e7, 1e7, WORK(INTERP_Z), .help = "origin on Z" },
	{ SECTION_WORK, "a", KEY_NUMBER, "deg", "0",
	  -1e7, 1e7, WORK(INTERP_A), .help = "origin on A" },
	{ SECTION_WORK, "b", KEY_NUMBER, "deg", "0",
	  -1e7, 1e7, WORK(INTERP_B), .help = "origin on B" },
	{ SECTION_WORK, "c", KEY_NUMBER, "deg", "0",
	  -1e7, 1e7, WORK(INTERP_C), .help = "origin on C" },
	{ SECTION_WORK, "u", KEY_NUMBER, "mm", "0",
	  -1e7, 1e7, WORK(INTERP_U), .help = "origin on U" },
	{ SECTION_WORK, "v", KEY_NUMBER, "mm", "0",
	  -1e7, 1e7, WORK(INTERP_V), .help = "origin on V" },

	{ SECTION_WIRE, "guides", KEY_ENUM, "", "off",
	  0, 0, AT(wire.guides), .word = guides_word,
	  .help = "what U V are: off: axes as any other; the upper guide" },
	{ SECTION_WIRE, "z_lower_mm", KEY_NUMBER, "mm", "-20",
	  -2000, 2000, AT(wire.z_lower_mm),
	  .help = "height of the lower guide" },
	{ SECTION_WIRE, "z_upper_mm", KEY_NUMBER, "mm", "80",
	  -2000, 2000, AT(wire.z_upper_mm),
	  .help = "height of the upper guide" },
	{ SECTION_WIRE, "z_program_mm", KEY_NUMBER, "mm", "0",
	  -2000, 2000, AT(wire.z_program_mm),
	  .help = "height of the plane X Y are programmed on" },
	{ SECTION_WIRE, "z_second_mm", KEY_NUMBER, "mm", "40",
	  -2000, 2000, AT(wire.z_second_mm),
	  .help = "height of the plane U V are programmed on" },
	{ SECTION_WIRE, "angle_max_deg", KEY_NUMBER, "deg", "30",
	  0, 80, AT(wire.angle_max_deg),
	  .help = "the wire may lean so far from upright" },
	{ SECTION_WIRE, "corner_angle_deg", KEY_NUMBER, "deg", "180",
	  1, 180, AT(wire.corner_angle_deg),
	  .help = "a turn by so much is a corner; 180: no corner control" },
	{ SECTION_WIRE, "corner_feed_percent", KEY_NUMBER, "%", "50",
	  1, 100, AT(wire.corner_feed_percent),
	  .help = "of the feed, at most, in front of a corner" },
	{ SECTION_WIRE, "corner_before_mm", KEY_NUMBER, "mm", "0.2",
	  0, 100, AT(wire.corner_before_mm),
	  .help = "so far in front of it" },
	{ SECTION_WIRE, "corner_dwell_s", KEY_NUMBER, "s", "0",
	  0, 3600, AT(wire.corner_dwell_s),
	  .help = "wait on a corner, for the wire to straighten" },
	{ SECTION_WIRE, "offset_0_mm", KEY_NUMBER, "mm", "0",
	  -50, 50, AT(offset_mm[0]),
	  .help = "register D0, H0 until a program fills it; 0: unfilled" },
	{ SECTION_WIRE, "offset_1_mm", KEY_NUMBER, "mm", "0",
	  -50, 50, AT(offset_mm[1]),
	  .help = "register D1, H1 until a program fills it; 0: unfilled" },

	{ SECTION_GAP, "source", KEY_ENUM, "", "sim",
	  0, 0, AT(gap.source), .word = source_word,
	  .help = "where the gap voltage comes from" },
	{ SECTION_GAP, "servo_v", KEY_NUMBER, "V", "15",
	  0.1, 500, AT(gap.servo_v),
	  .help = "mean gap voltage to hold" },
	{ SECTION_GAP, "short_v", KEY_NUMBER, "V", "8",
	  0, 500, AT(gap.short_v),
	  .help = "below: short circuit, retract" },
	{ SECTION_GAP, "open_v", KEY_NUMBER, "V", "60",
	  0.1, 500, AT(gap.open_v),
	  .help = "above: nothing to cut yet, approach" },
	{ SECTION_GAP, "feed_gain_mm_s_v", KEY_NUMBER, "mm/s/V", "0.02",
	  1e-6, 10, AT(gap.feed_gain_mm_s_v),
	  .help = "feed for each volt above servo_v" },
	{ SECTION_GAP, "feed_max_mm_s", KEY_NUMBER, "mm/s", "0.5",
	  1e-6, 100, AT(gap.feed_max_mm_s),
	  .help = "fastest feed while eroding" },
	{ SECTION_GAP, "approach_mm_s", KEY_NUMBER, "mm/s", "0.5",
	  1e-4, 100, AT(gap.approach_mm_s),
	  .help = "feed until the first spark" },
	{ SECTION_GAP, "retract_mm_s", KEY_NUMBER, "mm/s", "5",
	  1e-3, 1000, AT(gap.retract_mm_s),
	  .help = "back along the path on a short" },
	{ SECTION_GAP, "retract_limit_mm", KEY_NUMBER, "mm", "3",
	  1e-3, 1000, AT(gap.retract_limit_mm),
	  .help = "still short so far back: stand" },
	{ SECTION_GAP, "retract_wait_s", KEY_NUMBER, "s", "0.5",
	  0, 60, AT(gap.retract_wait_s),
	  .help = "still short so long after: fault short-not-cleared" },

	{ SECTION_JUMP, "height_mm", KEY_NUMBER, "mm", "2",
	  0, 500, AT(jump.height_mm),
	  .help = "lift, back along the path; 0: no jumps" },
	{ SECTION_JUMP, "every_s", KEY_NUMBER, "s", "2",
	  0.01, 86400, AT(jump.every_s),
	  .help = "of erosion between two jumps" },
	{ SECTION_JUMP, "v_max_mm_s", KEY_NUMBER, "mm/s", "80",
	  1e-3, 1e4, AT(jump.v_max_mm_s),
	  .help = "fastest speed of the lift" },
	{ SECTION_JUMP, "a_max_mm_s2", KEY_NUMBER, "mm/s2", "1000",
	  1e-2, 1e6, AT(jump.a_max_mm_s2),
	  .help = "acceleration of the lift" },
	{ SECTION_JUMP, "j_max_mm_s3", KEY_NUMBER, "mm/s3", "20000",
	  1, 1e9, AT(jump.j_max_mm_s3),
	  .help = "jerk of the lift" },
	{ SECTION_JUMP, "short_of_mm", KEY_NUMBER, "mm", "0.05",
	  0, 10, AT(jump.short_of_mm),
	  .help = "comes back to so far above the cut" },

	{ SECTION_SIM, "seed", KEY_WHOLE, "", "1",
	  0, 9007199254740992.0, AT(sim.seed),
	  .help = "of every random process; equal seeds, equal runs" },
	{ SECTION_SIM, "speed", KEY_WHOLE, "", "1",
	  1, 10000, AT(sim.speed),
	  .help = "periods run for each period of time" },
	{ SECTION_SIM, "on_us", KEY_NUMBER, "us", "8",
	  0.1, 10000, AT(sim.on_us),
	  .help = "on time of the generator's pulses" },
	{ SECTION_SIM, "off_us", KEY_NUMBER, "us", "20",
	  0.1, 10000, AT(sim.off_us),
	  .help = "off time between two pulses" },
	{ SECTION_SIM, "peak_a", KEY_NUMBER, "A", "6",
	  0.1, 2000, AT(sim.peak_a),
	  .help = "peak current" },
	{ SECTION_SIM, "open_v", KEY_NUMBER, "V", "180",
	  20, 500, AT(sim.open_v),
	  .help = "open-circuit voltage of the generator" },
	{ SECTION_SIM, "spark_v", KEY_NUMBER, "V", "25",
	  5, 100, AT(sim.spark_v),
	  .help = "across a burning spark" },
	{ SECTION_SIM, "short_gap_mm", KEY_NUMBER, "mm", "0.005",
	  1e-4, 1, AT(sim.short_gap_mm),
	  .help = "narrower: pulses short" },
	{ SECTION_SIM, "best_gap_mm", KEY_NUMBER, "mm", "0.02",
	  1e-4, 1, AT(sim.best_gap_mm),
	  .help = "removes most" },
	{ SECTION_SIM, "open_gap_mm", KEY_NUMBER, "mm", "0.06",
	  1e-4, 5, AT(sim.open_gap_mm),
	  .help = "wider: pulses do not ignite" },
	{ SECTION_SIM, "standoff_mm", KEY_NUMBER, "mm", "0.05",
	  0, 100, AT(sim.standoff_mm),
	  .help = "air before the workpiece" },
	{ SECTION_SIM, "area_mm2", KEY_NUMBER, "mm2", "19.635",
	  1e-3, 1e6, AT(sim.area_mm2),
	  .help = "frontal area of the electrode; 19.635 is 5 mm round" },
	{ SECTION_SIM, "removal_mm3_min", KEY_NUMBER, "mm3/min", "12.75",
	  1e-3, 1e5, AT(sim.removal_mm3_min),
	  .help = "at the best gap, clean" },
	{ SECTION_SIM, "wear_ratio", KEY_NUMBER, "", "0.01",
	  0, 10, AT(sim.wear_ratio),
	  .help = "electrode length lost per depth" },
	{ SECTION_SIM, "debris_per_mm", KEY_NUMBER, "1/mm", "20",
	  0, 1e4, AT(sim.debris_per_mm),
	  .help = "debris made per depth eroded, on a scale of 0 to 1" },
	{ SECTION_SIM, "debris_settle_s", KEY_NUMBER, "s", "20",
	  0.01, 1e5, AT(sim.debris_settle_s),
	  .help = "time constant of its decay, undisturbed" },
	{ SECTION_SIM, "debris_gap_mm", KEY_NUMBER, "mm", "0.012",
	  0, 1, AT(sim.debris_gap_mm),
	  .help = "gap lost at debris 1" },
	{ SECTION_SIM, "flush_mm", KEY_NUMBER, "mm", "0.5",
	  1e-3, 100, AT(sim.flush_mm),
	  .help = "jump stroke that halves the debris" },
	{ SECTION_SIM, "bridge_per_s", KEY_NUMBER, "1/s", "0.2",
	  0, 1000, AT(sim.bridge_per_s),
	  .help = "debris bridges at debris 1" },
	{ SECTION_SIM, "bridge_mm", KEY_NUMBER, "mm", "0.05",
	  0, 10, AT(sim.bridge_mm),
	  .help = "mean length of a bridge" },
	{ SECTION_SIM, "bridge_settle_s", KEY_NUMBER, "s", "0.3",
	  1e-3, 3600, AT(sim.bridge_settle_s),
	  .help = "time constant a bridge dissolves with" },
	{ SECTION_SIM, "noise_v", KEY_NUMBER, "V", "1",
	  0, 100, AT(sim.noise_v),
	  .help = "standard deviation of the gap voltage" },

	{ SECTION_LCM, "url", KEY_STRING, "",
	  "udpm://239.255.76.67:7667?ttl=0",
	  0, 0, AT(lcm_url), ROOM(lcm_url),
	  .help = "where messages go; ttl=0 stays on this host" },

	{ SECTION_DDS, "domain", KEY_WHOLE, "", "0",
	  0, 230, AT(dds_domain),
	  .help = "DDS domain of the fleet" },
	{ SECTION_DDS, "hz", KEY_NUMBER, "Hz", "10",
	  2, 100, AT(dds_hz),
	  .help = "status samples a second" },

	{ SECTION_JOBS, "store", KEY_STRING, "", "/var/lib/edmd",
	  0, 0, AT(store_dir), ROOM(store_dir),
	  .help = "folder of jobs, history and checkpoints" },
};
/* clang-format on */

#define NKEYS	(sizeof(config_key) / sizeof(config_key[0]))

_Static_assert(NKEYS <= CONFIG_NKEYS_MAX, "raise CONFIG_NKEYS_MAX");
_Static_assert(INTERP_NAXES <= CONFIG_NINSTANCES_MAX, "an axis too many");

const int config_nkeys = NKEYS;
