// SPDX-License-Identifier: Apache-2.0
//
// Programs: drop one, check it, mend it where it stands, send it; the queue and
// what has been.
import type { JSX } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { whyNot } from "./can";
import { clock, duration, moment, number, parse } from "./format";
import { table } from "./history";
import type { Came, Fault, Used } from "./history";
import { link } from "./link";
import { fitName, ownLines, unitOf } from "./names";
import { Card, Choice, Key, NumberField, PressKey, Sheet, act } from "./parts";
import { PathView } from "./pathview";
import { Picture } from "./picture";
import { TextSheet } from "./textview";
import { save, say, useAsk, usePages } from "./use";
import { faultWords, fieldWord, jobWord, list, refused, said, t } from "./words";

interface Checked { ok: boolean; where?: string; line: number; column: number; found: string; wanted: string; check?: string; lines?: number; length?: number; cut?: number; rapid?: number }
interface Draft { name: string; text: string; file: File | null; checked: Checked | null; busy: string; line: string; set: Record<string, string> }
interface Job { setting?: string; electrodes?: Used[]; n: number; job: string; name: string; state: string; hold: boolean; lines: number; submitted_us: number; begun_us: number; ended_us: number; reason: string; path_mm: number; length_mm: number; depth_mm: number; job_s: number; forecast_s?: number | null; forecast_why?: string; jumps: number; retracts: number; shorts: number; erode_s?: number | null; arcs?: number | null; energy_j?: number | null; conditions?: Came[]; faults?: Fault[]; changes?: { utime: number; place_mm: number; what: string; was: number | null; now: number | null }[] }

const EDITOR_MAX = 2 << 20, FILE_MAX = 64 << 20;

// Of this browser, and there when the page is left and opened again.
let draft: Draft | null = null;
const heard = new Set<() => void>();

function put(d: Draft | null): void {
	draft = d;
	for (const h of heard) h();
}

function useDraft(): Draft | null {
	const [, again] = useState(0);
	useEffect(() => {
		let n = 0;
		const h = () => again(++n);
		heard.add(h);
		return () => { heard.delete(h); };
	}, []);
	return draft;
}

function broken(e: unknown): string {
	return e instanceof Error && e.message === "connection" ? t("no.connection") : String(e);
}

/** What is set for a job: docs/3b.md has the words. */
function setting(d: Draft): string {
	const word = (k: string, v: string) => v === "" ? [] : [`${k}=${Number.isNaN(parse(v)) ? v : parse(v)}`];
	return encodeURIComponent(Object.entries(d.set).flatMap(([k, v]) => word(k, v.trim())).join(" "));
}

let turn = 0;

async function check(): Promise<void> {
	const d = draft, my = ++turn;
	if (!d) return;
	put({ ...d, busy: t("jobs.checking") });
	try {
		const c = await link.post<Checked>(`/api/check?name=${encodeURIComponent(d.name)}&set=${setting(d)}`, d.file ?? new Blob([d.text]));
		if (my === turn && draft) put({ ...draft, busy: "", checked: c });
	} catch (e) {
		if (my === turn && draft) put({ ...draft, busy: "", checked: { ok: false, line: 0, column: 0, found: broken(e), wanted: t("again") } });
	}
}

/** A file that was dropped or chosen: it is checked at once. */
export async function takeFile(f: File): Promise<void> {
	if (f.size > FILE_MAX) { say(t("jobs.toolong"), true); return; }
	const short = f.size <= EDITOR_MAX;
	put({ name: fitName(f.name), text: short ? ownLines(await f.text()) : "", file: short ? null : f, checked: null, busy: "", line: "", set: {} });
	await check();
}

/** G code that a form made: checked, then sent. */
export async function sendText(name: string, text: string, start: boolean): Promise<boolean> {
	const d: Draft = { name, text, file: null, checked: null, busy: "", line: "", set: {} };
	try {
		const c = await link.post<Checked>(`/api/check?name=${encodeURIComponent(name)}`, new Blob([text]));
		if (c.ok) return await send(d, start);
		const why = t("also", { one: c.found, other: c.wanted });
		say(c.line > 0 ? t("pair", { what: t("jobs.errorat", { line: c.line, column: c.column }), is: why }) : why, true);
	} catch (e) {
		say(broken(e), true);
	}
	return false;
}

