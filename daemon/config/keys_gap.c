/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_gap.c - keys of the gap servo, its jumps, and probing
 */
#include "keys_rows.h"

#include "cycle.h"

const char *config_process_word(int i)
{
	static const char *const words[CYCLE_NPROCESSES] = {
		[PROCESS_SINK] = "sink",
		[PROCESS_WIRE] = "wire",
	};

	return WORD_OF(words, i);
}

static const char *source_word(int i)
{
	static const char *const words[GAP_NSOURCES] = {
		[GAP_SIM] = "sim",
		[GAP_VOLTAGE] = "voltage",
		[GAP_SHARES] = "shares",
		[GAP_LINES] = "lines",
		[GAP_CAN] = "can",
		[GAP_COUNTS] = "counts",
	};

	return WORD_OF(words, i);
}

static const char *filter_word(int i)
{
	static const char *const words[GAP_NFILTERS] = {
		[GAP_MEDIAN] = "median",
		[GAP_FIRST_ORDER] = "first-order",
	};

	return WORD_OF(words, i);
}

static const char *retract_to_word(int i)
{
	static const char *const words[RETRACT_NPLACES] = {
		[RETRACT_LIMIT] = "limit",
		[RETRACT_START] = "start",
		[RETRACT_MOTION] = "motion",
	};

	return WORD_OF(words, i);
}

static const char *retreat_to_word(int i)
{
	static const char *const words[RETREAT_NPLACES] = {
		[RETREAT_DISTANCE] = "distance",
		[RETREAT_MOTION] = "motion",
		[RETREAT_HOLE] = "hole",
	};

	return WORD_OF(words, i);
}

static const char *retract_word(int i)
{
	return i == 0 ? "path" : i == 1 ? "escape" : NULL;
}

static const char *escape_word(int i)
{
	return i < 0 ? NULL :
	       interp_escape_mode_name((enum interp_escape_mode)i);
}

static const char *probe_word(int i)
{
	static const char *const words[] = { "sense", "spark-off-voltage" };

	return WORD_OF(words, i);
}

