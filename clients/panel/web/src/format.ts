// SPDX-License-Identifier: Apache-2.0
//
// Numbers as people of a language write them, and read back.
import { settings } from "./use";

const made = new Map<string, Intl.NumberFormat>();

function formatOf(decimals: number, sign: boolean): Intl.NumberFormat {
	const key = `${settings.language} ${decimals} ${sign}`;
	let f = made.get(key);
	if (!f) {
		f = new Intl.NumberFormat(settings.language, {
			minimumFractionDigits: decimals, maximumFractionDigits: decimals,
			signDisplay: sign ? "exceptZero" : "auto", useGrouping: false,
		});
		made.set(key, f);
	}
	return f;
}

/** Fixed decimals; a true minus, which is as wide as a plus. */
export function number(x: number, decimals: number, sign = false): string {
	const rounded = Number(x.toFixed(decimals)) === 0 ? 0 : x;
	return formatOf(decimals, sign).format(rounded).replace("-", "\u2212");
}

/** As few decimals as it needs, for values of a table. */
export function short(x: number): string {
	return new Intl.NumberFormat(settings.language, {
		maximumSignificantDigits: 6, useGrouping: false,
	}).format(x).replace("-", "\u2212");
}

/** Point and comma both; NaN if it is no number. */
export function parse(text: string): number {
	const t = text.trim().replace("\u2212", "-").replace(",", ".");
	return /^[+-]?(\d+\.?\d*|\.\d+)$/.test(t) ? Number(t) : NaN;
}

export function duration(s: number): string {
	if (!(s >= 0)) return "\u2013";
	const two = (n: number) => String(Math.floor(n)).padStart(2, "0");
	return s >= 3600 ? `${Math.floor(s / 3600)}:${two(s % 3600 / 60)}:${two(s % 60)}` :
		`${Math.floor(s / 60)}:${two(s % 60)}`;
}

export function clock(ms: number): string {
	return new Date(ms).toLocaleTimeString(settings.language, { hour: "2-digit", minute: "2-digit", hour12: false });
}

export function moment(ms: number): string {
	return new Date(ms).toLocaleString(settings.language, {
		month: "short", day: "2-digit", hour: "2-digit", minute: "2-digit", second: "2-digit", hour12: false,
	});
}

export function unitWord(unit: string): string {
	return unit.replace("us", "\u00b5s").replace("um", "\u00b5m").replace("mm3", "mm\u00b3");
}
