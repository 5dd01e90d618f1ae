// SPDX-License-Identifier: Apache-2.0
//
// The host and the cycle: lateness, what the host lacks, log, who did what.
import type { JSX } from "preact";
import { moment, number } from "./format";
import { link } from "./link";
import { Card, Choice, Key } from "./parts";
import { change, save, useAsk, useSettings, type Settings } from "./use";
import { isWord, said, t } from "./words";

interface Finding { what: string; verdict: string; found: string; mend: string }
interface Note { t: number; text: string }
interface Line { MESSAGE: string; _SYSTEMD_UNIT: string; __REALTIME_TIMESTAMP: string }

/** Counts are shown by their logarithm, so that a single late wake is seen. */
function Histogram(p: { bins: number[] }): JSX.Element {
	const last = p.bins.reduce((m, n, i) => n ? i : m, 0);
	const width = Math.max(1, Math.ceil((last + 1) / 64)), bars: number[] = [];
	for (let i = 0; i <= last; i += width) bars.push(p.bins.slice(i, i + width).reduce((a, b) => a + b, 0));
	const top = Math.log10(Math.max(...bars, 9) + 1), n = Math.max(bars.length, 16), w = 640 / n;
	const total = p.bins.reduce((a, b) => a + b, 0);
	return <figure class="histogram"><svg viewBox="0 0 640 170" role="img" aria-label={t("chart.latency")} preserveAspectRatio="none">
		{bars.map((b, i) => b > 0 && <rect x={i * w + 1} y={150 - Math.log10(b + 1) / top * 140} width={Math.max(w - 2, 1)} height={Math.log10(b + 1) / top * 140} />)}<path d="M0 150.5h640" /></svg>
		<figcaption><span>0 {"\u00b5s"}</span><span>{total} {t("machine.count")}</span><span>{n * width}{last === 255 ? "+" : ""} {"\u00b5s"}</span></figcaption></figure>;
}

function Latency(): JSX.Element {
	const [bins] = useAsk<number[]>("latency", {}, 2000);
	const s = link.state;
	return <Card title={t("machine.latency")}><p class="note">{t("machine.latency.about")}</p>
		{bins && <Histogram bins={bins} />}
		<dl class="facts"><dt>{t("machine.late")}</dt><dd>{s.lateMaxUs} {"\u00b5s"}</dd><dt>{t("machine.took")}</dt><dd>{s.tookMaxUs} {"\u00b5s"}</dd>
			<dt>{t("machine.missed")}</dt><dd>{s.overruns}</dd><dt>{t("machine.period")}</dt><dd>{number(s.periodUs, 0)} {"\u00b5s"}</dd></dl></Card>;
}

function Doctor(): JSX.Element {
	const [rows, refused] = useAsk<Finding[]>("doctor", {}, 30000);
	return <Card title={t("machine.doctor")}>{!rows && <p class="calm">{refused || t("machine.doctoring")}</p>}
		<ul class="findings">{rows?.map((f) => <li class={f.verdict}><b>{said(f.what)}</b><em>{isWord(`verdict.${f.verdict}`) ? t(`verdict.${f.verdict}` as "verdict.good") : f.verdict}</em><p>{said(f.found)}</p>{f.mend && <code>{said(f.mend)}</code>}</li>)}</ul></Card>;
}

function Acts(): JSX.Element {
	const [rows] = useAsk<Note[]>("notes", {}, 3000);
	return <Card title={t("machine.acts")}>{rows?.length === 0 && <p class="calm">{t("machine.noacts")}</p>}
		<div class="scroll tall" tabIndex={0} role="region" aria-label={t("machine.acts")}><table class="list"><thead><tr><th scope="col">{t("alarms.when")}</th><th scope="col">{t("alarms.what")}</th></tr></thead><tbody>{rows?.map((n) => <tr><td class="when">{moment(n.t)}</td><td>{said(n.text)}</td></tr>)}</tbody></table></div></Card>;
}

function Log(): JSX.Element {
	const [rows, refused] = useAsk<Line[]>("log", {}, 10000);
	return <Card title={t("machine.log")}>{(refused || rows?.length === 0) && <p class="calm">{refused || t("machine.nolog")}</p>}
		<div class="scroll tall" tabIndex={0} role="region" aria-label={t("machine.log")}><table class="list"><thead><tr><th scope="col">{t("alarms.when")}</th><th scope="col">{t("alarms.what")}</th></tr></thead><tbody>{[...(rows ?? [])].reverse().map((l) => <tr><td class="when">{moment(Number(l.__REALTIME_TIMESTAMP) / 1000)}</td><td><code>{l._SYSTEMD_UNIT?.replace(".service", "")}</code> {l.MESSAGE}</td></tr>)}</tbody></table></div></Card>;
}

async function bundle(): Promise<void> {
	const what = ["doctor", "latency", "notes", "log", "alarms", "queue", "past", "tech"];
	const got = await Promise.all(what.map((w) => link.ask(w, w === "past" ? { arg: 100 } : {})));
	const all = { at: new Date().toISOString(), hello: link.hello, state: link.state, ...Object.fromEntries(what.map((w, i) => [w, got[i]?.body ?? got[i]?.reason])) };
	save(`edm-${link.hello?.machine}-${Date.now()}.json`, "application/json", JSON.stringify(all, null, 1));
}

function Browser(): JSX.Element {
	const s = useSettings(), h = link.hello;
	return <Card title={t("machine.settings")}>
		<div class="setting"><span>{t("machine.language")}</span><Choice label={t("machine.language")} value={s.language} onChange={(language: Settings["language"]) => change({ language })} of={[{ value: "en", text: "English" }, { value: "zh-CN", text: "\u4e2d\u6587" }]} /></div>
		<div class="setting"><span>{t("machine.theme")}</span><Choice label={t("machine.theme")} value={s.theme} onChange={(theme: Settings["theme"]) => change({ theme })} of={(["auto", "light", "dark"] as const).map((v) => ({ value: v, text: t(`theme.${v}`) }))} /></div>
		<dl class="facts"><dt>{t("machine.user")}</dt><dd>{h && t("bracket", { what: h.user, is: t(`role.${h.role}`) })}</dd><dt>{t("machine.versions")}</dt><dd>edm-panel {h?.version}</dd>
			<dt>{t("machine.kind")}</dt><dd>{t(h?.simulated ? "machine.simulated" : "machine.real")}</dd></dl>
		<div class="keys"><Key onPress={() => void bundle()}>{t("machine.bundle")}</Key>{link.session?.login && <Key class="quiet" onPress={() => void link.logout()}>{t("machine.logout")}</Key>}</div></Card>;
}

export function Machine(): JSX.Element {
	return <div class="machine-grid"><div><Browser /><Latency /></div><div><Doctor /><Acts /><Log /></div></div>;
}
