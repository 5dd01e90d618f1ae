/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_gpio.c - keys of lines of a GPIO chip
 */
#include "keys_rows.h"

static const char *signal_word(int i)
{
	static const char *const words[] = { "step", "quadrature" };

	return WORD_OF(words, i);
}

static const char *pull_word(int i)
{
	static const char *const words[] = { "as-is", "up", "down", "none" };

	return WORD_OF(words, i);
}

#define LINE(key, i, what) \
	{ SECTION_GPIO, key, KEY_LINE, "", "none", 0, 0, AT(gpio.line[i]), \
	  ROOM(gpio.line[0]), .help = what }
#define AXIS_LINES(axis) \
	LINE("step_" #axis, LINE_STEP + INTERP_##axis, \
	     "output: step, or A"), \
	LINE("dir_" #axis, LINE_DIR + INTERP_##axis, \
	     "output: direction, on for +; or B"), \
	LINE("limit_" #axis, LINE_LIMIT + INTERP_##axis, \
	     "input: an end of the travel, either; fault limit-switch"), \
	LINE("home_" #axis, LINE_HOME + INTERP_##axis, "input: home switch"), \
	LINE("brake_" #axis, LINE_BRAKE + INTERP_##axis, \
	     "output: opens the axis' brake, while it is under power")
#define ENCODER(axis) \
	STRING(GPIO, "encoder_" #axis, "none", gpio.encoder[INTERP_##axis], \
	       "input: A and B of an encoder, as 24 25; or a counter of the " \
	       "kernel, as counter0/count0")

/* clang-format off */
static const struct config_key row[] = {
	STRING(GPIO, "chip", "gpiochip0", gpio.chip,
	       "GPIO chip of lines that name none: its name, label or "
	       "device file"),
	WORDS(GPIO, "signal", "step", AT(gpio.signal), signal_word,
	      "what step_ and dir_ carry: step and direction, or A and B "
	       "of quadrature"),
	WHOLE(GPIO, "high_cycles", "periods", "1", 1, 1000,
	      AT(gpio.high_cycles),
	      "time that a step stays on; in quadrature, between two "
	       "edges"),
	WHOLE(GPIO, "low_cycles", "periods", "1", 1, 1000, AT(gpio.low_cycles),
	      "time that a step stays off before the next one"),
	WHOLE(GPIO, "dir_setup_cycles", "periods", "1", 1, 1000,
	      AT(gpio.dir_setup_cycles),
	      "time from a change of direction to the step"),
	WHOLE(GPIO, "dir_hold_cycles", "periods", "1", 1, 1000,
	      AT(gpio.dir_hold_cycles),
	      "time from the end of a step to a change of direction"),
	NUMBER(GPIO, "high_us", "us", "5", 0, 1e5, AT(gpio.high_us),
	       "a step stays on for at least this time, however late the "
	       "cycle wakes; in quadrature, between two edges"),
	NUMBER(GPIO, "low_us", "us", "5", 0, 1e5, AT(gpio.low_us),
	       "... and off"),
	NUMBER(GPIO, "setup_us", "us", "5", 0, 1e5, AT(gpio.setup_us),
	       "... and this long after a change of direction it begins"),
	STRING(GPIO, "adc", "none", gpio.adc,
	       "converter of the gap's voltage: iio:deviceN or its name; for "
	       "[gap] source = voltage"),
	WHOLE(GPIO, "adc_channel", "", "0", 0, 255, AT(gpio.adc_channel),
	      "N of its in_voltageN"),
	STRING(GPIO, "adc_trigger", "none", gpio.adc_trigger,
	       "name of the trigger that starts a sample; none: the "
	       "converter needs none"),
	NUMBER(GPIO, "adc_ratio", "", "1", -1e6, 1e6, AT(gpio.adc_ratio),
	       "volts at the gap for one volt at the converter's input"),
	WHOLE(GPIO, "edges_per_period", "", "1", 1, 1000,
	      AT(gpio.edges_per_period),
	      "how often step and dir are written in a period, by a "
	       "thread of its own; 1: once, by the cycle"),
	WHOLE(GPIO, "edges_cpu", "", "-1", -1, 1023, AT(gpio.edges_cpu),
	      "processor core of that thread; -1: any"),
	NUMBER(GPIO, "watchdog_us", "us", "1000", 20, 1e6, AT(gpio.watchdog_us),
	       "time between two edges of the watchdog's wave"),
	STRING(GPIO, "watchdog_by", "none", gpio.watchdog_by,
	       "if there is a line spark and no line watchdog: in your "
	       "words, what ends the sparks when edmd dies"),
	STRING(GPIO, "estop_by", "none", gpio.estop_by,
	       "if there is a line spark and no line estop: in your words, "
	       "what stops everything at an emergency stop"),
	WORDS(GPIO, "pull", "as-is", AT(gpio.pull), pull_word,
	      "pull resistors of all inputs"),
	AXIS_LINES(X), AXIS_LINES(Y), AXIS_LINES(Z), AXIS_LINES(A),
	AXIS_LINES(B), AXIS_LINES(C), AXIS_LINES(U), AXIS_LINES(V),
	ENCODER(X), ENCODER(Y), ENCODER(Z), ENCODER(A),
	ENCODER(B), ENCODER(C), ENCODER(U), ENCODER(V),
	NUMBER(GPIO, "following_mm", "mm", "0.05", 0, 1000,
	       AT(gpio.following_mm),
	       "an axis whose encoder is farther from its pulses is fault "
	       "following; 0: not watched"),
	NUMBER(GPIO, "following_s", "s", "0", 0, 10, AT(gpio.following_s),
	       "added to following_mm: this time multiplied by the speed"),
	NUMBER(GPIO, "resync_mm", "mm", "0.2", 0, 100, AT(gpio.resync_mm),
	       "an axis that was pushed off the path goes back by itself if "
	       "it is nearer than this; docs/gpio.md"),
	NUMBER(GPIO, "resync_mm_s", "mm/s", "0.5", 0.001, 100,
	       AT(gpio.resync_mm_s), "speed back to the path"),
	LINE("enable", LINE_ENABLE,
	     "output: power on the axes' drives"),
	NUMBER(GPIO, "brake_ms", "ms", "100", 0, 5000, AT(gpio.brake_ms),
	       "time until a brake is open, or closed"),
	LINE("spark", LINE_SPARK, "output: sparks allowed"),
	LINE("pump", LINE_PUMP, "output: dielectric pump"),
	LINE("watchdog", LINE_WATCHDOG,
	     "output: a square wave that ends with the cycle"),
	LINE("gap_open", LINE_GAP_OPEN, "input: gap comparator, no spark"),
	LINE("gap_spark", LINE_GAP_SPARK, "input: gap comparator, a spark"),
	LINE("gap_short", LINE_GAP_SHORT, "input: gap comparator, a short"),
	LINE("estop", LINE_ESTOP, "input: fault e-stop"),
	LINE("wire", LINE_WIRE, "input: the wire is broken"),
	LINE("door", LINE_DOOR, "input: the door is open; fault door"),
	LINE("dielectric", LINE_DIELECTRIC,
	     "input: the level is too low; fault dielectric"),
};
/* clang-format on */

const struct config_keys config_keys_gpio = { row, ROWS_IN(row) };
