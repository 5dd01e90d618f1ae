// SPDX-License-Identifier: Apache-2.0
//
// The machines that are heard over DDS: who needs a person comes first.
import type { JSX } from "preact";
import { number } from "./format";
import { Card } from "./parts";
import { useAsk } from "./use";
import { faultWords, stateWord, t } from "./words";

interface Row { machine: string; state: string; fault?: string; job?: string; progress?: number; line?: number; depth_mm?: number; lost?: boolean; [k: string]: unknown }

const RANK = ["fault", "lost", "absent", "hold", "idle"];

function rank(r: Row): number {
	const at = RANK.indexOf(r.state);
	return at < 0 ? RANK.length : at;
}

function Tile(p: { row: Row }): JSX.Element {
	const r = p.row, done = typeof r.progress === "number" ? r.progress : 0;
	const needs = rank(r) < 4;
	return <Card class={`tile ${r.state === "fault" ? "bad" : needs ? "warn" : ""}`} label={r.machine}>
		<h2>{r.machine}</h2><p class="tile-state">{stateWord(r.state)}{needs && <em>{t("fleet.needs")}</em>}</p>
		{r.fault && r.fault !== "none" && <p>{faultWords(r.fault).what}</p>}
		<div class="bar"><i class="done" style={{ width: `${done * 100}%` }} /></div>
		<p class="note">{number(done * 100, 1)} % {t("fleet.progress")}</p>
	</Card>;
}

export function Fleet(): JSX.Element {
	const [got, refused] = useAsk<Row[] | { machines: Row[] }>("fleet", {}, 6000);
	const rows = Array.isArray(got) ? got : got?.machines;
	return <div class="column">
		{!rows && <Card title={t("page.fleet")}><p class="calm">{refused || t("fleet.looking")}</p></Card>}
		{rows && rows.length === 0 && <Card title={t("page.fleet")}><p class="calm">{t("fleet.none")}</p></Card>}
		<div class="tiles">{[...(rows ?? [])].sort((a, b) => rank(a) - rank(b) || a.machine.localeCompare(b.machine)).map((r) => <Tile row={r} key={r.machine} />)}</div>
	</div>;
}
