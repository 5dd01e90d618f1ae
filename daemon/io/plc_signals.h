/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_signals.h - the one table of what crosses between edmd and a PLC
 *
 * The SDO server and the frames (plc_table.c) are made of these rows, and so
 * are messages/edmd.eds, messages/edmd.dbc and docs/plc-signals.md: the script
 * messages/plc-files reads this file through the preprocessor.  After a change
 * run `make plc-files`.
 *
 * Threads: any; the tables are constant.
 */
#ifndef IO_PLC_SIGNALS_H
#define IO_PLC_SIGNALS_H

#include <stdint.h>

/* clang-format off */

/*
 * S(index, sub, type, by, field, pdo, byte, min, max, name, unit, scale, help)
 *
 * An object of the dictionary that carries a signal.  @by: TELL, edmd sends it;
 * ASK, the PLC does.  @field: its member of struct plc_tell or plc_ask.  @pdo:
 * the TPDO or RPDO that carries it, from @byte on; 0: none has room for it, it
 * is read by SDO.  @min and @max are counts; one count is @scale of @unit.
 */
#define PLC_SIGNAL_ROWS(S) \
S(0x2000, 1, U8, TELL, state, 1, 0, 0, 255, "State", "", 1, "what edmd does") \
S(0x2000, 2, U8, TELL, flags, 1, 1, 0, 255, "Flags", "", 1, "bits") \
S(0x2000, 3, U8, TELL, fault, 1, 2, 0, 255, "Fault", "", 1, \
  "the first fault that is latched") \
S(0x2000, 4, U8, TELL, mcode, 1, 3, 0, 255, "McodeWaiting", "", 1, \
  "M code that the PLC is to carry out; 0: none") \
S(0x2000, 5, U16, TELL, gap, 1, 4, 0, 65535, "GapVoltage", "V", 0.01, \
  "mean gap voltage") \
S(0x2000, 6, I16, TELL, feed, 1, 6, -32768, 32767, "Feed", "mm/s", 0.001, \
  "along the path; negative is backward") \
S(0x2000, 7, U32, TELL, job, 2, 0, 0, 4294967295, "Job", "", 1, \
  "number of the program; 0: none") \
S(0x2000, 8, U32, TELL, line, 2, 4, 0, 4294967295, "Line", "", 1, \
  "line of the source text") \
PLC_POSITION(S, 1, "X", 3, 0) \
PLC_POSITION(S, 2, "Y", 3, 4) \
PLC_POSITION(S, 3, "Z", 4, 0) \
PLC_POSITION(S, 4, "A", 0, 0) \
PLC_POSITION(S, 5, "B", 0, 0) \
PLC_POSITION(S, 6, "C", 4, 4) \
PLC_POSITION(S, 7, "U", 0, 0) \
PLC_POSITION(S, 8, "V", 0, 0) \
S(0x2000, 9, U8, TELL, stand, 0, 0, 0, 255, "Stand", "", 1, \
  "why the job stands, or what it waits for; 0: neither") \
S(0x2000, 10, U32, TELL, stand_of, 0, 0, 0, 4294967295, "StandOf", "", 1, \
  "what `Stand` is about: the number of the electrode to put in") \
S(0x2000, 11, U16, TELL, electrode, 5, 0, 0, 9999, "Electrode", "", 1, \
  "that is to be in the holder; in force with M6; 0: none") \
S(0x2000, 12, U16, TELL, condition, 5, 2, 0, 65535, "Condition", "", 1, \
  "number of the condition in force, as 120 of C120") \
S(0x2000, 13, U8, TELL, letter, 5, 4, 0, 90, "ConditionLetter", "", 1, \
  "its letter in ASCII, as 67 for C; 0: none was called") \
S(0x2000, 14, U16, TELL, pulse.number, 5, 5, 0, 65535, "Asked", "", 1, \
  "number of what the generator is asked for; 0: of nothing") \
S(0x2000, 15, U8, TELL, pulse.bits, 5, 7, 0, 255, "AskedBits", "", 1, "bits") \
PLC_PULSE_ROWS(PLC_ASKED, S) \
S(0x2100, 1, U8, ASK, command, 1, 0, 0, 255, "Command", "", 1, "bits") \
S(0x2100, 2, U8, ASK, locks, 1, 1, 0, 31, "Interlocks", "", 1, \
  "bits, each 1 while all is well") \
S(0x2100, 3, U16, ASK, override, 1, 2, 0, 2000, "FeedOverride", "%", 0.1, \
  "of positioning") \
S(0x2100, 4, U16, ASK, program, 1, 4, 0, 9999, "ProgramSelect", "", 1, \
  "job to be loaded next; 0: none") \
