// SPDX-License-Identifier: Apache-2.0
//
// Lines of the program that runs, asked for by the hundred and kept.
import { useEffect, useState } from "preact/hooks";
import { link } from "./link";

interface Lines { first: number; text: string }

let ofJob = "";
const known = new Map<number, string>();
const asked = new Set<number>();

/** The text of a line of a job; "" while it is not known. */
export function useLine(job: string, line: number): string {
	const [, again] = useState(0);
	if (job !== ofJob) {
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
	return known.get(line) ?? "";
}
