// SPDX-License-Identifier: Apache-2.0
//
// What is wrong, why, and what clears it; and what was wrong before.
import type { JSX } from "preact";
import { whyNot } from "./can";
import { moment, number } from "./format";
import { link } from "./link";
import { Card, Key, PressKey, act, standNow } from "./parts";
import { hasWarning, stateLine, storeWhy } from "./stateline";
import { useAsk } from "./use";
import { faultWords, huntingWords, isWord, list, said, t } from "./words";

/* What it was: a fault by its name, all else by its kind. */
function kindWord(a: Alarm): string {
	const word = `event.${a.kind}`;
	return a.kind === "alarm" ? faultWords(a.fault).what : isWord(word) ? t(word) : a.kind;
}

interface Alarm { utime: number; kind: string; job: string; fault: string; place_mm: number; text: string }

function Now(): JSX.Element {
	const s = link.state, w = faultWords(s.fault), text = standNow();
	const others = s.faults.split(" ").filter((f) => f && f !== s.fault);
	if (s.fault === "none") return <Card title={t("alarms.now")}><p class="calm">{s.daemon === "ok" && link.connection === "open" ? t("alarms.none") : stateLine().why}</p></Card>;
	return <Card title={t("alarms.now")} class="alarm-now">
		<h3><span class="dot cross" aria-hidden="true" />{w.what} <code>{s.fault}</code></h3>
		<dl><dt>{t("alarms.why")}</dt><dd>{w.why}</dd><dt>{t("alarms.clear")}</dt><dd>{w.clear}</dd>
			{others.length > 0 && <><dt>{t("alarms.others")}</dt><dd>{list(others.map((f) => faultWords(f).what))}</dd></>}
			{s.job && <><dt>{t("alarms.where")}</dt><dd>{t("alarms.inline", { job: s.jobName, line: s.line, mm: number(s.place, 3) })}</dd></>}</dl>
		<div class="keys"><Key id="reset" class="primary" why={whyNot("reset")} onPress={() => void act("reset")}>{t("reset")}</Key>
			<PressKey id="start" why={whyNot("start")} onPress={() => void act("start", { job: s.job, text })}>{t("resume")}</PressKey></div>
		<p class="note">{t("alarms.resetgo")}</p>
	</Card>;
}

function Warning(p: { title: string; text: string }): JSX.Element {
	return <><h3>{p.title}</h3><p>{p.text}</p></>;
}

/** What a person should look at, though nothing is latched. */
function Warnings(): JSX.Element | null {
	const s = link.state, store = storeWhy();
	if (!hasWarning()) return null;
	return <Card title={t("alarms.warnings")} class="warnings">
		{s.interrupted && <Warning title={t("alarms.interrupted")} text={t("why.interrupted")} />}
		{s.lost && <Warning title={t("alarms.lost", { axes: [...s.lost].join(" ") })} text={t("alarms.lost.about")} />}
		{store && <Warning title={t("alarms.store")} text={t("why.store", { why: store })} />}
		{s.hunts > 0 && <Warning title={t("alarms.hunts")} text={huntingWords()} />}
	</Card>;
}

export function Alarms(): JSX.Element {
	const [rows, refused] = useAsk<Alarm[]>("alarms", { fault: link.state.fault }, 4000);
	return <div class="column">
		<Now />
		<Warnings />
		<Card title={t("alarms.history")}>
			{refused && <p class="note">{refused}</p>}
			{rows && rows.length === 0 && <p class="calm">{t("alarms.empty")}</p>}
			{rows && rows.length > 0 && <div class="scroll"><table class="list"><thead><tr><th scope="col">{t("alarms.when")}</th><th scope="col">{t("alarms.what")}</th></tr></thead><tbody>{rows.map((a) => <tr>
				<td class="when">{moment(a.utime / 1000)}</td><td><b>{kindWord(a)}</b>{a.kind !== "back" && <p>{said(a.text)}</p>}</td></tr>)}</tbody></table></div>}
		</Card>
	</div>;
}
