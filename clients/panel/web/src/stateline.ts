// SPDX-License-Identifier: Apache-2.0
//
// One line that says how it is: the state, why it waits, what to do.
import { number, short, unitWord } from "./format";
import { link } from "./link";
import { isRunning } from "./can";
import { electrodeKnown, lineKnown } from "./lines";
import { faultWords, fieldWord, isWord, list, stateWord, t } from "./words";

// Stands that somebody confirms.
const CONFIRMED = new Set(["electrode", "setting"]);

export interface StateLine {
	title: string; why: string;
	tone: "calm" | "busy" | "warn" | "bad";
	shape: "square" | "bars" | "play" | "cross" | "ring";
}

function unhomed(): string {
	const bits = link.state.unhomed;
	return (link.hello?.axes ?? []).filter((a) => bits >> a.index & 1).map((a) => a.name).join(" ");
}

/** Why the store cannot write; "" if it can. */
export function storeWhy(): string {
	const s = link.state.store;
	return s === "" || s === "ok" ? "" : s.replace(/^degraded: /, "");
}

/** Is there what a person should look at, though no fault is latched? */
export function hasWarning(): boolean {
	const s = link.state;
	return !!(s.interrupted || s.lost || s.hunts > 0 || storeWhy());
}

function idle(): string {
	const { lost } = link.state;
	if (lost) return t("why.idle.lost", { axes: [...lost].join(" ") });
	if (unhomed()) return t("why.idle.unhomed", { axes: unhomed() });
	return t(link.state.queue > 0 ? "why.idle.queue" : "why.idle");
}

function held(): StateLine {
	const s = link.state, ready = s.stand === "ready";
	return {
		title: ready ? t("state.ready") : stateWord("hold"), tone: "warn", shape: "bars",
		why: ready ? t("why.ready", { job: s.jobName || s.job }) : stands() || t("why.hold"),
	};
}

/** Why it stands or waits, and what ends that; "" if it does not. */
function stands(): string {
	const s = link.state, word = `stand.${s.stand}${s.asks || !CONFIRMED.has(s.stand) ? "" : ".done"}`;
	return isWord(word) ? t(word, { n: named(s.standOf), line: s.line, said: says(), by: heldBy(), held: s.electrode ? named(s.electrode) : t("el.none"), condition: s.condition, fields: fieldsOf(s.standOf) }) : "";
}

/* What the program says about its stop. */
function says(): string {
	const comment = lineKnown(link.state.job, link.state.line).match(/\(([^)]*)\)|;(.*)/);
	const text = (comment?.[1] ?? comment?.[2] ?? "").trim();
	return text && t("pair", { what: "", is: text });
}

/* Whose command it was, if the machine knows. */
function heldBy(): string {
	const who = link.state.asksFor.match(/held by command of ([^;]+);/)?.[1];
	return who ? t("bracket", { what: "", is: who }) : "";
}

/* An electrode with what the table calls it. */
function named(n: number): string {
	const is = electrodeKnown(n);
	return is ? t("bracket", { what: String(n), is }) : String(n);
}

function fieldsOf(bits: number): string {
	return list((link.hello?.fields ?? []).filter((_, i) => bits >> i & 1).map((f) => {
		const value = link.state.values[f.name];
		return fieldWord(f.name, f.help) + (value === undefined ? "" : ` ${short(value)} ${unitWord(f.unit)}`);
	}));
}

function machineLine(): StateLine {
	const s = link.state;
	if (link.connection !== "open")
		return { title: t("lost.title"), why: t("why.connection"), tone: "warn", shape: "ring" };
	if (s.daemon !== "ok")
		return { title: stateWord("unknown"), why: t(s.daemon === "lost" ? "why.lost" : "why.absent"), tone: "warn", shape: "ring" };
	if (s.state === "fault") {
		const w = faultWords(s.fault);
		return { title: w.what[0]!.toUpperCase() + w.what.slice(1), why: w.clear, tone: "bad", shape: "cross" };
	}
	if (s.state === "idle" && s.interrupted)
		return { title: t("state.interrupted"), why: t("why.interrupted"), tone: "warn", shape: "bars" };
	if (s.state === "idle" && storeWhy())
		return { title: stateWord("idle"), why: t("why.store", { why: storeWhy() }), tone: "warn", shape: "ring" };
	if (s.state === "idle") return { title: stateWord("idle"), why: idle(), tone: s.lost ? "warn" : "calm", shape: "ring" };
	if (s.state === "hold" && !isRunning()) return held();
	const word = `why.${s.state}`;
	if (s.stand) return { title: t("state.waits"), tone: "warn", shape: "bars", why: stands() };
	return {
		title: stateWord(s.state), tone: "busy", shape: s.state === "erode" ? "play" : "square",
		why: isWord(word) ? t(word, { line: s.line, mm: number(s.values.jump_mm ?? 0, 1) }) : "",
	};
}

/** What keeps commands away comes first: somebody may have to stop the machine. */
export function stateLine(): StateLine {
	const line = machineLine(), s = link.state;
	if (link.connection !== "open" || s.jobs) return line;
	return {
		...line, why: t(s.daemon === "ok" ? "why.nojobs" : "why.noway"),
		tone: line.tone === "bad" ? "bad" : "warn",
	};
}
