/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_table.c - every signal between edmd and a PLC, once
 */
#include "plc.h"

#define TELL(field)	offsetof(struct plc_tell, field)
#define ASK(field)	offsetof(struct plc_ask, field)

/* Of pdo 0 are those that no frame has room for. */
#define POSITION(sub, axis, pdo, byte, what) \
	{ 0x2001, sub, PLC_I32, false, pdo, byte, TELL(pos[(sub) - 1]), \
	  INT32_MIN, INT32_MAX, "Position" axis, "pulses", 1, what }

/* clang-format off */
const struct plc_signal plc_signal[] = {
	/* index, sub, type, asked, pdo, byte, place, min, max, name */
	{ 0x2000, 1, PLC_U8,  false, 1, 0, TELL(state), 0, 255,
	  "State", "", 1,
	  "1 idle, 2 travel, 3 approach, 4 erode, 5 retract, 6 jump, 7 hold, 8 fault, "
	  "9 jog, 10 home, 11 probe" },
	{ 0x2000, 2, PLC_U8,  false, 1, 1, TELL(flags), 0, 255,
	  "Flags", "", 1,
	  "bits" },
	{ 0x2000, 3, PLC_U8,  false, 1, 2, TELL(fault), 0, 255,
	  "Fault", "", 1,
	  "0 none; the others have names in the DBC" },
	{ 0x2000, 4, PLC_U8,  false, 1, 3, TELL(mcode), 0, 255,
	  "McodeWaiting", "", 1,
	  "M code to be carried out; 0: none" },
	{ 0x2000, 5, PLC_U16, false, 1, 4, TELL(gap), 0, 65535,
	  "GapVoltage", "V", 0.01,
	  "mean gap voltage" },
	{ 0x2000, 6, PLC_I16, false, 1, 6, TELL(feed), -32768, 32767,
	  "Feed", "mm/s", 0.001,
	  "along the path, - is backward" },
	{ 0x2000, 7, PLC_U32, false, 2, 0, TELL(job), 0, UINT32_MAX,
	  "Job", "", 1,
	  "number of the program; 0: none" },
	{ 0x2000, 8, PLC_U32, false, 2, 4, TELL(line), 0, UINT32_MAX,
	  "Line", "", 1,
	  "of its source text" },
	POSITION(1, "X", 3, 0, "target"),
	POSITION(2, "Y", 3, 4, "target"),
	POSITION(3, "Z", 4, 0, "target"),
	POSITION(4, "A", 0, 0, "target; by SDO"),
	POSITION(5, "B", 0, 0, "target; by SDO"),
	POSITION(6, "C", 4, 4, "target"),
	POSITION(7, "U", 0, 0, "target; by SDO"),
	POSITION(8, "V", 0, 0, "target; by SDO"),
	{ 0x2100, 1, PLC_U8,  true,  1, 0, ASK(command), 0, 255,
	  "Command", "", 1,
	  "bits" },
	{ 0x2100, 2, PLC_U8,  true,  1, 1, ASK(locks), 0, PLC_LOCKS,
	  "Interlocks", "", 1,
	  "bits, each 1 while all is well" },
	{ 0x2100, 3, PLC_U16, true,  1, 2, ASK(override), 0, 2000,
	  "FeedOverride", "%", 0.1,
	  "of positioning" },
	{ 0x2100, 4, PLC_U16, true,  1, 4, ASK(program), 0, 9999,
	  "ProgramSelect", "", 1,
	  "job to be loaded next; 0: none" },
	{ 0x2100, 5, PLC_U8,  true,  1, 6, ASK(mcode_done), 0, 255,
	  "McodeDone", "", 1,
	  "M code that has been carried out; 0: none" },
	{ 0x2100, 6, PLC_U8,  true,  1, 7, ASK(axes_c), 0, 255,
	  "AxisTemperature", "degC", 0.25,
	  "of the axes, for [geometry] maps; 0: not told" },
};

const size_t plc_nsignals = sizeof(plc_signal) / sizeof(plc_signal[0]);

#define NO_RTR	0x40000000u

