// SPDX-License-Identifier: Apache-2.0
//
// What the pages share: the state as a hook, settings of this browser, toasts.
import { useEffect, useState } from "preact/hooks";
import { link } from "./link";

/** Renders again whenever something came over the link. */
export function useLink(): typeof link {
	const [, again] = useState(0);
	useEffect(() => link.listen(() => again(link.version)), []);
	return link;
}

const drafts = new Map<string, unknown>();

/** A state that is there again when its page is, by its name: what somebody has
 *  begun to write must not be lost by looking at another page. */
export function useDraft<T>(name: string, first: T): [T, (to: T) => void] {
	const [is, set] = useState<T>(() => drafts.has(name) ? drafts.get(name) as T : first);
	return [is, (to) => { drafts.set(name, to); set(() => to); }];
}

/** Asks once, and again every `everyMs`; null until it is answered. */
export function useAsk<T>(what: string, more: Record<string, unknown> = {},
	everyMs = 0): [T | null, string, () => void] {
	const [got, set] = useState<T | null>(null);
	const [refused, refuse] = useState("");
	const [turn, again] = useState(0);
	const open = link.connection === "open";
	useEffect(() => {
		let live = true;
		const ask = () => {
			if (document.hidden && got) return;
			void link.ask<T>(what, more).then((a) => {
				if (!live) return;
				if (a.code === 0) { set(a.body); refuse(""); } else refuse(a.reason);
			});
		};
		if (open) ask();
		const timer = everyMs && open ? setInterval(ask, everyMs) : 0;
		return () => { live = false; clearInterval(timer); };
	}, [what, JSON.stringify(more), open, turn]);
	return [got, refused, () => again(turn + 1)];
}

const PAGES_MAX = 20;
/** A list this short has always fitted one answer. */
const SHORT = 20;
const NO_SUCH_JOB = 66;

interface Rows<T> { rows: T[] | null; refused: string; whole: boolean }

/** All rows of so many pages: each begins behind the last job of the one before.
 * If that job is there no more, the rest comes with the next look. */
async function readPages<T extends { job: string }>(what: string, more: Record<string, unknown>,
	pages: number): Promise<Rows<T>> {
	const rows: T[] = [];
	for (let page = 0; page <= pages; page++) {
		const last = rows[rows.length - 1];
		const peek = page === pages;
		const a = await link.ask<T[]>(what, { ...more, ...(last ? { job: last.job } : {}), ...(peek ? { arg: 1 } : {}) });
		if (page > 0 && a.code === NO_SUCH_JOB) return { rows, refused: "", whole: false };
		if (a.code !== 0) return { rows: null, refused: a.reason, whole: true };
		if (peek) return { rows, refused: "", whole: a.body.length === 0 };
		rows.push(...a.body);
		if (a.body.length === 0 || rows.length < SHORT) break;
	}
	return { rows, refused: "", whole: true };
}

/** A list that may not fit one answer, asked for again every `everyMs`. `next`
 * asks for one page more; undefined if there is none. */
export function usePages<T extends { job: string }>(what: string, more: Record<string, unknown>,
	everyMs: number): { rows: T[] | null; refused: string; again: () => void; next?: () => void } {
	const [got, set] = useState<Rows<T>>({ rows: null, refused: "", whole: true });
	const [pages, want] = useState(1);
	const [turn, again] = useState(0);
	const open = link.connection === "open";
	useEffect(() => {
		let live = true, busy = false;
		const ask = async () => {
			if (busy || (document.hidden && got.rows)) return;
			busy = true;
			const r = await readPages<T>(what, more, pages);
			busy = false;
			/* What was refused says nothing of how many there are. */
			if (live) set((was) => r.rows ? r : { ...was, refused: r.refused });
		};
		if (open) void ask();
		const timer = open ? setInterval(() => void ask(), everyMs) : 0;
		return () => { live = false; clearInterval(timer); };
	}, [what, JSON.stringify(more), open, turn, pages]);
	return { rows: got.rows, refused: got.refused, again: () => again(turn + 1),
		...(got.whole || pages >= PAGES_MAX ? {} : { next: () => want(pages + 1) }) };
}

export interface Settings { language: "en" | "zh-CN"; theme: "auto" | "light" | "dark"; work: string }

function read(): Settings {
	const fall: Settings = {
		language: navigator.language.startsWith("zh") ? "zh-CN" : "en",
		theme: "auto", work: "G54",
	};
	try { return { ...fall, ...JSON.parse(localStorage.getItem("edm-panel") ?? "{}") }; } catch { return fall; }
}

export const settings: Settings = read();
const heard = new Set<() => void>();

export function change(s: Partial<Settings>): void {
	Object.assign(settings, s);
	localStorage.setItem("edm-panel", JSON.stringify(settings));
	apply();
	for (const h of heard) h();
}

export function apply(): void {
	const dark = settings.theme === "dark" ||
		(settings.theme === "auto" && matchMedia("(prefers-color-scheme: dark)").matches);
	document.documentElement.dataset.theme = dark ? "dark" : "light";
	document.documentElement.lang = settings.language;
}

export function useSettings(): Settings {
	const [, again] = useState(0);
	useEffect(() => {
		let n = 0;
		const h = () => again(++n);
		heard.add(h);
		const media = matchMedia("(prefers-color-scheme: dark)");
		const m = () => { apply(); h(); };
		media.addEventListener("change", m);
		return () => { heard.delete(h); media.removeEventListener("change", m); };
	}, []);
	return settings;
}

export interface Toast { n: number; text: string; bad: boolean }
let toasts: Toast[] = [];
let count = 0;
const toasted = new Set<() => void>();

export function say(text: string, bad = false): void {
	const t = { n: ++count, text, bad };
	toasts = [...toasts.filter((o) => o.text !== text).slice(-1), t];
	for (const h of toasted) h();
	setTimeout(() => drop(t.n), bad ? 9000 : 4000);
}

export function drop(n: number): void {
	toasts = toasts.filter((t) => t.n !== n);
	for (const h of toasted) h();
}

function useToasted(): void {
	const [, again] = useState(0);
	useEffect(() => {
		let n = 0;
		const h = () => again(++n);
		toasted.add(h);
		return () => { toasted.delete(h); };
	}, []);
}

export function useToasts(): Toast[] {
	useToasted();
	return toasts;
}

let open = 0;
/** So many sheets more, or less, are open. */
export function sheets(more: number): void {
	open += more;
	for (const h of toasted) h();
}

export function useSheets(): number {
	useToasted();
	return open;
}

/** Hands a text to the browser as a file. */
export function save(name: string, type: string, text: string): void {
	const a = document.createElement("a");
	a.href = URL.createObjectURL(new Blob([text], { type }));
	a.download = name;
	a.click();
	setTimeout(() => URL.revokeObjectURL(a.href), 1000);
}
