/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_generator.c - keys of the generator
 */
#include "keys_rows.h"

const char *config_interface_word(int i)
{
	static const char *const words[] = {
		"auto", "sim", "none", "lines", "can", "modbus", "plc"
	};

	return WORD_OF(words, i);
}

static const char *parity_word(int i)
{
	static const char *const words[] = { "even", "none", "odd" };

	return WORD_OF(words, i);
}

#define WAY(key, i, what) \
	STRING(GENERATOR, key, "auto", generator.field[i], what)
#define SUM(key, i, what) \
	STRING(GENERATOR, "told_" key, "none", generator.told[PROCESS_##i], \
	       what ", as can 1012 byte 0 bits 32, as input 40 bits 32: two " \
	       "registers, the high one first, or as input 40 bits 32 first " \
	       "low")
#define TOLD(key, i) \
	STRING(GENERATOR, "told_" key, "auto", \
	       generator.told[INTERP_TECH_##i], \
	       "where the generator tells the " key " that is in force, as " \
	       "can 1011 byte 0 bits 16 scale 0.1, or as register 30 scale " \
	       "0.1; auto: in the register that is written, by the PLC that " \
	       "sets it, else none")

/* clang-format off */
static const struct config_key row[] = {
	WORDS(GENERATOR, "interface", "auto", AT(generator.interface),
	      config_interface_word,
	      "how it is reached; auto: sim with backend sim, else none"),
	NAME(GENERATOR, "can_interface", "can0", generator.can_interface,
	     "network interface of its bus"),
	WHOLE(GENERATOR, "can_id", "", "0", 0, 2047, AT(generator.can_id),
	      "CAN identifier of the usual frame; 0: each field has a place "
	      "of its own"),
	WAY("peak_a", INTERP_TECH_PEAK_A,
	    "how the peak current reaches it, as lines 20 21 26 weights 3 6 "
	    "12, as can 1009 byte 2 bits 16 scale 0.1, or as register 10 "
	    "scale 0.1; plc: the PLC sets it; none: not at all; "
	    "auto: as the interface has it"),
	WAY("on_us", INTERP_TECH_ON_US, "the same for the on time"),
	WAY("off_us", INTERP_TECH_OFF_US,
	    "the same for the off time, as lines 5 6 codes 2 4 8 16"),
	WAY("ignition_v", INTERP_TECH_IGNITION_V,
	    "the same for the open-circuit voltage"),
	WAY("servo_v", INTERP_TECH_SERVO_V,
	    "the same for the reference of a gap servo of the generator's "
	    "own; auto: not at all"),
	WAY("polarity", INTERP_TECH_POLARITY,
	    "a line, or a bit, that is on while the electrode is to be "
	    "negative"),
	WAY("iso", INTERP_TECH_ISO,
	    "on while pulses are to be timed from their ignition"),
	WAY("sense", PROCESS_SENSE,
	    "on while the voltage to feel contact by is wanted"),
	WAY("pump", PROCESS_PUMP, "on while dielectric is wanted"),
	WAY("spark", PROCESS_SPARK, "on while sparks are allowed"),
	TOLD("peak_a", PEAK_A), TOLD("on_us", ON_US), TOLD("off_us", OFF_US),
	TOLD("ignition_v", IGNITION_V), TOLD("polarity", POLARITY),
	TOLD("iso", ISO), TOLD("servo_v", SERVO_V),
	SUM("opens", OPENS, "where it counts pulses that did not ignite"),
	SUM("sparks", SPARKS, "where it counts those that ignited well"),
	SUM("arcs", ARCS, "where it counts arcs"),
	SUM("shorts", SHORTS, "where it counts shorts"),
	SUM("energy_j", ENERGY_J,
	    "where it sums the energy of the discharges; scale: J of a count"),
	STRING(GENERATOR, "told_fault", "auto", generator.told[PROCESS_FAULT],
	       "where it tells the number of its own fault, 0: none, as "
	       "can 1012 byte 4 bits 8, or as input 45; auto: by the PLC that "
	       "sets it, else none"),
	STRING(GENERATOR, "fault_words", "none", generator.fault_words,
	       "its own faults in words, as 1 no water, 2 too warm"),
	STRING(GENERATOR, "by_hand", "none", generator.by_hand,
	       "fields of a condition that a person sets at the generator, as "
	       "on_us off_us: the job stands at each change and asks"),
	NUMBER(GENERATOR, "settle_ms", "ms", "20", 0, 60000,
	       AT(generator.settle_ms),
	       "time from a change to the first spark, where the generator "
	       "does not tell what is in force"),
	NUMBER(GENERATOR, "polarity_ms", "ms", "50", 0, 60000,
	       AT(generator.polarity_ms),
	       "the sparks are off for so long before the polarity changes"),
	NUMBER(GENERATOR, "silent_ms", "ms", "200", 1, 60000,
	       AT(generator.silent_ms),
	       "without a frame of one that tells for so long: fault "
	       "generator"),
	STRING(GENERATOR, "modbus", "none", generator.modbus,
	       "where the Modbus slave is: a serial port as /dev/ttyUSB0, or "
	       "ADDRESS:PORT as 192.168.1.5:502"),
	WHOLE(GENERATOR, "modbus_unit", "", "1", 0, 255, AT(generator.unit),
	      "its address: 1 to 247; over TCP also 0 and 255"),
	WHOLE(GENERATOR, "modbus_baud", "1/s", "19200", 300, 921600,
	      AT(generator.baud), "speed of the serial port"),
	WORDS(GENERATOR, "modbus_parity", "even", AT(generator.parity),
	      parity_word, "of the serial port; none: two stop bits"),
	NUMBER(GENERATOR, "modbus_timeout_ms", "ms", "50", 1, 10000,
	       AT(generator.timeout_ms),
	       "an answer begins in this time, beside the time that the bytes "
	       "of a serial port take"),
	NUMBER(GENERATOR, "modbus_every_ms", "ms", "50", 1, 10000,
	       AT(generator.every_ms),
	       "what the slave tells is read so often"),
	NUMBER(GENERATOR, "confirm_s", "s", "2", 0.01, 600,
	       AT(generator.confirm_s),
	       "without its word for so long that a change is in force: fault "
	       "generator"),
};
/* clang-format on */

const struct config_keys config_keys_generator = { row, ROWS_IN(row) };
