/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_config_refusals.c - the machine file: what it refuses and where
 */
#include "config_help.h"
#include "seed.h"

struct refusal {
	const char *text;
	uint32_t line, column;
	const char *found, *wanted;
};

#define BY_PLC	"[machine]\nbackend = null\n[plc]\ninterface = can1\n" \
	"[generator]\ninterface = plc\n"
#define MODBUS	"[machine]\nbackend = null\n[generator]\ninterface = modbus\n"

#define BY_ADC	ADC_MACHINE "spark = 9\nwatchdog_by = its own\n" \
	"estop_by = its own\n" \
	"[generator]\ninterface = modbus\nmodbus = /dev/ttyS0\n" \
	"peak_a = register 1 scale 0.1\n"
#define COUNTING	"told_opens = input 40 bits 32\n" \
	"told_sparks = input 42 bits 32\ntold_shorts = input 44 bits 32\n"
#define DAC	"[machine]\nbackend = null\n[generator]\ninterface = lines\n"

static const struct refusal refusals[] = {
	/* Names. */
	{ "[gap]\nservo_volt = 15\n", 2, 1,
	  "unknown key gap.servo_volt", "did you mean servo_v? one of source" },
	{ "[gap]\nqqqqqqqqqqqqqqqqqqqqqqq = 15\n", 2, 1,
	  "unknown key gap.qqq", "one of source, servo_v, " },
	{ "\n[gapp]\nservo_v = 15\n", 2, 2,
	  "unknown section [gapp]", "did you mean gap? one of machine" },
	{ "[axis.W]\n", 1, 2,
	  "unknown section [axis.W]", "axis.X to axis.V" },
	{ "[AXIS.Z]\n", 1, 2, "[AXIS.Z]", "did you mean axis.Z?" },
	{ "\n\nname = x\n", 3, 1, "a key before any section", "[section]" },
	{ "[dds]\nhz = 5\n\n[dds]\n  hz = 6\n", 5, 3,
	  "dds.hz again, first in line 2", "each key once" },
	{ "[axis.X]\nv_max_mm_s = 1\n[axis.X]\nv_max_mm_s = 1\n", 4, 1,
	  "axis.X.v_max_mm_s again, first in line 2", "each key once" },
	{ "[gap]\n= 4\n", 2, 1, "unknown key gap.", "one of source" },
	/* Syntax. */
	{ "[gap\n", 1, 1, "a section without its ]", "[section]" },
	{ "[gap] servo_v = 20\n", 1, 1, "text behind a section",
	  "from the next line" },
	{ "[gap]\nservo_v\n", 2, 1, "neither a key nor a section",
	  "key = value" },
	/* Kinds. */
	{ "[gap]\nservo_v =  fifteen\n", 2, 12,
	  "gap.servo_v 'fifteen' is not a number",
	  "number from 0.1 to 500 V" },
	{ "[gap]\nservo_v = \n", 2, 11, "'' is not a number", "to 500 V" },
	{ "[gap]\nservo_v = nan\n", 2, 11, "is not a number", "500 V" },
	{ "[gap]\nservo_v = inf\n", 2, 11, "is not a number", "500 V" },
	{ "[gap]\nservo_v = 0x10\n", 2, 11, "is not a number", "500 V" },
	{ "[gap]\nservo_v = 15 V\n", 2, 11, "is not a number", "500 V" },
	{ "[gap]\nservo_v = 1e\n", 2, 11, "is not a number", "500 V" },
	{ "[gap]\nservo_v = 1e999\n", 2, 11, "is too large", "500 V" },
	{ "[gap]\nservo_v = -1e999\n", 2, 11, "is too small", "500 V" },
	{ "[machine]\npriority = 1.5\n", 2, 12,
	  "is not a whole number", "whole number from 1 to 99" },
	{ "[machine]\npriority = 100\n", 2, 12, "is too large", "to 99" },
	{ "[machine]\nbackend = simulator\n", 2, 11,
	  "machine.backend 'simulator' is not known", "one of sim, null" },
	{ "[machine]\nstrategy = zigzag\n", 2, 12, "is not known",
	  "one of simultaneous, point-by-point" },
	{ "[axis.U]\npresent = 1\n", 2, 11, "is neither yes nor no",
	  "yes or no" },
	{ "[machine]\nname = a/b\n", 2, 8, "does not go into a file's name",
	  "1 to 31 letters, digits, - and _" },
	{ "[machine]\nname = \n", 2, 8, "is empty", "1 to 31" },
	{ "[machine]\nname = abcdefghijklmnopqrstuvwxyz012345\n", 2, 8,
	  "is too long", "1 to 31" },
	{ "[jobs]\nstore = /a\001b\n", 2, 9, "has a control character",
	  "text of 1 to 255 bytes" },
	/* Units of rotary axes. */
	{ "[axis.C]\nv_max_mm_s = -1\n", 2, 14, "is too small", "deg/s" },
	/* Between keys. */
	{ "[axis.Z]\ntravel_min_mm = 5\ntravel_max_mm = 5\n", 3, 0,
	  "axis.Z.travel_min_mm 5 mm is not below travel_max_mm 5 mm",
	  "travel_min_mm below travel_max_mm" },
	{ "[axis.A]\n\nstart_mm = 1000000.5\n", 3, 0,
	  "axis.A.start_mm 1000000.5 deg is not at most travel_max_mm",
	  "start_mm at most travel_max_mm" },
	{ "[axis.Y]\nstart_mm = -200.5\n", 2, 0,
	  "axis.Y.travel_min_mm -200 mm is not at most start_mm -200.5 mm",
	  "travel_min_mm at most start_mm" },
	{ "[axis.X]\ntravel_max_mm = 200\npulse_mm = 1e-7\n", 3, 12,
	  "is too small", "number from 1e-06 to 1 mm" },
	{ "[axis.X]\ntravel_max_mm = 2000\npulse_mm = 1e-6\n", 3, 0,
	  "axis.X.travel_max_mm 2000 mm is 2000000000 pulses",
	  "at most 1073741824 pulses either way: 1073.74 mm" },
	{ "[axis.X]\ntravel_min_mm = -1073742\n", 2, 0,
	  "travel_min_mm -1073742 mm is -1073742000 pulses", "1.07374e+06" },
	{ "[wire]\nz_upper_mm = -20\n", 2, 0,
	  "wire.z_lower_mm -20 mm is not below z_upper_mm -20 mm",
	  "z_lower_mm below z_upper_mm" },
	{ "[axis.V]\npresent = no\n[wire]\nguides = absolute\n", 4, 0,
	  "wire.guides without an axis V", "X Y U V present" },
	{ "[gap]\nshort_v = 25\n", 2, 0, "gap.short_v 25 V is not below",
	  "short_v below servo_v" },
	{ "[gap]\nopen_v = 15\n", 2, 0, "gap.servo_v 25 V is not below",
	  "servo_v below open_v" },
	{ "[gap]\nservo_v = 20\nwindow_high_v = 30\nwindow_low_v = 31\n", 4, 0,
	  "gap.window_low_v 31 V is not at most window_high_v 30 V",
	  "window_low_v at most window_high_v" },
	{ "[gap]\nwindow_low_v = 7.5\n", 2, 0,
	  "gap.short_v 8 V is not below window_low_v 7.5 V",
	  "short_v below window_low_v" },
	{ "[gap]\nwindow_low_v = 26\n", 2, 0,
	  "gap.window_low_v 26 V is not at most servo_v 25 V",
	  "window_low_v at most servo_v" },
	{ "[gap]\nwindow_high_v = 14\n", 2, 0,
	  "gap.servo_v 25 V is not at most window_high_v 14 V",
	  "servo_v at most window_high_v" },
	{ "[gap]\nwindow_high_v = 61\n", 2, 0,
	  "gap.window_high_v 61 V is not below open_v 60 V",
	  "window_high_v below open_v" },
	{ "[gap]\nignition_v = 60\n", 2, 0,
	  "gap.open_v 60 V is not below ignition_v 60 V",
	  "open_v below ignition_v" },
	{ "[gap]\nsource = guess\n", 2, 10, "gap.source 'guess'",
	  "sim, voltage, shares, lines, can" },
	{ "[gap]\nretract_to = home\n", 2, 14, "'home'",
	  "limit, start, motion" },
	{ "[jump]\nheight_mm = 401\n", 2, 0,
	  "jump.height_mm 401 mm is higher than any axis travels",
	  "at most 400 mm, the travel of axis.X" },
	{ "[jump]\nadaptive = yes\nheight_max_mm = 450\n", 3, 0,
	  "jump.height_max_mm 450 mm", "at most 400 mm" },
	{ "[jump]\nheight_min_mm = 6\n", 2, 0,
	  "jump.height_min_mm 6 mm is not at most height_max_mm 5 mm",
	  "height_min_mm at most height_max_mm" },
	{ "[jump]\nevery_max_s = 0.4\n", 2, 0,
	  "jump.every_min_s 0.5 s is not at most every_max_s 0.4 s",
	  "every_min_s at most every_max_s" },
	{ "[sim]\nspark_v = 100\nopen_v = 90\n", 3, 0, "sim.spark_v 100 V",
	  "spark_v below open_v" },
	{ "[sim]\nshort_gap_mm = 0.02\n", 2, 0, "sim.short_gap_mm 0.02 mm",
	  "short_gap_mm below best_gap_mm" },
	{ "[sim]\nbest_gap_mm = 0.07\n", 2, 0, "sim.best_gap_mm 0.07 mm",
	  "best_gap_mm below open_gap_mm" },
	{ "[sim]\narea_mm2 = 100\nperimeter_mm = 30\n", 3, 0,
	  "sim.perimeter_mm 30 mm is too short for area_mm2 100 mm2",
	  "more than its 35.45 mm" },
	{ "[sim]\non_us = 1500\noff_us = 1000\n", 3, 0,
	  "sim.wait_us 500 us is short for on_us 1500 us", "625 us, or more" },
	{ "[sim]\nopen_v = 30\niso = no\n", 2, 0,
	  "gap.servo_v 25 V is not below the simulated gap's 8.571 V",
	  "a shorter [sim] off_us 20 us" },
	{ "[machine]\nbackend = can402\n", 2, 0,
	  "backend can402 without a drive", "node_X" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\nnode_Z = 5\n",
	  5, 0, "can402.node_Z 5 a second time", "a node of its own" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_Z = 5\n", 2, 0,
	  "axis.Z.brake: not told", "free: it stays where it is" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_Z = 5\n[axis.Z]\n"
	  "brake = line\n", 6, 0, "axis.Z.brake = line and gpio.brake_Z is none",
	  "gpio.brake_Z = the number of a line" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_Z = 5\n[axis.Z]\n"
	  "brake = drive\n[gpio]\nbrake_Z = 7\n", 8, 0, "gpio.brake_Z of an axis "
	  "that does not have [axis.Z] brake = line", "or none" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[gpio]\n"
	  "estop = 7\n", 6, 0, "gpio.estop with backend can402",
	  "[generator] spark = line ..., watchdog_by and" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[gpio]\n"
	  "encoder_X = 1 2\n", 6, 0, "gpio.encoder_X with backend can402",
	  "chip, brake_X" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\nnode_Y = 6\n"
	  "[axis.X]\nbrake = line\n[axis.Y]\nbrake = line\n[gpio]\n"
	  "brake_X = 3\nbrake_Y = 3\n", 12, 0, "are both line 3",
	  "a line of its own" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n"
	  "following_mm = 0.2\n", 5, 0, "can402.following_mm 0.2 with resync_mm "
	  "0.2", "following_mm below resync_mm" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[axis.X]\n"
	  "drive_sdo = 605e:0=2/2 6065:0=100/1\n", 6, 0,
	  "axis.X.drive_sdo: \"6065:0=100/1\"", "INDEX:SUB=VALUE/BYTES" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[axis.X]\n"
	  "drive_leave = 1006 sixty\n", 6, 0, "axis.X.drive_leave: \"sixty\"",
	  "hexadecimal indexes" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[axis.X]\n"
	  "drive_identity = fb x -1\n", 6, 0, "axis.X.drive_identity: \"-1\"",
	  "vendor, product, revision, serial" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 9\n"
	  "master_node = 9\n", 4, 0, "can402.node_X 9 a second time",
	  "not master_node" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_B = 5\n[axis.B]\n"
	  "present = no\n", 4, 0, "for an axis that is not present",
	  "that is present" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n"
	  "gap_id = 389\n", 5, 0, "can402.gap_id 389, which is in use",
	  "384 to 1407" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[axis.Z]\n"
	  "brake = free\n[generator]\ninterface = can\ncan_id = 1500\n", 9, 0,
	  "generator.can_id 1500", "384 to 1407" },
	{ "[generator]\ninterface = can\n", 2, 0,
	  "generator.interface and machine.backend do not agree",
	  "sim with backend sim" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "peak_a = lines 20 21 weights 3\n", 5, 0,
	  "has fewer weights than lines", "lines 20 21 26 weights 3 6 12" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "on_us = lines 20 21 codes 2 4 8 16 32\n", 5, 0,
	  "has more codes than its lines or bits make", "codes 60 80 120 180" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "on_us = lines 20 21\n", 5, 0, "has neither weights nor codes", "" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "peak_a = lines 20 21 weights 600 900\n", 5, 0,
	  "makes a value out of the field's range", "" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "peak_a = lines 20 21 weights 3 6\npump = line 21\n", 6, 0,
	  "generator.pump and generator.peak_a are both line 21",
	  "a line of its own" },
	{ "[machine]\nbackend = null\n[gpio]\nspark = 7\n[generator]\n"
	  "interface = lines\npump = line 7\n", 7, 0,
	  "generator.pump and gpio.spark are both line 7",
	  "a line of its own" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "spark = line 7\n", 5, 0,
	  "generator.spark is a line and there is no gpio.watchdog",
	  "gpio.watchdog_by" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "peak_a = can 100 byte 2 bits 16\non_us = can 100 byte 3\n", 6, 0,
	  "generator.on_us and generator.peak_a have bits of frame 100",
	  "a place of its own" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "can_id = 100\niso = can 100 byte 1 bit 3\n", 6, 0,
	  "generator.iso is in byte 1 of frame 100", "another byte" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "peak_a = can 100 byte 7 bits 16\n", 5, 0,
	  "goes beyond the eighth byte", "as can 1013 byte 0" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = can 100 byte 0\n", 6, 0,
	  "is a frame, and the interface is not can", "as register 10" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "peak_a = register 10\n", 5, 0,
	  "is a register, and the interface is not modbus", "as can 1013 byte 0" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 10 bits 10\n"
	  "on_us = register 10 bit 9\n", 7, 0,
	  "generator.on_us and generator.peak_a have bits of register 10",
	  "a place of its own" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 65536\n", 6, 0,
	  "has no address of 0 to 65535", "as register 10" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1 bit 9 bits 8\n", 6,
	  0, "goes beyond the sixteenth bit", "" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1 scale 2000\n", 6, 0,
	  "cannot hold a value of the field", "" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1 byte 0\n", 6, 0,
	  "none of bit 0 to 15", "" },
	{ MODBUS "modbus = /dev/ttyS0\non_us = register 1 bits 1 codes 2 4 8\n",
	  6, 0, "has more codes than its lines or bits make", "" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "can_interface = can3\n", 7, 0,
	  "generator.can_interface with interface modbus, which does not use "
	  "it", "without it, or interface = can" },
	{ MODBUS "modbus = 10.0.0.7:502\npeak_a = register 1\n"
	  "modbus_baud = 9600\n", 7, 0,
	  "generator.modbus_baud with 10.0.0.7:502, which does not use it",
	  "modbus = a serial port" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "can_id = 1009\nmodbus_unit = 7\n", 6, 0,
	  "generator.modbus_unit with interface can", "interface = modbus" },
	{ "[machine]\nbackend = null\n[generator]\nsilent_ms = 100\n", 4, 0,
	  "generator.silent_ms with interface none",
	  "interface = can, modbus or plc" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1 within 0.1\n", 6,
	  0, "has within, which is of a number that is told", "" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_peak_a = input 1 within 0\n", 7, 0,
	  "within of what is told", "" },
	{ MODBUS "modbus = /dev/ttyS0\npolarity = register 1 bits 2\n", 6, 0,
	  "is of a field that is on or off", "as register 14 bit 0" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = input 1\n", 6, 0,
	  "is an input register, which nobody can write", "as register 10" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "spark = register 2 bit 0\n", 7, 0,
	  "take a round trip: it must be a line", "as line 20" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "sense = register 2 bit 0\n", 7, 0, "take a round trip", "" },
	{ MODBUS "peak_a = register 1\n", 0, 0,
	  "generator.modbus \"none\" is no device", "/dev/ttyUSB0" },
	{ MODBUS "modbus = generator:502\npeak_a = register 1\n", 5, 0,
	  "has no address in numbers", "192.168.1.5:502" },
	{ MODBUS "modbus = 10.0.0.1:0x2\npeak_a = register 1\n", 5, 0,
	  "has no port of 1 to 65535", "[fd00::5]:502" },
	{ MODBUS "modbus = /dev/ttyS0\nmodbus_unit = 0\npeak_a = register 1\n",
	  6, 0, "generator.modbus_unit 0", "1 to 247" },
	{ MODBUS "modbus = /dev/ttyS0\nmodbus_baud = 12345\n"
	  "peak_a = register 1\n", 6, 0, "generator.modbus_baud 12345",
	  "9600 19200 38400" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1 scale 1 scale 2\n",
	  6, 0, "has a word twice", "as register 10" },
	{ MODBUS "modbus = /dev/ttyS0\npolarity = register 1 bit 0\n"
	  "told_polarity = input 1 bit 0 scale 4\n", 7, 0,
	  "has a scale, and is of a field that is on or off",
	  "as register 14 bit 0" },
	{ MODBUS "modbus = /dev/ttyS0\nsilent_ms = 149\npeak_a = register 1\n",
	  6, 0, "generator.silent_ms 149", "at least 150" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_opens = input 40 bits 32\ntold_arcs = input 41\n", 8, 0,
	  "generator.told_arcs and generator.told_opens have bits of register "
	  "41", "a place of its own" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1 bits 32\n", 6, 0,
	  "has a word that is none of", "as register 10" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_opens = input 65535 bits 32\n", 7, 0,
	  "goes beyond the last register", "as register 10" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_opens = input 40 first low\n", 7, 0,
	  "has an order, and one register", "as register 10" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_fault = input 40 codes 1 2\n", 7, 0,
	  "has codes and is a sum or a number", "as register 10" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_fault = input 40\nfault_words = 1 no water, too warm\n", 8, 0,
	  "generator.fault_words \"1 no water, too warm\" has words without a "
	  "number", "1 no water, 2 too warm" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "fault_words = 1\n", 7, 0, "has a number without words",
	  "1 no water, 2 too warm" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_fault = input 40\n"
	  "fault_words = 1 no water, 2 too warm, 1 no oil\n", 8, 0,
	  "generator.fault_words \"1 no water, 2 too warm, 1 no oil\" has a "
	  "number twice", "1 no water, 2 too warm" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_fault = input 40 bits 8\nfault_words = 256 no water\n", 8, 0,
	  "has a number that generator.told_fault does not tell",
	  "1 no water, 2 too warm" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "told_fault = input 40\nfault_words = 65536 no water\n", 8, 0,
	  "has words without a number of 1 to 65535", "1 no water" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 1\n"
	  "fault_words = 1 no water\n", 7, 0,
	  "has a number that generator.told_fault does not tell",
	  "1 no water" },
	{ MODBUS "modbus = /dev/ttyS0\n", 4, 0, "it reaches no field",
	  "peak_a = register N" },
	{ LINES_MACHINE "[generator]\ninterface = modbus\nmodbus = /dev/ttyS0\n"
	  "peak_a = register 1\n", 0, 0, "generator.spark reaches nothing",
	  "[gpio] spark" },
	{ "[plc]\nm_before = 6\nm_redo = 6\n", 3, 0, "plc.m_redo: M6",
	  "no way back leads over a change of the electrode" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = plc\n", 4, 0,
	  "interface is plc and there is no PLC", "[plc] interface = can1" },
	{ BY_PLC "[plc]\nnode = 96\n", 6, 0, "interface is plc and plc.node 96",
	  "a node of 1 to 95" },
	{ BY_PLC "sense = plc\n", 7, 0, "those take a round trip: it must be "
	  "a line", "as line 20" },
	/* Counts for the gap servo. */
	{ "[gap]\nsource = counts\n", 2, 0, "nothing feels the gap without "
	  "sparks", "backend sim source = shares" },
	{ BY_ADC COUNTING "[gap]\nsource = counts\nshare_stale_ms = 149\n",
	  43, 0, "gap.share_stale_ms 149 is less than two "
	  "generator.modbus_every_ms and a modbus_timeout_ms",
	  "at least 150" },
	{ BY_ADC "told_sparks = input 42 bits 32\n"
	  "told_shorts = input 44 bits 32\n[gap]\nsource = counts\n"
	  "share_stale_ms = 150\n", 41, 0,
	  "gap.source is counts and generator.told_opens is none",
	  "told_sparks and told_shorts" },
	{ BY_ADC "told_opens = input 40 bits 32\ntold_sparks = input 42\n"
	  "told_shorts = input 44 bits 32\n[gap]\nsource = counts\n"
	  "share_stale_ms = 150\n", 39, 0,
	  "generator.told_sparks has bits 16", "bits 32 at least" },
	{ ADC_MACHINE "spark = 9\nwatchdog_by = its own\nestop_by = its "
	  "own\n[plc]\ninterface = can1\n[generator]\ninterface = plc\n"
	  "[gap]\nsource = counts\n", 39, 0,
	  "gap.source is counts and generator.told_opens is none",
	  "of a generator on can or modbus" },
	{ "[machine]\nbackend = can402\nperiod_us = 1000\n[axis.Y]\n"
	  "present = no\n[axis.Z]\npresent = no\n[axis.A]\npresent = no\n[axis.B]\n"
	  "present = no\n[axis.C]\npresent = no\n[axis.U]\npresent = no\n"
	  "[axis.V]\npresent = no\n[can402]\nnode_X = 5\ngap_id = 1008\n"
	  "[generator]\ninterface = can\ncan_id = 1009\n"
	  "told_opens = can 1012 byte 0 bits 32\n"
	  "told_sparks = can 1012 byte 4 bits 32\n"
	  "told_shorts = can 1013 byte 0 bits 32\n[gap]\nsource = counts\n"
	  "share_stale_ms = 3\n", 29, 0,
	  "gap.share_stale_ms 3 is less than four periods", "at least 4" },
	/* Converters. */
	{ DAC "peak_a = dac\n", 5, 0, "has no device", "as dac iio:device0" },
	{ DAC "peak_a = dac iio:device0 voltage to 10\n", 5, 0,
	  "has no channel voltageN or currentN", "as dac iio:device0" },
	{ DAC "peak_a = dac iio:device0 voltage0 scale 2\n", 5, 0,
	  "no highest output: to N", "to 10" },
	{ DAC "peak_a = dac iio:device0 voltage0 zero 4 to 4\n", 5, 0,
	  "no highest output", "as dac iio:device0" },
	{ DAC "peak_a = dac iio:device0 voltage0 scale 0 to 10\n", 5, 0,
	  "has no scale above 0", "as dac iio:device0" },
	{ DAC "peak_a = dac iio:device0 voltage0 to 10 scale\n", 5, 0,
	  "none of scale, zero, to", "as dac iio:device0" },
	{ DAC "ignition_v = dac iio:device0 voltage0 scale 0.1 to 10\n", 5, 0,
	  "cannot hold a value of the field", "as dac iio:device0" },
	{ DAC "polarity = dac iio:device0 voltage0 to 10\n", 5, 0,
	  "is of a field that is on or off", "auto, none, as line 20" },
	{ DAC "told_peak_a = dac iio:device0 voltage0 to 10\n", 5, 0,
	  "is told by a converter's output", "none" },
	/* It would spark as it likes. */
	{ ADC_MACHINE "[gap]\nsource = voltage\n"
	  "[generator]\ninterface = can\n"
	  "peak_a = can 1010 byte 0 scale 0.1\n", 0, 0,
	  "generator.spark reaches nothing", "can ID byte N bit N, or line N" },
	{ DAC "peak_a = dac ad5624r voltage0 to 10\n"
	  "ignition_v = dac ad5624r voltage0 scale 30 to 10\n", 6, 0,
	  "generator.ignition_v and generator.peak_a are both ad5624r voltage0",
	  "a channel of its own" },
	{ BY_PLC "told_sparks = plc\n", 7, 0, "is a sum, and the PLC has no "
	  "signal for it", "auto, none" },
	{ BY_PLC "on_us = plc scale 0.1\n", 7, 0, "has a word after plc",
	  "as plc" },
	{ BY_PLC "on_us = register 4\n", 7, 0, "the interface is not modbus",
	  "as plc" },
	{ BY_PLC "peak_a = none\non_us = none\noff_us = none\n"
	  "ignition_v = none\npolarity = none\niso = none\npump = none\n", 6,
	  0, "interface is plc and it reaches no field", "peak_a = plc" },
	{ LINES_MACHINE "[plc]\ninterface = can1\n[generator]\n"
	  "interface = plc\n", 0, 0, "generator.spark reaches nothing",
	  "[gpio] spark" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "peak_a = plc\n", 5, 0, "is by the PLC, and the interface is not plc",
	  "lines 20 21 26" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "off_us = lines 5 6 codes 2 4 8 16\nby_hand = on_us off_us\n", 6, 0,
	  "generator.by_hand has off_us, which reaches the generator",
	  "one of the two" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 10 scale 0.1\n"
	  "told_peak_a = none\non_us = register 11\n"
	  "told_on_us = register 10\n", 9, 0,
	  "generator.told_on_us is in register 10, and there edmd writes "
	  "generator.peak_a", "where the generator tells it" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "can_id = 100\ntold_iso = can 100 byte 0 bit 7\n", 6, 0,
	  "generator.told_iso is in frame 100, and there edmd sends",
	  "where the generator tells it" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "on_us = lines 5 6 codes 0 0 0 0\n", 5, 0,
	  "makes no value but 0, which is none", "codes 60 80 120 180" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = lines\n"
	  "peak_a = lines 5 6 weights 1 0x2\n", 5, 0,
	  "has a weight that is not above 0", "weights 3 6 12" },
	{ "[machine]\nbackend = null\n[generator]\nby_hand = none on_us\n",
	  4, 0, "generator.by_hand has \"none\"", "peak_a on_us off_us" },
	/* The machine file's own, for a condition that gives none. */
	{ ADC_MACHINE "[gap]\nsource = voltage\nservo_v = 45\n"
	  "[generator]\ninterface = can\ncan_id = 500\n"
	  "servo_v = can 501 byte 0 bits 8 scale 0.1\n", 33, 0,
	  "gap.servo_v 45 V does not reach the generator",
	  "0.1 to 25.4 V; or another [generator] servo_v" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "can_id = 100\nservo_v = can 100 byte 7\n", 6, 0,
	  "\"can 100 byte 7\" goes beyond the eighth byte",
	  "as can 1013 byte 0" },
	{ "[machine]\nbackend = null\n[generator]\ninterface = can\n"
	  "can_id = 100\nservo_v = can 100 byte 5\n", 6, 0,
	  "have bits of frame 100 in common", "a place of its own" },
	{ MODBUS "modbus = 127.0.0.1:502\nmodbus_unit = 248\n"
	  "peak_a = register 1\n", 6, 0,
	  "generator.modbus_unit 248 over TCP", "1 to 247, 0 or 255" },
	{ MODBUS "modbus = /dev/ttyS0\npeak_a = register 10 codes 1 2 3\n"
	  "told_peak_a = input 3 codes 5 6 7\n", 7, 0,
	  "generator.told_peak_a tells no value that generator.peak_a can",
	  "the same values" },
	{ "[machine]\nbackend = null\n[plc]\ninterface = can0\nnode = 32\n"
	  "[generator]\ninterface = can\ncan_id = 416\n", 8, 0,
	  "generator.can_id 416, which is between edmd and the PLC",
	  "rest by 128 is not plc.node 32" },
	{ "[machine]\nbackend = null\n[generator]\n"
	  "by_hand = on_us off_us on_us\n", 4, 0,
	  "generator.by_hand has \"on_us\"", "each once" },
	{ "[machine]\nbackend = null\n[generator]\nby_hand = on_us amps\n", 4,
	  0, "generator.by_hand has \"amps\"", "peak_a on_us off_us" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[axis.X]\n"
	  "drive_increments = 0\n", 6, 0, "axis.X.drive_increments 0",
	  "not 0" },
	{ "[machine]\nbackend = can402\n[can402]\nnode_X = 5\n[axis.X]\n"
	  "drive_increments = 1000000\n", 6, 0,
	  "its travel reaches to 200000000000", "within 2147483647" },
	{ "[machine]\nperiod_us = 0.5\n", 2, 0,
	  "machine.period_us 0.5 us is too short", "20 us and more" },
	{ "[axis.X]\npresent=no\n[axis.Y]\npresent=no\n[axis.Z]\npresent=no\n"
	  "[axis.A]\npresent=no\n[axis.B]\npresent=no\n[axis.C]\npresent=no\n"
	  "[axis.U]\npresent=no\n[axis.V]\npresent=no\n", 16, 0,
	  "no axis is present", "at least one" },
};

