// SPDX-License-Identifier: Apache-2.0
//
// Before the cut: home, jog, probe, offsets.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { whyNot } from "./can";
import { ElectrodeCard } from "./electrodes";
import { number, parse, short } from "./format";
import { link, type Axis } from "./link";
import { LOOK_MS, OffsetCard, WORKS, WorkChoice, useWork, type Row as OffsetRow } from "./offsets";
import { Card, Choice, HoldKey, Key, NumberField, PressKey, act } from "./parts";
import { beginPress } from "./press";
import { PROBES, isWhole, type Probe, type ProbeId, type Values } from "./probes";
import { say, useAsk, useDraft } from "./use";
import { jobWord, said, t, type Word } from "./words";

const STEPS = ["0.001", "0.01", "0.1", "1", "10"] as const;

const SPEEDS = { slow: 0.05, middle: 0.3, fast: 1 } as const;
type Speed = keyof typeof SPEEDS;

function JogKey(p: { axis: Axis; way: number; step: string; speed: Speed }): JSX.Element {
	const why = whyNot("jog"), name = `${p.axis.name}${p.way > 0 ? "+" : "\u2212"}`;
	const id = `jog-${p.axis.name}-${p.way > 0 ? "plus" : "minus"}`;
	if (p.step === "hold")
		return <HoldKey class="jogkey" why={why} label={`${name} ${t("setup.held")}`} id={id}
			onHold={(over) => beginPress(p.axis.name, p.way * p.axis.jog * SPEEDS[p.speed], over)}>{name}</HoldKey>;
	return <Key class="jogkey" why={why} label={`${name} ${p.step}`} id={id}
		onPress={() => void act("jog", { text: p.axis.name, arg: p.way * Number(p.step) })}>{name}</Key>;
}

function AxisState(p: { axis: Axis }): JSX.Element | null {
	const s = link.state, a = p.axis;
	const word = s.limit >> a.index & 1 ? "setup.limit" : s.lost.includes(a.name) ? "setup.lost" : s.unhomed >> a.index & 1 ? "setup.unhomed" : a.homes ? "setup.homed" : "";
	return word === "" ? null : <span class={`axis-state ${word === "setup.homed" ? "" : "warn"}`}>{t(word)}</span>;
}

function JogCard(): JSX.Element {
	const [step, set] = useState<string>("0.1"), [speed, setSpeed] = useState<Speed>("slow");
	const axes = link.hello?.axes ?? [], held = step === "hold", { place } = useWork();
	return <Card title={t("setup.jog")} class="jog" right={<><WorkChoice /><Key class="small" why={whyNot("hold")} onPress={() => void act("hold")}>{t("hold")}</Key></>}>
		<Choice label={t("setup.faster")} value={step} onChange={set} of={[...STEPS.map((v) => ({ value: v as string, text: short(Number(v)) })), { value: "hold", text: t("setup.held") }]} />
		{held && <Choice label={t("setup.speed")} value={speed} onChange={setSpeed} of={(Object.keys(SPEEDS) as Speed[]).map((v) => ({ value: v, text: t(`speed.${v}`) }))} />}
		<table class="axes"><tbody>{axes.map((a) => <tr key={a.name}><th scope="row">{a.name}</th>
			<td><JogKey axis={a} way={-1} step={step} speed={speed} /></td>
			<td class="n">{number(place(a), 3, true)}<u>{a.rotary ? "deg" : "mm"}</u><small class="mach">{t("work.machine")} {number(link.state.pos[a.index] ?? 0, 3, true)}</small><AxisState axis={a} /></td>
			<td><JogKey axis={a} way={1} step={step} speed={speed} /></td></tr>)}</tbody></table>
		<p class="note">{whyNot("jog") || (held ? t("setup.held.about") : "")}</p>
	</Card>;
}

/* An axis that nothing homes stands where a person says. */
function PlaceRow(p: { axis: Axis }): JSX.Element {
	const [text, set] = useState(""), mm = parse(text), a = p.axis;
	return <div class="keys wrap place">
		{link.state.lost.includes(a.name) && <PressKey id={`seen-${a.name}`} why={whyNot("home")} onPress={() => void act("place", { text: `${a.name} as-seen`, arg: 0 })}>{t("place.seen")}</PressKey>}
		<NumberField label={t("place.at", { axis: a.name })} unit={a.rotary ? "deg" : "mm"} value={text} onInput={set} />
		<PressKey id={`place-${a.name}`} why={Number.isFinite(mm) ? whyNot("home") : t("probe.bad")} onPress={() => { void act("place", { text: `${a.name} is`, arg: mm }); set(""); }}>{t("place.set")}</PressKey></div>;
}

