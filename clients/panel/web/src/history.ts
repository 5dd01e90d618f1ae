// SPDX-License-Identifier: Apache-2.0
//
// What jobs came to, as the table that `edmctl history --csv` prints too:
// docs/history.md.
import { link } from "./link";

export interface Came { condition: string; job_s: number; erode_s: number; energy_j: number | null; jumps: number; retracts: number; shorts: number; arcs: number }
export interface Fault { utime: number; fault: string; line: number; place_mm: number }
export interface Used { electrode: number; shift_mm: number; wear_before_mm: number; wear_after_mm: number; known: boolean; sparked_s: number }
export interface Ended { job: string; conditions?: Came[]; faults?: Fault[]; electrodes?: Used[]; [key: string]: unknown }

/** The name of a job comes from who sent it; a formula would be carried out. */
function text(v: unknown): string {
	const s = typeof v === "string" ? v : "";
	const formula = /^[=+\-@\t\r\n\uff1d\uff0b\uff0d\uff20]/.test(s);
	return formula || /[,"\r\n']/.test(s) ? `"${formula ? "'" : ""}${s.replace(/"/g, "\"\"")}"` : s;
}

const real = (v: unknown) => typeof v === "number" ? v.toFixed(3) : "";
const whole = (v: unknown) => typeof v === "number" ? v.toFixed(0) : "";
const time = (v: unknown) => typeof v === "number" && v > 0 ? new Date(Math.floor(v / 1000)).toISOString() : "";

type Column = [head: string, of: (j: Ended) => string];
const of = (put: (v: unknown) => string, ...keys: string[]): Column[] => keys.map((k) => [k, (j) => put(j[k])]);

const columns: Column[] = [
	...of(text, "job", "name", "state", "reason"),
	["submitted", (j) => time(j["submitted_us"])], ["begun", (j) => time(j["first_us"])], ["ended", (j) => time(j["ended_us"])],
	...of(real, "job_s", "erode_s", "path_mm", "length_mm", "depth_mm"),
	...of(whole, "jumps", "retracts", "shorts", "arcs"),
	...of(real, "energy_j"),
	["conditions", (j) => (j.conditions ?? []).map((c) => `${c.condition || "none"}=${c.job_s.toFixed(3)}`).join(";")],
	["faults", (j) => (j.faults ?? []).map((f) => `${f.fault}@${f.place_mm.toFixed(3)}/${f.line}`).join(";")],
	...of(whole, "lines"), ...of(text, "sha256", "tech_sha256"),
	["electrodes", (j) => (j.electrodes ?? []).map((e) => `${e.electrode}=${e.known ? (e.wear_after_mm - e.wear_before_mm).toFixed(4) : ""}`).join(";")],
];

/** All jobs that have ended, page by page; or why not. */
export async function table(): Promise<{ csv: string } | { refused: string }> {
	const rows = [columns.map((c) => c[0]).join(",")];
	for (let last = ""; ;) {
		const a = await link.ask<Ended[]>("past", last ? { job: last } : {});
		if (a.code !== 0) return { refused: a.reason };
		if (a.body.length === 0) return { csv: rows.map((r) => `${r}\r\n`).join("") };
		for (const j of a.body) rows.push(columns.map((c) => c[1](j)).join(","));
		last = (a.body[a.body.length - 1] as Ended).job;
	}
}