/* clang-format off */
static const struct config_key row[] = {
	WORDS(GAP, "source", "sim", AT(gap.source), source_word,
	      "where the gap signal comes from; counts: the pulses that "
	      "[generator] told_opens, told_sparks, told_shorts and told_arcs "
	      "count, as shares"),
	OF_WIRE(GAP, "servo_v", "V", "25", "15", 0.1, 500, AT(gap.servo_v),
		"mean gap voltage that the servo holds"),
	NUMBER(GAP, "short_v", "V", "8", 0, 500, AT(gap.short_v),
	       "a signal below this is a short circuit: the machine "
	       "retracts"),
	NUMBER(GAP, "open_v", "V", "60", 0.1, 500, AT(gap.open_v),
	       "a signal above this means that there is nothing to cut "
	       "yet: the machine approaches"),
	NUMBER(GAP, "window_low_v", "V", "0", 0, 500, AT(gap.window_low_v),
	       "below this signal the servo creeps back; 0: halfway from "
	       "short_v to servo_v"),
	NUMBER(GAP, "window_high_v", "V", "0", 0, 500, AT(gap.window_high_v),
	       "above this signal the servo feeds; between the two it "
	       "stands; 0: servo_v"),
	NUMBER(GAP, "ignition_v", "V", "0", 0, 1000, AT(gap.ignition_v),
	       "open-circuit voltage; a reading above 1.5 times as much is "
	       "not believed; 0: every reading is believed"),
	WORDS(GAP, "process", "sink", AT(gap.process), config_process_word,
	      "where the sparks are: in a cavity, or along a wire"),
	WORDS(GAP, "filter", "median", AT(gap.filter), filter_word,
	      "how the gap signal is smoothed"),
	COUNT(GAP, "filter_cycles", "cycles", "1", 1, GAP_FILTER_MAX,
	      AT(gap.filter_cycles),
	       "the filter works over this many cycles; 1: no filter"),
	COUNT(GAP, "short_cycles", "cycles", "1", 1, 1000, AT(gap.short_cycles),
	      "this many shorted cycles in a row are a short; the feed "
	       "ends at the first of them"),
	OF_WIRE(GAP, "feed_gain_mm_s_v", "mm/s/V", "0.01", "0.02", 1e-6, 10,
		AT(gap.gain_mm_s_v),
		"feed for each volt outside the window"),
	NUMBER(GAP, "integral_s", "s", "0", 0, 1000, AT(gap.integral_s),
	       "reset time of the servo's integral part; 0: no integral "
	       "part"),
	NUMBER(GAP, "feed_max_mm_s", "mm/s", "0.5", 1e-6, 100,
	       AT(gap.feed_max_mm_s), "fastest feed while eroding"),
	NUMBER(GAP, "creep_mm_s", "mm/s", "0.05", 0, 100, AT(gap.creep_mm_s),
	       "fastest speed back while eroding; 0: it stands instead"),
	NUMBER(GAP, "feed_a_mm_s2", "mm/s2", "0", 0, 1e6, AT(gap.feed_a_mm_s2),
	       "acceleration of the gap servo; 0: that of the axes"),
	NUMBER(GAP, "approach_mm_s", "mm/s", "0.5", 1e-4, 100,
	       AT(gap.approach_mm_s), "feed until the first spark"),
	NUMBER(GAP, "share_v", "V", "60", 0.1, 500, AT(gap.share_v),
	       "with source shares: a share of 1 is a signal of this many "
	       "volts"),
	NUMBER(GAP, "share_set", "", "0.2", -1, 1, AT(gap.share_set),
	       "with source shares: share of open pulses, minus weighted "
	       "shorts and arcs, that the servo holds"),
	NUMBER(GAP, "share_weight", "", "1", 0, 100, AT(gap.share_weight),
	       "with source shares: weight of shorts and arcs against open "
	       "pulses"),
	NUMBER(GAP, "share_short", "", "0.5", 0.01, 1, AT(gap.share_short),
	       "with source shares: this share of shorts is a short "
	       "circuit"),
	NUMBER(GAP, "share_open", "", "0.95", 0.01, 1, AT(gap.share_open),
	       "with source shares: this share of open pulses means that "
	       "there is nothing to cut yet"),
	NUMBER(GAP, "share_pulses", "", "10", 1, 1e6, AT(gap.share_pulses),
	       "with source counts: a reading is of so many pulses, or of "
	       "those of half of share_stale_ms"),
	NUMBER(GAP, "share_mm", "mm", "0.002", 1e-5, 10, AT(gap.share_mm),
	       "with source counts: after so much feed the servo stands until "
	       "the next reading"),
	NUMBER(GAP, "share_stale_ms", "ms", "50", 1, 10000,
	       AT(gap.share_stale_ms),
	       "with source counts: without a reading for so long the gap is "
	       "lost"),
	NUMBER(GAP, "retract_mm_s", "mm/s", "5", 1e-3, 1000,
	       AT(gap.retract_mm_s), "speed back along the path in a retract"),
	NUMBER(GAP, "retract_limit_mm", "mm", "3", 1e-3, 1000,
	       AT(gap.retract_limit_mm),
	       "a retract ends after this way, even if the gap is still "
	       "short"),
	PERIODS(GAP, "retract_wait_s", "s", "0.5", 0, 60, gap.retract_wait,
	       "still short so long after the end of a retract: fault "
	       "short-not-cleared"),
	PERIODS(GAP, "retract_max_s", "s", "60", 0, 86400, gap.retract_max,
	       "a retract that lasts longer is fault retract-time; 0: no "
	       "limit"),
	WORDS(GAP, "retract_to", "limit", AT(gap.retract_to), retract_to_word,
	      "how far a retract may go back: retract_limit_mm, to the "
	       "start of the program, or to the start of the motion"),
	WHOLE(GAP, "abort_count", "", "0", 0, 1e9, AT(gap.abort_count),
	      "this many retracts with no erosion between them are fault "
	       "retract-count; 0: no limit"),
	NUMBER(GAP, "progress_mm", "mm", "0.001", 0, 10, AT(gap.progress_mm),
	       "a cut that is deeper by more than this counts as erosion"),
	NUMBER(GAP, "arcing_share", "", "0.3", 0, 1, AT(gap.arcing_share),
	       "a larger share of arcs is arcing; 0: arcs are not watched"),
	COUNT(GAP, "arcing_cycles", "cycles", "200", 1, 1e6, AT(gap.arcing_cycles),
	      "the share of arcs is a mean over this many cycles with "
	       "power"),
	NUMBER(GAP, "arcing_sigma_v", "V", "0", 0, 100, AT(gap.arcing_sigma_v),
	       "where pulses are not counted: a voltage near a short whose "
	       "deviation is smaller is an arc; 0: arcs are not found by "
	       "voltage"),
	NUMBER(GAP, "off_us", "us", "0", 0, 1e5, AT(gap.off_us),
	       "off time of the generator itself; 0: [sim] off_us, or not "
	       "known"),
	NUMBER(GAP, "arcing_off_max", "", "4", 1, 100, AT(gap.arcing_off_max),
	       "against arcs the off time is made longer, at most by this "
	       "factor"),
	PERIODS(GAP, "arcing_recover_s", "s", "2", 0, 3600, gap.arcing_recover,
	       "time without arcs, after which the off time is made one "
	       "step shorter"),
	NUMBER(GAP, "arcing_retract_mm", "mm", "0.5", 0, 1000,
	       AT(gap.arcing_retract_mm), "smallest retract out of an arc"),
	PERIODS(GAP, "stuck_s", "s", "5", 0, 3600, gap.stuck,
	       "a signal that does not change for this time while the axes "
	       "move is fault gap-stuck; 0: not watched"),
	NUMBER(GAP, "noise_limit_v", "V", "100", 0, 1000, AT(gap.noise_limit_v),
	       "a signal that changes by more than this in a cycle, on "
	       "average, is fault gap-stuck; 0: not watched"),
	NUMBER(GAP, "wire_retract_mm", "mm", "0.5", 0.001, 1000,
	       AT(gap.wire_retract_mm),
	       "wire machines: a retract goes no farther back"),
	WORDS(GAP, "wire_retreat_to", "distance", AT(gap.wire_retreat_to),
	      retreat_to_word, "wire machines: how far the way back from a "
	      "broken wire goes: wire_retreat_mm, to the start of the motion, "
	      "or to the start hole"),
	NUMBER(GAP, "wire_retreat_mm", "mm", "1", 0, 1000,
	       AT(gap.wire_retreat_mm),
	       "wire machines: way back from a broken wire"),
	WORDS(GAP, "retract", "path", AT(gap.retract_escape), retract_word,
	      "way out of a short: back along the path, or by the escape"),

	NUMBER(JUMP, "height_mm", "mm", "2", 0, 500, AT(jump.height_mm),
	       "height of a jump, along its way out; 0: no jumps"),
	PERIODS(JUMP, "every_s", "s", "2", 0.01, 86400, jump.every,
	       "time of erosion between two jumps"),
	NUMBER(JUMP, "every_mm", "mm", "0", 0, 1000, AT(jump.every_mm),
	       "depth cut between two jumps; 0: jumps come by time alone"),
	BIT(JUMP, "adaptive", "no", AT(jump.adaptive),
	    "period and height follow the state of the gap"),
	PERIODS(JUMP, "every_min_s", "s", "0.5", 0.01, 86400,
	       jump.every_min,
	       "adaptive: shortest time between two jumps"),
	PERIODS(JUMP, "every_max_s", "s", "10", 0.01, 86400,
	       jump.every_max,
	       "adaptive: longest time between two jumps"),
	NUMBER(JUMP, "height_min_mm", "mm", "0.5", 0.001, 500,
	       AT(jump.height_min_mm), "adaptive: lowest jump"),
	NUMBER(JUMP, "height_max_mm", "mm", "5", 0.001, 500,
	       AT(jump.height_max_mm), "adaptive: highest jump"),
	NUMBER(JUMP, "bad_share", "", "0.02", 0.0001, 1, AT(jump.bad_share),
	       "adaptive: share of the time with shorts, retracts or arcs "
	       "that calls for more flushing"),
	NUMBER(JUMP, "v_max_mm_s", "mm/s", "80", 1e-3, 1e4, AT(jump.v_max_mm_s),
	       "fastest speed of the lift"),
	NUMBER(JUMP, "a_max_mm_s2", "mm/s2", "1000", 1e-2, 1e6,
	       AT(jump.a_max_mm_s2), "acceleration of the lift"),
	NUMBER(JUMP, "j_max_mm_s3", "mm/s3", "20000", 1, 1e9,
	       AT(jump.j_max_mm_s3), "jerk of the lift"),
	NUMBER(JUMP, "a_down_mm_s2", "mm/s2", "0", 0, 1e6,
	       AT(jump.a_down_mm_s2),
	       "acceleration toward the cut; 0: a_max_mm_s2"),
	NUMBER(JUMP, "short_of_mm", "mm", "0.05", 0, 10, AT(jump.short_of_mm),
	       "a jump comes back to this distance above the cut"),
	WORDS(JUMP, "escape", "path", AT(jump_escape), escape_word,
	      "way out of a jump, where it is free; a program may change "
	       "it by G140 ... G143"),

	NUMBER(PROBE, "feed_mm_s", "mm/s", "0.5", 0.001, 20,
	       AT(probe.feed_mm_s), "speed until the first contact"),
	NUMBER(PROBE, "fine_mm_s", "mm/s", "0.02", 0.0001, 5,
	       AT(probe.fine_mm_s),
	       "speed until the second contact, which counts"),
	NUMBER(PROBE, "back_mm", "mm", "0.1", 0, 10, AT(probe.back_mm),
	       "way back between the two contacts; 0: the first one counts"),
	WORDS(PROBE, "with", "sense", AT(probe_with), probe_word,
	      "what feels contact: the generator's sensing voltage, or the "
	      "voltage that is on the gap while the sparks are off"),
	PERIODS(PROBE, "settle_s", "s", "0.05", 0.002, 10, probe.settle,
	       "time for the sensing voltage to settle, before the motion "
	       "begins"),
};
/* clang-format on */

const struct config_keys config_keys_gap = { row, ROWS_IN(row) };
