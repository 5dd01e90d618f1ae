/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_gap.c - keys of the gap servo, its jumps, and touching
 */
#include "keys_rows.h"

#include "cycle.h"

static const char *process_word(int i)
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

static const char *retract_word(int i)
{
	return i == 0 ? "path" : i == 1 ? "escape" : NULL;
}

static const char *escape_word(int i)
{
	return i < 0 ? NULL :
	       interp_escape_mode_name((enum interp_escape_mode)i);
}

/* clang-format off */
static const struct config_key row[] = {
	WORDS(GAP, "source", "sim", AT(gap.source), source_word,
	      "where the gap signal comes from"),
	NUMBER(GAP, "servo_v", "V", "15", 0.1, 500, AT(gap.servo_v),
	       "mean gap voltage to hold"),
	NUMBER(GAP, "short_v", "V", "8", 0, 500, AT(gap.short_v),
	       "below: short circuit, retract"),
	NUMBER(GAP, "open_v", "V", "60", 0.1, 500, AT(gap.open_v),
	       "above: nothing to cut yet, approach"),
	NUMBER(GAP, "window_low_v", "V", "0", 0, 500, AT(gap.window_low_v),
	       "servo creeps back below it; 0: halfway from short_v to "
	       "servo_v"),
	NUMBER(GAP, "window_high_v", "V", "0", 0, 500, AT(gap.window_high_v),
	       "servo feeds above it, stands between; 0: servo_v"),
	NUMBER(GAP, "ignition_v", "V", "0", 0, 1000, AT(gap.ignition_v),
	       "open-circuit voltage; 1.5 times as much is no reading; 0: "
	       "any is"),
	WORDS(GAP, "process", "sink", AT(gap.process), process_word,
	      "where the sparks are: in a cavity, or along a wire"),
	WORDS(GAP, "filter", "median", AT(gap.filter), filter_word,
	      "how the gap signal is smoothed"),
	COUNT(GAP, "filter_cycles", "cycles", "1", 1, GAP_FILTER_MAX,
	      AT(gap.filter_cycles), "... over so many; 1: not at all"),
	COUNT(GAP, "short_cycles", "cycles", "1", 1, 1000, AT(gap.short_cycles),
	      "shorted in a row are a short; feed ends at the first"),
	NUMBER(GAP, "feed_gain_mm_s_v", "mm/s/V", "0.02", 1e-6, 10,
	       AT(gap.gain_mm_s_v),
	       "feed for each volt outside the window"),
	NUMBER(GAP, "integral_s", "s", "0", 0, 1000, AT(gap.integral_s),
	       "reset time of the integral of the feed; 0: none"),
	NUMBER(GAP, "feed_max_mm_s", "mm/s", "0.5", 1e-6, 100,
	       AT(gap.feed_max_mm_s), "fastest feed while eroding"),
	NUMBER(GAP, "creep_mm_s", "mm/s", "0.05", 0, 100, AT(gap.creep_mm_s),
	       "fastest back while eroding; 0: stand"),
	NUMBER(GAP, "feed_a_mm_s2", "mm/s2", "0", 0, 1e6, AT(gap.feed_a_mm_s2),
	       "acceleration of the servo; 0: the axes' own"),
	NUMBER(GAP, "approach_mm_s", "mm/s", "0.5", 1e-4, 100,
	       AT(gap.approach_mm_s), "feed until the first spark"),
	NUMBER(GAP, "share_v", "V", "60", 0.1, 500, AT(gap.share_v),
	       "shares: worth of 1, as volts of the signal"),
	NUMBER(GAP, "share_set", "", "0.2", -1, 1, AT(gap.share_set),
	       "shares: open, less weighted shorts and arcs, to hold"),
	NUMBER(GAP, "share_weight", "", "1", 0, 100, AT(gap.share_weight),
	       "shares: of shorts and arcs, against opens"),
	NUMBER(GAP, "share_short", "", "0.5", 0.01, 1, AT(gap.share_short),
	       "shares: so many shorts are a short circuit"),
	NUMBER(GAP, "share_open", "", "0.95", 0.01, 1, AT(gap.share_open),
	       "shares: so many opens are nothing to cut yet"),
	NUMBER(GAP, "retract_mm_s", "mm/s", "5", 1e-3, 1000,
	       AT(gap.retract_mm_s), "back along the path on a short"),
	NUMBER(GAP, "retract_limit_mm", "mm", "3", 1e-3, 1000,
	       AT(gap.retract_limit_mm), "still short so far back: stand"),
	NUMBER(GAP, "retract_wait_s", "s", "0.5", 0, 60, AT(seconds.retract_wait),
	       "still short so long after: fault short-not-cleared"),
	NUMBER(GAP, "retract_max_s", "s", "60", 0, 86400, AT(seconds.retract_max),
	       "a retract lasts longer: fault retract-time; 0: any"),
	WORDS(GAP, "retract_to", "limit", AT(gap.retract_to), retract_to_word,
	      "how far back: retract_limit_mm, the start of the program or "
	      "of the motion"),
	COUNT(GAP, "abort_count", "", "0", 0, 1e9, AT(gap.abort_count),
	      "retracts without erosion between: fault retract-count; 0: any"),
	NUMBER(GAP, "progress_mm", "mm", "0.001", 0, 10, AT(gap.progress_mm),
	       "cut deeper by more than this is erosion"),
	NUMBER(GAP, "arcing_share", "", "0.3", 0, 1, AT(gap.arcing_share),
	       "more of the pulses are arcing; 0: not looked at"),
	COUNT(GAP, "arcing_cycles", "cycles", "200", 1, 1e6, AT(gap.arcing_cycles),
	      "... in a mean over so many, with power"),
	NUMBER(GAP, "arcing_sigma_v", "V", "0", 0, 100, AT(gap.arcing_sigma_v),
	       "steadier near a short is an arc, where none are counted; 0: "
	       "no"),
	NUMBER(GAP, "off_us", "us", "0", 0, 1e5, AT(gap.off_us),
	       "the generator's own off time; 0: [sim] off_us, or not known"),
	NUMBER(GAP, "arcing_off_max", "", "4", 1, 100, AT(gap.arcing_off_max),
	       "off time against arcs, so many times at the most"),
	NUMBER(GAP, "arcing_recover_s", "s", "2", 0, 3600, AT(seconds.arcing_recover),
	       "without arcs, to a step down"),
	NUMBER(GAP, "arcing_retract_mm", "mm", "0.5", 0, 1000,
	       AT(gap.arcing_retract_mm), "retract out of an arc, at least"),
	NUMBER(GAP, "stuck_s", "s", "5", 0, 3600, AT(seconds.stuck),
	       "signal the very same while moving: fault gap-stuck; 0: any"),
	NUMBER(GAP, "noise_limit_v", "V", "100", 0, 1000, AT(gap.noise_limit_v),
	       "mean change in a cycle: fault gap-stuck; 0: any"),
	NUMBER(GAP, "wire_retract_mm", "mm", "0.02", 0.001, 1000,
	       AT(gap.wire_retract_mm), "wire: limit of a retract"),
	NUMBER(GAP, "wire_retreat_mm", "mm", "1", 0, 1000,
	       AT(gap.wire_retreat_mm),
	       "wire: back from a break; 0: to the motion's start"),
	WORDS(GAP, "retract", "path", AT(gap.retract_escape), retract_word,
	      "out of a short: back along the path, or by the escape"),

	NUMBER(JUMP, "height_mm", "mm", "2", 0, 500, AT(jump.height_mm),
	       "lift, along the way out; 0: no jumps"),
	NUMBER(JUMP, "every_s", "s", "2", 0.01, 86400, AT(seconds.jump_every),
	       "of erosion between two jumps"),
	NUMBER(JUMP, "every_mm", "mm", "0", 0, 1000, AT(jump.every_mm),
	       "of depth between two jumps; 0: by time alone"),
	BIT(JUMP, "adaptive", "no", AT(jump.adaptive),
	    "period and height follow the state of the gap"),
	NUMBER(JUMP, "every_min_s", "s", "0.5", 0.01, 86400,
	       AT(seconds.jump_every_min), "adaptive: no oftener"),
	NUMBER(JUMP, "every_max_s", "s", "10", 0.01, 86400,
	       AT(seconds.jump_every_max), "adaptive: no more seldom"),
	NUMBER(JUMP, "height_min_mm", "mm", "0.5", 0.001, 500,
	       AT(jump.height_min_mm), "adaptive: no lower"),
	NUMBER(JUMP, "height_max_mm", "mm", "5", 0.001, 500,
	       AT(jump.height_max_mm), "adaptive: no higher"),
	NUMBER(JUMP, "bad_share", "", "0.02", 0.0001, 1, AT(jump.bad_share),
	       "adaptive: of shorts, retracts and arcs in the time"),
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
	       "comes back to so far above the cut"),
	WORDS(JUMP, "escape", "path", AT(jump_escape), escape_word,
	      "the lift's way out, where it is free; until G140 ... G143"),

	NUMBER(PROBE, "feed_mm_s", "mm/s", "0.5", 0.001, 20,
	       AT(probe.feed_mm_s), "to the first contact"),
	NUMBER(PROBE, "fine_mm_s", "mm/s", "0.02", 0.0001, 5,
	       AT(probe.fine_mm_s), "to the second one, which counts"),
	NUMBER(PROBE, "back_mm", "mm", "0.1", 0, 10, AT(probe.back_mm),
	       "back between the two; 0: the first one counts"),
	NUMBER(PROBE, "settle_s", "s", "0.05", 0.002, 10, AT(seconds.probe_settle),
	       "for the sensing voltage, before it begins"),
};
/* clang-format on */

const struct config_keys config_keys_gap = { row, ROWS_IN(row) };
