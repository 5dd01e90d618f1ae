// SPDX-License-Identifier: Apache-2.0
//
// The path with what is said about it: legend, scale, the line that is touched.
import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { number } from "./format";
import { useLine } from "./lines";
import { Choice } from "./parts";
import { fetchPath, type PathData } from "./pathdata";
import type { Marks, PathScene, View } from "./scene";
import { settings } from "./use";
import { t } from "./words";

export interface PathViewProps {
	query: string;			// of /api/path; "": none
	place?: number; far?: number; electrode?: number[] | null;
	title?: JSX.Element | string; onLine?: (line: number) => void;
	foot?: JSX.Element | null; still?: boolean;
	job?: string;			// whose text is shown for a line
}

const RETRY_MS = 2000;
const BACK_MM = 0.0005;

function scaleOf(mmPerPx: number): { mm: number; px: number } {
	const want = mmPerPx * 110, ten = 10 ** Math.floor(Math.log10(want));
	const mm = [1, 2, 5, 10].map((k) => k * ten).filter((k) => k <= want).pop() ?? ten;
	return { mm, px: mm / mmPerPx };
}

function Overlay(p: { marks: Marks | null; back: boolean }): JSX.Element | null {
	if (!p.marks || !(p.marks.mmPerPx > 0)) return null;
	const scale = scaleOf(p.marks.mmPerPx);
	return <svg class="overlay" aria-hidden="true">
		{p.marks.electrode && <circle class={p.back ? "electrode back" : "electrode"} cx={p.marks.electrode[0]} cy={p.marks.electrode[1]} r="8" />}
		<svg x="14" y="100%" overflow="visible"><g class="triad" transform="translate(34 -40)">
			{p.marks.axes.map(([name, x, y]) => Math.hypot(x, y) < 0.05 ? null : <g>
				<path d={`M0 0L${x * 28} ${y * 28}`} /><text x={x * 38} y={y * 38 + 4}>{name}</text></g>)}
		</g></svg>
		<svg x="100%" y="100%" overflow="visible"><g class="scale" transform={`translate(${-scale.px - 16} -16)`}>
			<path d={`M0 0h${scale.px}M0 -4v8M${scale.px} -4v8`} />
			<text x={scale.px / 2} y="-8" text-anchor="middle">{`${number(scale.mm, scale.mm < 0.01 ? 3 : scale.mm < 1 ? 2 : 0)} mm`}</text>
		</g></svg>
	</svg>;
}

export function PathView(p: PathViewProps): JSX.Element {
	const box = useRef<HTMLDivElement>(null), canvas = useRef<HTMLCanvasElement>(null);
	const scene = useRef<PathScene | null>(null);
	const [data, setData] = useState<PathData | null>(null);
	const [note, setNote] = useState("");
	const [view, setView] = useState<View | "follow">("3d");
	const [marks, setMarks] = useState<Marks | null>(null);
	const [touched, touch] = useState(0);
	const text = useLine(p.job ?? "", p.job ? touched : 0);
	const back = (p.far ?? 0) - (p.place ?? 0) > BACK_MM;

	useEffect(() => {
		let live = true;
		let watch: ResizeObserver | null = null;
		const show = ({ PathScene: Scene }: typeof import("./scene")) => {
			if (!live || !canvas.current || !box.current) return;
			try {
				const s = new Scene(canvas.current);
				s.onMarks = setMarks;
				scene.current = s;
				(window as any).edmScene = s;
				watch = new ResizeObserver(() => {
					const r = box.current?.getBoundingClientRect();
					if (r) { s.resize(r.width, r.height); s.fit(); }
				});
				watch.observe(box.current);
				setNote("");
				setData((d) => { s.setPath(d); return d; });
			} catch { setNote(t("view.nogl")); }
		};
		// The 3D part is fetched when it is needed first; again while there is
		// no connection.
		const load = (): void => void import("./scene").then(show, () => {
			if (!live) return;
			setNote(t("view.failed", { why: t("no.connection") }));
			setTimeout(load, RETRY_MS);
		});
		load();
		return () => { live = false; watch?.disconnect(); scene.current?.dispose(); scene.current = null; };
	}, []);

	useEffect(() => {
		let live = true;
		if (!p.query) { setData(null); scene.current?.setPath(null); return; }
		setNote(t("view.loading"));
		fetchPath(p.query).then((d) => {
			if (!live) return;
			setNote("");
			setData(d);
			scene.current?.setPath(d);
		}, (e: Error) => { if (live) { setNote(t("view.failed", { why: e.message })); setData(null); } });
		return () => { live = false; };
	}, [p.query]);

	useEffect(() => {
		scene.current?.setLook({ place: p.place ?? 0, far: p.far ?? 0, back, electrode: p.electrode ?? null });
	}, [p.place, p.far, data, p.electrode?.join(), scene.current]);
	useEffect(() => scene.current?.colours(), [document.documentElement.dataset.theme]);

	const choose = (v: View | "follow") => {
		setView(v);
		if (!scene.current) return;
		if (v !== "follow") scene.current.view(v);
		scene.current.follow = v === "follow";
		scene.current.ask();
	};
	const press = useRef<[number, number]>([0, 0]);
	const onUp = (e: PointerEvent) => {
		if (Math.hypot(e.offsetX - press.current[0], e.offsetY - press.current[1]) > 5) return;
		const hit = scene.current?.lineAt(e.offsetX, e.offsetY);
		touch(hit?.line ?? 0);
		if (hit) p.onLine?.(hit.line);
	};
	void settings.language;
	return <div class="pathview">
		<div class="pathview-head"><h2>{p.title}</h2>
			<Choice label={t("cut.path")} value={view} onChange={choose} of={[
				{ value: "3d", text: t("view.3d") }, { value: "top", text: t("view.top") }, { value: "front", text: t("view.front") },
				...(p.electrode ? [{ value: "follow" as const, text: t("view.follow") }] : [])]} /></div>
		<div class="legend" aria-hidden="true"><span class="l-cut">{t("view.cut")}</span>{back && <span class="l-back">{t("view.back")}</span>}<span class="l-todo">{t("view.todo")}</span></div>
		<div class="canvas" ref={box}>
			<canvas ref={canvas} role="img" tabIndex={0} aria-label={t("cut.path")}
				onPointerDown={(e) => { press.current = [e.offsetX, e.offsetY]; }} onPointerUp={onUp} />
			{data && <Overlay marks={marks} back={back} />}
			{!p.query && !note && <p class="empty">{t("view.none")}</p>}
			{note && <p class="empty">{note}</p>}
			{touched > 0 && <p class="touched">{t("view.atline", { line: touched })} <code>{text}</code></p>}
		</div>
		{p.foot}
	</div>;
}
