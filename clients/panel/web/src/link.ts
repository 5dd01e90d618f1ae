// SPDX-License-Identifier: Apache-2.0
//
// The web socket to the panel: the state comes in, requests go out.

export interface Axis {
	name: string; index: number; rotary: boolean; min: number; max: number;
	pulse: number; vMax: number; jog: number; homes: boolean;
}

export interface Field {
	name: string; unit: string; min: number; max: number; whole: boolean;
	live: boolean; help: string;
}

export interface Hello {
	machine: string; user: string; role: Role; version: string; axes: Axis[];
	fields: Field[]; process: number; height: number; plc: boolean; simulated: boolean;
	table: string;
}

export type Role = "none" | "viewer" | "operator" | "service";

export interface State {
	daemon: string; state: string; fault: string; outcome: string; loaded: boolean;
	power: boolean; pump: boolean; negative: boolean; gap: number; feed: number;
	override: number; pos: number[]; place: number; far: number; length: number;
	depth: number; depthFar: number; lean: number; line: number; seg: number; program: number; unhomed: number;
	limit: number; jumps: number; retracts: number; shorts: number;
	overruns: number; lateMaxUs: number; tookMaxUs: number; periodUs: number;
	jobS: number; condition: string; values: Record<string, number>;
	set: string[]; told: Record<string, number>; generator_fault: string; jobs: boolean; job: string; jobName: string; jobState: string;
	lines: number; queue: number; eta: number; etaMin: number; etaMax: number; etaBy: string; etaCondition: string; etaFactor: number; end: number; queueS: number; queueUntold: number; queueEnd: number; progress: number;
	store: string;
	interrupted: string; lost: string; faults: string; hunts: number;
	electrode: number; work: string; workTurn: number; workMm: number[]; pass: number; passes: number; wireOffset: number; stand: string; standOf: number; standN: number; asks: boolean; asksFor: string;
}

// t ms, gap min mean max, feed min mean max, depth, state number
export type Point = [number, number, number, number, number, number, number,
	number, number];

export interface Session {
	user: string; role: Role; token: string; login: boolean; machine: string;
}

export interface Answer<T = unknown> { n?: number; code: number; reason: string; body: T }

export type Connection = "waiting" | "open" | "lost" | "login";

const EMPTY: State = {
	daemon: "absent", state: "unknown", fault: "none", outcome: "none",
	loaded: false, power: false, pump: false, negative: false, gap: 0, feed: 0,
	override: 1, pos: [], place: 0, far: 0, length: 0, depth: 0, depthFar: 0, lean: 0, line: 0, seg: 0,
	program: 0, unhomed: 0, limit: 0, jumps: 0, retracts: 0, shorts: 0,
	overruns: 0, lateMaxUs: 0, tookMaxUs: 0, periodUs: 0, jobS: 0, condition: "",
	values: {}, set: [], told: {}, generator_fault: "", jobs: false, job: "", jobName: "", jobState: "",
	lines: 0, queue: 0, eta: -1, etaMin: -1, etaMax: -1, etaBy: "", etaCondition: "", etaFactor: 0, end: 0, queueS: 0, queueUntold: 0, queueEnd: 0, progress: 0,
	store: "", interrupted: "", lost: "",
	faults: "", hunts: 0, electrode: 0, work: "", workTurn: 0, workMm: [], pass: 0, passes: 0, wireOffset: 0, stand: "", standOf: 0, standN: 0, asks: false, asksFor: "",
};

const POINTS_KEPT = 620;
const SILENT_MS = 2000;
const ASK_MS = 5000;

type Listener = () => void;

class Link {
	state: State = EMPTY;
	hello: Hello | null = null;
	session: Session | null = null;
	connection: Connection = "waiting";
	points: Point[] = [];
	events: { kind: string; text: string; n: number }[] = [];
	version = 0;
	private socket: WebSocket | null = null;
	private number = 0;
	private waiting = new Map<number, (a: Answer<any>) => void>();
	private listeners = new Set<Listener>();
	private heard = 0;
	private delay = 250;

	listen(l: Listener): () => void {
		this.listeners.add(l);
		return () => { this.listeners.delete(l); };
	}

	private tell(): void {
		this.version++;
		for (const l of this.listeners) l();
	}

	async start(): Promise<void> {
		setInterval(() => this.watch(), 500);
		await this.open();
	}

