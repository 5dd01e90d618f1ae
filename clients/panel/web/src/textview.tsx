// SPDX-License-Identifier: Apache-2.0
//
// The text of a job, of any length: a piece of it at a time.
import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { number } from "./format";
import { link } from "./link";
import { Key, Sheet } from "./parts";
import { t } from "./words";

interface Piece { first: number; text: string }

export function TextSheet(p: { job: string; lines: number; at: number; onClose: () => void }): JSX.Element {
	const [first, go] = useState(Math.max(1, p.at - 5));
	const [piece, set] = useState<Piece | null>(null);
	const [why, tell] = useState("");
	const step = Math.max(1, piece ? piece.text.split("\n").length - 1 : 1);
	const to = (n: number) => go(Math.min(Math.max(1, Math.round(n)), Math.max(1, p.lines)));
	useEffect(() => {
		let live = true;
		// A finger that slides asks for the last place only.
		const timer = setTimeout(() => void link.ask<Piece>("text", { job: p.job, arg: first }).then((a) => {
			if (!live) return;
			tell(a.code === 0 ? "" : a.reason);
			if (a.code === 0) set(a.body);
		}), 60);
		return () => { live = false; clearTimeout(timer); };
	}, [p.job, first]);
	const rows = (piece?.text ?? "").split("\n").slice(0, -1);
	return <Sheet title={t("jobs.text")} onClose={p.onClose} wide>
		<div class="textkeys"><Key label={t("text.before")} onPress={() => to(first - step)}>{"\u2191"}</Key>
			<input type="range" min={1} max={Math.max(1, p.lines)} value={first} aria-label={t("text.line")} onInput={(e) => to(Number(e.currentTarget.value))} />
			<Key label={t("text.after")} onPress={() => to(first + step)}>{"\u2193"}</Key>
			<input class="lineno" inputMode="numeric" value={first} aria-label={t("text.line")} onChange={(e) => to(Number(e.currentTarget.value) || 1)} /><span>{t("of")} {number(p.lines, 0)}</span></div>
		{why && <p class="note">{why}</p>}
		<pre class="program" id="program">{rows.map((r, i) => <div class={(piece?.first ?? 1) + i === p.at && p.at > 1 ? "here" : ""}><i>{(piece?.first ?? 1) + i}</i>{r}</div>)}</pre>
	</Sheet>;
}
