// SPDX-License-Identifier: Apache-2.0
//
// The first page: the path, the gap, the feed, and the keys of a cut.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { isRunning, whyNot } from "./can";
import { Strip } from "./chart";
import { clock, duration, moment, number, parse, short } from "./format";
import { ResumeSheet } from "./jobs";
import { link, type Axis, type Point } from "./link";
import { useLine } from "./lines";
import { Card, Choice, Key, NumberField, PressKey, Sheet, Toasts, act, standNow } from "./parts";
import { WorkChoice, useWork } from "./offsets";
import { PathView } from "./pathview";
import { TextSheet } from "./textview";
import { useAsk } from "./use";
import { ValueSheet, ValuesSheet } from "./values";
import { t } from "./words";

const RETRACTS = [0.5, 1, 2, 5, 10];

/* What changes from moment to moment is not shown as it was. */
function isKnown(): boolean {
	return link.connection === "open" && link.state.daemon === "ok";
}

function isWire(): boolean {
	return link.hello?.process === 1;
}

function Gap(p: { onOpen: () => void }): JSX.Element {
	const s = link.state, v = s.values;
	const known = isKnown();
	const top = Math.max(v.ignition_v ?? 0, (v.open_v ?? 60) * 1.3) * 0.5 > (v.open_v ?? 60) ? (v.open_v ?? 60) * 1.4 : (v.open_v ?? 60) * 1.25;
	const share = (x: number) => `${Math.min(100, Math.max(0, x / top * 100))}%`;
	const low = v.window_low_v || v.servo_v || 0, high = v.window_high_v || v.servo_v || 0;
	return <Card class="gap" label={t("cut.gap")}>
		<div class="reading"><h2><button type="button" onClick={p.onOpen}>{t("cut.gap")}</button></h2><p><b>{known ? number(s.gap, 1) : "\u2013"}</b> <u>V</u> {known && <em>{t(s.power ? "cut.sparks" : "cut.nosparks")}</em>}</p></div>
		<div class="bar gapbar" aria-hidden="true">
			<i class="window" style={{ left: share(Math.min(low, (v.servo_v ?? 0) - top * 0.01)), right: `calc(100% - ${share(Math.max(high, (v.servo_v ?? 0) + top * 0.01))})` }} />
			<i class="mark" style={{ left: share(v.short_v ?? 0) }} /><i class="mark" style={{ left: share(v.open_v ?? 0) }} />
			{known && <i class={`pointer ${s.gap > top ? "over" : ""}`} style={{ left: share(s.gap) }} />}
		</div>
		<div class="barwords" aria-hidden="true"><span style={{ left: share(v.short_v ?? 0) }}>{t("cut.short")}</span>
			<span class="servo" style={{ left: share(v.servo_v ?? 0) }}>{t("cut.servo")} {short(v.servo_v ?? 0)}</span>
			<span style={{ left: share(v.open_v ?? 0) }}>{t("cut.open")}</span></div>
		<button type="button" class="stripkey" onClick={p.onOpen} aria-label={t("chart.gap")}>
			<Strip points={link.points} at={1} colour="--acc" label={t("chart.gap")} height={62} span={60} lines={[v.servo_v ?? 0]} clip={[0, top]} /></button>
	</Card>;
}

let cutSeen: object | null = null, cutFeed = NaN;

/* While it cuts: the feed of the cut alone, smoothed.  A jump or a retract
 * leaves it as it was. */
function feedOfCut(): number {
	const s = link.state;
	if (!["erode", "jump", "retract", "approach"].includes(s.state)) { cutFeed = NaN; return s.feed; }
	if (s.state === "erode" && s !== cutSeen) cutFeed = Number.isNaN(cutFeed) ? s.feed : cutFeed + (s.feed - cutFeed) * 0.1;
	cutSeen = s;
	return Number.isNaN(cutFeed) ? s.feed : cutFeed;
}

