// SPDX-License-Identifier: Apache-2.0
//
// Sentences of the machine in Chinese: what the host lacks (clients/ctl/doctor.c),
// events, who did what, and what is refused most often.  What is not known here is
// shown as it was said.
import { zhFaults, zhHunting } from "./zh";

type Put = string | ((...m: string[]) => string);

const ROLES: Record<string, string> = { none: "无", viewer: "查看者", operator: "操作员", service: "维护员" };
const STATES: Record<string, string> = {
	idle: "空闲", travel: "定位", approach: "趋近", erode: "加工", retract: "回退", jump: "抬刀", hold: "保持", fault: "故障",
	jog: "点动", home: "回零", probe: "测量",
};
const VERBS: Record<string, string> = {
	start: "启动", hold: "保持", resume: "继续任务", stop: "结束任务", retract: "回退", step: "走到节点", done: "确认",
	jog: "点动", "jog-on": "按住点动", home: "回零", place: "说明位置", override: "定位倍率", estop: "停止", reset: "复位", set: "设定",
	remove: "移除", move: "移动", offset: "工件偏置", mdi: "直接执行", "electrode-add": "新电极", "electrode-set": "修改电极",
	"electrode-remove": "移除电极", "electrode-use": "装入电极", "electrode-measure": "测量电极",
};

function faultOf(name: string): string {
	return zhFaults[name as keyof typeof zhFaults]?.what ?? name;
}

// Names of what the host is looked at for.
export const zhHost: Record<string, string> = {
	"kernel": "内核", "isolated core": "隔离的核", "governor": "调频策略", "throttling": "节流", "interrupts": "中断",
	"memory lock": "内存锁定", "priority": "优先级", "multicast route": "组播路由", "GPIO": "GPIO", "CAN": "CAN",
	"shared memory": "共享内存", "edmd": "edmd", "edmd-jobs": "edmd-jobs", "store": "存储", "checkpoint": "断点记录",
};

const HOST: [RegExp, Put][] = [
	[/(\S+) may run on ([^;]+)/g, "$1 可在核 $2 上运行"], [/isolated: none/g, "没有隔离的核"], [/isolated: (\S+)/g, "已隔离 $1"],
	[/\bcore (\d+) (\w+)/g, "核 $1 为 $2"], [/its cores have no steps of frequency/, "它的核没有频率档"],
	[/edmd does not run/, "edmd 没有运行"], [/^never$/, "从不"],
	[/after (\d+) of (\d+) us: a thread that never sleeps, as edges_per_period makes one, then stands/, "每 $2 µs 中的 $1 µs 之后：从不休眠的线程（如 edges_per_period 所需）会停住"],
	[/no thread of an interrupt of CAN or of lines/, "没有 CAN 或信号线的中断线程"], [/others at (\d+)/, "其他为 $1"],
	[/(\S+) at (\d+) on (\S+)/g, "$1 优先级 $2，在核 $3"], [/, of edmd$/, "（edmd）"], [/, of this shell$/, "（本次检查）"], [/^unlimited/, "不限"],
	[/^no way to (\S+)$/, "没有到 $1 的路由"], [/^no (\/dev\/gpiochip\*)$/, "没有 $1"], [/ not permitted/g, " 无权限"], [/^no CAN interface$/, "没有 CAN 接口"],
	[/ is there$/, " 存在"], [/ is not there, or not for this user$/, " 不存在，或此用户无权访问"], [/^not running$/, "没有运行"],
	[/^pid (\d+), (\w+), period (\S+) us, woken late by (\S+) us at most$/, (_, pid, s, period, late) => `进程 ${pid}，${STATES[s as string] ?? s}，周期 ${period} µs，最多晚醒 ${late} µs`],
	[/^pid (\d+)$/, "进程 $1"], [/^its STATUS is heard$/, "收到它的 STATUS"], [/^no STATUS is heard$/, "收不到 STATUS"],
	[/^edmd-jobs does not answer$/, "edmd-jobs 没有应答"], [/ MB, (\d+) jobs$/, " MB，$1 个任务"],
	[/^degraded: (.*); (\d+) entries wait in memory$/, "降级：$1；$2 条在内存中等待"],
	[/^(\d+) written since the start, (\S+) MB, the slowest took (\S+) ms$/, "启动以来写入 $1 次，$2 MB，最慢 $3 ms"], [/^cannot be written: /, "无法写入："],
	// What mends it: commands stay as they are.
	[/, and boot it$/, "，并用它启动"], [/^boot with (.*), and (.*); another N for (.*)$/, "启动参数 $1，并设 $2；$3 用另一个 N"],
	[/^ulimit (.*), or (\S+) in edmd.service$/, "ulimit $1，或在 edmd.service 中设 $2"],
	[/^chrt .*$/, "chrt -f -p N PID（该线程的 PID；N 高于其他中断线程、低于 edmd-cycle）；并用 edmd 以外的核"],
	[/^install (\S+) as a udev rule, /, "把 $1 装为 udev 规则，"], [/^make room on the disk of (.*), or mend it; nothing else needs to be done$/, "给 $1 所在磁盘腾出空间，或修复磁盘；其他不必做"],
	[/^mend the disk of (.*): until then a job cannot be found again after a power cut$/, "修复 $1 所在磁盘：在此之前，断电后无法找回任务"],
];

