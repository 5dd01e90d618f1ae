// SPDX-License-Identifier: Apache-2.0
//
// Work offsets: those in force, as `edmctl offset` shows and changes them.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { whyNot } from "./can";
import { number, parse } from "./format";
import { link, type Axis } from "./link";
import { Card, Choice, Key, NumberField, Sheet, act } from "./parts";
import { change, useAsk, useSettings } from "./use";
import { t } from "./words";

/** Of each axis, where its origin is; `touched`: those not of the machine file. */
export interface Row { work: string; touched: string; turn_deg: number; tilt_x_deg: number; tilt_y_deg: number; from_mm: number[]; [axis: string]: string | number | number[] }

/** The systems that every control has; the others are in the table alone. */
export const WORKS = ["G54", "G55", "G56", "G57", "G58", "G59"];
export const LOOK_MS = 5000;
// What a number means, as `edmctl offset` writes it: X=5, X@5.
const MEANS = { here: "=", origin: "@" } as const;
type Means = keyof typeof MEANS;

function at(row: Row, axis: Axis): number {
	const mm = row[axis.name];
	return typeof mm === "number" ? mm : 0;
}

/* X Y and U V are turned back. */
function turnedBack(pos: number[], deg: number): number[] {
	const c = Math.cos(deg * Math.PI / 180), s = Math.sin(deg * Math.PI / 180), to = [...pos];
	for (const i of [0, 6]) {
		const x = pos[i] ?? 0, y = pos[i + 1] ?? 0;
		to[i] = c * x + s * y;
		to[i + 1] = c * y - s * x;
	}
	return to;
}

/** Where the machine stands, as a program has it: in the system in force while
 * a job is loaded, else in the one that is chosen. */
export function useWork(): { work: string; place: (a: Axis) => number } {
	const { work } = useSettings(), s = link.state;
	const [rows] = useAsk<Row[]>("offsets", {}, LOOK_MS);
	const row = rows?.find((r) => r.work === work);
	if (s.loaded && s.work) return { work: s.work, place: (a) => s.workMm[a.index] ?? 0 };
	const q = turnedBack(s.pos, row?.turn_deg ?? 0);
	return { work, place: (a) => (q[a.index] ?? 0) - (row?.from_mm[a.index] ?? 0) };
}

/** How far it is turned; "" where it is not. */
export function turnText(deg: number): string {
	return deg === 0 ? "" : ` \u2220 ${number(deg, 3, true)}\u00b0`;
}

/** Which system that is. */
export function WorkChoice(): JSX.Element {
	const { work } = useSettings(), s = link.state;
	if (s.loaded && s.work) return <span class="workchoice" id="inforce" title={t("work.inforce")}><b>{s.work}</b>{turnText(s.workTurn)}</span>;
	return <select class="workchoice" aria-label={t("work.system")} value={work} onChange={(e) => change({ work: e.currentTarget.value })}>
		{[...WORKS, "G59.1", "G59.2", "G59.3"].map((w) => <option key={w} value={w}>{w}</option>)}</select>;
}

function OffsetSheet(p: { row: Row; axes: Axis[]; onClose: () => void }): JSX.Element {
	const [means, mean] = useState<Means>("here"), [v, set] = useState<Record<string, string>>({});
	const given = p.axes.filter((a) => (v[a.name] ?? "").trim() !== "");
	const whole = given.every((a) => !Number.isNaN(parse(v[a.name] as string)));
	const why = whyNot("send") || (given.length === 0 || !whole ? t("probe.bad") : "");
	const go = (words: string[]) => void act("offset", { text: [p.row.work, ...words].join("\n") }).then((ok) => { if (ok) p.onClose(); });
	return <Sheet title={t("off.edit", { work: p.row.work })} onClose={p.onClose}>
		<Choice label={t("off.means")} value={means} onChange={mean} of={(Object.keys(MEANS) as Means[]).map((m) => ({ value: m, text: t(`off.${m}`) }))} />
		<p class="note">{t(`off.${means}.about`)}</p>
		<div class="fields">{p.axes.map((a) => <NumberField id={`off-${a.name}`} key={a.name} label={t("bracket", { what: a.name, is: `${t("off.now")} ${number(at(p.row, a), 3, true)}` })}
			unit={a.rotary ? "deg" : "mm"} value={v[a.name] ?? ""} onInput={(x) => set({ ...v, [a.name]: x })} />)}</div>
		<div class="keys end"><Key id="off-clear" why={whyNot("send") || (p.row.touched === "" && p.row.turn_deg === 0 ? t("off.asfile") : "")} onPress={() => go(["clear"])}>{t("off.clear")}</Key>
			<Key id="off-save" class="primary" why={why} onPress={() => go(given.map((a) => a.name + MEANS[means] + parse(v[a.name] as string)))}>{t("el.save")}</Key></div>
	</Sheet>;
}

export function OffsetCard(): JSX.Element {
	const [rows, refused, again] = useAsk<Row[]>("offsets", {}, LOOK_MS);
	const [open, set] = useState("");
	const axes = link.hello?.axes ?? [], row = rows?.find((r) => r.work === open);
	return <Card title={t("setup.offsets")} class="offsets"><p class="note">{refused || t("setup.offsetnote")}</p>
		<div class="scroll"><table class="list"><thead><tr><th scope="col">{t("off.system")}</th>{axes.map((a) => <th scope="col" class="n" key={a.name}>{a.name}</th>)}<th scope="col" class="n">{t("off.turn")}</th></tr></thead>
			<tbody>{rows?.map((r) => <tr key={r.work}><th scope="row"><Key class="small" label={t("off.edit", { work: r.work })} onPress={() => set(r.work)}>{r.work}</Key></th>
				{axes.map((a) => <td class="n" key={a.name}>{number(at(r, a), 3, true)}{r.touched.includes(a.name) ? "*" : ""}</td>)}<td class="n">{r.turn_deg === 0 ? "\u2013" : `${number(r.turn_deg, 3, true)}\u00b0`}</td></tr>)}</tbody></table></div>
		{row && <OffsetSheet row={row} axes={axes} onClose={() => { set(""); again(); }} />}
	</Card>;
}
