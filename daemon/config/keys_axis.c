/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_axis.c - keys of the axes, and of how they keep to a contour
 */
#include "keys_rows.h"

#include "cycle.h"

static const char *method_word(int i)
{
	static const char *const words[HOME_NMETHODS] = {
		[HOME_NONE] = "none",
		[HOME_SWITCH] = "switch",
		[HOME_SWITCH_INDEX] = "switch-index",
		[HOME_ABSOLUTE] = "absolute",
		[HOME_DRIVE] = "drive",
	};

	return WORD_OF(words, i);
}

static const char *direction_word(int i)
{
	return i == 0 ? "-" : i == 1 ? "+" : NULL;
}

static const char *yes_word(int i)
{
	return i == 0 ? "no" : i == 1 ? "yes" : NULL;
}

static const char *mode_word(int i)
{
	return i == DRIVE_CSP ? "csp" : i == DRIVE_IP ? "ip" : NULL;
}

static const char *brake_word(int i)
{
	static const char *const words[] = {
		[BRAKE_UNSAID] = "unsaid", [BRAKE_FREE] = "free",
		[BRAKE_DRIVE] = "drive", [BRAKE_NONE] = "none",
		[BRAKE_LINE] = "line",
	};

	return WORD_OF(words, i);
}

#define DRIVE(field)	EACH(drive[0].field, struct config_drive)
#define DRIVE_TEXT(key, field, what) \
	{ SECTION_AXIS, key, KEY_STRING, "", "none", 0, 0, DRIVE(field), \
	  ROOM(drive[0].field), .help = what }
#define AXIS(field)	EACH(axes.axis[0].field, struct interp_axis_limits)
#define MANUAL(field)	EACH(manual[0].field, struct manual_axis)
#define BACKLASH(field)	EACH(backlash[0].field, struct config_backlash)
#define LOOP(field)	EACH(loop[0].field, struct interp_axis_loop)