const TOLD: [RegExp, Put][] = [
	[/^job (.*): fault (\S+?)( \(.*\))? in line (\d+); reset, then start goes on, stop ends it$/, (_, job, f, own, line) => `任务 ${job}，第 ${line} 行：${faultOf(f as string)}${own ?? ""}；复位后启动可继续，结束任务可放弃`],
	[/^job (.*): the gap servo hunts: (\d+) retracts in a row without progress; .*$/, (_, job, n) => `任务 ${job}：间隙伺服振荡，连续 ${n} 次回退而无进展。${zhHunting}`],
	[/^interrupted in (\w+), line (\d+), at (\S+) mm of (\S+), cut to (\S+) mm; last seen (.*); if the host did not go down, edmd's log says why$/, (_, s, line, at, of, far, seen) => `中断于${STATES[s as string] ?? s}，第 ${line} 行，路径 ${at} / ${of} mm 处，已加工到 ${far} mm；最后所见 ${seen}；若主机没有断电，原因在 edmd 的日志里`],
	[/^edmd is lost: its cycle stands still$/, "控制循环停住或 edmd 已退出"], [/^edmd is there$/, "edmd 已恢复"],
	[/^fault (\S+?)( \(.*\))? without a job; reset leaves it$/, (_, f, own) => `没有任务时：${faultOf(f as string)}${own ?? ""}；复位即可`],
	[/^(\S+) \((\w+), ([^)]*)\): (\S+)(.*): ([^:]*)$/, (_, user, role, from, verb, what, became) => `${user}（${ROLES[role as string] ?? role}，${from}）：${VERBS[verb as string] ?? verb}${what}：${zhSaid(became as string)}`],
	[/^(\S+) \((\w+)\): sent job (\S+), (.*): ([^:]*)$/, (_, user, role, _id, job, became) => `${user}（${ROLES[role as string] ?? role}）：发送任务 ${job}：${zhSaid(became as string)}`],
	[/^accepted; /, "已接收；"], [/it will wait for start$/, "等待启动"], [/it starts now$/, "现在开始"],
	[/it starts when those before it are done$/, "前面的完成后开始"], [/the queue waits for start$/, "队列等待启动"],
	[/^(\S+) \((\w+), ([^)]*)\): jog-on (\w+) (begins|ends)$/, (_, user, role, from, axis, how) => `${user}（${ROLES[role as string] ?? role}，${from}）：按住点动 ${axis} ${how === "begins" ? "开始" : "结束"}`],
	[/^(\S+) \((\w+), ([^)]*)\): (\S+) was refused$/, (_, user, role, from, verb) => `${user}（${ROLES[role as string] ?? role}，${from}）：${VERBS[verb as string] ?? verb}被拒绝`],
	[/^(\S+): login as (.*) was refused$/, "$1：以 $2 登录被拒绝"], [/^(\S+): (\S+) logged in as (\w+)$/, (_, from, user, role) => `${from}：${user} 以${ROLES[role as string] ?? role}登录`],
];

const SHORT: Record<string, string> = {
	"done": "完成", "removed": "已移除", "moved": "已移动", "ready": "就绪", "no contact": "没有碰到", "none": "无",
	"the store failed": "存储失败", "the job has ended": "任务已结束", "the holder is empty": "夹头为空",
	"starts when its turn comes": "轮到时开始", "it is in the holder": "它在夹头中", "fault": "故障",
};

function put(text: string, table: [RegExp, Put][]): string {
	return table.reduce((s, [from, to]) => typeof to === "string" ? s.replace(from, to) : s.replace(from, to), text);
}

/** @text in Chinese, with its punctuation, as far as it is known. */
export function zhSaid(text: string): string {
	const known = zhHost[text] ?? SHORT[text] ?? (text in zhFaults ? faultOf(text) : undefined);
	if (known) return known;
	const is = put(put(text, TOLD), HOST);
	return is === text ? text : is.replace(/; /g, "；").replace(/, (?=\S)/g, "，");
}
