// SPDX-License-Identifier: Apache-2.0
//
// The table of electrodes: which is in the holder, how far each is worn, and
// its numbers to change.  docs/electrodes.md tells what they mean.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { whyNot } from "./can";
import { number, parse } from "./format";
import { link } from "./link";
import { Card, Choice, Key, NumberField, PressKey, Sheet, act } from "./parts";
import { say } from "./use";
import { list, t } from "./words";

const STATES = ["there", "worn", "absent"] as const;
type ElectrodeState = typeof STATES[number];

interface Electrode {
	n: number; name: string; material: string; note: string; state: ElectrodeState;
	undersize_mm: number; length_mm: number; wear_mm: number; x_mm: number; y_mm: number; c_deg: number; spark_s: number;
	life_mm: number; life_s: number; left: number | null; held: boolean;
}

const PAGES_MAX = 10;
const LOOK_MS = 5000;

/** The table comes in pages, each from behind the last number before it. */
async function read(): Promise<Electrode[] | string> {
	const rows: Electrode[] = [];
	for (let page = 0; page < PAGES_MAX; page++) {
		const a = await link.ask<Electrode[]>("electrodes", { arg: rows[rows.length - 1]?.n ?? 0 });
		if (a.code !== 0) return a.reason;
		if (a.body.length === 0) break;
		rows.push(...a.body);
	}
	return rows;
}

function useElectrodes(): { rows: Electrode[] | null; refused: string; again: () => void } {
	const [rows, set] = useState<Electrode[] | null>(null);
	const [refused, refuse] = useState("");
	const [turn, again] = useState(0);
	const open = link.connection === "open";
	useEffect(() => {
		let live = true;
		const look = () => void read().then((r) => {
			if (!live) return;
			if (typeof r === "string") refuse(r); else { set(r); refuse(""); }
		});
		if (open) look();
		const timer = open ? setInterval(() => { if (!document.hidden) look(); }, LOOK_MS) : 0;
		return () => { live = false; clearInterval(timer); };
	}, [open, turn, link.state.electrode]);
	return { rows, refused, again: () => again(turn + 1) };
}

// The values of a form, by the keys that `edmctl electrode set` takes.
const WORDS = ["name", "material", "note"] as const;
const NUMBERS = ["undersize", "length", "wear", "x", "y", "c", "life", "minutes", "sparked"] as const;
type Form = Record<typeof WORDS[number] | typeof NUMBERS[number] | "state", string>;

function formOf(e: Electrode | null): Form {
	const one = (x: number | undefined) => x ? String(Number(x.toFixed(5))) : "0";
	return {
		name: e?.name ?? "", material: e?.material ?? "", note: e?.note ?? "", state: e?.state ?? "there",
		undersize: one(e?.undersize_mm), length: one(e?.length_mm), wear: one(e?.wear_mm),
		x: one(e?.x_mm), y: one(e?.y_mm), c: one(e?.c_deg),
		life: one(e?.life_mm), minutes: one((e?.life_s ?? 0) / 60), sparked: one((e?.spark_s ?? 0) / 60),
	};
}

/** Only what was changed is sent, so that wear that came meanwhile stays. */
function changed(form: Form, was: Form): string {
	const keys = Object.keys(form) as (keyof Form)[];
	const value = (k: keyof Form) => (NUMBERS as readonly string[]).includes(k) ? String(parse(form[k])) : form[k].trim();
	return keys.filter((k) => form[k] !== was[k]).map((k) => `${k}=${value(k)}`).join("\n");
}

function TextField(p: { label: string; value: string; onInput: (text: string) => void; id: string; max: number }): JSX.Element {
	return <label class="field"><span>{p.label}</span><span class="box"><input id={p.id} autocomplete="off" maxLength={p.max} value={p.value} onInput={(e) => p.onInput(e.currentTarget.value)} /></span></label>;
}