function PlaceCard(): JSX.Element | null {
	const axes = (link.hello?.axes ?? []).filter((a) => !a.homes);
	if (!axes.length) return null;
	return <Card title={t("place.title")} class="places"><p class="note">{t("place.about")}</p>
		{axes.map((a) => <PlaceRow key={a.name} axis={a} />)}</Card>;
}

function HomeCard(): JSX.Element | null {
	const axes = (link.hello?.axes ?? []).filter((a) => a.homes);
	if (!axes.length) return null;
	return <Card title={t("setup.home")}><div class="keys wrap">
		<PressKey class="primary" why={whyNot("home")} onPress={() => void act("home")}>{t("setup.homeall")}</PressKey>
		{axes.map((a) => <PressKey why={whyNot("home")} onPress={() => void act("home", { text: a.name })}>{t("setup.home")} {a.name}</PressKey>)}</div></Card>;
}

/** What the cycle does, drawn: the work hatched, the electrode as a ring. */
function Drawing(p: { id: ProbeId; v: Record<string, string> }): JSX.Element {
	const minus = p.v.way === "-";
	const art: Record<ProbeId, JSX.Element> = {
		edge: p.v.axis === "Z" ? <g transform={minus ? "" : "translate(0 120) scale(1 -1)"}><rect class="work" x="20" y="80" width="160" height="30" /><circle class="tool" cx="100" cy="30" r="12" /><path class="way" d="M100 44v24m-5 -7 5 7 5 -7" /></g> :
			<g transform={(minus ? "" : "translate(200 0) scale(-1 1)") + (p.v.axis === "Y" ? " rotate(-90 100 60)" : "")}><rect class="work" x="20" y="15" width="40" height="90" /><circle class="tool" cx="150" cy="60" r="12" /><path class="way" d="M134 60H68m7 -5 -7 5 7 5" /></g>,
		hole: <g><path class="work" fill-rule="evenodd" d="M30 8h140v104H30zM100 18a42 42 0 1 0 .1 0z" /><circle class="tool" cx="92" cy="64" r="10" /><path class="way" d="M104 64h32m-6 -4 6 4 -6 4M80 64H62m6 -4 -6 4 6 4M92 52V24m-4 6 4 -6 4 6M92 76v20m-4 -6 4 6 4 -6" /><path class="cross" d="M96 60h8m-4 -4v8" /></g>,
		block: <g><rect class="work" x="62" y="28" width="76" height="64" /><circle class="tool" cx="100" cy="60" r="9" /><path class="way" d="M26 60h30m-6 -4 6 4 -6 4M174 60h-30m6 -4 -6 4 6 4M100 6v16m-4 -6 4 6 4 -6M100 114V98m-4 6 4 -6 4 6" /><path class="cross" d="M96 60h8m-4 -4v8" /></g>,
		length: <g><rect class="work" x="20" y="92" width="160" height="20" /><path class="tool" d="M78 12h44v18h-8v40h-28V30h-8z" /><path class="way" d="M100 73v15m-5 -6 5 6 5 -6M140 30v40m-4 -36 4 -4 4 4M136 66l4 4 4 -4" /></g>,
		skew: <g><path class="work" d="M16 84 184 68v46H16z" /><circle class="tool" cx="50" cy="40" r="10" /><circle class="tool" cx="150" cy="32" r="10" /><path class="way" d="M50 52v24m-5 -7 5 7 5 -7M150 44v21m-5 -7 5 7 5 -7M66 22h66m-7 -5 7 5 -7 5" /></g>,
		middle: <g><circle class="work" cx="100" cy="60" r="26" /><rect class="tool" x="82" y="46" width="28" height="28" /><path class="way" d="M30 60h38m-6 -4 6 4 -6 4M170 60h-38m6 -4 -6 4 6 4M100 6v20m-4 -6 4 6 4 -6M100 114V94m-4 6 4 -6 4 6" /><path class="cross" d="M96 60h8m-4 -4v8" /></g>,
		straight: <g><circle class="work" cx="100" cy="98" r="12" /><path class="tool" d="M40 40 150 30l2 26L42 66z" /><path class="way" d="M60 70v24m-5 -7 5 7 5 -7M140 62v22m-5 -7 5 7 5 -7M168 20a30 30 0 0 1 8 34m-7 -3 7 3 3 -8" /></g>,
		corner: <g transform={`translate(100 60) scale(${p.v.wayX === "-" ? -1 : 1} ${p.v.wayY === "-" ? 1 : -1}) translate(-100 -60)`}><path class="work" d="M130 10h40v102H20V84h110z" /><circle class="tool" cx="90" cy="44" r="11" /><path class="way" d="M104 44h20m-6 -4 6 4 -6 4M90 58v20m-4 -6 4 6 4 -6" /></g>,
	};
	return <svg class="drawing" viewBox="0 0 200 120" aria-hidden="true">{art[p.id]}</svg>;
}