function Feed(p: { onOpen: () => void }): JSX.Element {
	const s = link.state, v = s.values;
	const feed = feedOfCut() * 60, slow = Math.abs(feed) < 100, most = Math.max(v.feed_max_mm_s ?? 0.5, 0.1);
	const span = Math.abs(s.feed) > most * 1.5 ? Math.max(v.retract_mm_s ?? 5, Math.abs(s.feed)) : most;
	const share = Math.min(50, Math.abs(s.feed) / span * 50);
	const height = link.hello?.height ?? 0;
	// An axis that is homed or moved by hand is on no path.
	const along = isKnown() && s.loaded;
	const way = feed > 1e-4 ? "cut.forward" : feed < -1e-4 ? "cut.back" : "cut.still";
	return <Card class="feed" label={t("cut.feed")}>
		<div class="reading"><h2><button type="button" onClick={p.onOpen}>{t("cut.feed")}</button></h2><p><b>{along ? number(feed, slow ? 2 : 0, true) : "\u2013"}</b> <u>mm/min</u> {along && <em>{height > 0 ? `${number(feed * height, 1, true)} mm\u00b2/min` : t(way)}</em>}</p></div>
		<div class="bar feedbar" aria-hidden="true"><i class={s.feed < 0 ? "flow back" : "flow"} style={s.feed < 0 ? { right: "50%", width: `${share}%` } : { left: "50%", width: `${share}%` }} /><i class="zero" /></div>
		<button type="button" class="stripkey" onClick={p.onOpen} aria-label={t("chart.feed")}>
			<Strip points={link.points} at={4} colour="--done" label={t("chart.feed")} height={44} span={60} lines={[0]} clip={[-most * 1.2, most * 1.2]} /></button>
	</Card>;
}

function axisWord(a: Axis): string {
	const s = link.state;
	return s.limit >> a.index & 1 ? t("setup.limit") : s.lost.includes(a.name) ? t("setup.lost") : s.unhomed >> a.index & 1 ? t("setup.unhomed") : "";
}

function Positions(): JSX.Element {
	const s = link.state, axes = link.hello?.axes ?? [], { place } = useWork();
	return <Card class={`positions ${axes.length > 3 ? "many" : ""} ${axes.length > 6 ? "most" : ""}`} label={t("cut.position")}><div class="workhead"><WorkChoice /><span>{t("work.machine")}</span></div><ul>
		{axes.map((a) => <li key={a.name}><b>{a.name}</b>
			<span class="n">{number(place(a), 3, true)}</span><u>{a.rotary ? "deg" : "mm"}</u>
			<small class="mach" title={t("cut.machine")}>{number(s.pos[a.index] ?? 0, 3, true)}</small>
			<em title={axisWord(a)}>{axisWord(a)}</em></li>)}
	</ul></Card>;
}
/* Before ground was cut it is a range. */
function left(): string {
	const s = link.state;
	return s.eta < 0 || s.etaBy === "cut" ? duration(s.eta) : `${duration(s.etaMin)}\u2013${duration(s.etaMax)}`;
}

// When it ends, and by what that is known.
function TimeNote(): JSX.Element | null {
	const s = link.state, words: string[] = [];
	if (s.eta < 0) return null;
	if (s.end > 0) words.push(t("time.end", { at: s.end * 1000 - Date.now() > 20 * 3600e3 ? moment(s.end * 1000) : clock(s.end * 1000) }));
	const what = s.etaCondition === "positioning" ? t("time.positioning") : s.etaCondition || t("time.cutting"), of = number(s.etaFactor, 2);
	if (s.etaBy === "forecast") words.push(t("time.forecast"));
	else if (s.etaBy === "learnt") words.push(t("time.learnt", { what, of }));
	else if (Math.abs(s.etaFactor - 1) > 0.1) words.push(t("time.cut", { what, of }));
	return words.length ? <p class="timenote">{words.join(t("time.and"))}</p> : null;
}

function Sums(): JSX.Element {
	const s = link.state;
	return <Card class="sums" label={t("cut.done")}>
		<div class="three">{isWire() ? <div><span>{t("cut.lean")}</span><p><b>{number(s.lean, 2)}</b> <u>deg</u></p></div> :
			<div><span>{t("cut.depth")}</span><p><b>{number(s.depth, 3)}</b> <u>mm</u></p>{s.depthFar > s.depth + 5e-4 && <small>{t("cut.deepest", { mm: number(s.depthFar, 3) })}</small>}</div>}
			<div><span>{t("cut.done")}</span><p><b>{number(s.progress * 100, 1)}</b> <u>%</u></p></div>
			<div><span>{t("cut.left")}</span><p><b>{left()}</b></p></div></div>
		<TimeNote />
		<div class="counts">{s.pass > 0 && <span id="pass">{t("cut.pass")} <b>{s.pass}</b> {t("of")} <b>{s.passes}</b></span>}{isWire() && s.wireOffset !== 0 && <span id="wireoffset">{t("cut.offset")} <b>{number(s.wireOffset, 4)}</b> mm</span>}{!isWire() && <span>{t("cut.jumps")} <b>{s.jumps}</b></span>}<span>{t("cut.retracts")} <b>{s.retracts}</b></span>
			<span>{t("cut.shorts")} <b>{s.shorts}</b></span><span>{t("cut.time")} <b>{duration(s.jobS)}</b></span>{s.electrode > 0 && <span id="held">{t("cut.electrode")} <b>{s.electrode}</b></span>}</div>
	</Card>;
}

