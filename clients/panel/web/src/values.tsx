// SPDX-License-Identifier: Apache-2.0
//
// Values of the condition in force, changed within their limits.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { whyNot } from "./can";
import { parse, short, unitWord } from "./format";
import { link, type Field } from "./link";
import { Key, NumberField, Sheet, act } from "./parts";
import { fieldWord, list, t } from "./words";

/** A step a finger would want: a twentieth, as 1, 2 or 5 times a power of ten. */
export function stepOf(f: Field, value: number): number {
	if (f.whole) return 1;
	const want = Math.max(Math.abs(value) / 15, f.min > 0 ? f.min : 0.001);
	const ten = 10 ** Math.floor(Math.log10(want));
	return [1, 2, 5].map((k) => k * ten).filter((k) => k <= want * 1.0001).pop() ?? ten;
}

const ORDER = ["short_v", "window_low_v", "servo_v", "window_high_v", "open_v", "ignition_v"];

/** What a value has to stay between, with the others that are in force. */
export function limitsOf(f: Field, values: Record<string, number>): [number, number] {
	let [min, max] = [f.min, f.max];
	const at = ORDER.indexOf(f.name);
	if (at < 0) return [min, max];
	for (const [i, name] of ORDER.entries()) {
		const v = values[name];
		if (v === undefined || (v === 0 && name.startsWith("window"))) continue;
		if (i < at) min = Math.max(min, v);
		if (i > at) max = Math.min(max, v);
	}
	return [min, max];
}

function One(p: { field: Field; autofocus?: boolean }): JSX.Element {
	const f = p.field, s = link.state, value = s.values[f.name];
	const [text, set] = useState("");
	const [min, max] = limitsOf(f, s.values), why = whyNot("set");
	const x = parse(text), bad = text !== "" && !(x >= min && x <= max && (!f.whole || Number.isInteger(x)));
	const step = stepOf(f, value ?? min);
	const go = (v: number) => {
		const to = Number(Math.min(max, Math.max(min, v)).toPrecision(9));
		void act("set", { text: f.name, arg: to }).then((ok) => { if (ok) set(""); });
	};
	const own = s.set.includes(f.name);
	return <div class="value"><div class="value-head"><b>{fieldWord(f.name, f.help)}</b><code>{f.name}</code></div>
		<div class="stepper"><Key id={`less-${f.name}`} label={`${fieldWord(f.name, f.help)} \u2212`} why={why} onPress={() => go((value ?? min) - step)}>{"\u2212"}{short(step)}</Key>
			<output>{value === undefined ? "\u2013" : short(value)} <u>{unitWord(f.unit)}</u></output>
			{s.told[f.name] !== undefined && <em>{t("cut.told", { value: short(s.told[f.name] as number) })}</em>}
			<Key id={`more-${f.name}`} label={`${fieldWord(f.name, f.help)} +`} why={why} onPress={() => go((value ?? min) + step)}>+{short(step)}</Key></div>
		<div class="keys"><NumberField label={t("cut.range", { min: short(min), max: short(max), unit: unitWord(f.unit) })} unit={unitWord(f.unit)} value={text} onInput={set} onEnter={() => { if (text && !bad) go(x); }} />
			<Key why={why || (text === "" || bad ? t("cut.range", { min: short(min), max: short(max), unit: unitWord(f.unit) }) : "")} onPress={() => go(x)}>{t("cut.set")}</Key>
			{own && <Key class="quiet" why={why} onPress={() => void act("set", { text: f.name, arg: null })}>{t("cut.takeback")}</Key>}</div>
	</div>;
}

export function ValueSheet(p: { names: string[]; onClose: () => void; onMore: () => void }): JSX.Element {
	const fields = (link.hello?.fields ?? []).filter((f) => p.names.includes(f.name));
	return <Sheet title={`${t("cut.condition")} ${link.state.condition}`} onClose={p.onClose}>
		{fields.map((f) => <One field={f} key={f.name} />)}
		<p class="note">{whyNot("set") || t("cut.setnote")}</p>
		<Key class="quiet" onPress={p.onMore}>{t("cut.more")}</Key>
	</Sheet>;
}

export function ValuesSheet(p: { onClose: () => void }): JSX.Element {
	const [at, set] = useState("");
	const s = link.state, fields = (link.hello?.fields ?? []).filter((f) => f.live);
	const one = fields.find((f) => f.name === at);
	const counts = Object.entries(s.told).filter(([name]) => !(name in s.values) && name !== "fault").map(([name, v]) => `${name} ${short(v)}`);
	const more = list(counts);
	return <Sheet title={t("pair", { what: t("cut.values"), is: s.condition || "\u2013" })} onClose={p.onClose} wide>
		{one ? <><One field={one} /><Key class="quiet" onPress={() => set("")}>{t("cut.more")}</Key></> :
			<ul class="valuelist">{fields.map((f) => <li><button type="button" onClick={() => set(f.name)}>
				<span>{fieldWord(f.name, f.help)}</span><b>{s.values[f.name] === undefined ? "\u2013" : short(s.values[f.name] as number)} <u>{unitWord(f.unit)}</u></b>
				{s.told[f.name] !== undefined && <em>{t("cut.told", { value: short(s.told[f.name] as number) })}</em>}
				{s.set.includes(f.name) && <em>{t("cut.setby")}</em>}</button></li>)}</ul>}
		{more && <p class="note">{t("cut.counts", { value: more })}</p>}
		{s.generator_fault && <p class="note">{t("cut.ownfault", { value: s.generator_fault })}</p>}
		<p class="note">{whyNot("set") || t("cut.setnote")}</p>
	</Sheet>;
}