async function send(d: Draft, start: boolean): Promise<boolean> {
	interface Sent { code?: number; reason?: string; job?: string; found?: string; wanted?: string; body?: Checked }
	const progress = (share: number) => { if (draft) put({ ...draft, busy: t("jobs.sending", { share: Math.round(share * 100) }) }); };
	try {
		// Held first, so that what starts it is the press of a person.
		const a = await link.post<Sent>(`/api/jobs?hold=1&name=${encodeURIComponent(d.name)}&line=${Number(d.line) || 0}&set=${setting(d)}`, d.file ?? new Blob([d.text]), progress);
		if (a.code !== 0) { say(said(a.reason ?? t("also", { one: a.found ?? "", other: a.wanted ?? "" })), true); if (draft) put({ ...draft, busy: "" }); return false; }
		say(d.line ? a.reason ?? "" : t("jobs.sent", { name: d.name }));
		if (start) await begin(a.job as string);
	} catch (e) {
		say(broken(e), true);
		if (draft) put({ ...draft, busy: "" });
		return false;
	}
	return true;
}

// It takes a moment until it is loaded and can be started.
async function begin(job: string): Promise<void> {
	for (let i = 0; i < 40; i++) {
		if (link.state.job === job && link.state.loaded && link.state.state === "hold") break;
		await new Promise((r) => setTimeout(r, 100));
	}
	if (await act("start", { job })) location.hash = "#/cut";
}

function Editor(p: { draft: Draft; error: Checked | null }): JSX.Element {
	const area = useRef<HTMLTextAreaElement>(null), gutter = useRef<HTMLDivElement>(null);
	const lines = p.draft.text.split("\n");
	const goTo = () => {
		const a = area.current, e = p.error;
		if (!a || !e || e.line < 1) return;
		const line = lines[e.line - 1] ?? "", at = unitOf(line, e.column);
		const from = lines.slice(0, e.line - 1).reduce((n, l) => n + l.length + 1, 0) + at;
		a.focus();
		a.setSelectionRange(from, from + Math.max(1, line.slice(at).match(/^\S+/)?.[0].length ?? 1));
		a.scrollTop = Math.max(0, (e.line - 4) * 22);
	};
	useEffect(goTo, [p.error]);
	const many = lines.length, numbers = useMemo(() => Array.from({ length: many }, (_, i) => i + 1).join("\n"), [many]);
	return <div class="editor"><div class="gutter" ref={gutter} aria-hidden="true"><pre>{numbers}</pre>
		{p.error && p.error.line > 0 && <i class="bad" style={{ top: `${(p.error.line - 1) * 22 + 8}px` }}>{p.error.line}</i>}</div>
		<textarea ref={area} id="editor" spellcheck={false} autocapitalize="off" wrap="off" aria-label={t("jobs.editor")} value={p.draft.text}
			onScroll={(e) => { if (gutter.current) gutter.current.scrollTop = e.currentTarget.scrollTop; }}
			onInput={(e) => { turn++; put({ ...p.draft, text: e.currentTarget.value, checked: null, busy: "" }); }} /></div>;
}

const SETTINGS = [["taper", "\u00b0"], ["wire-offset", "mm"], ["scale", ""], ["turn", "\u00b0"], ["plane", "mm"], ["second-plane", "mm"]] as const;
const MIRRORS = ["none", "x", "y", "exchange"] as const;

/** What the program has no words for: of a wire. */
function Setting(p: { draft: Draft }): JSX.Element {
	const put1 = (k: string, v: string) => { turn++; put({ ...p.draft, checked: null, busy: "", set: { ...p.draft.set, [k]: v } }); };
	return <details id="setting" open={Object.values(p.draft.set).some((v) => v !== "")}><summary>{t("jobs.set")}</summary>
		<div class="keys wrap">{SETTINGS.map(([k, unit]) => <NumberField id={`set-${k}`} label={t(`jobs.set.${k}`)} unit={unit} value={p.draft.set[k] ?? ""} onInput={(v) => put1(k, v)} />)}
			<Choice label={t("jobs.set.mirror")} value={p.draft.set["mirror"] || "none"} onChange={(v) => put1("mirror", v === "none" ? "" : v)} of={MIRRORS.map((m) => ({ value: m, text: t(`jobs.mirror.${m}`) }))} /></div>
	</details>;
}

