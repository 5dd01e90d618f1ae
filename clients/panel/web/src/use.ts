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

export interface Settings { language: "en" | "zh-CN"; theme: "auto" | "light" | "dark" }

function read(): Settings {
	const fall: Settings = {
		language: navigator.language.startsWith("zh") ? "zh-CN" : "en",
		theme: "auto",
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
	toasts = [...toasts.filter((o) => o.text !== text).slice(-2), t];
	for (const h of toasted) h();
	setTimeout(() => drop(t.n), bad ? 9000 : 4000);
}

export function drop(n: number): void {
	toasts = toasts.filter((t) => t.n !== n);
	for (const h of toasted) h();
}

export function useToasts(): Toast[] {
	const [, again] = useState(0);
	useEffect(() => {
		let n = 0;
		const h = () => again(++n);
		toasted.add(h);
		return () => { toasted.delete(h); };
	}, []);
	return toasts;
}
