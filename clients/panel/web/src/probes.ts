// SPDX-License-Identifier: Apache-2.0
//
// Touching off as forms: what each asks for, and the words of `edmctl offset`
// that it makes.  The words are those of docs/probe.md.
import { parse } from "./format";
import type { Word } from "./words";

export type ProbeId = "edge" | "hole" | "block" | "corner" | "skew" | "length" | "middle" | "straight";

export interface Ask { key: string; label: Word; unit: string; preset: string; may?: boolean; choices?: string[]; when?: (v: Values) => boolean }

/** `shows`: the values that it changes, by their keys in a row of the offsets, or,
 * if `electrode`, in one of the electrodes. */
export interface Probe { id: ProbeId; electrode?: boolean; asks: Ask[]; shows: (v: Values) => string[]; words: (v: Values) => string[] }

export type Values = Record<string, string>;

const WAYS = ["+", "-"];
const number = (key: string, label: Word, preset: string, may = false): Ask => ({ key, label, unit: "mm", preset, may });
const side = (key: string, label: Word, preset: string): Ask => ({ key, label, unit: "", preset, choices: WAYS });
const zero = (axis: string): Ask => ({ key: `zero${axis}`, label: "probe.zero", unit: axis ? `${axis} mm` : "mm", preset: "0" });
const radius = number("tool", "probe.tool", "0");

function num(v: Values, key: string): number {
	return Number(parse(v[key] ?? "").toFixed(6));
}

/** Such as R10; without a number it is left out. */
function word(v: Values, key: string, letter: string): string[] {
	const n = num(v, key);
	return Number.isNaN(n) ? [] : [`${letter}${n}`];
}

const walls = (v: Values): string[] => num(v, "tool") > 0 ? word(v, "tool", "radius=") : [];
const zeros = (v: Values): string[] => ["X", "Y"].flatMap((a) => word(v, `zero${a}`, `${a}=`));

/* A face at two places: one along X has its face on Y.  A face above has both. */
function skew(v: Values): string[] {
	return ["skew", v.face ?? "", ...word(v, "along", v.face?.startsWith("X") || (v.face === "Z-" && v.line === "Y") ? "J" : "I"), ...word(v, "far", "R")];
}

export const PROBES: Probe[] = [
	{ id: "edge", asks: [{ key: "axis", label: "probe.axis", unit: "", preset: "X", choices: ["X", "Y", "Z"] },
		side("way", "probe.way", "-"), number("far", "probe.far", "10"), zero(""), radius],
	shows: (v) => [v.axis ?? "X"],
	words: (v) => [`${v.axis}=probe${v.way}${num(v, "far")}`, ...word(v, "zero", `${v.axis}=`), ...(v.axis === "Z" ? [] : walls(v))] },
	{ id: "hole", asks: [number("radius", "probe.radius", "10"), number("off", "probe.off", "0.1", true),
		{ key: "times", label: "probe.times", unit: "", preset: "2" }, zero("X"), zero("Y")],
	shows: () => ["X", "Y"],
	words: (v) => ["bore", ...word(v, "radius", "R"), ...word(v, "off", "Q"), ...word(v, "times", "L"), ...zeros(v)] },
	{ id: "block", asks: [number("x", "probe.sidex", "15"), number("y", "probe.sidey", "15"), number("down", "probe.down", "5"),
		number("off", "probe.off", "0.1", true), zero("X"), zero("Y")],
	shows: () => ["X", "Y"],
	words: (v) => ["boss", ...word(v, "x", "I"), ...word(v, "y", "J"), ...word(v, "down", "K"), ...word(v, "off", "Q"), ...zeros(v)] },
	{ id: "corner", asks: [side("wayX", "probe.wayx", "+"), side("wayY", "probe.wayy", "+"), number("x", "probe.sidex", "10", true),
		number("y", "probe.sidey", "10", true), number("off", "probe.off", "0.5"), zero("X"), zero("Y"), radius],
	shows: () => ["X", "Y"],
	words: (v) => ["corner", `X${v.wayX}`, `Y${v.wayY}`, ...word(v, "x", "I"), ...word(v, "y", "J"), ...word(v, "off", "Q"), ...zeros(v), ...walls(v)] },
	{ id: "skew", asks: [{ key: "face", label: "probe.face.along", unit: "", preset: "Y+", choices: ["X+", "X-", "Y+", "Y-", "Z-"] },
		{ key: "line", label: "probe.line", unit: "", preset: "X", choices: ["X", "Y"], when: (v) => v.face === "Z-" }, number("along", "probe.along", "20"), number("far", "probe.far", "10")],
	shows: (v) => v.face === "Z-" ? [v.line === "Y" ? "tilt_y_deg" : "tilt_x_deg"] : ["turn_deg", "C"],
	words: skew },
	{ id: "length", asks: [number("far", "probe.far", "10"), { key: "zero", label: "probe.face", unit: "Z mm", preset: "0" },
		{ key: "is", label: "probe.is", unit: "", preset: "new", choices: ["new", "worn"] }],
	electrode: true, shows: () => ["long_mm"],
	words: (v) => [`Z=probe-${num(v, "far")}`, ...word(v, "zero", "Z="), ...(v.is === "new" ? ["new"] : [])] },
	{ id: "middle", electrode: true, asks: [number("x", "probe.sidex", "15"), number("y", "probe.sidey", "15"), number("down", "probe.down", "5"),
		{ key: "zeroX", label: "probe.ball", unit: "X mm", preset: "", may: true }, { key: "zeroY", label: "probe.ball", unit: "Y mm", preset: "", may: true }],
	shows: () => ["x_mm", "y_mm"],
	words: (v) => ["boss", ...word(v, "x", "I"), ...word(v, "y", "J"), ...word(v, "down", "K"), ...zeros(v)] },
	{ id: "straight", electrode: true, asks: [{ key: "face", label: "probe.face.along", unit: "", preset: "Y+", choices: ["X+", "X-", "Y+", "Y-"] },
		number("along", "probe.along", "20"), number("far", "probe.far", "10")],
	shows: () => ["c_deg"], words: skew },
];

/** Everything that has to be given is, and every number is one. */
export function isWhole(p: Probe, v: Values): boolean {
	return p.asks.every((a) => a.choices ? a.choices.includes(v[a.key] ?? "") :
		a.may && !(v[a.key] ?? "").trim() ? true : !Number.isNaN(parse(v[a.key] ?? "")));
}