static void a_refusal_says_where_what_and_what_is_accepted(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	for (size_t i = 0; i < COUNT(refusals); i++) {
		const struct refusal *r = &refusals[i];

		assert_int_equal(read_text(r->text, &c, &d), -EINVAL);
		if (d.line != r->line || d.column != r->column ||
		    !strstr(d.found, r->found) || !strstr(d.wanted, r->wanted))
			fail_msg("%s\ngave %u:%u: %s; %s", r->text, d.line,
				 d.column, d.found, d.wanted);
	}
}

/* It may be refused for what it stands beside, but not for itself. */
static int takes_what_is_offered(const char *base, const char *key)
{
	char text[400], offered[240], *from = offered, *at;
	struct machine_config c;
	struct interp_diag d;
	int n = 0;

	snprintf(text, sizeof(text), "%s%s = rubbish\n", base, key);
	assert_int_equal(read_text(text, &c, &d), -EINVAL);
	snprintf(offered, sizeof(offered), "%s", d.wanted);
	while ((at = strstr(from, ", as "))) {
		const size_t len = strcspn(at + 5, ",;");

		snprintf(text, sizeof(text), "%s%s = %.*s\n", base, key,
			 (int)len, at + 5);
		from = at + 5;
		n++;
		if (read_text(text, &c, &d) && strchr(d.found, '"'))
			fail_msg("%s\ngave %s; %s", text, d.found, d.wanted);
	}
	return n;
}

