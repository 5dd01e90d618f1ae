/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_sim.c - keys of the simulated machine
 */
#include "keys_rows.h"

static const char *sim_process_word(int i)
{
	return i == SIM_SINK ? "sink" : i == SIM_WIRE ? "wire" : NULL;
}

static const char *electrode_word(int i)
{
	static const char *const words[] = {
		[ELECTRODE_FLAT] = "flat",
		[ELECTRODE_BALL] = "ball",
		[ELECTRODE_CONE] = "cone",
	};

	return WORD_OF(words, i);
}

/* clang-format off */
static const struct config_key row[] = {
	WHOLE(SIM, "seed", "", "1", 0, 9007199254740992.0, AT(sim.seed),
	      "seed of all random numbers; equal seeds give equal runs"),
	WHOLE(SIM, "speed", "", "1", 1, 10000, AT(sim.speed),
	      "how many times faster than real time the simulated machine "
	       "runs"),
	{ SECTION_SIM, "process", KEY_ENUM, "", "sink", 0, 0, AT(sim.process),
	  .def_wire = "wire", .word = sim_process_word,
	  .help = "a sinker's electrode, or a wire through the work" },
	OF_WIRE(SIM, "on_us", "us", "8", "2", 0.1, 10000, AT(sim.on_us),
	       "on time of the generator's pulses"),
	NUMBER(SIM, "off_us", "us", "20", 0.1, 10000, AT(sim.off_us),
	       "off time between two pulses"),
	OF_WIRE(SIM, "peak_a", "A", "6", "60", 0.1, 2000, AT(sim.peak_a),
	       "peak current"),
	NUMBER(SIM, "open_v", "V", "180", 20, 500, AT(sim.open_v),
	       "open-circuit voltage of the generator"),
	NUMBER(SIM, "spark_v", "V", "25", 5, 100, AT(sim.spark_v),
	       "voltage across a burning spark"),
	BIT(SIM, "iso", "yes", AT(sim.iso),
	    "on time begins at the ignition: sparks of equal energy"),
	NUMBER(SIM, "wait_us", "us", "500", 1, 1e5, AT(sim.wait_us),
	       "with iso: longest wait for an ignition"),
	NUMBER(SIM, "open_us", "us", "0", 0, 1e5, AT(sim.open_us),
	       "a pulse that waits longer counts as open; 0: chosen so "
	       "that a fifth of them are, at the best gap"),
	NUMBER(SIM, "respond_s", "s", "0", 0, 10, AT(sim.respond_s),
	       "from power on to the first pulse"),
	OF_WIRE(SIM, "short_gap_mm", "mm", "0.005", "0.004", 1e-4, 1,
	       AT(sim.short_gap_mm),
	       "in a narrower gap the pulses are shorts"),
	OF_WIRE(SIM, "best_gap_mm", "mm", "0.02", "0.015", 1e-4, 1,
	       AT(sim.best_gap_mm),
	       "gap at which most is removed"),
	OF_WIRE(SIM, "open_gap_mm", "mm", "0.06", "0.04", 1e-4, 5, AT(sim.open_gap_mm),
	       "in a wider gap the pulses do not ignite"),
	NUMBER(SIM, "standoff_mm", "mm", "0.05", 0, 100, AT(sim.standoff_mm),
	       "distance to the workpiece at the start"),
	WORDS(SIM, "electrode", "flat", AT(sim.electrode), electrode_word,
	      "form of the electrode's tip"),
	NUMBER(SIM, "area_mm2", "mm2", "19.635", 1e-3, 1e6, AT(sim.area_mm2),
	       "whole frontal area of the electrode; 19.635 is 5 mm round"),
	NUMBER(SIM, "tip_mm", "mm", "2.5", 1e-3, 1000, AT(sim.tip_mm),
	       "length of the ball's or cone's tip"),
	NUMBER(SIM, "perimeter_mm", "mm", "0", 0, 1e5, AT(sim.perimeter_mm),
	       "circumference of the electrode; 0: as if it were round"),
	NUMBER(SIM, "depth_mm", "mm", "0", 0, 1000, AT(sim.depth_mm),
	       "depth of the cavity before the first spark"),
	NUMBER(SIM, "side_gap_mm", "mm", "0.05", 1e-3, 10, AT(sim.side_gap_mm),
	       "between the electrode's side and the cavity"),
	NUMBER(SIM, "wire_mm", "mm", "0.25", 0.01, 5, AT(sim.wire_mm),
	       "diameter of the wire; process wire"),
	NUMBER(SIM, "height_mm", "mm", "40", 0.1, 1000, AT(sim.height_mm),
	       "height of the work along the wire; process wire"),
	NUMBER(SIM, "removal_mm3_min", "mm3/min", "12.75", 1e-3, 1e5,
	       AT(sim.removal_mm3_min),
	       "removal at the best gap, clean, with pulses of 6 A, 8 us "
	       "on and 20 us off"),
	NUMBER(SIM, "crater_peak_power", "", "1", 0, 3,
	       AT(sim.crater_peak_power),
	       "a spark's volume grows with peak_a to this power"),
	NUMBER(SIM, "crater_on_power", "", "1", 0, 3, AT(sim.crater_on_power),
	       "a spark's volume grows with on_us to this power"),
	NUMBER(SIM, "wear_ratio", "", "0.01", 0, 10, AT(sim.wear_ratio),
	       "length that the electrode loses per depth cut"),
	NUMBER(SIM, "negative_removal", "", "1.2", 0.01, 100,
	       AT(sim.negative_removal),
	       "factor on the removal with the electrode negative"),
	NUMBER(SIM, "negative_wear", "", "5", 0, 1000, AT(sim.negative_wear),
	       "factor on the wear with the electrode negative"),
	OF_WIRE(SIM, "debris_per_mm", "1/mm", "20", "5", 0, 1e4,
	       AT(sim.debris_per_mm),
	       "debris made per depth cut, on a scale of 0 to 1"),
	NUMBER(SIM, "debris_settle_s", "s", "20", 0.01, 1e5,
	       AT(sim.debris_settle_s),
	       "time constant with which debris settles if nothing flushes "
	       "it"),
	NUMBER(SIM, "debris_gap_mm", "mm", "0.012", 0, 1, AT(sim.debris_gap_mm),
	       "part of the gap that is lost at debris 1"),
	NUMBER(SIM, "secondary", "", "0.5", 0, 1, AT(sim.secondary),
	       "part of the sparks that strike debris, at debris 1"),
	NUMBER(SIM, "flush_mm", "mm", "0.5", 1e-3, 100, AT(sim.flush_mm),
	       "length of a fast stroke in clean fluid that halves the "
	       "debris"),
	NUMBER(SIM, "flush_mm_s", "mm/s", "5", 0, 1000, AT(sim.flush_mm_s),
	       "a stroke of this speed carries half of what a fast one "
	       "could"),
	OF_WIRE(SIM, "flush_per_s", "1/s", "0.05", "2", 0, 1000, AT(sim.flush_per_s),
	       "share of the debris that the pump drives out per second in "
	       "a shallow cavity"),
	NUMBER(SIM, "bridge_per_s", "1/s", "0.2", 0, 1000, AT(sim.bridge_per_s),
	       "bridges of debris per second at debris 1"),
	NUMBER(SIM, "bridge_mm", "mm", "0.05", 0, 10, AT(sim.bridge_mm),
	       "mean length of a bridge"),
	NUMBER(SIM, "bridge_settle_s", "s", "0.3", 1e-3, 3600,
	       AT(sim.bridge_settle_s),
	       "time constant with which a bridge dissolves"),
	NUMBER(SIM, "deion_us", "us", "5", 0.01, 1000, AT(sim.deion_us),
	       "time constant with which the channel of a spark recovers"),
	NUMBER(SIM, "arcing_gain", "", "2", 0, 1000, AT(sim.arcing_gain),
	       "arcs stay at their place if this times the square of the "
	       "crowding is above 1"),
	NUMBER(SIM, "arcing_s", "s", "1", 1e-3, 1000, AT(sim.arcing_s),
	       "time constant of a place heated by arcs"),
	NUMBER(SIM, "break_per_j", "1/J", "0.000002", 0, 1, AT(sim.break_per_j),
	       "probability per joule that the wire breaks; process wire"),
	NUMBER(SIM, "rethread_s", "s", "30", 0, 3600, AT(sim.rethread_s),
	       "time with the power off until a broken wire is threaded "
	       "again"),
	NUMBER(SIM, "noise_v", "V", "1", 0, 100, AT(sim.noise_v),
	       "standard deviation of the gap voltage"),
	BIT(SIM, "counted", "no", AT(sim.counted),
	    "voltage and shares scatter as single pulses do"),
	NUMBER(SIM, "lag_s", "s", "0", 0, 10, AT(sim.lag_s),
	       "the axes follow with this time constant"),
	BIT(SIM, "loops", "no", AT(sim.loops),
	    "the axes are the models of [axis.*] loop_*, off by "
	    "[contour] model_error"),
	NUMBER(SIM, "start_s", "s", "0", 0, 10, AT(sim.start_s),
	       "dead time of an axis that starts or turns back"),
	NUMBER(SIM, "home_off_mm", "mm", "0", -1e6, 1e6, AT(sim.home_off_mm),
	       "distance by which home and limit switches are off the "
	       "places in the machine file"),
	NUMBER(SIM, "index_mm", "mm", "2", 1e-3, 1e4, AT(sim.index_mm),
	       "distance from one index mark to the next"),
	NUMBER(SIM, "measure_pulses", "pulses", "0", 0, 1000,
	       AT(sim.measure_pulses),
	       "standard deviation of the measured places"),
	BIT(SIM, "block", "no", AT(sim.block),
	    "there is a block that the electrode can touch"),
	NUMBER(SIM, "block_x_min_mm", "mm", "-10", -1e5, 1e5,
	       AT(sim.block_min_mm[0]), "the block, in machine coordinates"),
	NUMBER(SIM, "block_x_max_mm", "mm", "10", -1e5, 1e5,
	       AT(sim.block_max_mm[0]), "the block, in machine coordinates"),
	NUMBER(SIM, "block_y_min_mm", "mm", "-10", -1e5, 1e5,
	       AT(sim.block_min_mm[1]), "the block, in machine coordinates"),
	NUMBER(SIM, "block_y_max_mm", "mm", "10", -1e5, 1e5,
	       AT(sim.block_max_mm[1]), "the block, in machine coordinates"),
	NUMBER(SIM, "block_top_mm", "mm", "0", -1e5, 1e5, AT(sim.block_top_mm),
	       "place of the block's upper face on Z; it has no lower face"),
	NUMBER(SIM, "bore_x_mm", "mm", "0", -1e5, 1e5, AT(sim.bore_at_mm[0]),
	       "centre of a bore through the block"),
	NUMBER(SIM, "bore_y_mm", "mm", "0", -1e5, 1e5, AT(sim.bore_at_mm[1]),
	       "centre of a bore through the block"),
	NUMBER(SIM, "bore_mm", "mm", "0", 0, 1e5, AT(sim.bore_mm),
	       "diameter of the bore; 0: none"),
	NUMBER(SIM, "feeler_mm", "mm", "1", 0, 1000, AT(sim.feeler_mm),
	       "diameter of the cylinder along Z that touches the block"),
};
/* clang-format on */

const struct config_keys config_keys_sim = { row, ROWS_IN(row) };