function New(): JSX.Element {
	const d = useDraft(), input = useRef<HTMLInputElement>(null);
	const choose = <><input ref={input} id="file" type="file" class="hidden" tabIndex={-1} aria-label={t("jobs.choose")} onChange={(e) => {
		const f = e.currentTarget.files?.[0];
		e.currentTarget.value = "";
		if (f) void takeFile(f);
	}} /><Key onPress={() => input.current?.click()}>{t("jobs.choose")}</Key></>;
	// A change of the text is checked when the hand rests.
	useEffect(() => {
		if (!d || d.checked || d.busy || d.file) return;
		const timer = setTimeout(() => void check(), 700);
		return () => clearTimeout(timer);
	}, [d]);
	if (!d) return <Card title={t("jobs.new")} class="dropzone"><p class="calm">{t("jobs.drop")}</p>{choose}</Card>;
	const c = d.checked, why = c && !c.ok ? t("jobs.checkfirst") : d.busy || !c ? t("jobs.checking") : whyNot("send");
	const line = d.line && !/^[1-9]\d{0,8}$/.test(d.line.trim()) ? t("jobs.line.wanted") : "";
	return <Card title={d.name} class="draft" right={<div class="keys">{choose}<Key class="quiet" onPress={() => put(null)}>{t("close")}</Key></div>}>
		<div class="draft-grid">
			{d.file ? <p class="calm">{t("jobs.large")}</p> : <Editor draft={d} error={c && !c.ok ? c : null} />}
			<div class="preview">{c?.ok && c.check ? <PathView query={`check=${c.check}`} title={t("jobs.preview")} still /> : <p class="empty">{d.busy || t("jobs.preview")}</p>}</div>
		</div>
		<div class="verdict" role="status" aria-live="polite">
			{d.busy && <p>{d.busy}</p>}
			{!d.busy && c?.ok && <p class="good">{t("jobs.ok", { lines: c.lines ?? 0, mm: number(c.length ?? 0, 2) })} {t("jobs.sum", { cut: number(c.cut ?? 0, 2), rapid: number(c.rapid ?? 0, 2) })}</p>}
			{!d.busy && c && !c.ok && <div class="refusal"><b>{c.line > 0 ? t("jobs.errorat", { line: c.line, column: c.column }) : c.where}</b><p>{refused(c.found)}</p><p><i>{t("pair", { what: t("jobs.accepted"), is: "" })}</i> {refused(c.wanted)}</p></div>}
		</div>
		{link.hello?.process === 1 && <Setting draft={d} />}
		<div class="keys end"><NumberField id="fromline" label={t("jobs.line")} value={d.line} onInput={(line) => put({ ...d, line })} />
			<Key id="send" why={why || line} onPress={() => void send(d, false).then((ok) => { if (ok) put(null); })}>{t("jobs.send")}</Key>
			<PressKey id="sendstart" class="primary" why={why || line || (d.line ? t("jobs.line.look") : link.state.loaded ? t("no.loaded") : "")} onPress={() => void send(d, true).then((ok) => { if (ok) put(null); })}>{t("jobs.sendstart")}</PressKey></div>
	</Card>;
}

function energy(j: number | null | undefined): string {
	return typeof j === "number" ? `${number(j / 1000, 3)} kJ` : t("jobs.notcounted");
}