function Past(p: { onClose: () => void }): JSX.Element {
	const [span, set] = useState<"60" | "600" | "3600">("600");
	const [rows] = useAsk<Point[]>("history", { seconds: Number(span), points: 900 }, 2000);
	return <Sheet title={t("cut.past")} onClose={p.onClose} wide>
		<Choice label={t("cut.past")} value={span} onChange={set} of={[{ value: "60", text: t("range.60") }, { value: "600", text: t("range.600") }, { value: "3600", text: t("range.3600") }]} />
		<h3>{t("cut.gap")} <u>V</u></h3><Strip points={rows ?? []} at={1} colour="--acc" label={t("chart.gap")} height={190} axes span={Number(span)} />
		<h3>{t("cut.feed")} <u>mm/min</u></h3><Strip points={rows ?? []} at={4} colour="--done" label={t("chart.feed")} height={190} axes span={Number(span)} />
	</Sheet>;
}

function RetractSheet(p: { onClose: () => void }): JSX.Element {
	const [text, set] = useState("1");
	const mm = parse(text);
	const ok = mm > 0 && mm <= 10000;
	const go = (x: number) => { void act("retract", { arg: x }); p.onClose(); };
	return <Sheet title={t("cut.retractby")} onClose={p.onClose}>
		<p>{t("cut.retractnote")}</p>
		<div class="keys wrap">{RETRACTS.map((x) => <PressKey onPress={() => go(x)} why={whyNot("retract")}>{short(x)} mm</PressKey>)}</div>
		<div class="keys"><NumberField label={t("cut.retractby")} unit="mm" value={text} onInput={set} />
			<PressKey class="primary" onPress={() => go(mm)} why={ok ? whyNot("retract") : t("probe.bad")}>{t("retract")}</PressKey></div>
		<h3>{t("cut.step")}</h3>
		<div class="keys"><Key onPress={() => void act("step", { arg: -1 })} why={whyNot("retract")}>{"\u2212"}1</Key>
			<Key onPress={() => void act("step", { arg: 1 })} why={whyNot("retract")}>+1</Key></div>
		<div class="keys end"><PressKey class="danger" onPress={() => { void act("stop"); p.onClose(); }} why={whyNot("end")}>{t("end")}</PressKey></div>
	</Sheet>;
}

function OverrideSheet(p: { onClose: () => void }): JSX.Element {
	return <Sheet title={t("cut.override")} onClose={p.onClose}><p>{t("cut.override.about")}</p>
		<div class="keys wrap">{[10, 25, 50, 75, 100, 125, 150, 200].map((x) => <Key class={Math.round(link.state.override * 100) === x ? "primary" : ""}
			why={whyNot("estop")} onPress={() => { void act("override", { arg: x / 100 }); p.onClose(); }}>{x} %</Key>)}</div></Sheet>;
}

interface Chip { id: string; label: string; text: string; open: string }

function chips(): Chip[] {
	const s = link.state, v = s.values;
	const f = (name: string, unit: string) => v[name] === undefined ? "\u2013" : `${short(v[name] as number)} ${unit}`;
	const wire = [{ id: "height", label: t("cut.height"), text: `${short(link.hello?.height ?? 0)} mm`, open: "*" }];
	const jump = [{ id: "jump_mm", label: t("cut.jump"), text: v.jump_mm === undefined ? "\u2013" : `${short(v.jump_mm)} mm / ${short(v.jump_every_s ?? 0)} s`, open: "jump_mm jump_every_s" }];
	const speed = { id: "override", label: t("cut.override"), text: `${number(s.override * 100, 0)} %`, open: "%" };
	return [
		...(s.override === 0 ? [speed] : []),
		{ id: "condition", label: t("cut.condition"), text: s.condition || "\u2013", open: "*" },
		{ id: "peak_a", label: t("cut.peak"), text: f("peak_a", "A"), open: "peak_a" },
		{ id: "on_us", label: t("cut.onoff"), text: v.on_us === undefined ? "\u2013" : `${short(v.on_us)} / ${short(v.off_us ?? 0)} \u00b5s`, open: "on_us off_us" },
		{ id: "servo_v", label: t("cut.servochip"), text: f("servo_v", "V"), open: "servo_v" },
		...(isWire() ? wire : jump),
		...(s.override === 0 ? [] : [speed]),
	];
}

