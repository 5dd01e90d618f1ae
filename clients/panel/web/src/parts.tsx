// SPDX-License-Identifier: Apache-2.0
//
// Keys, cards and sheets: what every page is made of.
import type { ComponentChildren, JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { whyNot } from "./can";
import { parse } from "./format";
import { link } from "./link";
import { drop, say, sheets, useSheets, useToasts } from "./use";
import { said, t } from "./words";

export const PRESS_MS = 1000;

export function Card(p: { title?: ComponentChildren; children: ComponentChildren; class?: string; right?: ComponentChildren; label?: string }): JSX.Element {
	return <section class={`card ${p.class ?? ""}`} aria-label={p.label}>
		{(p.title || p.right) && <header class="card-head">{p.title ? <h2>{p.title}</h2> : null}{p.right}</header>}
		{p.children}
	</section>;
}

interface KeyProps {
	children: ComponentChildren; note?: string; why?: string; class?: string;
	onPress: () => void; label?: string; id?: string;
}

/** A key.  With `why` it is grey, and says why when it is pressed. */
export function Key(p: KeyProps): JSX.Element {
	const off = !!p.why;
	return <button type="button" id={p.id} class={`key ${off ? "off" : ""} ${p.class ?? ""}`}
		aria-disabled={off} aria-label={p.label}
		onClick={() => off ? say(p.why as string, true) : p.onPress()}>
		<span>{p.children}</span>{p.note && <small>{p.note}</small>}
	</button>;
}

/** Acts when it was pressed for a second, by finger, mouse or keyboard.  A press is for
 *  the job that was there when it began: another is not begun by it. */
export function PressKey(p: KeyProps): JSX.Element {
	const [since, set] = useState(0);
	const timer = useRef<number>(0);
	const latest = useRef(p);
	latest.current = p;
	const off = !!p.why;
	const begin = () => {
		if (off) { say(p.why as string, true); return; }
		if (timer.current) return;
		set(Date.now());
		timer.current = window.setTimeout(() => {
			timer.current = 0;
			set(0);
			// It is for what was shown when it began.
			if (!latest.current.why) p.onPress();
		}, PRESS_MS);
	};
	const end = () => {
		clearTimeout(timer.current);
		timer.current = 0;
		set(0);
	};
	useEffect(() => {
		window.addEventListener("blur", end);
		return () => { window.removeEventListener("blur", end); end(); };
	}, [link.state.job]);
	const key = (e: KeyboardEvent, go: () => void) => {
		if (e.key !== "Enter" && e.key !== " ") return;
		e.preventDefault();
		if (!e.repeat) go();
	};
	return <button type="button" id={p.id} class={`key press ${off ? "off" : ""} ${since ? "pressed" : ""} ${p.class ?? ""}`}
		aria-disabled={off} aria-label={p.label}
		onPointerDown={(e) => { if (e.button === 0) begin(); }} onPointerUp={end} onPointerLeave={end}
		onPointerCancel={end} onContextMenu={(e) => e.preventDefault()}
		onKeyDown={(e) => key(e, begin)} onKeyUp={(e) => key(e, end)}>
		<svg class="ring" viewBox="0 0 28 28" aria-hidden="true"><circle cx="14" cy="14" r="11" /><circle class="fill" cx="14" cy="14" r="11" pathLength="1" /></svg>
		<span>{p.children}<small>{p.note ?? t("press")}</small></span>
	</button>;
}

/** Goes on as long as it is pressed; a finger that slips off has let go. */
export function HoldKey(p: Omit<KeyProps, "onPress"> & { onHold: (over: (why: string) => void) => () => void }): JSX.Element {
	const [on, set] = useState(false);
	const stop = useRef<(() => void) | null>(null);
	const off = !!p.why;
	const end = () => {
		stop.current?.();
		stop.current = null;
		set(false);
	};
	const begin = () => {
		if (off) { say(p.why as string, true); return; }
		if (stop.current) return;
		set(true);
		stop.current = p.onHold((why) => {
			stop.current = null;
			set(false);
			say(why === "connection" ? t("no.connection") : why, true);
		});
	};
	useEffect(() => {
		const hidden = () => { if (document.hidden) end(); };
		window.addEventListener("blur", end);
		document.addEventListener("visibilitychange", hidden);
		return () => { window.removeEventListener("blur", end); document.removeEventListener("visibilitychange", hidden); end(); };
	}, []);
	const key = (e: KeyboardEvent, go: () => void) => {
		if (e.key !== "Enter" && e.key !== " ") return;
		e.preventDefault();
		if (!e.repeat) go();
	};
	return <button type="button" id={p.id} class={`key hold ${off ? "off" : ""} ${on ? "pressed" : ""} ${p.class ?? ""}`}
		aria-disabled={off} aria-label={p.label} aria-pressed={on}
		onPointerDown={(e) => { if (e.button !== 0) return; e.currentTarget.releasePointerCapture(e.pointerId); begin(); }}
		onPointerUp={end} onPointerLeave={end} onPointerCancel={end} onContextMenu={(e) => e.preventDefault()}
		onKeyDown={(e) => key(e, begin)} onKeyUp={(e) => key(e, end)} onBlur={end}>
		<span>{p.children}</span></button>;
}

/** The same place on every page, and over a sheet too. */
export function StopKey(p: { over?: boolean }): JSX.Element {
	const why = whyNot("estop");
	const [at, place] = useState<JSX.CSSProperties>({});
	useEffect(() => {
		if (!p.over) return;
		const look = () => {
			const r = document.getElementById("stop")?.getBoundingClientRect();
			if (r) place({ left: `${r.left}px`, top: `${r.top}px`, width: `${r.width}px`, height: `${r.height}px` });
		};
		look();
		addEventListener("resize", look);
		return () => removeEventListener("resize", look);
	}, [p.over]);
	return <button type="button" class={`stop ${why ? "off" : ""} ${p.over ? "over" : ""}`} id={p.over ? "stop-over" : "stop"} style={at} title={t("stop.about")} aria-disabled={!!why}
		onClick={() => why ? say(why, true) : void act("estop")}>
		{t("stop")}<small>{t("stop.note")}</small></button>;
}

/** What is to be told for a moment.  It has a place of its own, above the keys or
 * at the end of a sheet, and lies over nothing. */
export function Toasts(p: { over?: boolean }): JSX.Element | null {
	const all = useToasts(), open = useSheets() > 0;
	if (open && !p.over) return null;
	return <div class="toasts" role="alert">{all.map((o) =>
		<button type="button" class={`toast ${o.bad ? "bad" : ""}`} key={o.n} onClick={() => drop(o.n)}>{o.text}</button>)}</div>;
}

export function Sheet(p: { title: string; onClose: () => void; children: ComponentChildren; wide?: boolean }): JSX.Element {
	const ref = useRef<HTMLDialogElement>(null);
	// A press that ends elsewhere than it began, as where a message comes under it,
	// is a click on the whole sheet.
	const beside = useRef(false);
	useEffect(() => {
		const d = ref.current;
		if (d && !d.open) d.showModal();
		sheets(1);
		return () => { sheets(-1); d?.close(); };
	}, []);
	return <dialog ref={ref} class={`sheet ${p.wide ? "wide" : ""}`} aria-label={p.title}
		onPointerDown={(e) => { beside.current = e.target === ref.current; }}
		onClick={(e) => { if (beside.current && e.target === ref.current) p.onClose(); }}
		onCancel={(e) => { e.preventDefault(); p.onClose(); }}>
		<header><h2>{p.title}</h2><Key class="small quiet" onPress={p.onClose}>{t("close")}</Key></header>
		<div class="sheet-body">{p.children}</div>
		<Toasts over />
		<StopKey over />
	</dialog>;
}

/** A number with its unit; takes point and comma. */
export function NumberField(p: { label: string; unit?: string; value: string; onInput: (text: string) => void; id?: string; onEnter?: () => void }): JSX.Element {
	const bad = p.value.trim() !== "" && Number.isNaN(parse(p.value));
	return <label class={`field ${bad ? "bad" : ""}`}><span>{p.label}</span>
		<span class="box"><input id={p.id} inputMode="decimal" autocomplete="off" value={p.value} aria-invalid={bad}
			onInput={(e) => p.onInput(e.currentTarget.value)}
			onKeyDown={(e) => { if (e.key === "Enter") p.onEnter?.(); }} /><u>{p.unit}</u></span></label>;
}

export function Choice<T extends string>(p: { value: T; of: { value: T; text: string }[]; onChange: (v: T) => void; label: string; class?: string }): JSX.Element {
	return <div class={`choice ${p.class ?? ""}`} role="radiogroup" aria-label={p.label}>
		{p.of.map((o) => <button type="button" role="radio" aria-checked={o.value === p.value}
			class={o.value === p.value ? "on" : ""} onClick={() => p.onChange(o.value)}>{o.text}</button>)}
	</div>;
}

/** A request that does something; a refusal is said. */
export async function act(what: string, more: Record<string, unknown> = {}): Promise<boolean> {
	const a = await link.ask(what, more);
	if (a.code !== 0) say(a.reason === "connection" ? t("no.connection") : said(a.reason), true);
	return a.code === 0;
}

/** The stand that is shown, for a press: it is for that one alone. */
export function standNow(): string {
	return link.state.stand ? String(link.state.standN) : "";
}

const paths: Record<string, string> = {
	cut: "M4 17 9 8l4 6 3-9 4 7", jobs: "M5 6h14M5 12h14M5 18h9",
	setup: "M12 4v16M4 12h16M9 7l3-3 3 3M9 17l3 3 3-3M7 9l-3 3 3 3M17 9l3 3-3 3",
	tech: "M5 5h14v14H5zM5 10h14M10 5v14", alarms: "M12 4 21 19H3zM12 10v4M12 16.5v.5",
	machine: "M4 7h16v9H4zM9 19h6M12 16v3M8 11h3M14 11h2",
	fleet: "M5 5h6v6H5zM13 5h6v6h-6zM5 13h6v6H5zM13 13h6v6h-6z",
	up: "M12 5v14M6 11l6-6 6 6", file: "M7 4h7l4 4v12H7zM14 4v4h4",
};

export function Icon(p: { name: string }): JSX.Element {
	return <svg class="icon" viewBox="0 0 24 24" aria-hidden="true"><path d={paths[p.name]} /></svg>;
}
