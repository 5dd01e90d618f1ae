// SPDX-License-Identifier: Apache-2.0
//
// A motion that lasts as long as a finger: a sign of the press goes out every
// 40 ms, and the machine stands a fifth of a second after the last one.
import { link } from "./link";

const SIGN_MS = 40;

/** Begins it.  `over` is called if it ends by itself: with the reason. */
export function beginPress(axis: string, speed: number, over: (why: string) => void): () => void {
	const press = 1 + Math.floor(Math.random() * 0xfffffffe);
	let heard = 0, ended = false;
	const sign = () => {
		if (ended) return;
		void link.ask("press", { text: axis, arg: speed, press, heard }).then((a) => {
			if (ended) return;
			if (a.code !== 0) { end(); over(a.reason); return; }
			const first = heard === 0;
			heard = a.n ?? 0;
			// The second one begins the motion: it need not wait.
			if (first) sign();
		});
	};
	const end = () => {
		if (ended) return;
		ended = true;
		clearInterval(timer);
		void link.ask("press", { text: axis, arg: 0, press, heard });
	};
	const timer = setInterval(sign, SIGN_MS);
	sign();
	return end;
}
