/* SPDX-License-Identifier: Apache-2.0 */
/*
 * meanings.h - what a G, M or T word can mean: the names by which the file of a
 * dialect gives a meaning to its words
 *
 * A row has the name, the group whose function carries it out, a value for that
 * function, and the slots that the word uses on its line.  A letter that a
 * dialect does not have is never on a line, so one row serves all dialects.
 */
#ifndef CODE_MEANINGS_H
#define CODE_MEANINGS_H

#include "code/words.h"

#include "interp/orbit.h"
#include "interp/wire.h"

#define NC_XY	(NC_BIT(NC_X) | NC_BIT(NC_Y))
#define NC_XYZ	(NC_XY | NC_BIT(NC_Z))
#define NC_IJ	(NC_BIT(NC_I) | NC_BIT(NC_J))
#define NC_ARC	(NC_AXES | NC_CENTRE | NC_BIT(NC_R) | NC_BIT(NC_UI) | \
		 NC_BIT(NC_UJ) | NC_CORNER)
#define NC_ANG	(NC_BIT(NC_A) | NC_BIT(NC_ANGLE))
#define NC_DOWN	(NC_XYZ | NC_BIT(NC_C))
#define NC_ROUND (NC_DOWN | NC_CENTRE | NC_BIT(NC_R) | NC_BIT(NC_Q) | \
		  NC_BIT(NC_P))
#define NC_LQ	(NC_BIT(NC_L) | NC_BIT(NC_Q))

