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
	       AT(can402.bitrate_kbit), "of the bus, to know how full it is"),
	NODE(X), NODE(Y), NODE(Z), NODE(A),
	NODE(B), NODE(C), NODE(U), NODE(V),
	WHOLE(CAN402, "master_node", "", "127", 1, 127, AT(can402.master_node),
	      "our own node, whose heartbeat the drives watch"),
	WHOLE(CAN402, "heartbeat_ms", "ms", "100", 10, 10000,
	      AT(can402.heartbeat_ms),
	      "of us and of each drive; 2.5 times of it is silence"),
	WHOLE(CAN402, "missing_max", "", "2", 0, 100, AT(can402.missing_max),
	      "SYNCs in a row a drive may leave unanswered"),
	WHOLE(CAN402, "sdo_ms", "ms", "1000", 10, 60000, AT(can402.sdo_ms),
	      "a drive may take so long for an answer while it is set up"),
	NUMBER(CAN402, "following_mm", "mm", "0.05", 0, 1000,
	       AT(can402.following_mm),
	       "an axis farther from its target is a fault; 0: never"),
	NUMBER(CAN402, "following_s", "s", "0.05", 0, 10,
	       AT(can402.following_s),
	       "and by so much of its speed: what a position loop lags"),
	NUMBER(CAN402, "resync_mm", "mm", "0.2", 0, 100, AT(can402.resync_mm),
	       "farther from its place an axis is not enabled"),
	NUMBER(CAN402, "resync_mm_s", "mm/s", "1", 0.001, 100,
	       AT(can402.resync_mm_s),
	       "back to its place after it was enabled"),
	NUMBER(CAN402, "enable_s", "s", "5", 0.01, 1000, AT(can402.enable_s),
	       "for the axes to be enabled and on their places"),
	WHOLE(CAN402, "gap_id", "", "0", 0, 2047, AT(can402.gap_id),
	      "identifier of the gap's frames; 0: no gap, no sparks"),
	WHOLE(CAN402, "generator_id", "", "0", 0, 2047, AT(can402.generator_id),
	      "identifier of the frames to the generator; 0: none"),

	NAME(PLC, "interface", "none", plc.interface,
	     "network interface of its bus; none: there is no PLC"),
	WHOLE(PLC, "node", "", "32", 1, 127, AT(plc.node),
	      "our node on it"),
	WHOLE(PLC, "alive_ms", "ms", "200", 10, 10000, AT(plc.alive_ms),
	      "without a turn of its toggle for so long: fault plc-lost"),
	WHOLE(PLC, "cycle_ms", "ms", "20", 5, 10000, AT(plc.cycle_ms),
	      "from one set of frames to it to the next"),
	STRING(PLC, "m_before", "none", plc.m_before,
	       "M codes for it, done before the motion of their line"),
	STRING(PLC, "m_after", "none", plc.m_after,
	       "M codes for it, done after the motion of their line"),
	STRING(PLC, "m_free", "none", plc.m_free,
	       "M codes for it, which no motion waits for"),
	STRING(PLC, "m_redo", "none", plc.m_redo,
	       "those done again after a way back over them"),
	STRING(PLC, "m_stop", "none", plc.m_stop,
	       "those that end a way back"),
	NUMBER(PLC, "m_timeout_s", "s", "30", 0, 86400, AT(plc.m_timeout_s),
	       "longer waits are fault m-code; 0: none is"),
};
/* clang-format on */

const struct config_keys config_keys_bus = { row, ROWS_IN(row) };