	private async open(): Promise<void> {
		try {
			const r = await fetch("/api/session", { signal: AbortSignal.timeout(ASK_MS) });
			this.session = await r.json() as Session;
		} catch {
			this.again();
			return;
		}
		if (this.session.role === "none") {
			this.connection = "login";
			this.tell();
			return;
		}
		const scheme = location.protocol === "https:" ? "wss:" : "ws:";
		const s = new WebSocket(`${scheme}//${location.host}/api/live`, "edm-panel");
		this.socket = s;
		this.heard = performance.now() + ASK_MS;
		s.onopen = () => {
			this.heard = performance.now();
			this.number = 0;
			this.delay = 250;
		};
		s.onmessage = (m) => { if (this.socket === s) this.take(JSON.parse(m.data as string)); };
		s.onclose = () => { if (this.socket === s) this.again(); };
	}

	// Lost: what waits for an answer is told so, and the way is tried again.
	private again(): void {
		this.socket = null;
		this.connection = "lost";
		for (const done of this.waiting.values())
			done({ code: 69, reason: "connection", body: null });
		this.waiting.clear();
		this.tell();
		setTimeout(() => void this.open(), this.delay);
		this.delay = Math.min(this.delay * 1.6, 3000);
	}

	// A socket that fell silent may take minutes to end: it is left at once.
	private watch(): void {
		const s = this.socket;
		if (!s || performance.now() - this.heard < SILENT_MS) return;
		this.again();
		s.close();
	}

	private take(m: any): void {
		this.heard = performance.now();
		if (m.hello) {
			this.hello = m.hello as Hello;
			this.connection = "open";
			void this.fetchPast();
		} else if (m.whole || m.new) {
			this.state = m.whole ? { ...EMPTY, ...m.whole } : { ...this.state, ...m.new };
			if (m.point) this.points.push(m.point as Point);
			if (this.points.length > POINTS_KEPT)
				this.points.splice(0, this.points.length - POINTS_KEPT);
		} else if (m.event) {
			this.events.push({ ...m.event, n: this.version });
			this.events.splice(0, this.events.length - 20);
		} else if (typeof m.n === "number") {
			const done = this.waiting.get(m.n as number);
			this.waiting.delete(m.n as number);
			done?.(m as Answer);
		}
		this.tell();
	}

	private async fetchPast(): Promise<void> {
		const a = await this.ask<Point[]>("history", { seconds: 60, points: 600 });
		if (a.code === 0 && Array.isArray(a.body)) this.points = a.body;
		else if (a.code === 75) setTimeout(() => void this.fetchPast(), 2000);
	}

	ask<T = unknown>(what: string, more: Record<string, unknown> = {}): Promise<Answer<T>> {
		return new Promise((resolve) => {
			if (!this.socket || this.socket.readyState !== WebSocket.OPEN) {
				resolve({ code: 69, reason: "connection", body: null as T });
				return;
			}
			const n = ++this.number;
			this.waiting.set(n, resolve);
			this.socket.send(JSON.stringify({ n, token: this.session?.token, do: what, ...more }));
		});
	}

	async post<T>(path: string, body: BodyInit, progress?: (share: number) => void): Promise<T> {
		// fetch() tells nothing of an upload's progress.
		return new Promise((resolve, reject) => {
			const x = new XMLHttpRequest();
			x.open("POST", path);
			x.setRequestHeader("X-Edm-Token", this.session?.token ?? "");
			x.upload.onprogress = (e) => progress?.(e.total ? e.loaded / e.total : 0);
			x.onload = () => {
				try { resolve(JSON.parse(x.responseText) as T); } catch { reject(new Error(String(x.status))); }
			};
			x.onerror = () => reject(new Error("connection"));
			x.send(body as XMLHttpRequestBodyInit);
		});
	}

	async login(user: string, password: string): Promise<string> {
		const r = await fetch("/api/login", {
			method: "POST", body: JSON.stringify({ user, password }),
		});
		const o = await r.json() as Session & { found?: string; wanted?: string };
		if (!r.ok) return `${o.found}; ${o.wanted}`;
		this.connection = "waiting";
		this.tell();
		await this.open();
		return "";
	}

	async logout(): Promise<void> {
		await this.post("/api/logout", "");
		location.reload();
	}
}

export const link = new Link();
