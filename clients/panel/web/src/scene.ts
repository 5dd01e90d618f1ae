// SPDX-License-Identifier: Apache-2.0
//
// The path in space: done, to do, walked back now, and where the electrode is.
//
// Thick lines are drawn for what is done as long as they are few; a path of
// very many points is drawn by plain lines.  While it is turned it is drawn as
// fine as this machine can in 30 frames a second.
import {
	BufferAttribute, BufferGeometry, Color, Line, LineBasicMaterial, LineSegments,
	OrthographicCamera, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { CUT, indexAt, pointAt, type PathData } from "./pathdata";

export type View = "3d" | "top" | "front";

export interface Look { place: number; far: number; back: boolean; electrode: number[] | null }

export interface Marks {
	/** Of the canvas, px. */
	electrode: [number, number] | null;
	axes: [string, number, number][];
	mmPerPx: number;
}

const THICK_MAX = 20000;
// Points of the path while it is turned, from fine to coarse.
const LEVELS = [60000, 20000, 7000, 2500, 900];
const FRAME_MS = 30;
const BACK_MAX = 3000;

function cssColor(name: string): Color {
	const c = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
	return new Color(c);
}

/** Every point that is farther than so much from the last one that was kept. */
function thin(p: PathData, mm: number, most: number): number[] {
	const kept = [0], at = p.at;
	let x = at[0] as number, y = at[1] as number, z = at[2] as number;
	for (let i = 1; i < p.n && kept.length <= most; i++) {
		const dx = (at[3 * i] as number) - x, dy = (at[3 * i + 1] as number) - y, dz = (at[3 * i + 2] as number) - z;
		if (dx * dx + dy * dy + dz * dz < mm * mm) continue;
		kept.push(i);
		x += dx; y += dy; z += dz;
	}
	return kept;
}

interface Level { kept: number[]; todo: Line; done: Line }

/** The path by fewer points: details smaller than a step are left out. */
function level(p: PathData, most: number, span: number): Level {
	let mm = span / 1e5, kept = thin(p, mm, most);
	while (kept.length > most) { mm *= 1.6; kept = thin(p, mm, most); }
	const to = new Float32Array(3 * kept.length);
	kept.forEach((i, k) => to.set(p.at.subarray(3 * i, 3 * i + 3), 3 * k));
	const at = new BufferAttribute(to, 3);
	const line = (colour: string, order: number) => {
		const l = new Line(new BufferGeometry().setAttribute("position", at), new LineBasicMaterial({ color: cssColor(colour) }));
		l.frustumCulled = false;
		l.renderOrder = order;
		return l;
	};
	return { kept, todo: line("--todo", 0), done: line("--done", 2) };
}

/** How many of them are not behind point i. */
function upTo(kept: number[], i: number): number {
	let low = 0, high = kept.length;
	while (low < high) {
		const k = (low + high) >> 1;
		if ((kept[k] as number) <= i) low = k + 1;
		else high = k;
	}
	return low;
}

export class PathScene {
	frames = 0;
	private renderer: WebGLRenderer;
	private scene = new Scene();
	private camera = new OrthographicCamera(-1, 1, 1, -1, -1, 1);
	private controls: OrbitControls;
	private path: PathData | null = null;
	private todo: Line | null = null;
	private rapid: LineSegments | null = null;
	private done: LineSegments2 | Line | null = null;
	private edge: LineSegments2;
	private back: LineSegments2;
	private upper: Line | null = null;
	private coarse: Level[] = [];
	private level = 1;
	private drawn = 0;
	private took = 0;
	private begun = false;
	private look: Look = { place: 0, far: 0, back: false, electrode: null };
	private span = 1;
	private width = 1;
	private height = 1;
	private asked = 0;
	private turning = false;
	private cutUpTo: Uint32Array = new Uint32Array(0);
	follow = false;
	onMarks: (m: Marks) => void = () => {};

	constructor(canvas: HTMLCanvasElement) {
		this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: "low-power" });
		this.camera.up.set(0, 0, 1);
		this.controls = new OrbitControls(this.camera, canvas);
		this.controls.enableDamping = false;
		this.controls.addEventListener("change", () => this.ask());
		this.controls.addEventListener("start", () => { this.turning = true; this.drawn = 0; this.follow = false; });
		this.controls.addEventListener("end", () => { this.turning = false; this.ask(); });
		this.edge = this.thick(3);
		this.back = this.thick(6);
		this.back.renderOrder = 3;
		this.scene.add(this.edge, this.back);
		this.colours();
	}

	private thick(px: number): LineSegments2 {
		const l = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: px, depthTest: false }));
		l.frustumCulled = false;
		l.visible = false;
		return l;
	}

	colours(): void {
		const done = cssColor("--done"), todo = cssColor("--todo"), back = cssColor("--amber");
		for (const o of [this.todo, this.upper, this.rapid, ...this.coarse.map((c) => c.todo)])
			(o?.material as LineBasicMaterial | undefined)?.color.copy(todo);
		this.coarse.forEach((c) => (c.done.material as LineBasicMaterial).color.copy(done));
		if (this.done) (this.done.material as LineBasicMaterial).color.copy(done);
		(this.edge.material as LineMaterial).color.copy(done);
		(this.back.material as LineMaterial).color.copy(back);
		this.ask();
	}

	resize(width: number, height: number): void {
		if (width < 2 || height < 2) return;
		this.width = width;
		this.height = height;
		this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
		this.renderer.setSize(width, height, false);
		for (const l of [this.edge, this.back, this.done])
			if (l && l.material instanceof LineMaterial) l.material.resolution.set(width, height);
		this.frame();
	}

	setPath(p: PathData | null): void {
		for (const o of [this.todo, this.rapid, this.done, this.upper, ...this.coarse.flatMap((c) => [c.todo, c.done])]) {
			if (!o) continue;
			this.scene.remove(o);
			o.geometry.dispose();
			(o.material as LineBasicMaterial).dispose();
		}
		this.todo = this.rapid = this.done = this.upper = null;
		this.coarse = [];
		this.begun = false;
		this.path = p;
		this.back.visible = this.edge.visible = false;
		if (p && p.n > 1) this.build(p);
		this.setLook(this.look);	// it may have come before the path
		this.colours();
		this.view("3d");
	}

	// Cuts are lines of two points each, so that a part of them can be drawn;
	// cutUpTo tells how many of them there are up to a point.
	private build(p: PathData): void {
		const cuts: number[] = [], rapids: number[] = [];
		this.cutUpTo = new Uint32Array(p.n);
		for (let i = 1; i < p.n; i++) {
			const to = p.kind[i] === CUT ? cuts : rapids;
			for (let k = -3; k < 3; k++) to.push(p.at[3 * i + k] as number);
			this.cutUpTo[i] = cuts.length / 6;
		}
		const flat = (a: number[]) => {
			const g = new BufferGeometry();
			g.setAttribute("position", new BufferAttribute(new Float32Array(a), 3));
			return g;
		};
		this.todo = new LineSegments(flat(cuts), new LineBasicMaterial());
		this.rapid = new LineSegments(flat(rapids), new LineBasicMaterial({ transparent: true, opacity: 0.45 }));
		if (cuts.length / 6 <= THICK_MAX && cuts.length) {
			const g = new LineSegmentsGeometry();
			g.setPositions(cuts);
			const m = new LineMaterial({ linewidth: 2.6, depthTest: false });
			m.resolution.set(this.width, this.height);
			this.done = new LineSegments2(g, m);
		} else {
			this.done = new LineSegments(flat(cuts), new LineBasicMaterial());
		}
		this.done.renderOrder = 2;
		for (const o of [this.todo, this.rapid, this.done]) { o.frustumCulled = false; this.scene.add(o); }
		if (p.upper) this.buildUpper(p, p.upper);
	}

	private buildUpper(p: PathData, upper: Float32Array): void {
		const up = new Float32Array(3 * p.n), lift = Math.max(...p.max.map((m, i) => m - (p.min[i] as number))) * 0.35;
		for (let i = 0; i < p.n; i++) {
			up[3 * i] = (upper[2 * i] as number) - (p.origin[0] as number);
			up[3 * i + 1] = (upper[2 * i + 1] as number) - (p.origin[1] as number);
			up[3 * i + 2] = (p.at[3 * i + 2] as number) + lift;
		}
		const g = new BufferGeometry();
		g.setAttribute("position", new BufferAttribute(up, 3));
		this.upper = new Line(g, new LineBasicMaterial());
		this.upper.frustumCulled = false;
		this.scene.add(this.upper);
	}

	private coarser(): Level | null {
		const p = this.path, most = LEVELS[this.level] as number, l = this.look;
		if (!p || p.n <= most) return null;
		let c = this.coarse[this.level];
		if (!c) {
			c = this.coarse[this.level] = level(p, most, this.span);
			this.scene.add(c.todo, c.done);
		}
		c.done.geometry.setDrawRange(0, upTo(c.kept, indexAt(p, l.back ? l.place : l.far)));
		return c;
	}

	// Slow frames make it coarser at once, quick ones finer after a while.
	private choose(): void {
		const now = performance.now(), ms = now - this.drawn;
		if (this.drawn && ms < 2000) this.took += (ms - this.took) * (ms > this.took ? 0.5 : 0.1);
		else this.took = 20;
		this.drawn = now;
		if (this.took > FRAME_MS && this.level < LEVELS.length - 1) { this.level++; this.took = 22; }
		else if (this.took < 17.5 && this.level > 0) { this.level--; this.took = 22; }
	}

	/** Where the machine is: cheap enough for ten times a second. */
	setLook(l: Look): void {
		this.look = l;
		const p = this.path;
		if (p && this.done) {
			const i = indexAt(p, l.back ? l.place : l.far), n = this.cutUpTo[i] as number;
			const done = this.done as LineSegments2;
			if (done.isLineSegments2) done.geometry.instanceCount = n;
			else this.done.geometry.setDrawRange(0, 2 * n);
			this.begun = n > 0;
			this.fill(this.edge, p, Math.max(p.s[i] as number, 0), l.back ? l.place : l.far, p.kind[Math.min(i + 1, p.n - 1)] === CUT);
			this.fill(this.back, p, l.place, l.far, l.back);
		}
		this.ask();
	}

	private fill(line: LineSegments2, p: PathData, from: number, to: number, on: boolean): void {
		line.visible = on && to - from > 1e-9;
		if (!line.visible) return;
		const i = indexAt(p, from), j = indexAt(p, to), step = Math.max(1, Math.ceil((j - i) / BACK_MAX));
		const points: number[] = [];
		let last = pointAt(p, from);
		const go = (q: [number, number, number]) => { points.push(...last, ...q); last = q; };
		for (let k = i + 1; k <= j; k += step)
			go([p.at[3 * k] as number, p.at[3 * k + 1] as number, p.at[3 * k + 2] as number]);
		go(pointAt(p, to));
		line.geometry.dispose();
		line.geometry = new LineSegmentsGeometry();
		line.geometry.setPositions(points);
		(line.material as LineMaterial).resolution.set(this.width, this.height);
	}

	view(v: View): void {
		const p = this.path;
		const centre = new Vector3(0, 0, 0);
		this.span = 1;
		if (p) {
			centre.set(...([0, 1, 2].map((i) => ((p.min[i] as number) + (p.max[i] as number)) / 2 - (p.origin[i] as number)) as [number, number, number]));
			this.span = Math.hypot(...[0, 1, 2].map((i) => (p.max[i] as number) - (p.min[i] as number))) || 1;
		}
		const far = this.span * 50;
		this.camera.near = -far * 2;
		this.camera.far = far * 2;
		this.camera.zoom = 1;
		const way = v === "top" ? new Vector3(0, -1e-4, 1) : v === "front" ? new Vector3(0, -1, 0) : new Vector3(0.8, -1, 0.62);
		this.camera.position.copy(centre).addScaledVector(way.normalize(), this.span * 2);
		this.controls.target.copy(centre);
		this.frame();
		this.controls.update();
		this.fit();
	}

	/** So that the whole path is seen from where it is looked at. */
	fit(): void {
		const p = this.path;
		if (p && p.n > 1) {
			this.camera.updateMatrixWorld();
			let x = 1e-9, y = 1e-9;
			const step = Math.max(1, Math.floor(p.n / 4000)), v = new Vector3();
			for (let i = 0; i < p.n; i += step) {
				v.fromArray(p.at, 3 * i).applyMatrix4(this.camera.matrixWorldInverse);
				x = Math.max(x, Math.abs(v.x));
				y = Math.max(y, Math.abs(v.y));
			}
			const unit = this.span * 0.6, wide = this.width / this.height;
			this.camera.zoom = Math.min(unit * Math.max(1, wide) / x, unit * Math.max(1, 1 / wide) / y) * 0.84;
		}
		this.camera.updateProjectionMatrix();
		this.ask();
	}

	private frame(): void {
		const half = this.span * 0.6, wide = this.width / this.height;
		const x = half * Math.max(1, wide), y = half * Math.max(1, 1 / wide);
		this.camera.left = -x;
		this.camera.right = x;
		this.camera.top = y;
		this.camera.bottom = -y;
		this.camera.updateProjectionMatrix();
		this.ask();
	}

	private project(v: Vector3): [number, number] {
		v.project(this.camera);
		return [(v.x + 1) / 2 * this.width, (1 - v.y) / 2 * this.height];
	}

	/** The line of the program whose path is nearest to a place on the canvas. */
	lineAt(x: number, y: number): { line: number; s: number } | null {
		const p = this.path;
		if (!p) return null;
		let best = 24 * 24, found = -1;
		const v = new Vector3(), step = Math.max(1, Math.floor(p.n / 100000));
		for (let i = 0; i < p.n; i += step) {
			const [px, py] = this.project(v.fromArray(p.at, 3 * i));
			const d = (px - x) ** 2 + (py - y) ** 2;
			if (d < best) { best = d; found = i; }
		}
		return found < 0 ? null : { line: p.line[found] as number, s: p.s[found] as number };
	}

	ask(): void {
		if (this.asked) return;
		this.asked = requestAnimationFrame(() => { this.asked = 0; this.draw(); });
	}

	draw(): void {
		const at = this.electrode();
		if (this.follow && at) {
			const move = at.clone().sub(this.controls.target);
			this.camera.position.add(move);
			this.controls.target.copy(at);
			this.camera.updateMatrixWorld();
		}
		if (this.turning) this.choose();
		const coarse = this.turning ? this.coarser() : null;
		this.coarse.forEach((c) => { c.todo.visible = c.done.visible = c === coarse; });
		for (const o of [this.todo, this.rapid, this.upper]) if (o) o.visible = !coarse;
		if (this.done) this.done.visible = !coarse && this.begun;
		this.renderer.render(this.scene, this.camera);
		this.frames++;
		this.mark();
	}

	private electrode(): Vector3 | null {
		const p = this.path, e = this.look.electrode;
		return p && e ? new Vector3(...([0, 1, 2].map((i) => (e[i] as number) - (p.origin[i] as number)) as [number, number, number])) : null;
	}

	private mark(): void {
		const at = this.electrode();
		this.onMarks({
			electrode: at ? this.project(at) : null,
			axes: this.triad(),
			mmPerPx: (this.camera.right - this.camera.left) / this.camera.zoom / this.width,
		});
	}

	private triad(): [string, number, number][] {
		const m = this.camera.matrixWorldInverse;
		return (["X", "Y", "Z"] as const).map((name, i) => {
			const v = new Vector3(i === 0 ? 1 : 0, i === 1 ? 1 : 0, i === 2 ? 1 : 0).transformDirection(m);
			return [name, v.x, -v.y];
		});
	}

	/** Turns the view round and draws each step: frames in a second. */
	async measure(ms: number): Promise<number> {
		const begun = performance.now();
		let n = 0;
		while (performance.now() - begun < ms) {
			this.camera.position.sub(this.controls.target).applyAxisAngle(new Vector3(0, 0, 1), 0.02).add(this.controls.target);
			this.camera.lookAt(this.controls.target);
			this.draw();
			this.renderer.getContext().finish();
			n++;
			await new Promise((r) => requestAnimationFrame(r));
		}
		return n * 1000 / (performance.now() - begun);
	}

	dispose(): void {
		cancelAnimationFrame(this.asked);
		this.setPath(null);
		cancelAnimationFrame(this.asked);
		this.controls.dispose();
		this.renderer.dispose();
	}
}
