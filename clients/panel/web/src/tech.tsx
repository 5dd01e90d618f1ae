// SPDX-License-Identifier: Apache-2.0
//
// The technology table as a table; two conditions beside each other; changes
// within units and limits, to be exported.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { moment, parse, short, unitWord } from "./format";
import { link, type Field } from "./link";
import { whyNot } from "./can";
import { Card, Key, PressKey, act } from "./parts";
import { save, useAsk, useDraft } from "./use";
import { fieldWord, list, t } from "./words";

interface Row { name: string; line: number; values: Record<string, number> }
interface Table { electrode: string; workpiece: string; notes: string[]; rows: Row[]; sequences: { number: number; steps: string[] }[] }
interface Tech { base: Record<string, number>; file: string; table?: Table; refused?: { line: number; column: number; found: string; wanted: string } }

type Edits = Record<string, number>;		// "C120.servo_v"

function bad(f: Field, x: number): boolean {
	return !(x >= f.min && x <= f.max) || (f.whole && !Number.isInteger(x));
}

/** The table as a .tech text: docs/technology.md. */
export function techText(table: Table, fields: Field[], edits: Edits): string {
	const value = (r: Row, f: Field) => edits[`${r.name}.${f.name}`] ?? r.values[f.name];
	const used = fields.filter((f) => table.rows.some((r) => value(r, f) !== undefined));
	const rows = table.rows.map((r) => [r.name, ...used.map((f) => value(r, f)?.toString() ?? "-")].join(", "));
	return [
		...(table.electrode ? [`electrode = ${table.electrode}`] : []), ...(table.workpiece ? [`workpiece = ${table.workpiece}`] : []),
		...table.notes.map((n) => `note = ${n}`), "", ["condition", ...used.map((f) => f.unit ? `${f.name} [${f.unit}]` : f.name)].join(", "), ...rows, "",
		...table.sequences.map((q) => `sequence Q${q.number} = ${q.steps.join(" ")}`), "",
	].join("\n");
}

function Cell(p: { row: Row; field: Field; edits: Edits; onEdit: (e: Edits) => void }): JSX.Element {
	const key = `${p.row.name}.${p.field.name}`, now = p.edits[key] ?? p.row.values[p.field.name];
	const [text, set] = useState<string | null>(null);
	const x = parse(text ?? ""), wrong = text !== null && text.trim() !== "" && (Number.isNaN(x) || bad(p.field, x));
	const leave = () => {
		if (text !== null && text.trim() !== "" && !wrong) p.onEdit({ ...p.edits, [key]: x });
		set(null);
	};
	return <td class={`n ${key in p.edits ? "edited" : ""}`}><input class={wrong ? "bad" : ""} inputMode="decimal" aria-label={`${p.row.name} ${fieldWord(p.field.name, p.field.help)}`} aria-invalid={wrong}
		title={t("cut.range", { min: short(p.field.min), max: short(p.field.max), unit: unitWord(p.field.unit) })}
		value={text ?? (now === undefined ? "\u2013" : short(now))} onFocus={(e) => { set(now === undefined ? "" : short(now)); const i = e.currentTarget; setTimeout(() => i.select()); }}
		onInput={(e) => set(e.currentTarget.value)} onBlur={leave} onKeyDown={(e) => { if (e.key === "Enter") e.currentTarget.blur(); if (e.key === "Escape") set(null); }} /></td>;
}

function Compare(p: { rows: Row[]; fields: Field[] }): JSX.Element {
	const [a, setA] = useState(p.rows[0]?.name ?? ""), [b, setB] = useState(p.rows[1]?.name ?? p.rows[0]?.name ?? "");
	const of = (n: string) => p.rows.find((r) => r.name === n)?.values ?? {};
	const one = of(a), two = of(b), fields = p.fields.filter((f) => one[f.name] !== undefined || two[f.name] !== undefined);
	const most = (f: Field) => Math.max(Math.abs(one[f.name] ?? 0), Math.abs(two[f.name] ?? 0)) || 1;
	const choose = (value: string, set: (v: string) => void) => <select value={value} aria-label={t("tech.condition")} onChange={(e) => set(e.currentTarget.value)}>{p.rows.map((r) => <option value={r.name}>{r.name}</option>)}</select>;
	return <Card title={t("tech.compare")} right={<div class="keys compare-of">{choose(a, setA)}<span>{t("tech.with")}</span>{choose(b, setB)}</div>}>
		<table class="compare"><thead><tr><th scope="col">{t("tech.field")}</th><th scope="col">{a}</th><th scope="col">{b}</th></tr></thead><tbody>{fields.map((f) => <tr class={one[f.name] === two[f.name] ? "same" : ""}><th scope="row">{fieldWord(f.name, f.help)}<code>{f.name}</code></th>
			{[one, two].map((v) => <td><span class="n">{v[f.name] === undefined ? "\u2013" : short(v[f.name] as number)} <u>{unitWord(f.unit)}</u></span><i class="share" style={{ width: `${Math.abs(v[f.name] ?? 0) / most(f) * 100}%` }} /></td>)}</tr>)}</tbody></table></Card>;
}

