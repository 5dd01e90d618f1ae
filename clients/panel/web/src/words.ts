// SPDX-License-Identifier: Apache-2.0
//
// The one catalogue of the page's words.  English stands here; zh.ts has the
// same keys, and a missing one fails the build.  The machine's own words
// (states, faults and their remedies) come from the tables of the daemons:
// machine.json is printed by `edm-panel --print-words`.
import machine from "./machine.json";
import { settings } from "./use";
import { zh, zhFaults, zhFields, zhHunting } from "./zh";
import { zhRefused } from "./zhnc";
import { zhSaid } from "./zhsaid";

export const en = {
	"page.cut": "Cut", "page.jobs": "Jobs", "page.setup": "Set up",
	"page.tech": "Technology", "page.alarms": "Alarms", "page.machine": "Machine",
	"page.fleet": "Fleet",

	"stop": "Stop", "stop.note": "not the emergency stop",
	"stop.about": "Ends motion and sparks at once. It does not replace the emergency stop of the machine.",
	"start": "Start", "resume": "Go on", "hold": "Hold", "retract": "Retract", "more": "Retract, end\u2026",
	"reset": "Reset", "end": "End job", "press": "press for 1 s",
	"close": "Close", "cancel": "Cancel", "again": "Try again", "remove": "Remove",
	"done": "done", "of": "of", "role": "role",
	"list": ", ", "pair": "{what}: {is}", "also": "{one}; {other}", "bracket": "{what} ({is})",

	"role.none": "nobody", "role.viewer": "viewer", "role.operator": "operator",
	"role.service": "service",

	"state.idle": "Idle", "state.travel": "Positioning", "state.approach": "Approach",
	"state.erode": "Cutting", "state.retract": "Retract", "state.jump": "Jump",
	"state.hold": "Held", "state.fault": "Fault", "state.jog": "Jog",
	"state.home": "Homing", "state.probe": "Probing", "state.unknown": "No signal",
	"state.ready": "Ready", "state.waits": "Waits", "state.interrupted": "Interrupted",

	"why.idle": "No job is loaded. Drop a program anywhere to begin.",
	"why.idle.queue": "Jobs wait in the queue. On Cut, press Start for 1 s to begin the next one.",
	"why.idle.lost": "The place of {axes} is not certain. On Set up, home these axes or say where they stand.",
	"why.idle.unhomed": "Axes are not homed: {axes}. Home them on Set up.",
	"why.interrupted": "A job was cut off, by a power failure or by the death of edmd. Look at the work; then resume the job on Jobs, or remove it.",
	"why.store": "The store cannot write, so no job is taken or begun. {why}.",
	"why.ready": "{job} is ready. On Cut, press Start for 1 s.",
	"why.travel": "Moves without sparks to where the cut begins.",
	"why.approach": "Moves up to the work until it sparks.",
	"why.erode": "Cuts line {line} by the gap voltage.",
	"why.retract": "Goes back along the path: the gap was short.",
	"why.jump": "Flushing lift of {mm} mm, then on at the same place.",
	"why.hold": "Stands on the path, sparks off. Go on, retract, or end the job.",
	"stand.held": "Held by command{by}, sparks off. Go on, retract, or end the job.",
	"stand.plc": "Held by the PLC. When it lets go: Go on.",
	"stand.stop": "The program stops in line {line}{said}. Go on when you are ready.",
	"stand.optional-stop": "An optional stop in line {line}{said}. Go on when you are ready.",
	"stand.electrode": "Put electrode {n} in; {held} is in. Then confirm it on Cut.",
	"stand.electrode.done": "Electrode {n} is in. Go on.",
	"stand.setting": "At the generator, set {condition}: {fields}. Then confirm it on Cut.",
	"stand.setting.done": "The generator is set. Go on.",
	"stand.reset": "A fault was reset. Look at the work; then go on, or end the job.",
	"stand.restart": "edmd was started anew. Look at the machine; then go on, or end the job.",
	"stand.end": "The program is at its end. End the job.",
	"stand.m-code": "Waits until the PLC has carried out M{n}.",
	"stand.generator": "Waits until the generator has the condition.",
	"stand.override": "Positioning is set to 0 %. Set it higher.",
	"stand.power": "Waits until the drives have power.",
	"done.electrode": "{n} is in", "done.empty": "It is out", "done.set": "It is set",
	"no.asks": "Confirm first what the machine asks for.",

	"why.jog": "Moves by hand.",
	"why.home": "Looks for the home of an axis.",
	"why.probe": "Moves until the electrode meets the work.",
	"why.absent": "edmd does not run on this host. Start it: systemctl start edmd.",
	"why.lost": "The cycle stands still, or edmd is dead. The last known values are shown. Use the machine's own emergency stop.",
	"why.connection": "The page has lost the panel. What runs goes on; it tries again by itself. Until then use the machine's own emergency stop.",
	"why.nojobs": "edmd-jobs does not answer. Hold, Stop and E-stop go to edmd itself, nothing else works; beside them use the machine's own emergency stop.",
	"why.noway": "No command reaches the machine. Use its own emergency stop.",

	"no.role": "The role {role} only looks on. Log in as operator.",
	"no.connection": "No connection to the panel.",
	"no.edmd": "edmd is not there.",
	"no.runs": "It runs already.",
	"no.job": "There is no job. Send one on Jobs.",
	"no.fault": "A fault is latched. Reset it first.",
	"no.nofault": "There is no fault.",
	"no.still": "Nothing runs.",
	"no.loaded": "A job is loaded. End it first, on Cut.",
	"no.moving": "The machine moves. Wait until it stands.",

	"cut.gap": "Gap voltage", "cut.feed": "Feed along the path", "cut.short": "short",
	"cut.servo": "servo", "cut.servochip": "Servo", "cut.runs": "runs already", "cut.open": "open", "cut.sparks": "sparks on",
	"cut.nosparks": "sparks off", "cut.back": "back", "cut.forward": "forward",
	"cut.still": "still", "cut.togo": "to go", "cut.depth": "Depth", "cut.deepest": "deepest {mm}", "cut.lean": "Wire leans", "cut.height": "Work height", "cut.done": "Done",
	"time.end": "ends {at}", "time.forecast": "by forecast", "time.cutting": "cutting", "time.positioning": "positioning", "time.and": ", ",
	"time.cut": "{what} takes {of} times its forecast", "time.learnt": "as learnt: {what} takes {of} times its forecast",
	"cut.left": "Left", "cut.jumps": "Jumps", "cut.retracts": "Retracts",
	"cut.shorts": "Shorts", "cut.time": "Time", "cut.line": "line", "cut.nojob": "No program",
	"cut.condition": "Condition", "cut.peak": "Peak", "cut.onoff": "On / off",
	"cut.jump": "Jump", "cut.override": "Positioning", "cut.more": "All values",
	"cut.path": "Path of the program", "cut.position": "Positions", "cut.machine": "machine coordinates",
	"cut.past": "Last hour", "cut.last": "last {s}", "cut.retractby": "Retract along the path",
	"cut.retractnote": "Goes back so far along the path, then stands held.",
	"cut.step": "Step to a node of the path", "cut.values": "Values in force",
	"cut.setnote": "A value that is set stays with its condition until the job ends.",
	"cut.takeback": "Take back", "cut.set": "Set", "cut.range": "{min} to {max} {unit}",
	"cut.setby": "set by hand", "cut.told": "the generator tells {value}", "cut.counts": "The generator counts: {value}", "cut.ownfault": "The generator's own fault: {value}", "cut.ofcondition": "of the condition",
	"cut.bounds": "{low} has to stay below {high}.",
	"cut.override.about": "Speed of positioning, in per cent of the programmed one.",

	"view.3d": "3D", "view.top": "Top", "view.front": "Front", "view.follow": "Follow",
	"view.cut": "cut", "view.back": "walked back now", "view.todo": "to do",
	"view.rapid": "positioning", "view.none": "The path of a program is drawn here.",
	"view.loading": "Drawing the path\u2026", "view.nogl": "This browser has no WebGL; the path cannot be drawn.",
	"view.failed": "The path cannot be drawn: {why}", "view.atline": "line {line}",
	"view.fit": "Fit", "view.electrode": "electrode",

	"jobs.drop": "Drop a program anywhere on this page", "jobs.choose": "Choose a file",
	"jobs.new": "New program", "jobs.queue": "Queue", "jobs.history": "History",
	"jobs.line": "Begin at line", "jobs.line.wanted": "A line of the program: 1, 2, 3 \u2026", "jobs.line.look": "Send it first, and look which way it will go in.",
	"jobs.set": "Set for this job", "jobs.set.taper": "Taper, + to the left", "jobs.set.wire-offset": "Wire offset, + to the left", "jobs.set.scale": "Scale", "jobs.set.turn": "Turn", "jobs.set.plane": "Plane of X Y", "jobs.set.second-plane": "Plane of U V",
	"jobs.set.mirror": "Mirror image", "jobs.mirror.none": "no image", "jobs.mirror.x": "of X", "jobs.mirror.y": "of Y", "jobs.mirror.exchange": "X for Y",
	"jobs.check": "Check", "jobs.checking": "Checking\u2026", "jobs.send": "Send",
	"jobs.sendstart": "Send and start", "jobs.ok": "Understood: {lines} lines, {mm} mm of path.",
	"jobs.errorat": "Line {line}, column {column}", "jobs.toerror": "Go to line {line}",
	"jobs.accepted": "Accepted instead", "jobs.name": "Name", "jobs.state": "State",
	"jobs.time": "Time", "jobs.depth": "Depth", "jobs.ended": "Ended", "jobs.reason": "Reason",
	"jobs.empty": "The queue is empty.", "jobs.nohistory": "No job has ended yet.",
	"jobs.sent": "{name} is in the queue.", "jobs.sending": "Sending: {share} %",
	"jobs.toolong": "The file is longer than 64 MiB.", "jobs.details": "Details of {name}",
	"jobs.changes": "Conditions called and values set", "jobs.nochanges": "None.",
	"jobs.length": "Path", "jobs.preview": "Preview", "jobs.editor": "Program text",
	"jobs.large": "This program is too long for the editor; it is checked and sent as it is.",
	"jobs.checkfirst": "The program has an error. Mend it first.",
	"jobs.sum": "Cut {cut} mm, positioning {rapid} mm",
	"jobs.conditions": "Conditions", "jobs.faults": "Faults", "jobs.inline": "line {line}",
	"jobs.arcs": "Arcs", "jobs.energy": "Energy", "jobs.notcounted": "not counted", "jobs.csv": "Save the history as a CSV table",
	"jobs.waits": "waits for Start", "jobs.more": "Show more",
	"jobs.resume": "Resume", "jobs.resume.about": "The job is read again and then stands ready. Start positions the electrode off the work and comes in along the path that was cut before.",
	"jobs.resume.sure": "The machine stands where it shows: {axes}",
	"jobs.front": "{name}: first", "jobs.back": "{name}: last", "jobs.clear": "Remove all that wait",
	"jobs.total": "All of it takes {time}; if nothing is held, it ends {at}.", "jobs.untold": "Of {n} more that is not known.",
	"jobs.search": "Name, day, T3 \u2026", "jobs.nofound": "No job has all of that.", "jobs.totals": "Totals", "jobs.days": "By day", "jobs.months": "By month",
	"jobs.day": "Day", "jobs.month": "Month", "jobs.eroding": "Eroding", "jobs.text": "Program text",
	"text.before": "Lines before", "text.after": "Lines behind", "text.line": "First line that is shown",
	"jobs.outcome": "What it did", "jobs.setwas": "Was", "jobs.setis": "Is",
	"jobs.ahead": "{name}: earlier", "jobs.behind": "{name}: later",

	"job.queued": "queued", "job.ready": "ready", "job.running": "runs", "job.held": "held",
	"job.done": "done", "job.fault": "fault", "job.stopped": "ended",
	"job.interrupted": "interrupted",

	"setup.jog": "Jog", "setup.step": "Step",
	"place.title": "Place of axes that nothing homes", "place.about": "Nothing moves. Say where an axis stands; as seen is for one that was not moved while the power was off.",
	"place.seen": "As seen last", "place.at": "{axis} stands at", "place.set": "Take",
	"setup.home": "Home", "setup.homeall": "Home all axes", "setup.probe": "Touch off",
	"setup.offsets": "Work offsets", "setup.position": "Position",
	"setup.homed": "homed", "setup.unhomed": "not homed", "setup.limit": "on its limit switch", "setup.lost": "not certain",
	"setup.offsetnote": "Where the origins are on the machine. * was touched off, the others are those of the machine file.",
	"setup.faster": "Step size", "setup.held": "while pressed", "setup.speed": "Speed",
	"setup.held.about": "Moves while the key is pressed, and stands when it is let go or the connection is lost.",
	"work.system": "Work system that is shown", "work.machine": "machine", "cut.pass": "Pass", "cut.offset": "Offset",
	"tech.save": "Save on the host", "tech.versions": "Versions", "tech.back": "Take back", "tech.backto": "Take version {n} back",
	"jobs.noforecast": "no forecast: {why}", "work.inforce": "The work system in force at the line that is cut",
	"off.turn": "Turn", "off.tiltx": "Rises along X", "off.tilty": "Rises along Y",
	"el.x": "Shifts X (C at 0)", "el.y": "Shifts Y (C at 0)", "el.c": "Shifts C",
	"off.edit": "Work offset {work}", "off.system": "System", "off.means": "What the numbers mean", "off.now": "origin now at",
	"off.here": "Here is", "off.here.about": "Where an axis stands becomes this number. The machine must be idle; an axis without a number stays.",
	"off.origin": "Origin at", "off.origin.about": "The origin of an axis becomes this place of the machine. An axis without a number stays.",
	"off.clear": "As in the machine file", "off.asfile": "All axes are as in the machine file.",
	"el.title": "Electrodes", "el.add": "New electrode", "el.edit": "Electrode {n}", "el.n": "Electrode",
	"el.empty": "The table of electrodes is empty.", "el.none": "none", "el.held": "in the holder",
	"el.name": "Name", "el.material": "Material", "el.undersize": "Undersize on each side", "el.length": "Length when new",
	"el.wear": "Wear", "el.life": "Worn out at a wear of (0: never)", "el.minutes": "Worn out after (0: never)", "el.sparked": "Sparked",
	"el.left": "Left", "el.state": "State", "el.note": "Note", "el.shift": "Z shifted by",
	"el.number": "Number (T word)", "el.save": "Save", "el.use": "It is in the holder", "el.out": "The holder is empty",
	"el.measure": "Measure", "el.measure.about": "Measure makes a job: it stops until this electrode is in the holder, then goes down on the reference and writes what it finds into the table. Start it on Cut.",
	"el.measuring": "The job that measures electrode {n} is in the queue.",
	"el.there": "there", "el.worn": "worn", "el.absent": "absent", "el.used": "Electrodes", "cut.electrode": "Electrode",

	"mdi.title": "Lines at once", "mdi.about": "A line is checked, then carried out at once. It begins from where the machine stands.",
	"mdi.line": "Line", "mdi.run": "Carry out", "mdi.none": "Write a line first, such as G0 X5.", "mdi.runs": "{line}: it runs\u2026",
	"mdi.done": "{line}: done", "mdi.failed": "{line}: {why}", "mdi.last": "Last lines, to be taken again",

	"speed.slow": "slow", "speed.middle": "middle", "speed.fast": "fast",

	"probe.edge": "Edge or face", "probe.edge.about": "Moves along one axis until the electrode meets the work.",
	"probe.hole": "Centre of a hole", "probe.hole.about": "The electrode stands in the hole. X and Y are probed both ways, then it goes to the middle.",
	"probe.block": "Centre of a block", "probe.block.about": "The electrode stands over the block, near its middle. It goes beside it, down, and probes each side.",
	"probe.corner": "Corner", "probe.corner.about": "Probes X, then Y, and stands off both walls.",
	"probe.axis": "Axis", "probe.way": "Way", "probe.far": "At most", "probe.radius": "Farthest way to a wall",
	"probe.off": "Off a wall", "probe.times": "Times", "probe.sidex": "Beside, X", "probe.sidey": "Beside, Y",
	"probe.down": "Down", "probe.wayx": "Wall, X", "probe.wayy": "Wall, Y", "probe.zero": "It is",
	"probe.nozero": "or empty", "probe.outer": "Outer corner",
	"probe.skew": "Lie of the work", "probe.skew.about": "Touches one face twice. The angle turns the work system, so that a program is cut as the work lies; a face above tells how far it rises.",
	"probe.middle": "Middle of the electrode", "probe.middle.about": "The electrode stands over a ball or pin whose place is known. All four sides are probed; how far the electrode is beside the holder goes into its table.",
	"probe.straight": "Turn of the electrode", "probe.straight.about": "One face of the electrode touches a pin twice. C is shifted so that the face is straight.",
	"probe.face.along": "Toward the face", "probe.line": "Along", "probe.along": "From touch to touch", "probe.ball": "Middle of the ball",
	"probe.warn": "The electrode moves. Look at the machine, not at this page.",
	"probe.bad": "Number wanted",
	"probe.length": "Electrode length", "probe.length.about": "Feels down to a face whose machine place is known. The length goes into the table of electrodes.",
	"probe.tool": "Radius of the electrode", "probe.face": "The face is at", "probe.is": "The electrode is",
	"touch.new": "new", "touch.worn": "worn", "touch.into": "Into", "touch.run": "Touch off", "touch.none": "No electrode of the table is in the holder. Take one on this page.",
	"touch.now": "now", "touch.was": "was", "touch.is": "is", "touch.feels": "It feels\u2026", "touch.failed": "Nothing was changed: {why}",

	"tech.table": "Technology table", "tech.none": "The machine file names no technology table ([tech] table).",
	"tech.refused": "The table is refused", "tech.condition": "Condition", "tech.sequences": "Sequences",
	"tech.compare": "Compare", "tech.with": "with", "tech.export": "Export as .tech",
	"tech.electrode": "Electrode", "tech.workpiece": "Workpiece", "tech.field": "Field",
	"tech.value": "Value", "tech.unit": "Unit", "tech.inforce": "in force",
	"tech.edit": "Edit", "tech.edited": "Not saved yet. Jobs have it when it is saved; {file} is kept as a version.",
	"tech.machine": "machine file", "tech.same": "same", "tech.notes": "Notes",
	"tech.discard": "Discard changes",

	"event.warning": "Warning", "event.lost": "edmd was lost", "event.back": "edmd is there",
	"alarms.now": "Now", "alarms.none": "No fault.", "alarms.history": "Earlier",
	"alarms.empty": "No alarm is recorded.", "alarms.when": "When", "alarms.what": "What", "alarms.why": "Why",
	"alarms.clear": "What to do", "alarms.where": "Where", "alarms.inline": "{job}, line {line}, {mm} mm along the path",
	"alarms.warnings": "Warnings", "alarms.store": "The store is degraded", "alarms.interrupted": "A job was interrupted",
	"alarms.lost": "The place of {axes} is not certain", "alarms.lost.about": "On Set up, home these axes or say where they stand.",
	"alarms.hunts": "Many retracts without progress",
	"alarms.others": "Latched as well",
	"alarms.resetgo": "Reset, then Start goes on where it stands.",

	"machine.latency": "Latency of the cycle", "machine.latency.about": "How late the cycle was woken, and how often.",
	"machine.late": "latest", "machine.took": "longest cycle", "machine.missed": "missed periods",
	"machine.period": "period", "machine.doctor": "Host", "machine.log": "Log", "machine.acts": "Who did what",
	"machine.versions": "Versions", "machine.settings": "This browser", "machine.language": "Language",
	"machine.theme": "Colours", "theme.auto": "as the device", "theme.light": "light", "theme.dark": "dark",
	"machine.bundle": "Download for support", "machine.nolog": "This host keeps no journal of the services.",
	"machine.noacts": "Nothing was done yet.", "machine.user": "You are", "machine.logout": "Log out",
	"machine.browsers": "Panel", "verdict.good": "good", "verdict.lacking": "lacking", "verdict.unused": "unused",
	"machine.doctoring": "Looking at the host\u2026", "machine.count": "wakes", "machine.simulated": "simulated machine",
	"machine.real": "real machine", "machine.kind": "Kind",

	"fleet.none": "No machine is heard over DDS. edm-dds tells the fleet of a machine.",
	"fleet.looking": "Listening for machines\u2026", "fleet.progress": "done", "fleet.needs": "needs a person",

	"login.title": "Log in", "login.user": "User", "login.password": "Password", "login.go": "Log in",
	"lost.title": "Connection lost", "unit.mms": "mm/s", "unit.min": "min",
	"skip": "Skip to the page", "chart.gap": "Gap voltage over time", "chart.feed": "Feed over time",
	"chart.latency": "Histogram of lateness", "range.60": "60 s", "range.600": "10 min", "range.3600": "1 h",
	"drop.here": "Drop to check the program", "event.alarm": "Alarm",
} as const;

