// SPDX-License-Identifier: Apache-2.0
//
// Probing cycles as forms: what they ask for, and the G code they make.
// The words are those of docs/probe.md.
import { parse } from "./format";
import type { Word } from "./words";

export type ProbeId = "edge" | "hole" | "block" | "corner";

export interface Ask { key: string; label: Word; unit: string; preset: string; may?: boolean; choices?: string[] }

export interface Probe { id: ProbeId; asks: Ask[]; code: (v: Record<string, string>) => string[] }

function num(v: Record<string, string>, key: string): string {
	const x = parse(v[key] ?? "");
	return Number.isNaN(x) ? "" : String(Number(x.toFixed(6)));
}

function word(v: Record<string, string>, key: string, letter: string): string {
	const n = num(v, key);
	return n === "" ? "" : ` ${letter}${n}`;
}

// G92 names the place the electrode stands at.
function zero(v: Record<string, string>, axes: string[]): string[] {
	const words = axes.map((a) => word(v, `zero${a}`, a)).join("");
	return words ? [`G92${words}`] : [];
}

const WAYS = ["+", "-"];

export const PROBES: Probe[] = [
	{ id: "edge", asks: [
		{ key: "axis", label: "probe.axis", unit: "", preset: "X", choices: ["X", "Y", "Z"] },
		{ key: "way", label: "probe.way", unit: "", preset: "-", choices: WAYS },
		{ key: "far", label: "probe.far", unit: "mm", preset: "10" },
		{ key: "zero", label: "probe.zero", unit: "mm", preset: "", may: true }],
	code: (v) => {
		const far = num(v, "far"), axis = v.axis ?? "X";
		return ["G21 G91", `G80 ${axis}${v.way === "-" ? "-" : ""}${far}`, "G90", ...(num(v, "zero") ? [`G92 ${axis}${num(v, "zero")}`] : []), "M30"];
	} },
	{ id: "hole", asks: [
		{ key: "radius", label: "probe.radius", unit: "mm", preset: "10" },
		{ key: "off", label: "probe.off", unit: "mm", preset: "0.1", may: true },
		{ key: "times", label: "probe.times", unit: "", preset: "2" },
		{ key: "zeroX", label: "probe.zero", unit: "X mm", preset: "0", may: true },
		{ key: "zeroY", label: "probe.zero", unit: "Y mm", preset: "0", may: true }],
	code: (v) => ["G21 G90", `G160${word(v, "radius", "R")}${word(v, "off", "Q")}${word(v, "times", "L")}`, ...zero(v, ["X", "Y"]), "M30"] },
	{ id: "block", asks: [
		{ key: "x", label: "probe.sidex", unit: "mm", preset: "15" },
		{ key: "y", label: "probe.sidey", unit: "mm", preset: "15" },
		{ key: "down", label: "probe.down", unit: "mm", preset: "5" },
		{ key: "off", label: "probe.off", unit: "mm", preset: "0.1", may: true },
		{ key: "zeroX", label: "probe.zero", unit: "X mm", preset: "0", may: true },
		{ key: "zeroY", label: "probe.zero", unit: "Y mm", preset: "0", may: true }],
	code: (v) => ["G21 G90", `G161${word(v, "x", "I")}${word(v, "y", "J")}${word(v, "down", "K")}${word(v, "off", "Q")}`, ...zero(v, ["X", "Y"]), "M30"] },
	{ id: "corner", asks: [
		{ key: "wayX", label: "probe.wayx", unit: "", preset: "+", choices: WAYS },
		{ key: "wayY", label: "probe.wayy", unit: "", preset: "+", choices: WAYS },
		{ key: "x", label: "probe.sidex", unit: "mm", preset: "10", may: true },
		{ key: "y", label: "probe.sidey", unit: "mm", preset: "10", may: true },
		{ key: "off", label: "probe.off", unit: "mm", preset: "0.5" },
		{ key: "zeroX", label: "probe.zero", unit: "X mm", preset: "", may: true },
		{ key: "zeroY", label: "probe.zero", unit: "Y mm", preset: "", may: true }],
	code: (v) => ["G21 G90", `G162 X${v.wayX} Y${v.wayY}${word(v, "x", "I")}${word(v, "y", "J")}${word(v, "off", "Q")}`, ...zero(v, ["X", "Y"]), "M30"] },
];

/** Everything that has to be given is, and every number is one. */
export function isWhole(p: Probe, v: Record<string, string>): boolean {
	return p.asks.every((a) => a.choices ? a.choices.includes(v[a.key] ?? "") :
		a.may && !(v[a.key] ?? "").trim() ? true : !Number.isNaN(parse(v[a.key] ?? "")));
}
