// SPDX-License-Identifier: Apache-2.0
//
// The frame of every page: rail, state line, stop; and what is dropped on it.
import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { Alarms } from "./alarms";
import { Cut } from "./cut";
import { Fleet } from "./fleet";
import { clock } from "./format";
import { Jobs, takeFile } from "./jobs";
import { useElectrodeNames, useLine } from "./lines";
import { link } from "./link";
import { Machine } from "./machine";
import { Icon, StopKey, Toasts } from "./parts";
import { Setup } from "./setup";
import { hasWarning, stateLine } from "./stateline";
import { Tech } from "./tech";
import { useLink, useSettings } from "./use";
import { t, type Word } from "./words";

const PAGES: { id: string; word: Word; page: () => JSX.Element }[] = [
	{ id: "cut", word: "page.cut", page: Cut },
	{ id: "jobs", word: "page.jobs", page: Jobs },
	{ id: "setup", word: "page.setup", page: Setup },
	{ id: "tech", word: "page.tech", page: Tech },
	{ id: "alarms", word: "page.alarms", page: Alarms },
	{ id: "machine", word: "page.machine", page: Machine },
	{ id: "fleet", word: "page.fleet", page: Fleet },
];

function pageOf(): string {
	const id = location.hash.replace("#/", "");
	return PAGES.some((p) => p.id === id) ? id : "cut";
}

export function goTo(id: string): void {
	location.hash = `#/${id}`;
}

function Rail(p: { at: string }): JSX.Element {
	const fault = link.state.fault !== "none";
	return <nav class="rail" aria-label="edmd">
		{PAGES.map((page) => <a href={`#/${page.id}`} class={p.at === page.id ? "on" : ""}
			aria-current={p.at === page.id ? "page" : undefined}>
			<Icon name={page.id} /><span>{t(page.word)}</span>
			{page.id === "alarms" && (fault || hasWarning()) && <b class={`badge ${fault ? "" : "warn"}`} aria-label={t(fault ? "event.alarm" : "alarms.warnings")}>!</b>}
		</a>)}
	</nav>;
}

/* How high the head is now: a long line has room, and sheets begin below it. */
function useHeight(): { current: HTMLElement | null } {
	const box = useRef<HTMLElement>(null);
	useEffect(() => {
		const watch = new ResizeObserver(() => document.documentElement.style.setProperty("--headnow", `${box.current?.offsetHeight ?? 0}px`));
		watch.observe(box.current as HTMLElement);
		return () => watch.disconnect();
	}, []);
	return box;
}

function Head(): JSX.Element {
	const { stand, standOf, electrode, job, line } = link.state, box = useHeight();
	useElectrodeNames(stand === "electrode" ? [standOf, electrode] : []);
	useLine(/stop$/.test(stand) ? job : "", line);
	const s = stateLine();
	return <header class={`head ${s.tone}`} ref={box}>
		<span class={`dot ${s.shape}`} aria-hidden="true" />
		<div class="state" role="status" aria-live="polite"><h1>{s.title}</h1><p title={s.why}>{s.why}</p></div>
		<small class="who">{link.hello?.machine ?? ""} <time>{clock(Date.now())}</time><br />
			{link.hello ? t(`role.${link.hello.role}`) : ""}</small>
		<StopKey />
	</header>;
}

function Login(): JSX.Element {
	const [user, setUser] = useState(""), [password, setPassword] = useState("");
	const [refused, refuse] = useState("");
	const go = async (e: Event) => {
		e.preventDefault();
		refuse(await link.login(user, password));
		setPassword("");
	};
	return <main class="login"><form class="card" onSubmit={(e) => void go(e)}>
		<h1>{t("login.title")}</h1><p>{link.session?.machine}</p>
		<label class="field"><span>{t("login.user")}</span><span class="box"><input id="user" autocomplete="username" value={user} onInput={(e) => setUser(e.currentTarget.value)} /></span></label>
		<label class="field"><span>{t("login.password")}</span><span class="box"><input id="password" type="password" autocomplete="current-password" value={password} onInput={(e) => setPassword(e.currentTarget.value)} /></span></label>
		{refused && <p class="bad" role="alert">{refused}</p>}
		<button type="submit" class="key primary">{t("login.go")}</button>
	</form></main>;
}

/** A file may be dropped anywhere. */
function useDrop(): boolean {
	const [over, set] = useState(false);
	useEffect(() => {
		const has = (e: DragEvent) => !!e.dataTransfer?.types.includes("Files");
		const on = (e: DragEvent) => { if (has(e)) { e.preventDefault(); set(true); } };
		const off = (e: DragEvent) => { if (!e.relatedTarget) set(false); };
		const take = (e: DragEvent) => {
			if (!has(e)) return;
			e.preventDefault();
			set(false);
			const f = e.dataTransfer?.files[0];
			if (f) { goTo("jobs"); void takeFile(f); }
		};
		addEventListener("dragover", on);
		addEventListener("dragleave", off);
		addEventListener("drop", take);
		return () => { removeEventListener("dragover", on); removeEventListener("dragleave", off); removeEventListener("drop", take); };
	}, []);
	return over;
}

export function App(): JSX.Element {
	useLink();
	useSettings();
	const [at, set] = useState(pageOf());
	const over = useDrop();
	useEffect(() => {
		const h = () => set(pageOf());
		addEventListener("hashchange", h);
		return () => removeEventListener("hashchange", h);
	}, []);
	if (link.connection === "login") return <><Login /><Toasts /></>;
	const page = PAGES.find((p) => p.id === at) ?? PAGES[0]!;
	const Page = page.page;
	document.title = `${stateLine().title} \u00b7 ${link.hello?.machine ?? "edmd"}`;
	const stale = link.connection !== "open" || link.state.daemon !== "ok";
	return <div class={`frame ${stale ? "stale" : ""}`}>
		<a class="skip" href="#page" onClick={(e) => { e.preventDefault(); document.getElementById("page")?.focus(); }}>{t("skip")}</a>
		<Rail at={at} /><Head />
		<main id="page" tabIndex={-1} class={`page page-${page.id}`} key={page.id}><Page /></main>
		{page.id !== "cut" && <Toasts />}
		{over && <div class="dropping"><Icon name="file" />{t("drop.here")}</div>}
	</div>;
}
