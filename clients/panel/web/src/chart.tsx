// SPDX-License-Identifier: Apache-2.0
//
// Strip charts: mean as a line, smallest to largest as a band.
import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { short } from "./format";
import type { Point } from "./link";
import { settings } from "./use";

interface StripProps { points: Point[]; at: 1 | 4; colour: string; label: string; height: number; lines?: number[]; axes?: boolean; span: number; clip?: [number, number] }

function css(name: string): string {
	return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function columns(points: Point[], at: number): uPlot.AlignedData {
	const t: number[] = [], low: number[] = [], mean: (number | null)[] = [], high: number[] = [];
	for (const p of points) {
		t.push(p[0] / 1000);
		low.push(p[at] as number);
		mean.push(p[8] ? p[at + 1] as number : null);
		high.push(p[at + 2] as number);
	}
	return [t, low, high, mean];
}

export function Strip(p: StripProps): JSX.Element {
	const box = useRef<HTMLDivElement>(null), plot = useRef<uPlot | null>(null);
	const latest = useRef(p);
	latest.current = p;
	const theme = document.documentElement.dataset.theme;
	useEffect(() => {
		const el = box.current as HTMLDivElement;
		const colour = css(p.colour), mute = css("--mute"), grid = css("--line");
		const axis = (more: uPlot.Axis): uPlot.Axis => ({ stroke: mute, grid: { stroke: grid, width: 1 }, ticks: { show: false }, font: "12px system-ui", ...more });
		plot.current = new uPlot({
			width: Math.max(el.clientWidth, 50), height: p.height, cursor: { show: !!p.axes, points: { show: false } }, legend: { show: false },
			padding: p.axes ? [8, 8, 0, 0] : [2, 0, 2, 0],
			scales: {
				x: { time: true, range: () => { const end = latest.current.points[latest.current.points.length - 1]?.[0] ?? Date.now(); return [end / 1000 - latest.current.span, end / 1000]; } },
				y: { range: (_u, min, max) => latest.current.clip ?? [min ?? 0, (max ?? 1) > (min ?? 0) ? (max as number) : (min ?? 0) + 1] },
			},
			axes: p.axes ? [axis({ values: (_u, v) => v.map((x) => new Date(x * 1000).toLocaleTimeString(settings.language, { hour12: false })) , space: 110 }), axis({ size: 56, values: (_u, v) => v.map((x) => short(p.at === 4 ? x * 60 : x)) })] : [{ show: false }, { show: false }],
			bands: [{ series: [2, 1], fill: `${colour}38` }],
			series: [{}, { width: 0, points: { show: false } }, { width: 0, points: { show: false } },
				{ stroke: colour, width: 1.5, points: { show: false } }],
			hooks: { draw: [(u) => {
				for (const y of latest.current.lines ?? []) {
					const at = u.valToPos(y, "y", true);
					u.ctx.strokeStyle = mute;
					u.ctx.setLineDash([4, 4]);
					u.ctx.beginPath();
					u.ctx.moveTo(u.bbox.left, at);
					u.ctx.lineTo(u.bbox.left + u.bbox.width, at);
					u.ctx.stroke();
					u.ctx.setLineDash([]);
				}
			}] },
		}, columns(p.points, p.at), el);
		const watch = new ResizeObserver(() => plot.current?.setSize({ width: Math.max(el.clientWidth, 50), height: latest.current.height }));
		watch.observe(el);
		return () => { watch.disconnect(); plot.current?.destroy(); plot.current = null; };
	}, [p.colour, p.at, p.height, theme, settings.language]);
	useEffect(() => { plot.current?.setData(columns(p.points, p.at)); });
	return <div class="strip" ref={box} role="img" aria-label={p.label} />;
}