static void each_way_that_is_offered_is_taken(void **state)
{
	static const char *const base[] = {
		DAC, MODBUS "modbus = /dev/ttyS0\n", BY_PLC,
		"[machine]\nbackend = null\n[generator]\ninterface = can\n",
	};

	(void)state;
	for (size_t k = 0; k < COUNT(base); k++) {
		for (int i = 0; i < PROCESS_NFIELDS; i++)
			assert_true(takes_what_is_offered(base[k],
							  process_name(i)));
		takes_what_is_offered(base[k], "told_peak_a");
		takes_what_is_offered(base[k], "told_iso");
		takes_what_is_offered(base[k], "told_arcs");
	}
}

static void every_number_is_refused_outside_its_range(void **state)
{
	struct machine_config c;
	struct interp_diag d;
	char num[40];

	(void)state;
	config_defaults(&c);
	for (int i = 0; config_key(i); i++) {
		const struct config_key *k = config_key(i);

		if (k->kind != KEY_NUMBER && k->kind != KEY_WHOLE &&
		    k->kind != KEY_COUNT)
			continue;
		config_number(nextafter(k->min, -1e300), num, sizeof(num));
		assert_int_equal(config_key_parse(k, 0, num, &c, &d), -EINVAL);
		config_number(nextafter(k->max, 1e300), num, sizeof(num));
		assert_int_equal(config_key_parse(k, 0, num, &c, &d), -EINVAL);
	}
}