function Sums(p: { job: Job }): JSX.Element {
	const came = p.job.conditions ?? [], faults = p.job.faults ?? [], used = p.job.electrodes ?? [];
	return <>{came.length > 0 && <><h3>{t("jobs.conditions")}</h3><div class="scroll"><table class="list" id="conditions"><thead><tr><th scope="col">{t("cut.condition")}</th>{(["jobs.time", "cut.retracts", "cut.shorts", "jobs.energy"] as const).map((w) => <th scope="col" class="n">{t(w)}</th>)}</tr></thead><tbody>{came.map((c) =>
		<tr><td>{c.condition || "\u2013"}</td><td class="n">{duration(c.job_s)}</td><td class="n">{c.retracts}</td><td class="n">{c.shorts}</td><td class="n">{energy(c.energy_j)}</td></tr>)}</tbody></table></div></>}
		{faults.length > 0 && <><h3>{t("jobs.faults")}</h3><div class="scroll"><table class="list" id="jobfaults"><thead><tr><th scope="col">{t("alarms.when")}</th><th scope="col">{t("alarms.what")}</th><th scope="col" class="n">{t("cut.line")}</th><th scope="col" class="n">{t("cut.path")}</th></tr></thead><tbody>{faults.map((f) =>
			<tr><td class="when">{moment(f.utime / 1000)}</td><td>{faultWords(f.fault).what}</td><td class="n">{f.line}</td><td class="n">{number(f.place_mm, 3)} mm</td></tr>)}</tbody></table></div></>}
		{used.length > 0 && <><h3>{t("el.used")}</h3><div class="scroll"><table class="list" id="jobelectrodes"><thead><tr>{(["el.n", "el.wear", "el.sparked", "el.shift"] as const).map((w) => <th scope="col" class="n">{t(w)}</th>)}</tr></thead><tbody>{used.map((e) =>
			<tr><td class="n">{e.electrode || t("el.none")}</td><td class="n">{e.known ? `${number(e.wear_before_mm, 4)} \u2192 ${number(e.wear_after_mm, 4)} mm` : "\u2013"}</td><td class="n">{duration(e.sparked_s)}</td><td class="n">{number(e.shift_mm, 4, true)} mm</td></tr>)}</tbody></table></div></>}
	</>;
}

/* A condition has a name of its own, a value that of its field. */
function changeWord(what: string): string {
	const f = link.hello?.fields.find((x) => x.name === what);
	return f ? fieldWord(f.name, f.help) : said(what);
}

function Details(p: { id: string; name: string; onClose: () => void }): JSX.Element {
	const [j] = useAsk<Job>("show", { job: p.id });
	const [reads, read] = useState(false);
	return <Sheet title={t("jobs.details", { name: p.name })} onClose={p.onClose} wide>{j && <>
		<dl class="facts"><dt>{t("jobs.state")}</dt><dd>{jobWord(j.state)}</dd>{j.setting && <><dt>{t("jobs.set")}</dt><dd>{j.setting}</dd></>}{j.reason && <><dt>{t("jobs.reason")}</dt><dd>{said(j.reason)}</dd></>}
			<dt>{t("jobs.time")}</dt><dd>{duration(j.job_s)}</dd><dt>{t("jobs.length")}</dt><dd>{number(j.path_mm ?? 0, 3)} {t("of")} {number(j.length_mm ?? 0, 3)} mm</dd>
			{link.hello?.process !== 1 && <><dt>{t("jobs.depth")}</dt><dd>{number(j.depth_mm ?? 0, 3)} mm</dd><dt>{t("cut.jumps")}</dt><dd>{j.jumps ?? 0}</dd></>}<dt>{t("cut.retracts")}</dt><dd>{j.retracts ?? 0}</dd><dt>{t("cut.shorts")}</dt><dd>{j.shorts ?? 0}</dd>
			<dt>{t("jobs.arcs")}</dt><dd>{j.arcs ?? "\u2013"}</dd><dt>{t("jobs.energy")}</dt><dd>{energy(j.energy_j)}</dd></dl>
		<Picture job={p.id} size={220} />
		<div class="keys"><Key id="jobtext" onPress={() => read(true)}>{t("jobs.text")}</Key></div>
		{reads && <TextSheet job={p.id} lines={j.lines} at={1} onClose={() => read(false)} />}
		<Sums job={j} />
		<h3>{t("jobs.changes")}</h3>
		{(j.changes ?? []).length === 0 ? <p class="calm">{t("jobs.nochanges")}</p> : <div class="scroll"><table class="list" id="jobchanges"><thead><tr><th scope="col">{t("alarms.when")}</th><th scope="col">{t("alarms.what")}</th>{(["jobs.setwas", "jobs.setis", "cut.path"] as const).map((w) => <th scope="col" class="n">{t(w)}</th>)}</tr></thead><tbody>{j.changes?.map((c) =>
			<tr><td class="when">{moment(c.utime / 1000)}</td><td>{changeWord(c.what)}</td><td class="n">{c.was ?? ""}</td><td class="n">{c.now ?? ""}</td><td class="n">{number(c.place_mm, 3)} mm</td></tr>)}</tbody></table></div>}
	</>}</Sheet>;
}

/** The operator answers for the places of axes that nothing can home.  Then the
 * job is ready, and the page Cut has its Start. */