S(0x2100, 5, U8, ASK, mcode_done, 1, 6, 0, 255, "McodeDone", "", 1, \
  "M code that has been carried out; 0: none") \
S(0x2100, 6, U8, ASK, axes_c, 1, 7, 0, 255, "AxisTemperature", "degC", 0.25, \
  "of the axes, for [geometry] maps; 0: not told") \
S(0x2101, 1, U16, ASK, pulse.number, 2, 0, 0, 65535, "InForce", "", 1, \
  "`Asked`, once the generator has all of that") \
S(0x2101, 2, U16, ASK, pulse_fault, 2, 2, 0, 65535, "GeneratorFault", "", 1, \
  "number of its own fault; 0: none") \
S(0x2101, 3, U8, ASK, pulse.bits, 2, 4, 0, 255, "ToldBits", "", 1, "bits") \
PLC_PULSE_ROWS(PLC_TOLD, S)

#define PLC_POSITION(S, sub, axis, pdo, byte) \
S(0x2001, sub, I32, TELL, pos[(sub) - 1], pdo, byte, -2147483648, 2147483647, \
  "Position" axis, "pulses", 1, "target of axis " axis)

/*
 * P(S, id, i, tpdo, rpdo, byte, name, unit, scale, help): value @i of a
 * generator that the PLC sets, by enum interp_tech_id.
 */
#define PLC_PULSE_ROWS(P, S) \
P(S, PEAK_A, 0, 6, 3, 0, "Current", "A", 0.1, "peak current") \
P(S, ON_US, 1, 6, 3, 2, "OnTime", "us", 0.1, "on time") \
P(S, OFF_US, 2, 6, 3, 4, "OffTime", "us", 0.1, "off time") \
P(S, IGNITION_V, 3, 6, 3, 6, "Voltage", "V", 0.1, "open-circuit voltage") \
P(S, SERVO_V, 4, 0, 2, 5, "Servo", "V", 0.1, "reference of the gap servo")

#define PLC_NPULSES	5

#define PLC_ASKED(S, id, i, tpdo, rpdo, byte, name, unit, scale, help) \
S(0x2002, (i) + 1, U16, TELL, pulse.value[i], tpdo, byte, 0, 65535, \
  "Asked" name, unit, scale, help "; all bits set: its own setting")
#define PLC_TOLD(S, id, i, tpdo, rpdo, byte, name, unit, scale, help) \
S(0x2101, (i) + 4, U16, ASK, pulse.value[i], rpdo, byte, 0, 65535, \
  "Told" name, unit, scale, help " of the generator")

/* B(id, of, bit, name, help): bit @bit of the signal @of is PLC_@id in C. */
#define PLC_BIT_ROWS(B) \
B(TOGGLE,      "Flags", 0, "Toggle", "turns with every frame") \
B(SPARK,       "Flags", 1, "Spark", "edmd asks for spark power") \
B(RUNS,        "Flags", 2, "Runs", "a job is under way") \
B(HELD,        "Flags", 3, "Held", "the machine stands on the path") \
B(FAULTY,      "Flags", 4, "Faulty", "there is a fault; `Fault` tells which") \
B(PUMP,        "Flags", 5, "Pump", "edmd asks for dielectric") \
B(LOADED,      "Flags", 6, "Loaded", "a job is loaded or under way") \
B(NEGATIVE,    "Flags", 7, "Negative", "the electrode is to be negative") \
B(ASKED_NEGATIVE, "AskedBits", 0, "AskedNegative", \
  "the electrode is to be negative") \
B(ASKED_ISO,   "AskedBits", 1, "AskedIso", \
  "pulses are to be timed from their ignition") \
B(PERMIT,      "Command", 0, "Permit", "1: sparks and motion are allowed") \
B(START,       "Command", 1, "Start", "rising edge: start, or go on") \
B(HOLD,        "Command", 2, "Hold", "1: the machine is held") \
B(RESET,       "Command", 3, "Reset", "rising edge: from a fault to hold") \
B(DONE,        "Command", 4, "Done", \
  "rising edge: what the machine asks for is done; Start goes on") \
B(ALIVE,       "Command", 7, "Alive", "to be turned within each `alive_ms`") \
B(DOOR,        "Interlocks", 0, "DoorClosed", "1: the door is closed") \
B(LEVEL,       "Interlocks", 1, "LevelOk", "1: dielectric covers the work") \
B(TEMPERATURE, "Interlocks", 2, "TemperatureOk", \
  "1: the dielectric is neither too warm nor too cold") \