// Every state and outcome of the machine has a word above.
type States = `state.${keyof typeof machine.states}`;
type Outcomes = `job.${Exclude<keyof typeof machine.outcomes, "none">}`;
type Missing = Exclude<States | Outcomes, keyof typeof en>;
const missing: [Missing] extends [never] ? true : Missing = true;
void missing;

export type Word = keyof typeof en;
export type Fault = keyof typeof machine.faults;
export interface FaultWords { what: string; why: string; clear: string }

/** The text of a word in this browser's language; {x} is put in. */
export function t(word: Word, put: Record<string, string | number> = {}): string {
	const text: string = settings.language === "zh-CN" ? zh[word] : en[word];
	return text.replace(/\{(\w+)\}/g, (_, k: string) => String(put[k] ?? ""));
}

/** Several things, as the language lists them. */
export function list(of: string[]): string {
	return of.filter((x) => x).join(t("list"));
}

/** What the machine said in a sentence of its own, as far as it is known. */
export function said(text: string): string {
	return settings.language === "zh-CN" ? zhSaid(text) : keys(text);
}

/** What was found in a program, or what is accepted. */
export function refused(text: string): string {
	return settings.language === "zh-CN" ? zhRefused(text) : text;
}

export function isWord(word: string): word is Word {
	return word in en;
}