export function ResumeSheet(p: { id: string; onClose: () => void }): JSX.Element {
	const [job] = useAsk<Job>("show", { job: p.id });
	const axes = link.state.lost, letters = [...axes].join(" ");
	const go = async () => {
		const ok = await act("resume", { job: p.id, text: axes });
		p.onClose();
		if (ok) location.hash = "#/cut";
	};
	return <Sheet title={t("pair", { what: t("jobs.resume"), is: job?.name ?? "" })} onClose={p.onClose}>
		<p>{t("jobs.resume.about")}</p><p>{said(job?.reason ?? "")}</p>
		{axes && <p class="note warn">{t("alarms.lost", { axes: letters })}</p>}
		<div class="keys end"><PressKey id="resumejob" class="primary" why={whyNot("send")} onPress={() => void go()}>{axes ? t("jobs.resume.sure", { axes: letters }) : t("jobs.resume")}</PressKey></div>
	</Sheet>;
}

/* As a time, or why there is none yet. */
function takes(j: Job): string {
	const s = j.forecast_s;
	return j.state === "running" ? "" : typeof s !== "number" ? "\u2026" : s < -1 ? "\u2026" : s < 0 ? t("jobs.noforecast", { why: j.forecast_why ?? "" }) : duration(s);
}

const WAYS = [
	{ arg: -2, sign: "\u21e7", word: "jobs.front" }, { arg: -1, sign: "\u2191", word: "jobs.ahead" },
	{ arg: 1, sign: "\u2193", word: "jobs.behind" }, { arg: 2, sign: "\u21e9", word: "jobs.back" },
] as const;

/* Page by page: what is gone is on none any more. */
async function clearQueue(): Promise<void> {
	for (;;) {
		const a = await link.ask<Job[]>("queue");
		const waits = a.code === 0 ? a.body.filter((j) => j.state === "queued") : [];
		if (waits.length === 0) return;
		for (const j of waits) if (!await act("remove", { job: j.job })) return;
	}
}

function Queue(p: { open: (j: Job) => void }): JSX.Element {
	const s = link.state;
	const [resumed, resume] = useState("");
	const { rows, refused, again, next } = usePages<Job>("queue", { turn: `${s.job}${s.jobState}${s.queue}` }, 3000);
	const waiting = (rows ?? []).filter((o) => o.state === "queued").length;
	const clear = waiting > 1 ? <PressKey id="queueclear" class="small quiet" why={whyNot("send")} onPress={() => void clearQueue().then(again)}>{t("jobs.clear")}</PressKey> : undefined;
	return <Card title={t("jobs.queue")} right={clear}>{refused && <p class="note">{refused}</p>}
		{rows && rows.length === 0 && <p class="calm">{t("jobs.empty")}</p>}
		<ul class="jobs">{(rows ?? []).map((j) => <li key={j.job}><button type="button" class="job" onClick={() => p.open(j)}><b>{j.name}</b><span>{list([jobWord(j.state), j.hold && j.state !== "running" ? t("jobs.waits") : ""])}</span><span class="n">{takes(j)}</span></button>
			{j.state === "queued" && waiting > 1 && WAYS.map((w) =>
				<Key class="small quiet" label={t(w.word, { name: j.name })} why={whyNot("send")} onPress={() => void act("move", { job: j.job, arg: w.arg }).then(again)}>{w.sign}</Key>)}
			{j.state === "interrupted" && <Key class="small" why={whyNot("send")} onPress={() => resume(j.job)}>{t("jobs.resume")}</Key>}
			{["running", "held", "fault"].includes(j.state) && <PressKey class="small" why={whyNot("end")} onPress={() => void act("stop").then(again)}>{t("end")}</PressKey>}
			{["queued", "ready", "interrupted"].includes(j.state) && <Key class="small quiet" why={whyNot("send")} onPress={() => void act("remove", { job: j.job }).then(again)}>{t("remove")}</Key>}</li>)}</ul>
		{s.queueS > 0 && <p class="timenote" id="queuetotal">{t("jobs.total", { time: duration(s.queueS + Math.max(0, s.eta)), at: s.queueEnd * 1000 - Date.now() > 20 * 3600e3 ? moment(s.queueEnd * 1000) : clock(s.queueEnd * 1000) })}{s.queueUntold > 0 && ` ${t("jobs.untold", { n: s.queueUntold })}`}</p>}
		{next && <Key class="quiet" onPress={next}>{t("jobs.more")}</Key>}
		{resumed && <ResumeSheet id={resumed} onClose={() => { resume(""); again(); }} />}
	</Card>;
}