B(FIRE,        "Interlocks", 3, "NoFire", "1: there is no fire") \
B(WIRE,        "Interlocks", 4, "WireWhole", "1: the wire is whole") \
B(TOLD_NEGATIVE, "ToldBits", 0, "ToldNegative", "the electrode is negative") \
B(TOLD_ISO,    "ToldBits", 1, "ToldIso", \
  "pulses are timed from their ignition")

/* F(id, by, pdo, name): a frame, and the CAN id that its node is added to. */
#define PLC_FRAME_ROWS(F) \
F(0x180, TELL, 1, "EdmdStatus") \
F(0x280, TELL, 2, "EdmdJob") \
F(0x380, TELL, 3, "EdmdPositionXY") \
F(0x480, TELL, 4, "EdmdPositionZC") \
F(0x500, TELL, 5, "EdmdCondition") \
F(0x680, TELL, 6, "EdmdPulse") \
F(0x200, ASK,  1, "PlcRequest") \
F(0x300, ASK,  2, "PlcGenerator") \
F(0x400, ASK,  3, "PlcPulse")

/*
 * O(index, sub, type, value, live, name)
 *
 * The other objects that CiA 301 has.  @live says what becomes of @value:
 * FIXED, nothing; PLUS_NODE, the node is added; the others are read from
 * struct plc.  The PLC may write EMCY, BEAT and, with 0, ERRORS.  What a frame
 * carries (1600 ..., 1A00 ...) follows from the signals.  What stands before a
 * comma in the name of sub-index 0 is the name of the whole object.
 */
#define PLC_OBJECT_ROWS(O) \
O(0x1000, 0, U32, 0, FIXED, "Device type") \
O(0x1001, 0, U8, 0, REGISTER, "Error register") \
O(0x1003, 0, U8, 0, ERRORS, "Errors, number of them") \
PLC_ERROR_AT(O, 1) \
PLC_ERROR_AT(O, 2) \
PLC_ERROR_AT(O, 3) \
PLC_ERROR_AT(O, 4) \
PLC_ERROR_AT(O, 5) \
PLC_ERROR_AT(O, 6) \
PLC_ERROR_AT(O, 7) \
PLC_ERROR_AT(O, 8) \
/* "edmd", the first letter lowest */ \
O(0x1008, 0, TEXT, 0x646d6465, FIXED, "Manufacturer device name") \
O(0x1014, 0, U32, 0x80, EMCY, "COB-ID EMCY") \
O(0x1017, 0, U16, 100, BEAT, "Producer heartbeat time") \
O(0x1018, 0, U8, 3, FIXED, "Identity, highest sub-index") \
O(0x1018, 1, U32, 0, FIXED, "Vendor") \
O(0x1018, 2, U32, 0x65646d64, FIXED, "Product code") \
O(0x1018, 3, U32, 1, FIXED, "Revision number") \
PLC_RPDO(O, 1, 0x1400, 0x200) \
PLC_RPDO(O, 2, 0x1401, 0x300) \
PLC_RPDO(O, 3, 0x1402, 0x400) \
PLC_TPDO(O, 1, 0x1800, 0x180) \
PLC_TPDO(O, 2, 0x1801, 0x280) \
PLC_TPDO(O, 3, 0x1802, 0x380) \
PLC_TPDO(O, 4, 0x1803, 0x480) \
PLC_TPDO(O, 5, 0x1804, 0x500) \
PLC_TPDO(O, 6, 0x1805, 0x680) \
O(0x2000, 0, U8, 15, FIXED, "Machine, highest sub-index") \
O(0x2001, 0, U8, 8, FIXED, "Positions, highest sub-index") \
O(0x2002, 0, U8, 5, FIXED, "Pulse, highest sub-index") \
O(0x2100, 0, U8, 6, FIXED, "PLC, highest sub-index") \
O(0x2101, 0, U8, 8, FIXED, "Generator, highest sub-index")

#define PLC_ERROR_AT(O, i) \
O(0x1003, i, U32, 0, ERROR, "Error " #i)

/* How a frame is sent (bit 30: not on request). */
#define PLC_TPDO(O, n, at, id) \
O(at, 0, U8, 2, FIXED, "TPDO" #n ", highest sub-index") \
O(at, 1, U32, 0x40000000 + id, PLUS_NODE, "TPDO" #n " COB-ID") \
O(at, 2, U8, 254, FIXED, "TPDO" #n " transmission type")
#define PLC_RPDO(O, n, at, id) \
O(at, 0, U8, 2, FIXED, "RPDO" #n ", highest sub-index") \
O(at, 1, U32, id, PLUS_NODE, "RPDO" #n " COB-ID") \
O(at, 2, U8, 255, FIXED, "RPDO" #n " transmission type")

/* clang-format on */

#endif /* IO_PLC_SIGNALS_H */