/* What a touch off is about to change, and what it has made of it. */
type Before = Record<string, number>;
interface Felt { job: string; target: string; was: Before }

interface Seat { n: number; length_mm: number; wear_mm: number; x_mm: number; y_mm: number; c_deg: number }

/* The values of these keys, of a system or of the electrode in the holder. */
function useBefore(target: string, electrode: boolean, keys: string[]): [Before, () => void] {
	const held = link.state.electrode;
	const [rows, , look] = useAsk<OffsetRow[]>("offsets", {}, LOOK_MS);
	const [own, , lookOwn] = useAsk<Seat[]>("electrodes", { arg: Math.max(0, held - 1) }, LOOK_MS);
	const e = own?.find((x) => x.n === held);
	const row: Record<string, unknown> = electrode ? { ...e, long_mm: e && e.length_mm - e.wear_mm } : { ...rows?.find((r) => r.work === target) };
	const now: Before = Object.fromEntries(keys.filter((key) => typeof row[key] === "number").map((key) => [key, row[key] as number]));
	return [now, () => { look(); lookOwn(); }];
}

const NAMES: Record<string, Word> = { turn_deg: "off.turn", tilt_x_deg: "off.tiltx", tilt_y_deg: "off.tilty", long_mm: "el.length", x_mm: "el.x", y_mm: "el.y", c_deg: "el.c" };

function nameOf(key: string): string {
	return NAMES[key] ? t(NAMES[key]) : key;
}

function unitOf(key: string): string {
	return key.endsWith("_deg") || "ABC".includes(key) ? "\u00b0" : " mm";
}

/* Such a job, until it is over: why it failed, or "done". */
function useOver(job: string, over: () => void): string {
	const [state, set] = useState("");
	useEffect(() => {
		let live = true;
		set("");
		const look = async () => {
			const a = await link.ask<{ state: string; reason: string }>("show", { job });
			if (!live || a.code !== 0 || !["done", "stopped", "fault", "interrupted"].includes(a.body.state)) return;
			clearInterval(timer);
			set(a.body.state === "done" ? "done" : said(a.body.reason) || jobWord(a.body.state));
			over();
		};
		const timer = job ? setInterval(() => void look(), 400) : 0;
		return () => { live = false; clearInterval(timer); };
	}, [job]);
	return state;
}

function Changes(p: { target: string; felt: Felt | null; state: string; now: Before }): JSX.Element {
	const { felt, now } = p, done = felt && p.state === "done";
	const value = (x: number | undefined, key: string) => x === undefined ? "\u2013" : number(x, key.endsWith("_deg") ? 4 : 3) + unitOf(key);
	return <div class="felt" role="status"><table class="list"><thead><tr><th scope="col">{p.target}</th><th scope="col" class="n">{t(done ? "touch.was" : "touch.now")}</th>{done && <th scope="col" class="n">{t("touch.is")}</th>}</tr></thead>
		<tbody>{Object.keys(now).map((a) => <tr key={a}><th scope="row">{nameOf(a)}</th><td class="n">{value(done ? felt.was[a] : now[a], a)}</td>{done && <td class="n"><b>{value(now[a], a)}</b></td>}</tr>)}</tbody></table>
		{felt && p.state !== "done" && <p class={p.state ? "warn" : "note"}>{p.state ? t("touch.failed", { why: p.state }) : t("touch.feels")}</p>}</div>;
}

function hasAxis(name: string): boolean {
	return !!link.hello?.axes.some((a) => a.name === name);
}