const OUTCOMES = ["done", "stopped", "fault"] as const;

/* Words that are all in name, outcome, day, electrode; and what that sums to. */
function Search(p: { words: string; look: (w: string) => void }): JSX.Element {
	const [months, by] = useState(false);
	const [open, set] = useState(false);
	const has = (w: string) => p.words.split(" ").includes(w);
	const turn = (w: string) => p.look(has(w) ? p.words.split(" ").filter((x) => x !== w).join(" ") : [...p.words.split(" ").filter((x) => !OUTCOMES.includes(x as "done")), w].join(" ").trim());
	return <><div class="search"><input id="historywords" type="search" value={p.words} maxLength={60} placeholder={t("jobs.search")} aria-label={t("jobs.search")} onInput={(e) => p.look(e.currentTarget.value)} />
		{OUTCOMES.map((o) => <Key class={has(o) ? "small primary" : "small quiet"} onPress={() => turn(o)}>{jobWord(o)}</Key>)}
		<Key id="totals" class={open ? "small primary" : "small quiet"} onPress={() => set(!open)}>{t("jobs.totals")}</Key></div>
		{open && <Totals words={p.words} months={months} by={by} />}</>;
}

interface Total { time: string; jobs: number; done: number; job_s: number; erode_s: number; energy_j: number | null }

function Totals(p: { words: string; months: boolean; by: (m: boolean) => void }): JSX.Element {
	const [rows] = useAsk<Total[]>("totals", { text: p.words, arg: p.months ? 1 : 0 });
	return <><Choice label={t("jobs.totals")} value={p.months ? "m" : "d"} onChange={(v) => p.by(v === "m")} of={[{ value: "d", text: t("jobs.days") }, { value: "m", text: t("jobs.months") }]} />
		<div class="scroll"><table class="list" id="totalrows"><thead><tr><th scope="col">{t(p.months ? "jobs.month" : "jobs.day")}</th>{(["page.jobs", "job.done", "jobs.time", "jobs.eroding", "jobs.energy"] as const).map((w) => <th scope="col" class="n">{t(w)}</th>)}</tr></thead>
			<tbody>{(rows ?? []).map((r) => <tr><td>{r.time}</td><td class="n">{r.jobs}</td><td class="n">{r.done}</td><td class="n">{duration(r.job_s)}</td><td class="n">{duration(r.erode_s)}</td><td class="n">{energy(r.energy_j)}</td></tr>)}</tbody></table></div></>;
}

function History(p: { open: (j: Job) => void }): JSX.Element {
	const [words, look] = useState("");
	const { rows, refused, next } = usePages<Job>("past", { arg: 50, text: words, turn: link.state.job + link.state.jobState }, 5000);
	const [why, tell] = useState("");
	const download = () => void table().then((a) => {
		tell("refused" in a ? a.refused : "");
		if ("csv" in a) save(`edm-${link.hello?.machine}-history.csv`, "text/csv", a.csv);
	});
	return <Card title={t("jobs.history")} right={rows && rows.length > 0 ? <Key id="historycsv" class="small quiet" label={t("jobs.csv")} onPress={download}>CSV</Key> : undefined}>{why && <p class="note">{why}</p>}{refused && <p class="note">{refused}</p>}
		<Search words={words} look={look} />
		{rows && rows.length === 0 && <p class="calm">{t(words ? "jobs.nofound" : "jobs.nohistory")}</p>}
		<ul class="jobs">{(rows ?? []).map((j) => <li key={j.job}><button type="button" class="job" onClick={() => p.open(j)}><Picture job={j.job} size={44} /><b>{j.name}</b>
			<span class={`job-${j.state}`}>{jobWord(j.state)}</span><span class="when">{moment(j.ended_us / 1000)}</span><span class="n">{duration(j.job_s)}</span></button></li>)}</ul>
		{next && <Key class="quiet" onPress={next}>{t("jobs.more")}</Key>}
	</Card>;
}

export function Jobs(): JSX.Element {
	const [open, set] = useState<Job | null>(null);
	return <div class="jobs-grid"><New /><div class="two"><Queue open={set} /><History open={set} /></div>
		{open && <Details id={open.job} name={open.name} onClose={() => set(null)} />}</div>;
}