#define NC_MEANINGS(W) \
	W("rapid", MOTION, 0, NC_AXES) \
	W("line", MOTION, 1, NC_AXES | NC_CORNER) \
	W("line-with-R", MOTION, 1, NC_AXES | NC_CORNER | NC_BIT(NC_R)) \
	W("arc-clockwise", MOTION, 2, NC_ARC) \
	W("arc-counter-clockwise", MOTION, 3, NC_ARC) \
	W("arc-clockwise-with-P", MOTION, 2, NC_ARC | NC_BIT(NC_P)) \
	W("arc-counter-clockwise-with-P", MOTION, 3, NC_ARC | NC_BIT(NC_P)) \
	W("cubic", MOTION, NC_SPLINE, \
	  NC_XY | NC_IJ | NC_BIT(NC_P) | NC_BIT(NC_Q)) \
	W("parabola", MOTION, NC_PARABOLA, NC_XY | NC_IJ) \
	W("nurbs-point", MOTION, NC_NURBS_BLOCK, \
	  NC_XY | NC_BIT(NC_P) | NC_BIT(NC_L)) \
	W("nurbs-end", MOTION, NC_NURBS_END, 0) \
	W("nurbs", MOTION, NC_NURBS, \
	  NC_AXES | NC_BIT(NC_P) | NC_BIT(NC_K) | NC_BIT(NC_R)) \
	W("body-curve", MOTION, NC_BODY, NC_XYZ | NC_BIT(NC_P) | NC_LQ | \
	  NC_CENTRE | NC_BIT(NC_R)) \
	W("plane-xy", PLANE, 0, 0) \
	W("plane-zx", PLANE, 1, 0) \
	W("plane-yz", PLANE, 2, 0) \
	W("inches", UNITS, true, 0) \
	W("millimetres", UNITS, false, 0) \
	W("absolute", DISTANCE, false, 0) \
	W("incremental", DISTANCE, true, 0) \
	W("centre-absolute", ARC_DISTANCE, false, 0) \
	W("centre-incremental", ARC_DISTANCE, true, 0) \
	W("work-offset-1", WORK, 0, 0) \
	W("work-offset-2", WORK, 1, 0) \
	W("work-offset-3", WORK, 2, 0) \
	W("work-offset-4", WORK, 3, 0) \
	W("work-offset-5", WORK, 4, 0) \
	W("work-offset-6", WORK, 5, 0) \
	W("work-offset-7", WORK, 6, 0) \
	W("work-offset-8", WORK, 7, 0) \
	W("work-offset-9", WORK, 8, 0) \
	W("electrode", ELECTRODE, NC_ELECTRODE_NOW, 0) \
	W("electrode-next", ELECTRODE, NC_ELECTRODE_NEXT, 0) \
	W("electrode-change", ELECTRODE_CHANGE, 0, 0) \
	W("feed-per-minute", FEED_MODE, 0, 0) \
	W("offset-off", OFFSET, 0, 0) \
	W("offset-left", OFFSET, 1, 0) \
	W("offset-right", OFFSET, 2, 0) \
	W("taper-off", TAPER, 0, NC_BIT(NC_ANGLE)) \
	W("taper-left", TAPER, 1, NC_ANG) \
	W("taper-right", TAPER, 2, NC_ANG) \
	W("corner-conical", TAPER_CORNER, INTERP_CORNER_CONICAL, 0) \
	W("corner-constant", TAPER_CORNER, INTERP_CORNER_CONSTANT, 0) \
	W("corner-sharp", TAPER_CORNER, INTERP_CORNER_SHARP, 0) \
	W("mirror-off", MIRROR, NC_MIRROR_OFF, 0) \
	W("mirror-axis-off", MIRROR, NC_MIRROR_END, NC_AXES) \
	W("mirror-at", MIRROR, NC_MIRROR_PLACES, NC_AXES) \
	W("mirror-x", MIRROR, NC_MIRROR_X, 0) \
	W("mirror-y", MIRROR, NC_MIRROR_Y, 0) \
	W("exchange-xy", MIRROR, NC_MIRROR_EXCHANGE, 0) \
	W("scale-off", SCALE, false, 0) \
	W("scale", SCALE, true, NC_XYZ | NC_BIT(NC_P)) \
	W("turn-off", TURN, NC_TURN_OFF, 0) \
	W("turn", TURN, NC_TURN_ABOUT_XY, NC_AXES | NC_BIT(NC_R)) \
	W("turn-about-ij", TURN, NC_TURN_ABOUT_IJ, NC_IJ | NC_BIT(NC_R)) \
	W("tool-tip", TOOL_POINT, NC_TOOL_ANGLES, 0) \
	W("tool-tip-by-vector", TOOL_POINT, NC_TOOL_VECTOR, 0) \
	W("tool-tip-off", TOOL_POINT, NC_TOOL_OFF, 0) \
	W("machine-place", MACHINE, 0, 0) \
	W("probe-at-feed", PROBE, NC_PROBE_FEED, NC_XYZ) \
	W("probe", PROBE, NC_PROBE_ONE, NC_XYZ) \
	W("to-limit", PROBE, NC_PROBE_LIMIT, NC_XYZ) \
	W("half-way", PROBE, NC_PROBE_HALF, NC_XYZ) \
	W("find-hole", PROBE, NC_PROBE_HOLE, NC_BIT(NC_R) | NC_LQ) \
	W("find-block", PROBE, NC_PROBE_PILLAR, NC_CENTRE | NC_LQ) \
	W("find-corner", PROBE, NC_PROBE_CORNER, \
	  NC_XY | NC_IJ | NC_BIT(NC_R) | NC_BIT(NC_Q)) \
	W("sink-by-time", CYCLE, INTERP_NORBITS, NC_DOWN | NC_BIT(NC_P)) \
	W("orbit-circle", CYCLE, INTERP_ORBIT_CIRCLE, NC_ROUND) \
	W("orbit-square", CYCLE, INTERP_ORBIT_SQUARE, NC_ROUND) \
	W("orbit-sphere", CYCLE, INTERP_ORBIT_SPHERE, NC_ROUND) \
	W("orbit-cone", CYCLE, INTERP_ORBIT_CONE, NC_ROUND) \
	W("orbit-vector", CYCLE, INTERP_ORBIT_VECTOR, NC_ROUND | \
	  NC_BIT(NC_L)) \
	W("orbit-expand", CYCLE, INTERP_ORBIT_EXPAND, NC_ROUND) \
	W("lift-along-path", ESCAPE, INTERP_ESCAPE_PATH, 0) \
	W("lift-by-centre", ESCAPE, INTERP_ESCAPE_CENTRE, 0) \
	W("lift-along-axis", ESCAPE, INTERP_ESCAPE_AXIS, 0) \
	W("lift-by-normal", ESCAPE, INTERP_ESCAPE_NORMAL, 0) \
	W("power-positive", POWER, INTERP_AUX_POWER_POSITIVE, 0) \
	W("power-negative", POWER, INTERP_AUX_POWER_NEGATIVE, 0) \
	W("power-off", POWER, INTERP_AUX_POWER_OFF, 0) \
	W("pump-on", PUMP, INTERP_AUX_PUMP_ON, 0) \
	W("pump-off", PUMP, INTERP_AUX_PUMP_OFF, 0) \
	W("wire-stop", WIRE_STOP, 0, 0) \
	W("stop", STOP, NC_HALT, 0) \
	W("optional-stop", STOP, NC_OPTIONAL_HALT, 0) \
	W("end", STOP, NC_FINISH, 0) \
	W("call", STOP, NC_CALL, \
	  NC_BIT(NC_P) | NC_BIT(NC_L) | NC_BIT(NC_NAME)) \
	W("return", STOP, NC_RETURN, NC_BIT(NC_P))

#endif /* CODE_MEANINGS_H */
