// SPDX-License-Identifier: Apache-2.0
//
// Lines of the program that runs, asked for by the hundred and kept; and what
// the table calls an electrode that is asked for.
import { useEffect, useState } from "preact/hooks";
import { link } from "./link";
import { list } from "./words";

interface Lines { first: number; text: string }

let ofJob = "";
const known = new Map<number, string>();
const asked = new Set<number>();

/** The text of a line of a job; "" while it is not known. */
export function useLine(job: string, line: number): string {
	const [, again] = useState(0);
	if (job && job !== ofJob) {
		ofJob = job;
		known.clear();
		asked.clear();
	}
	useEffect(() => {
		const first = Math.max(1, line - 50);
		if (!job || line < 1 || known.has(line) || asked.has(line)) return;
		asked.add(line);
		void link.ask<Lines>("text", { job, arg: known.has(first) ? line : first }).then((a) => {
			if (job !== ofJob) return;
			if (a.code !== 0 || !a.body) { asked.delete(line); return; }
			a.body.text.split("\n").slice(0, -1).forEach((s, i) => known.set((a.body as Lines).first + i, s));
			if (known.size > 5000) known.clear();
			again((n) => n + 1);
		});
	}, [job, line]);
	return lineKnown(job, line);
}

/** The same, of lines that somebody has asked for already. */
export function lineKnown(job: string, line: number): string {
	return job === ofJob ? known.get(line) ?? "" : "";
}

interface Row { n: number; name: string; material: string }
const called = new Map<number, string>();

/** Name and material of an electrode, of those that useElectrodeNames() asked for. */
export function electrodeKnown(n: number): string {
	return called.get(n) ?? "";
}

/** Asks what these electrodes are called. */
export function useElectrodeNames(of: number[]): void {
	const [, again] = useState(0);
	useEffect(() => {
		for (const n of of) if (n > 0) void link.ask<Row[]>("electrodes", { arg: n - 1 }).then((a) => {
			const row = a.code === 0 ? a.body?.find((e) => e.n === n) : undefined;
			called.set(n, list([row?.name ?? "", row?.material ?? ""]));
			again((k) => k + 1);
		});
	}, [of.join(), link.connection]);
}
