// SPDX-License-Identifier: Apache-2.0
//
// What can be done now, and if not, why not.  "" means it can.
import { link } from "./link";
import { t, type Word } from "./words";

const RUNS = new Set(["travel", "approach", "erode", "retract", "jump", "probe"]);
const BY_HAND = new Set(["jog", "home"]);

export type Act = "start" | "hold" | "retract" | "estop" | "reset" | "end" | "jog" | "home" | "set" | "send";

function word(act: Act): Word | "" {
	const s = link.state;
	const runs = isRunning(), loaded = s.loaded || s.jobState === "held";
	switch (act) {
	case "estop": return "";
	case "send": return s.jobs ? "" : "why.nojobs";
	case "start":
		if (s.state === "fault") return "no.fault";
		if (runs) return "no.runs";
		if (BY_HAND.has(s.state)) return "no.moving";
		if (s.interrupted && !s.loaded) return "why.interrupted";
		if (s.asks) return "no.asks";
		return s.state === "hold" || s.queue > 0 || s.job ? "" : "no.job";
	case "hold": return runs || BY_HAND.has(s.state) ? "" : "no.still";
	case "retract":
	case "end":
		if (s.state === "fault") return "no.fault";
		return loaded ? "" : "no.job";
	case "reset": return s.state === "fault" ? "" : "no.nofault";
	case "set": return loaded ? "" : "no.job";
	case "jog":
	case "home":
		if (s.state === "fault") return "no.fault";
		if (loaded) return "no.loaded";
		return s.state === "idle" || s.state === "jog" ? "" : "no.moving";
	}
}

export function whyNot(act: Act): string {
	if (link.connection !== "open") return t("no.connection");
	const role = link.hello?.role ?? "none";
	if (role !== "operator" && role !== "service")
		return t("no.role", { role: t(`role.${role}`) });
	if (link.state.daemon !== "ok" && act !== "send") return t("no.edmd");
	const w = word(act);
	return w ? t(w) : "";
}

/** Does it move, or begin to as soon as its drives have power? */
export function isRunning(): boolean {
	return RUNS.has(link.state.state) || link.state.stand === "power";
}