function keys(text: string): string {
	return text.replace(/edmctl doctor/g, "Host on page Machine").replace(/edmctl estop/g, "Stop")
		.replace(/\b(edmctl )?stop ends (it|the job)/g, "End job ends $2").replace(/edmctl /g, "");
}

// The table speaks of edmctl; here its verbs are keys and pages.
function onPage(text: string): string {
	return keys(text).replace(/^./, (c) => c.toUpperCase());
}

export function faultWords(fault: string): FaultWords {
	if (settings.language === "zh-CN") return zhFaults[fault as Fault] ?? { what: fault, why: "", clear: "" };
	const w = machine.faults[fault as Fault] ?? { what: fault, why: "", clear: "" };
	return { what: onPage(w.what), why: onPage(w.why), clear: onPage(w.clear) };
}

export function stateWord(state: string): string {
	const word = `state.${state}`;
	return isWord(word) ? t(word) : state;
}

export function jobWord(state: string): string {
	const word = `job.${state}`;
	return isWord(word) ? t(word) : state;
}

/** What helps against a servo that hunts. */
export function huntingWords(): string {
	return onPage(settings.language === "zh-CN" ? zhHunting : machine.hunting);
}

/** What a field of a condition is called. */
export function fieldWord(name: string, help: string): string {
	return settings.language === "zh-CN" ? zhFields[name] ?? help : help;
}