interface Version { n: number; utime: number; by: string; what: string }

/* What was saved on the host; each can come back. */
function Versions(p: { file: string; again: () => void }): JSX.Element | null {
	const [rows, , look] = useAsk<Version[]>("tech-versions", {}, 5000);
	if (!rows?.length) return null;
	const back = (n: number) => void act("tech-back", { arg: n }).then((ok) => { if (ok) { look(); p.again(); } });
	return <Card title={t("tech.versions")} class="versions"><ul class="jobs">{rows.map((v, i) => <li key={v.n}><div class="job"><b>{v.n}</b><span>{list(v.what.trim().split("\n"))}</span><span class="n">{moment(v.utime / 1000)}{v.by && ` \u00b7 ${v.by}`}</span></div>
		{i > 0 && <PressKey class="small" label={t("tech.backto", { n: v.n })} why={whyNot("send")} onPress={() => back(v.n)}>{t("tech.back")}</PressKey>}</li>)}</ul></Card>;
}

export function Tech(): JSX.Element {
	const [tech, refused, again] = useAsk<Tech>("tech");
	const [edits, setEdits] = useDraft<Edits>("tech", {});
	const all = link.hello?.fields ?? [], table = tech?.table;
	if (refused) return <div class="column"><p class="note">{refused}</p></div>;
	if (!tech) return <div class="column" />;
	if (tech.refused) return <div class="column"><Card title={t("tech.refused")} class="bad"><p>{tech.file}{tech.refused.line > 0 && `:${tech.refused.line}:${tech.refused.column}`}</p><p>{tech.refused.found}</p><p>{t("pair", { what: t("jobs.accepted"), is: tech.refused.wanted })}</p></Card></div>;
	if (!table) return <div class="column"><Card title={t("tech.table")}><p class="calm">{t("tech.none")}</p></Card>
		<Card title={t("tech.machine")}><ul class="valuelist">{all.filter((f) => tech.base[f.name] !== undefined).map((f) => <li><div><span>{fieldWord(f.name, f.help)}</span><b>{short(tech.base[f.name] as number)} <u>{unitWord(f.unit)}</u></b></div></li>)}</ul></Card></div>;
	const used = all.filter((f) => table.rows.some((r) => r.values[f.name] !== undefined));
	const keep = () => void act("tech-set", { text: Object.entries(edits).map(([key, x]) => `${key}=${x}`).join("\n") }).then((ok) => { if (ok) { setEdits({}); again(); } });
	const edited = Object.keys(edits).length > 0, name = tech.file.split("/").pop() ?? "table.tech";
	return <div class="column wide">
		<Card title={t("pair", { what: t("tech.table"), is: name })} right={<div class="keys">{edited && <Key class="small quiet" onPress={() => setEdits({})}>{t("tech.discard")}</Key>}
			{edited && <PressKey id="techsave" class="small primary" why={whyNot("send")} onPress={() => keep()}>{t("tech.save")}</PressKey>}
			<Key class="small" onPress={() => save(name.replace(/\.\w+$/, "") + ".tech", "text/plain", techText(table, all, edits))}>{t("tech.export")}</Key></div>}>
			<p class="facts-line">{t("tech.electrode")} <b>{table.electrode || "\u2013"}</b> {"\u00b7"} {t("tech.workpiece")} <b>{table.workpiece || "\u2013"}</b></p>
			{edited && <p class="note warn">{t("tech.edited", { file: tech.file })}</p>}
			<div class="scroll" tabIndex={0} role="region" aria-label={t("tech.table")}><table class="list techtable"><thead><tr><th scope="col">{t("tech.condition")}</th>{used.map((f) => <th scope="col">{fieldWord(f.name, f.help)}<u><code>{f.name}</code> {unitWord(f.unit)}</u></th>)}</tr></thead>
				<tbody>{table.rows.map((r) => <tr class={link.state.condition === r.name ? "inforce" : ""}><th scope="row">{r.name}{link.state.condition === r.name && <em>{t("tech.inforce")}</em>}</th>
					{used.map((f) => <Cell row={r} field={f} edits={edits} onEdit={setEdits} key={f.name} />)}</tr>)}</tbody></table></div>
			{table.notes.map((n) => <p class="note ofshop">{n}</p>)}
		</Card>
		<Compare rows={table.rows.map((r) => ({ ...r, values: { ...r.values, ...Object.fromEntries(Object.entries(edits).filter(([k]) => k.startsWith(`${r.name}.`)).map(([k, x]) => [k.slice(r.name.length + 1), x])) } }))} fields={used} />
		<Versions file={tech.file} again={again} />
		{table.sequences.length > 0 && <Card title={t("tech.sequences")}>{table.sequences.map((q) => <p class="sequence"><b>Q{q.number}</b>{q.steps.map((x) => <span>{x}</span>)}</p>)}</Card>}
	</div>;
}
