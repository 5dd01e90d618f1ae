// SPDX-License-Identifier: Apache-2.0
//
// A program's path as the panel sends it: work.h of clients/panel says how.

export interface PathData {
	n: number; lines: number; length: number; cut: number; rapid: number;
	tolerance: number; origin: number[]; min: number[]; max: number[]; name: string;
	s: Float64Array; at: Float32Array; line: Uint32Array; upper: Float32Array | null;
	kind: Uint8Array;
}

export const CUT = 0, RAPID = 1, PROBE = 2;

export function decode(b: ArrayBuffer): PathData {
	const bytes = new Uint8Array(b);
	const end = bytes.indexOf(10) + 1;
	const h = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
	const n = h.points as number;
	let at = end;
	const take = (size: number) => { const from = at; at += size; return from; };
	const s = new Float64Array(b, take(8 * n), n);
	const xyz = new Float32Array(b, take(12 * n), 3 * n);
	const line = new Uint32Array(b, take(4 * n), n);
	const upper = h.upper ? new Float32Array(b, take(8 * n), 2 * n) : null;
	const kind = new Uint8Array(b, take(n), n);
	return { n, lines: h.lines, length: h.length, cut: h.cut, rapid: h.rapid, tolerance: h.tolerance,
		origin: h.origin, min: h.min, max: h.max, name: h.name, s, at: xyz, line, upper, kind };
}

/** The last point that is not beyond the place s. */
export function indexAt(p: PathData, s: number): number {
	let low = 0, high = p.n - 1;
	while (low < high) {
		const mid = (low + high + 1) >> 1;
		if ((p.s[mid] as number) <= s) low = mid; else high = mid - 1;
	}
	return low;
}

/** The point at the place s, less the origin. */
export function pointAt(p: PathData, s: number): [number, number, number] {
	const i = indexAt(p, s), j = Math.min(i + 1, p.n - 1);
	const from = p.s[i] as number, to = p.s[j] as number;
	const u = to > from ? Math.min(1, Math.max(0, (s - from) / (to - from))) : 0;
	const mix = (k: number) => (p.at[3 * i + k] as number) * (1 - u) + (p.at[3 * j + k] as number) * u;
	return [mix(0), mix(1), mix(2)];
}

const known = new Map<string, Promise<PathData>>();

async function load(query: string, tries = 10): Promise<PathData> {
	const r = await fetch(`/api/path?${query}`);
	// Others are being drawn.
	if (r.status === 503 && tries > 0) {
		await new Promise((done) => setTimeout(done, 1000));
		return load(query, tries - 1);
	}
	if (!r.ok) {
		const o = await r.json().catch(() => ({ found: String(r.status) })) as { found: string };
		throw new Error(o.found);
	}
	return decode(await r.arrayBuffer());
}

/** Kept, so that a page that is opened again has its path at once. */
export function fetchPath(query: string): Promise<PathData> {
	let p = known.get(query);
	if (!p) {
		p = load(query);
		known.set(query, p);
		p.catch(() => known.delete(query));
		if (known.size > 6) known.delete(known.keys().next().value as string);
	}
	return p;
}