static void every_misspelt_key_is_met_with_the_right_one(void **state)
{
	struct machine_config c;
	struct interp_diag d;
	char text[128], section[32], meant[64];

	(void)state;
	for (int i = 0; config_key(i); i++) {
		const struct config_key *k = config_key(i);

		if (strlen(k->name) < 4)
			continue;
		config_section_name(k->section, 0, section, sizeof(section));
		/* Not at its end: there stands an axis, for some. */
		snprintf(text, sizeof(text), "[%s]\n%c%s = 1\n", section,
			 k->name[0], k->name);
		snprintf(meant, sizeof(meant), "did you mean %s?", k->name);
		assert_int_equal(read_text(text, &c, &d), -EINVAL);
		assert_non_null(strstr(d.wanted, meant));
	}
}

static void a_nul_byte_or_an_endless_line_is_refused(void **state)
{
	static const char nul[] = "[gap]\nservo_v = 1\0" "5\n";
	struct machine_config c;
	struct interp_diag d;
	char text[3000];

	(void)state;
	assert_int_equal(read_bytes(nul, sizeof(nul) - 1, &c, &d), -EINVAL);
	assert_int_equal(d.line, 2);
	assert_string_equal(d.found, "a NUL byte");

	memset(text, 'x', sizeof(text));
	memcpy(text, "[gap]\n", 6);
	assert_int_equal(read_bytes(text, sizeof(text), &c, &d), -EINVAL);
	assert_int_equal(d.line, 2);
	assert_string_equal(d.found, "a line too long");
}