function ProbeForm(p: { probe: Probe }): JSX.Element {
	const [v, set] = useDraft<Values>(`probe.${p.probe.id}`, Object.fromEntries(p.probe.asks.map((a) => [a.key, a.preset])));
	const [work, into] = useDraft<string>("probe.work", "G54"), [felt, feel] = useState<Felt | null>(null);
	const own = !!p.probe.electrode, target = own ? `T${link.state.electrode}` : work;
	const [now, look] = useBefore(target, own, p.probe.shows(v)), state = useOver(felt?.job ?? "", look);
	const whole = isWhole(p.probe, v), words = whole ? [target, ...p.probe.words(v)] : [];
	const why = !whole ? t("probe.bad") : own && !link.state.electrode ? t("touch.none") : whyNot("jog") || whyNot("send");
	const change = (key: string, text: string) => set({ ...v, [key]: text });
	const run = async () => {
		const a = await link.ask("offset", { text: words.join("\n") });
		if (a.code !== 0) say(a.reason === "connection" ? t("no.connection") : said(a.reason), true);
		else feel({ job: a.reason, target, was: now });
	};
	return <div class="probe"><div class="probe-top"><Drawing id={p.probe.id} v={v} /><p>{t(`probe.${p.probe.id}.about`)}</p></div>
		<div class="fields">{!own && <label class="field"><span>{t("touch.into")}</span><select id="touch-into" value={work} onChange={(e) => { into(e.currentTarget.value); feel(null); }}>{WORKS.map((w) => <option key={w} value={w}>{w}</option>)}</select></label>}
			{p.probe.asks.filter((a) => !a.when || a.when(v)).map((a) => a.choices ? <label class="field"><span>{t(a.label)}</span><Choice class="wrap" label={t(a.label)} value={v[a.key] ?? ""} onChange={(x) => change(a.key, x)} of={a.choices.filter((c) => !/^[XYZ]$/.test(c) || hasAxis(c)).map((c) => ({ value: c, text: c === "new" || c === "worn" ? t(`touch.${c}`) : c.replace("-", "\u2212") }))} /></label> :
			<NumberField key={a.key} label={a.may ? t("bracket", { what: t(a.label), is: t("probe.nozero") }) : t(a.label)} unit={a.unit} value={v[a.key] ?? ""} onInput={(x) => change(a.key, x)} />)}</div>
		<Changes target={target} felt={felt} state={state} now={now} />
		<p class="note">{t("probe.warn")}</p>
		<div class="keys end"><PressKey id="probe-run" class="primary" why={why} onPress={() => void run()}>{t("touch.run")}</PressKey></div>
	</div>;
}

function ProbeCard(): JSX.Element {
	const [at, set] = useDraft<ProbeId>("probe", "edge");
	const probe = PROBES.find((x) => x.id === at) as Probe;
	return <Card title={t("setup.probe")} class="probing" right={<select id="probe-form" aria-label={t("setup.probe")} value={at} onChange={(e) => set(e.currentTarget.value as ProbeId)}>
		{PROBES.filter((x) => !x.electrode || hasAxis("Z")).map((x) => <option key={x.id} value={x.id}>{t(`probe.${x.id}`)}</option>)}</select>}>
		<ProbeForm probe={probe} key={at} /></Card>;
}

/* Lines of this browser, newest first; there when the page is opened again. */
const LAST_MAX = 6;
let lastLines: string[] = [];

function MdiCard(): JSX.Element {
	const [line, set] = useDraft("mdi", ""), [ran, run] = useDraft("mdi.ran", { job: "", line: "" });
	const state = useOver(ran.job, () => undefined), text = line.trim();
	const why = !text ? t("mdi.none") : whyNot("jog") || whyNot("send");
	const go = async () => {
		const a = await link.ask("mdi", { text });
		if (a.code !== 0) { say(a.reason === "connection" ? t("no.connection") : said(a.reason), true); return; }
		lastLines = [text, ...lastLines.filter((l) => l !== text)].slice(0, LAST_MAX);
		run({ job: a.reason, line: text });
		set("");
	};
	const told = !ran.job ? "" : t(state === "" ? "mdi.runs" : state === "done" ? "mdi.done" : "mdi.failed", { line: ran.line, why: state });
	return <Card title={t("mdi.title")} class="mdi"><p class="note">{t("mdi.about")}</p>
		<div class="keys"><label class="field"><span>{t("mdi.line")}</span><span class="box"><input id="mdi" autocomplete="off" autocapitalize="characters" spellcheck={false} maxLength={200} value={line} onInput={(e) => set(e.currentTarget.value)} /></span></label>
			<PressKey id="mdi-run" class="primary" why={why} onPress={() => void go()}>{t("mdi.run")}</PressKey></div>
		{told && <p role="status" class={state && state !== "done" ? "note warn" : "note"}>{told}</p>}
		{lastLines.length > 0 && <div class="keys wrap" role="group" aria-label={t("mdi.last")}>{lastLines.map((l) => <Key key={l} class="small quiet code" onPress={() => set(l)}>{l}</Key>)}</div>}</Card>;
}

export function Setup(): JSX.Element {
	return <div class="setup-grid"><div><JogCard /><MdiCard /><HomeCard /><PlaceCard /><ElectrodeCard /></div><div><ProbeCard /><OffsetCard /></div></div>;
}