// What ends the state that it is in, if it is not the start.
function Middle(p: { open: (what: string) => void }): JSX.Element {
	const s = link.state;
	if (s.state === "idle" && s.interrupted) return <Key id="resume" class="primary" why={whyNot("send")} onPress={() => p.open("resume")}>{t("jobs.resume")}</Key>;
	if (s.state === "fault") return <Key id="reset" class="primary" why={whyNot("reset")} onPress={() => void act("reset")}>{t("reset")}</Key>;
	if (!s.asks) return <Key id="hold" why={whyNot("hold")} onPress={() => void act("hold")}>{t("hold")}</Key>;
	const electrode = s.stand === "electrode", text = standNow();
	return <PressKey id="done" class="primary" why={whyNot("retract")} onPress={() => void act("done", { arg: electrode ? s.standOf : 0, text })}>
		{!electrode ? t("done.set") : s.standOf ? t("done.electrode", { n: s.standOf }) : t("done.empty")}</PressKey>;
}

function Foot(p: { open: (what: string) => void }): JSX.Element {
	const s = link.state, held = s.state === "hold" && s.far > 0, text = standNow();
	return <div class="bottom"><Toasts /><footer class="foot">
		<div class="chips">{chips().map((c) => <button type="button" id={`chip-${c.id}`} class={`chip ${c.id === "override" && s.override === 0 ? "zero" : ""} ${s.set.some((f) => c.open.split(" ").includes(f)) ? "set" : ""}`} onClick={() => p.open(c.open)}>
			<span>{c.label}</span><b>{c.text}</b></button>)}</div>
		<div class="keys">
			<Key id="retract" why={whyNot("retract")} onPress={() => p.open("retract")}>{t("more")}</Key>
			<Middle open={p.open} />
			<PressKey id="start" class={isRunning() || s.asks ? "" : "primary"} why={whyNot("start")} note={isRunning() ? t("cut.runs") : undefined}
				onPress={() => void act("start", { job: s.job, text })}>{t(held ? "resume" : "start")}</PressKey>
		</div>
	</footer></div>;
}

export function Cut(): JSX.Element {
	const [open, set] = useState("");
	const s = link.state;
	const shown = s.program > 0 && s.loaded;
	const line = useLine(shown ? s.job : "", s.line);
	const foot = shown ? <div class="progress"><p><button type="button" class="codekey" title={line} onClick={() => set("text")}><code>{line}</code></button><span>{number(s.far, 2)} {t("of")} {number(s.length, 2)} mm{"\u2002"}{number(Math.max(0, s.length - s.far), 2)} {t("cut.togo")}</span></p>
		<div class="bar"><i class="done" style={{ width: `${Math.min(100, s.progress * 100)}%` }} /></div></div> : null;
	return <>
		<div class="cut-grid">
			<section class="card view" aria-label={t("cut.path")}>
				<PathView query={shown ? `program=${s.program}` : ""} job={s.job} place={s.place} far={s.far} electrode={s.pos.length ? s.pos : null} foot={foot}
					title={shown ? <>{s.jobName || t("cut.nojob")}{s.line > 0 && <> {"\u00b7"} {t("cut.line")} {s.line} {t("of")} {s.lines}</>}</> : t("cut.nojob")} />
			</section>
			<div class="cut-side"><Gap onOpen={() => set("past")} /><Feed onOpen={() => set("past")} /><Positions /><Sums /></div>
		</div>
		<Foot open={set} />
		{open === "past" && <Past onClose={() => set("")} />}
		{open === "retract" && <RetractSheet onClose={() => set("")} />}
		{open === "resume" && <ResumeSheet id={s.interrupted} onClose={() => set("")} />}
		{open === "%" && <OverrideSheet onClose={() => set("")} />}
		{open === "text" && <TextSheet job={s.job} lines={s.lines} at={s.line} onClose={() => set("")} />}
		{open === "*" && <ValuesSheet onClose={() => set("")} />}
		{open && !["past", "retract", "resume", "%", "*", "text"].includes(open) && <ValueSheet names={open.split(" ")} onClose={() => set("")} onMore={() => set("*")} />}
	</>;
}