static void lines_may_end_in_cr_alone(void **state)
{
	static const char *const end[] = { "\n", "\r\n", "\r" };
	struct machine_config c;
	struct interp_diag d;
	char text[120];

	(void)state;
	for (size_t i = 0; i < sizeof(end) / sizeof(end[0]); i++) {
		const int n = snprintf(text, sizeof(text),
				       "; a comment%s[gap]%s%sservo_v = 20%s"
				       "nonsense%s", end[i], end[i], end[i],
				       end[i], end[i]);

		assert_int_equal(read_bytes(text, (size_t)n, &c, &d), -EINVAL);
		assert_int_equal(d.line, 5);
		*strstr(text, "nonsense") = ';';
		assert_int_equal(read_bytes(text, (size_t)n, &c, &d), 0);
		assert_true(c.gap.servo_v == 20);
	}
}

static void a_refused_file_leaves_the_machine_alone(void **state)
{
	struct machine_config c, before;
	struct interp_diag d;

	(void)state;
	memset(&c, 0x5a, sizeof(c));
	before = c;
	assert_int_equal(read_text("[gap]\nservo_v = 20\nx = 1\n", &c, &d),
			 -EINVAL);
	assert_memory_equal(&c, &before, sizeof(c));
}

static void a_missing_file_is_told_from_a_bad_one(void **state)
{
	struct machine_config c;
	struct interp_diag d;

	(void)state;
	assert_int_equal(config_read(&c, "/nonexistent/machine.ini", &d),
			 -ENOENT);
	assert_int_equal(config_read(&c, "/", &d), -EISDIR);
}