/* clang-format off */
static const struct config_key row[] = {
	BIT(AXIS, "present", "yes", AT(axes.present),
	    "the machine has this axis"),
	NUMBER(AXIS, "pulse_mm", "mm", "0.001", 1e-6, 1, AXIS(pulse_mm),
	       "distance of one pulse"),
	ROTARY(AXIS, "travel_min_mm", "mm", "-200", "-1000000", -1e7, 1e7,
	       AXIS(travel_min_mm), "lower soft limit, machine coordinates"),
	ROTARY(AXIS, "travel_max_mm", "mm", "200", "1000000", -1e7, 1e7,
	       AXIS(travel_max_mm), "upper soft limit, machine coordinates"),
	ROTARY(AXIS, "v_max_mm_s", "mm/s", "80", "60", 1e-3, 1e5,
	       AXIS(v_max_mm_s), "fastest speed"),
	NUMBER(AXIS, "a_max_mm_s2", "mm/s2", "1000", 1e-2, 1e6,
	       AXIS(a_max_mm_s2), "largest acceleration"),
	NUMBER(AXIS, "j_max_mm_s3", "mm/s3", "20000", 1, 1e9, AXIS(j_max_mm_s3),
	       "largest jerk"),
	NUMBER(AXIS, "jog_mm_s", "mm/s", "5", 1e-3, 1e5, MANUAL(jog_mm_s),
	       "speed of a jog"),
	WORDS(AXIS, "home_method", "none", MANUAL(method), method_word,
	      "how its place is found; docs/homing.md"),
	WORDS(AXIS, "home_dir", "-", EACH(home_dir[0], int), direction_word,
	      "direction in which the home switch lies"),
	NUMBER(AXIS, "home_fast_mm_s", "mm/s", "10", 1e-3, 1e5,
	       MANUAL(home_fast_mm_s), "speed toward the switch"),
	NUMBER(AXIS, "home_slow_mm_s", "mm/s", "0.5", 1e-3, 1e5,
	       MANUAL(home_slow_mm_s),
	       "speed off the switch and onto it again, and of jogs before "
	       "homing"),
	NUMBER(AXIS, "home_at_mm", "mm", "0", -1e6, 1e6, MANUAL(home_at_mm),
	       "place of the switch or of the index mark; with home_method "
	       "absolute or drive, the place where the drive says 0"),
	NUMBER(AXIS, "home_back_mm", "mm", "1", 1e-3, 1e4, MANUAL(home_back_mm),
	       "distance that the axis leaves the switch by, before it "
	       "goes onto it slowly"),
	NUMBER(AXIS, "home_search_mm", "mm", "10", 1e-3, 1e4,
	       MANUAL(home_search_mm),
	       "homing goes this far beyond the last place where the switch "
	       "or the mark can be, and no farther"),
	COUNT(AXIS, "home_order", "", "0", 0, 99, MANUAL(home_order),
	      "axes are homed one after another, the lowest number first"),
	NUMBER(AXIS, "backlash_um", "um", "0", 0, 10000, BACKLASH(um),
	       "lost motion where the axis turns back"),
	NUMBER(AXIS, "backlash_mm_s", "mm/s", "1", 1e-3, 1e5,
	       BACKLASH(mm_s),
	       "speed at which backlash and geometric errors are taken up"),
	{ SECTION_AXIS, "pitch_map", KEY_STRING, "", "none", 0, 0,
	  EACH(pitch_map[0], char[128]), 128,
	  .help = "file of the axis's pitch errors; docs/homing.md"},
	NUMBER(AXIS, "start_mm", "mm", "0", -1e7, 1e7, EACH(start_mm, double),
	       "place of the axis when edmd starts, if the machine is "
	       "simulated or its drives cannot tell"),
	WHOLE(AXIS, "drive_increments", "", "1", -1e9, 1e9,
	      EACH(drive[0].increments, struct config_drive),
	      "CiA 402: this many increments of the drive (negative: the "
	       "other direction) ..."),
	WHOLE(AXIS, "drive_pulses", "pulses", "1", 1, 1e9,
	      EACH(drive[0].pulses, struct config_drive),
	      "... are this many pulses"),
	WHOLE(AXIS, "encoder_counts", "", "1", -1e9, 1e9,
	      DRIVE(encoder_counts),
	      "[gpio] encoder_: this many counts, four in a period of A "
	       "(negative: the other direction) ..."),
	WHOLE(AXIS, "encoder_pulses", "pulses", "1", 1, 1e9,
	      DRIVE(encoder_pulses), "... are this many pulses"),
	WORDS(AXIS, "absolute", "no", DRIVE(absolute), yes_word,
	      "the drive knows its place when it is switched on"),
	WORDS(AXIS, "brake", "unsaid", DRIVE(brake), brake_word,
	      "without power the axis stays where it is (free), the "
	       "drive's own brake holds it (drive), a brake on gpio.brake_ "
	       "holds it (line), or it would fall and "
	       "must be held under torque (none)"),
	WORDS(AXIS, "drive_follow_bit", "yes", DRIVE(follow_bit), yes_word,
	      "the drive reports with bit 12 of its statusword that it "
	       "follows its target"),
	WHOLE(AXIS, "drive_fault_reaction", "", "-1", -1, 4,
	      DRIVE(fault_reaction),
	       "object 605E; -1: left as the drive has it"),
	WHOLE(AXIS, "drive_connection_lost", "", "3", -1, 3,
	      DRIVE(connection_lost),
	      "object 6007: 1 fault, 2 no power, 3 quick stop; -1: left "
	       "as it is"),
	NUMBER(AXIS, "drive_window_mm", "mm", "0", 0, 1000, DRIVE(window_mm),
	       "object 6065, the drive's own limit of the following error; "
	       "0: left as it is"),
	NUMBER(AXIS, "drive_quick_stop_mm_s2", "mm/s2", "0", 0, 1e6,
	       DRIVE(quick_stop_mm_s2),
	       "object 6085, the drive's ramp in a quick stop; 0: left as "
	       "it is"),
	WORDS(AXIS, "drive_mode", "csp", DRIVE(mode), mode_word,
	      "mode of the drive: cyclic synchronous position (8), or "
	      "interpolated position (7) if it has no other"),
	WHOLE(AXIS, "drive_home", "", "0", -128, 127, DRIVE(home),
	      "object 6098, how the drive homes by itself, with home_method "
	       "drive: 1 to 34 as in CiA 402, 35 or 37 where it stands, "
	       "negative: the maker's own"),
	NUMBER(AXIS, "drive_velocity_unit", "increments/s", "1", 0, 1e9,
	       DRIVE(velocity_unit),
	       "so many are 1 in object 6099, which gets home_fast_mm_s and "
	       "home_slow_mm_s; 0: left as the drive has it"),
	NUMBER(AXIS, "drive_acceleration_unit", "increments/s2", "1", 0, 1e12,
	       DRIVE(acceleration_unit),
	       "so many are 1 in object 609A, which gets a_max_mm_s2; 0: left "
	       "as the drive has it"),
	DRIVE_TEXT("drive_identity", identity,
		   "object 1018, hexadecimal, vendor product revision serial; "
		   "x: any"),
	DRIVE_TEXT("drive_sdo", sdo,
		   "more objects to write, INDEX:SUB=VALUE/BYTES; all but "
	       "BYTES in hexadecimal"),
	DRIVE_TEXT("drive_leave", leave,
		   "objects, in hexadecimal, that edmd leaves as the drive has "
	       "them"),
	DRIVE_TEXT("drive_inputs", inputs,
		   "what is wired to inputs of the drive, object 60FD: "
	       "limit_low:BIT limit_high:BIT home:BIT estop:BIT contact:BIT; "
	       "!BIT: on when the bit is 0"),
	DRIVE_TEXT("drive_eds", eds,
		   "file of the drive's EDS; what edmd writes is checked "
	       "against it"),
	NUMBER(AXIS, "loop_gain_1_s", "1/s", "0", 0, 1000, LOOP(gain_1_s),
	       "gain of the position loop, as edmctl identify finds it; 0: "
	       "not known"),
	NUMBER(AXIS, "loop_hz", "Hz", "60", 1, 1000, LOOP(velocity_hz),
	       "natural frequency of the velocity loop"),
	NUMBER(AXIS, "loop_damping", "", "0.7", 0.1, 3, LOOP(damping),
	       "damping of the velocity loop"),
	NUMBER(AXIS, "loop_delay_s", "s", "0", 0, 0.012, LOOP(delay_s),
	       "delay from the set value to the velocity loop"),
	NUMBER(AXIS, "loop_feedforward", "", "0", -0.5, 1.5, LOOP(feedforward),
	       "share of the set speed that the drive itself feeds "
	       "forward; 1: all of it"),
	NUMBER(AXIS, "friction_mm_s", "mm/s", "0", -10, 10, LOOP(kick_mm_s),
	       "friction: speed by which the axis lags after a reversal"),
	NUMBER(AXIS, "friction_s", "s", "0.02", 0.002, 0.2, LOOP(kick_s),
	       "time constant with which that lag decays"),
	NUMBER(AXIS, "backlash_mm", "mm", "0", 0, 1, LOOP(backlash_mm),
	       "lost motion at a reversal, in the model of the axis"),

	STRING(GEOMETRY, "maps", "none", maps,
	       "file of the machine's geometric errors: pitch, "
	       "straightness, squareness, growth"),
	NUMBER(GEOMETRY, "over_k", "K", "0", -50, 50, AT(over_k),
	       "temperature of the axes over that of the maps, until a PLC "
	       "tells it"),
	NUMBER(GEOMETRY, "maps_c", "degC", "20", -20, 60, AT(maps_c),
	       "temperature the maps were measured at"),

	STRING(CONTOUR, "method", "none", contour.method,
	       "none, or of feedforward, cross-coupled, joined by +; in "
	       "edmsim --tune-contour and reports predictive and zpetc too"),
	NUMBER(CONTOUR, "speed", "", "1", 0, 2, AT(contour.speed),
	       "feedforward: of the set speed"),
	NUMBER(CONTOUR, "acceleration", "", "1", 0, 3, AT(contour.acceleration),
	       "feedforward: of what the velocity loop lags"),
	NUMBER(CONTOUR, "lead_periods", "periods", "0.5", 0, 1,
	       AT(contour.lead_periods), "feedforward: so far ahead"),
	NUMBER(CONTOUR, "cross_1_s", "1/s", "0", 0, 1000, AT(contour.cross_1_s),
	       "cross-coupled: speed for each mm of contour error"),
	NUMBER(CONTOUR, "predicted_1_s", "1/s", "0", 0, 1000,
	       AT(contour.predicted_1_s),
	       "predictive: Kff, for the error to come"),
	NUMBER(CONTOUR, "measured_1_s", "1/s", "0", 0, 1000,
	       AT(contour.measured_1_s),
	       "predictive: Kfb, for the present one"),
	NUMBER(CONTOUR, "horizon_s", "s", "0.02", 0, 0.064,
	       AT(contour.horizon_s), "predictive: how far it looks ahead"),
	NUMBER(CONTOUR, "noise_mm", "mm", "0.0005", 0, 0.1,
	       AT(contour.noise_mm), "sigma of the encoders, for trials"),
	NUMBER(CONTOUR, "model_error", "", "0.02", 0, 0.5,
	       AT(contour.model_error),
	       "gain, velocity loop and delay are off by it, for trials"),
};
/* clang-format on */

const struct config_keys config_keys_axis = { row, ROWS_IN(row) };