/* How a frame is sent, and what object stands in it. */
#define TPDO(n, at, id) \
	{ at, 0, PLC_U8, 2, PLC_FIXED, "TPDO" #n ", highest sub-index" }, \
	{ at, 1, PLC_U32, NO_RTR | (id), PLC_PLUS_NODE, "TPDO" #n " COB-ID" }, \
	{ at, 2, PLC_U8, 254, PLC_FIXED, "TPDO" #n " transmission type" }
#define MAPPED(frame, at, i, index, sub, bits) \
	{ at, i, PLC_U32, (uint32_t)(index) << 16 | (sub) << 8 | (bits), \
	  PLC_FIXED, #frame " object " #i }

#define ERROR_AT(i) \
	{ 0x1003, i, PLC_U32, 0, PLC_ERROR, "Error " #i }

const struct plc_constant plc_constant[] = {
	{ 0x1000, 0, PLC_U32, 0, PLC_FIXED, "Device type" },
	{ 0x1001, 0, PLC_U8, 0, PLC_REGISTER, "Error register" },
	{ 0x1003, 0, PLC_U8, 0, PLC_ERRORS, "Errors, number of them" },
	ERROR_AT(1), ERROR_AT(2), ERROR_AT(3), ERROR_AT(4),
	ERROR_AT(5), ERROR_AT(6), ERROR_AT(7), ERROR_AT(8),
	{ 0x1008, 0, PLC_U32, 0x646d6465, false,
	  "Manufacturer device name" },		/* "edmd" */
	{ 0x1014, 0, PLC_U32, CAN_EMCY, PLC_PLUS_NODE, "COB-ID EMCY" },
	{ 0x1017, 0, PLC_U16, 100, PLC_FIXED, "Producer heartbeat time" },
	{ 0x1018, 0, PLC_U8, 3, PLC_FIXED, "Identity, highest sub-index" },
	{ 0x1018, 1, PLC_U32, 0, PLC_FIXED, "Vendor" },
	{ 0x1018, 2, PLC_U32, 0x65646d64, PLC_FIXED, "Product code" },
	{ 0x1018, 3, PLC_U32, 1, PLC_FIXED, "Revision number" },
	{ 0x1400, 0, PLC_U8, 2, PLC_FIXED, "RPDO1, highest sub-index" },
	{ 0x1400, 1, PLC_U32, CAN_RPDO1, PLC_PLUS_NODE, "RPDO1 COB-ID" },
	{ 0x1400, 2, PLC_U8, 255, PLC_FIXED, "RPDO1 transmission type" },
	{ 0x1600, 0, PLC_U8, 6, PLC_FIXED, "RPDO1 mapping, objects" },
	MAPPED(RPDO1, 0x1600, 1, 0x2100, 1, 8),
	MAPPED(RPDO1, 0x1600, 2, 0x2100, 2, 8),
	MAPPED(RPDO1, 0x1600, 3, 0x2100, 3, 16),
	MAPPED(RPDO1, 0x1600, 4, 0x2100, 4, 16),
	MAPPED(RPDO1, 0x1600, 5, 0x2100, 5, 8),
	MAPPED(RPDO1, 0x1600, 6, 0x2100, 6, 8),
	TPDO(1, 0x1800, 0x180),
	TPDO(2, 0x1801, 0x280),
	TPDO(3, 0x1802, 0x380),
	TPDO(4, 0x1803, 0x480),
	{ 0x1a00, 0, PLC_U8, 6, PLC_FIXED, "TPDO1 mapping, objects" },
	MAPPED(TPDO1, 0x1a00, 1, 0x2000, 1, 8),
	MAPPED(TPDO1, 0x1a00, 2, 0x2000, 2, 8),
	MAPPED(TPDO1, 0x1a00, 3, 0x2000, 3, 8),
	MAPPED(TPDO1, 0x1a00, 4, 0x2000, 4, 8),
	MAPPED(TPDO1, 0x1a00, 5, 0x2000, 5, 16),
	MAPPED(TPDO1, 0x1a00, 6, 0x2000, 6, 16),
	{ 0x1a01, 0, PLC_U8, 2, PLC_FIXED, "TPDO2 mapping, objects" },
	MAPPED(TPDO2, 0x1a01, 1, 0x2000, 7, 32),
	MAPPED(TPDO2, 0x1a01, 2, 0x2000, 8, 32),
	{ 0x1a02, 0, PLC_U8, 2, PLC_FIXED, "TPDO3 mapping, objects" },
	MAPPED(TPDO3, 0x1a02, 1, 0x2001, 1, 32),
	MAPPED(TPDO3, 0x1a02, 2, 0x2001, 2, 32),
	{ 0x1a03, 0, PLC_U8, 2, PLC_FIXED, "TPDO4 mapping, objects" },
	MAPPED(TPDO4, 0x1a03, 1, 0x2001, 3, 32),
	MAPPED(TPDO4, 0x1a03, 2, 0x2001, 6, 32),
	{ 0x2000, 0, PLC_U8, 8, PLC_FIXED, "Machine, highest sub-index" },
	{ 0x2001, 0, PLC_U8, 8, PLC_FIXED, "Positions, highest sub-index" },
	{ 0x2100, 0, PLC_U8, 6, PLC_FIXED, "PLC, highest sub-index" },
};
/* clang-format on */

const size_t plc_nconstants = sizeof(plc_constant) / sizeof(plc_constant[0]);