/* Bytes flipped, dropped and doubled anywhere in a good file. */
static size_t damage(char *text, size_t n, size_t room)
{
	int hits = 1 + rand() % 4;

	while (hits-- && n > 1) {
		size_t at = (size_t)rand() % n;
		size_t run = 1 + (size_t)rand() % 40;

		if (run > n - at)
			run = n - at;
		switch (rand() % 3) {
		case 0:
			text[at] = (char)rand();
			break;
		case 1:
			memmove(text + at, text + at + run, n - at - run);
			n -= run;
			break;
		case 2:
			if (n + run > room)
				break;
			memmove(text + at + run, text + at, n - at);
			n += run;
			break;
		}
	}
	return n;
}

static void a_damaged_file_is_read_or_refused_with_its_line(void **state)
{
	struct machine_config c;
	struct interp_diag d;
	char *whole, text[131072];
	const int rounds = SEED_ROUNDS(2000);
	int refused = 0;

	(void)state;
	srand((unsigned)seed_take());
	config_defaults(&c);
	whole = print_text(&c);
	for (int i = 0; i < rounds; i++) {
		size_t n = strlen(whole);
		int err;

		assert_true(n < sizeof(text));
		memcpy(text, whole, n);
		n = damage(text, n, sizeof(text));
		err = read_bytes(text, n, &c, &d);
		if (!err)
			continue;
		refused++;
		assert_int_equal(err, -EINVAL);
		assert_true(d.line > 0 && d.found[0] && d.wanted[0]);
	}
	free(whole);
	assert_true(refused > rounds / 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_refusal_says_where_what_and_what_is_accepted),
		cmocka_unit_test(each_way_that_is_offered_is_taken),
		cmocka_unit_test(every_number_is_refused_outside_its_range),
		cmocka_unit_test(every_misspelt_key_is_met_with_the_right_one),
		cmocka_unit_test(a_nul_byte_or_an_endless_line_is_refused),
		cmocka_unit_test(lines_may_end_in_cr_alone),
		cmocka_unit_test(a_refused_file_leaves_the_machine_alone),
		cmocka_unit_test(a_missing_file_is_told_from_a_bad_one),
		cmocka_unit_test(a_damaged_file_is_read_or_refused_with_its_line),
	};

	return cmocka_run_group_tests_name("config", tests, make_file,
					   remove_file);
}
