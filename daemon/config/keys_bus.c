/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_bus.c - keys of a CAN bus of drives, and of one with a PLC
 */
#include "keys_rows.h"

#define NODE(axis) \
	WHOLE(CAN402, "node_" #axis, "", "0", 0, 126, \
	      AT(can402.node[INTERP_##axis]), \
	      "node of " #axis "'s drive; 0: it has none")

/* clang-format off */
static const struct config_key row[] = {
	NAME(CAN402, "interface", "can0", can402.interface,
	     "network interface of the bus"),
	NUMBER(CAN402, "bitrate_kbit", "kbit/s", "1000", 10, 1000,
	       AT(can402.bitrate_kbit),
	       "bit rate of the bus, from which edmd reckons how full it "
	       "is"),
	NODE(X), NODE(Y), NODE(Z), NODE(A),
	NODE(B), NODE(C), NODE(U), NODE(V),
	WHOLE(CAN402, "master_node", "", "127", 1, 127, AT(can402.master_node),
	      "edmd's own node, whose heartbeat the drives watch"),
	WHOLE(CAN402, "heartbeat_ms", "ms", "100", 10, 10000,
	      AT(can402.heartbeat_ms),
	      "heartbeat of edmd and of each drive; 2.5 times this "
	       "without one means that it is silent"),
	WHOLE(CAN402, "missing_max", "", "2", 0, 100, AT(can402.missing_max),
	      "this many SYNCs in a row may stay unanswered by a drive"),
	WHOLE(CAN402, "sdo_ms", "ms", "1000", 10, 60000, AT(can402.sdo_ms),
	      "longest time for an answer of a drive while it is set up"),
	NUMBER(CAN402, "following_mm", "mm", "0.05", 0, 1000,
	       AT(can402.following_mm),
	       "an axis that is farther from its target is fault "
	       "following; 0: not watched"),
	NUMBER(CAN402, "following_s", "s", "0.05", 0, 10,
	       AT(can402.following_s),
	       "added to following_mm: this time multiplied by the speed, "
	       "because a position loop lags"),
	NUMBER(CAN402, "resync_mm", "mm", "0.2", 0, 100, AT(can402.resync_mm),
	       "an axis that is farther from its place is not enabled"),
	NUMBER(CAN402, "resync_mm_s", "mm/s", "1", 0.001, 100,
	       AT(can402.resync_mm_s),
	       "speed back to its place after an axis was enabled"),
	NUMBER(CAN402, "enable_s", "s", "5", 0.01, 1000, AT(can402.enable_s),
	       "longest time until the axes are enabled and at their "
	       "places"),
	WHOLE(CAN402, "gap_id", "", "0", 0, 2047, AT(can402.gap_id),
	      "CAN identifier of the frames with the gap's signal; 0: "
	       "there is no gap and no spark"),

	NAME(PLC, "interface", "none", plc.interface,
	     "network interface of the PLC's bus; none: there is no PLC"),
	WHOLE(PLC, "node", "", "32", 1, 127, AT(plc.node),
	      "edmd's node on that bus"),
	WHOLE(PLC, "alive_ms", "ms", "200", 10, 10000, AT(plc.alive_ms),
	      "without a turn of the PLC's bit Alive for this time: fault "
	       "plc-lost"),
	WHOLE(PLC, "cycle_ms", "ms", "20", 5, 10000, AT(plc.cycle_ms),
	      "time from one set of frames for the PLC to the next"),
	STRING(PLC, "m_before", "none", plc.m_before,
	       "M codes that the PLC carries out before the motion of "
	       "their line"),
	STRING(PLC, "m_after", "none", plc.m_after,
	       "M codes that the PLC carries out after the motion of their "
	       "line"),
	STRING(PLC, "m_free", "none", plc.m_free,
	       "M codes for the PLC that no motion waits for"),
	STRING(PLC, "m_redo", "none", plc.m_redo,
	       "those of them that are done again after the machine went "
	       "back over them"),
	STRING(PLC, "m_stop", "none", plc.m_stop,
	       "those of them that the machine does not go back over"),
	NUMBER(PLC, "m_timeout_s", "s", "30", 0, 86400, AT(plc.m_timeout_s),
	       "an M code that takes longer is fault m-code; 0: no limit"),
};
/* clang-format on */

const struct config_keys config_keys_bus = { row, ROWS_IN(row) };