function Keys(p: { e: Electrode; close: () => void }): JSX.Element {
	const { e } = p, loaded = link.state.loaded ? t("no.loaded") : "";
	const go = (what: string, arg: number, said = "") => void act(what, { arg }).then((ok) => {
		if (ok && said) say(said);
		if (ok) p.close();
	});
	return <><p class="note">{t("el.measure.about")}</p><div class="keys">
		<PressKey id="el-use" why={whyNot("send") || loaded} onPress={() => go("electrode-use", e.held ? 0 : e.n)}>{t(e.held ? "el.out" : "el.use")}</PressKey>
		<PressKey id="el-measure" why={whyNot("send")} onPress={() => go("electrode-measure", e.n, t("el.measuring", { n: e.n }))}>{t("el.measure")}</PressKey>
		<PressKey id="el-remove" class="danger" why={whyNot("send")} onPress={() => go("electrode-remove", e.n)}>{t("remove")}</PressKey></div></>;
}

function ElectrodeSheet(p: { e: Electrode | null; onClose: () => void }): JSX.Element {
	const [was] = useState(() => formOf(p.e));
	const [form, set] = useState(was), [n, name] = useState(p.e ? String(p.e.n) : "");
	const put = (k: keyof Form) => (text: string) => set({ ...form, [k]: text });
	const text = changed(form, was);
	const whole = NUMBERS.every((k) => !Number.isNaN(parse(form[k]))) && /^[1-9]\d{0,3}$/.test(n.trim());
	const why = whyNot("send") || (!whole ? t("probe.bad") : "");
	const save = () => void act(p.e ? "electrode-set" : "electrode-add", { arg: Number(n), text }).then((ok) => { if (ok) p.onClose(); });
	return <Sheet title={p.e ? t("el.edit", { n: p.e.n }) : t("el.add")} onClose={p.onClose}>
		<div class="fields">
			{!p.e && <NumberField id="el-n" label={t("el.number")} value={n} onInput={name} />}
			<TextField id="el-name" label={t("el.name")} max={31} value={form.name} onInput={put("name")} />
			<TextField id="el-material" label={t("el.material")} max={31} value={form.material} onInput={put("material")} />
			{NUMBERS.map((k) => <NumberField id={`el-${k}`} key={k} label={t(`el.${k}`)} unit={k === "minutes" || k === "sparked" ? t("unit.min") : k === "c" ? "deg" : "mm"} value={form[k]} onInput={put(k)} />)}
			<TextField id="el-note" label={t("el.note")} max={100} value={form.note} onInput={put("note")} />
		</div>
		<div class="field"><span>{t("el.state")}</span><Choice label={t("el.state")} value={form.state as ElectrodeState} onChange={put("state")} of={STATES.map((v) => ({ value: v, text: t(`el.${v}`) }))} /></div>
		<div class="keys end"><Key id="el-save" class="primary" why={why} onPress={() => text || !p.e ? save() : p.onClose()}>{t("el.save")}</Key></div>
		{p.e && <Keys e={p.e} close={p.onClose} />}
	</Sheet>;
}

/** How much of its life is left, as a bar; without a limit there is none. */
function Left(p: { e: Electrode }): JSX.Element {
	const { e } = p, limited = e.life_mm > 0 || e.life_s > 0;
	if (!limited || e.left === null) return <>{"\u2013"}</>;
	const share = Math.max(0, Math.min(1, e.left)) * 100;
	return <span class="life"><i class={share <= 10 ? "low" : ""} style={{ width: `${share}%` }} /><b>{number(share, 0)} %</b></span>;
}

export function ElectrodeCard(): JSX.Element {
	const { rows, refused, again } = useElectrodes();
	const [open, set] = useState<Electrode | "new" | null>(null);
	const close = () => { set(null); again(); };
	return <Card title={t("el.title")} class="electrodes" right={<Key id="el-add" class="small" why={whyNot("send")} onPress={() => set("new")}>{t("el.add")}</Key>}>
		{refused && <p class="note">{refused}</p>}
		{rows && rows.length === 0 && <p class="calm">{t("el.empty")}</p>}
		<ul class="jobs">{(rows ?? []).map((e) => <li key={e.n}><button type="button" class="job electrode-row" aria-label={`${t("el.edit", { n: e.n })} ${e.name}`} onClick={() => set(e)}>
			<b>T{e.n} {e.name}</b><span>{list([e.material, e.state === "there" ? "" : t(`el.${e.state}`)])}{e.held && <em>{t("el.held")}</em>}</span>
			<span class="n">{t("el.wear")} {number(e.wear_mm, 3)} mm</span><Left e={e} /></button></li>)}</ul>
		{open && <ElectrodeSheet e={open === "new" ? null : open} onClose={close} />}
	</Card>;
}
