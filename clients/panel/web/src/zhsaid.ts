// SPDX-License-Identifier: Apache-2.0
//
// Sentences of the machine in Chinese: what the host lacks (clients/ctl/doctor.c),
// events, who did what, and what is refused most often.  What is not known here is
// shown as it was said.
import { zhFaults, zhHunting } from "./zh";
import { zhRefused } from "./zhnc";

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
	[/^'(.*)'; a number of mm from (\S+) to (\S+)$/, "“$1”；须为 $2 到 $3 mm"],
	[/^nothing may move now: .*; edmctl faults (\S+) tells why, and what clears it$/, (_, f) => `现在不能移动：${faultOf(f as string)}；edmctl faults ${f} 说明原因和办法`],
	[/^(\w) was seen last at (\S+), and its drive tells (\S+): it was moved; look, and place \w is MM$/, "$1 上次在 $2，它的驱动器报告 $3：它被移动过；请查看，再说明 $1 的位置"],
	[/^edmd is lost: its cycle stands still$/, "控制循环停住或 edmd 已退出"], [/^edmd is there$/, "edmd 已恢复"],
	[/^fault (\S+?)( \(.*\))? without a job; reset leaves it$/, (_, f, own) => `没有任务时：${faultOf(f as string)}${own ?? ""}；复位即可`],
	[/^(\S+) \((\w+), ([^)]*)\): (\S+)(.*): ([^:]*)$/, (_, user, role, from, verb, what, became) => `${user}（${ROLES[role as string] ?? role}，${from}）：${VERBS[verb as string] ?? verb}${what}：${zhSaid(became as string)}`],
	[/^(\S+) \((\w+)\): sent job (\S+), (.*): ([^:]*)$/, (_, user, role, _id, job, became) => `${user}（${ROLES[role as string] ?? role}）：发送任务 ${job}：${zhSaid(became as string)}`],
	[/^(?:(\S+):)?(\d+):(\d+): (.*?); (.*)$/, (_, name, line, at, found, wanted) => `${name ? `${name}，` : ""}第 ${line} 行第 ${at} 列：${zhRefused(found as string)}；接受的是：${zhRefused(wanted as string)}`],
	[/^accepted; /, "已接收；"], [/it will wait for start$/, "等待启动"], [/it starts now$/, "现在开始"],
	[/it starts when those before it are done$/, "前面的完成后开始"], [/the queue waits for start$/, "队列等待启动"],
	[/^(\S+) \((\w+), ([^)]*)\): jog-on (\w+) (begins|ends)$/, (_, user, role, from, axis, how) => `${user}（${ROLES[role as string] ?? role}，${from}）：按住点动 ${axis} ${how === "begins" ? "开始" : "结束"}`],
	[/^(\S+) \((\w+), ([^)]*)\): (\S+) was refused$/, (_, user, role, from, verb) => `${user}（${ROLES[role as string] ?? role}，${from}）：${VERBS[verb as string] ?? verb}被拒绝`],
	[/^(\S+): login as (.*) was refused$/, "$1：以 $2 登录被拒绝"], [/^(\S+): (\S+) logged in as (\w+)$/, (_, from, user, role) => `${from}：${user} 以${ROLES[role as string] ?? role}登录`],
];

// What the machine asks for (daemon/jobs/asks.c), and what it says to who did not do that.
const ASKS: [RegExp, Put][] = [
	[/^not before this: (.*)$/, (_, asks) => `须先做到：${zhSaid(asks as string)}`],
	[/^that is not what the machine asks for: (.*)$/, (_, asks) => `机器要求的不是这个：${zhSaid(asks as string)}`],
	[/^the program stops in line (\d+)(?:: (.*))?; edmctl start goes on$/, (_, line, words) => `程序在第 ${line} 行停止${words ? `：${words}` : ""}；启动可继续`],
	[/^put electrode (\d+)( .+?)? in(?: \((\d+) is in\))?; edmctl done \d+, then edmctl start$/, (_, n, name, is) => `请装入电极 ${n}${name ?? ""}${is ? `（现在装的是 ${is}）` : ""}；确认，然后启动`],
	[/^take the electrode out(?: \((\d+) is in\))?; edmctl done 0, then edmctl start$/, (_, is) => `请取下电极${is ? `（现在装的是 ${is}）` : ""}；确认，然后启动`],
	[/^electrode (\d+) is in; edmctl start goes on$/, "电极 $1 已装入；启动可继续"],
	[/^set (.*?)(?: for (\w+))? at the generator; edmctl done, then edmctl start$/, (_, values, of) => `请在脉冲电源上设定${of ? ` ${of}：` : " "}${values}；确认，然后启动`],
	[/^the generator is set; edmctl start goes on$/, "脉冲电源已设定；启动可继续"],
	[/^the PLC carries out an M code: M(\d+); it goes on by itself$/, "PLC 正在执行 M$1；自动继续"],
	[/^it was held by command(?: of (.*?))?; edmctl start goes on, edmctl stop ends the job$/, (_, by) => `由命令保持${by ? `（${by}）` : ""}；启动可继续，也可结束任务`],
];

const SHORT: Record<string, string> = {
	"it asks for nothing": "它没有要求什么",
	"the job is ready; edmctl start begins it": "任务已就绪；启动即开始",
	"the PLC held it; once the PLC lets go, start goes on": "PLC 保持了它；PLC 放开后，启动可继续",
	"a fault was reset; edmctl start goes on, edmctl stop ends the job": "故障已复位；启动可继续，也可结束任务",
	"edmd was started anew; look at the machine; edmctl start goes on, edmctl stop ends the job": "edmd 已重新启动；请查看机床；启动可继续，也可结束任务",
	"the program is at its end; edmctl stop ends the job": "程序已到末尾；请结束任务",
	"the generator does not have the condition yet; it goes on by itself": "脉冲电源还没有此条件；自动继续",
	"the override is 0; edmctl override 100, or the knob of the PLC": "定位倍率为 0；请调到 100 %，或用 PLC 的旋钮",
	"the drives do not have power yet; it goes on by itself": "驱动器还没有上电；自动继续",
	"done": "完成", "removed": "已移除", "moved": "已移动", "ready": "就绪", "no contact": "没有碰到", "none": "无",
	"the store failed": "存储失败", "the job has ended": "任务已结束", "the holder is empty": "夹头为空",
	"64 keys are there; remove one": "已有 64 个密钥；请移除一个",
	"a fault is latched; reset first": "有故障锁存；请先复位",
	"the PLC holds": "PLC 要求保持", "the PLC holds: nothing may move until it lets go": "PLC 要求保持：放开之前不能移动",
	"a job is loaded that cuts with it; try again when the job has ended": "已载入的任务用它加工；请等任务结束",
	"a job is loaded; try again when it has ended, or write a T word in the program": "已载入任务；请等它结束，或在程序中用 T 字",
	"a job wants a key of role operator": "发送任务需要操作员的密钥",
	"a name of 1 to 31 of A-Z a-z 0-9 . _ -, a role, and 64 hex digits": "需要名称（1 到 31 个字符：A-Z a-z 0-9 . _ -）、权限和 64 位十六进制数",
	"a table of an .enc file is not written; edmsim --tech makes a .tech of it": ".enc 工艺表不能写入；edmsim --tech 可把它转为 .tech",
	"the table has more than 60000 bytes; change its file by hand": "工艺表超过 60000 字节；请手工写入文件",
	"AXIS as-seen, or AXIS is and a number of mm or degrees": "AXIS as-seen，或 AXIS is 加 mm 数或度数",
	"the machine file names no table; [tech] table = NAME.tech": "机床文件没有指定工艺表；[tech] table = NAME.tech",
	"this press cannot be read; AXIS, a number from 1 to 16777215 that no press before it had, and begin if it begins": "无法识别此次按键；须为 AXIS、1 到 16777215 中未用过的编号，开始时加 begin",
	"added": "已添加", "begun": "已开始", "stored": "已保存", "no memory": "内存不足",
	"an axis cannot have power": "有轴不能上电", "an axis is not homed": "有轴没有回零",
	"an axis is on its limit switch": "有轴压在限位开关上", "argument out of range": "数值超出范围",
	"edmd is lost; systemctl status edmd": "edmd 已失去联系；systemctl status edmd",
	"edmd is not there; systemctl start edmd": "edmd 不在；systemctl start edmd",
	"edmd refused the value: with the others in force, short_v < window_low_v <= servo_v <= window_high_v < open_v < ignition_v must hold": "edmd 不接受此值：须满足 short_v < window_low_v <= servo_v <= window_high_v < open_v < ignition_v",
	"edmd refused the value; it must be finite and in range": "edmd 不接受此值；须为范围内的有限数",
	"it asks for something that nobody confirmed": "它要求的事还没有人确认",
	"that is not asked for": "没有要求确认此事",
	"text is the number of a stand, or empty": "text 须为停顿的编号，或为空",
	"the stand that it was for is over": "它所针对的停顿已经结束",
	"that stand is over: somebody was quicker; look what the machine wants now": "那次停顿已经结束：有人更快；请看机床现在要什么",
	"it cannot be checked: no memory, or the store failed": "无法检查：内存不足或存储失败",
	"it has begun or ended; stop ends a job that runs": "它已开始或已结束；“停止”可结束运行中的任务",
	"it is just being loaded; try again when it is ready": "正在载入；就绪后请再试",
	"it is not taken any more, but the store failed: it comes back when edmd-jobs is started again; see its journal": "已不再接受，但存储失败：edmd-jobs 重新启动后它会恢复；见其日志",
	"it is read again; an event says which way it will go in; then it waits for start": "正在重新读入；事件会说明从哪条路进入；然后等待启动",
	"it is the first that waits already": "它已是等待中的第一个", "it is the last that waits already": "它已是等待中的最后一个",
	"no axis has a home_method; the places they start at are good": "没有轴设 home_method；启动时的位置即有效",
	"no job is loaded; submit one": "没有载入任务；请发送一个", "no key of this name; edmctl keys list": "没有此名称的密钥；edmctl keys list",
	"no program is loaded": "没有载入程序", "no such electrode; edmctl electrode list has them": "没有此电极；edmctl electrode list 列出全部",
	"no such job; edmctl queue lists them": "没有此任务；edmctl queue 列出全部",
	"no such length; a number of mm above 0, at most 10000": "长度无效；须为大于 0 且不超过 10000 的 mm 数",
	"no such length; a number of mm or degrees, + or -": "长度无效；须为 mm 或度数，可正可负",
	"no such node on the path": "路径上没有此节点", "no such number of nodes; 1 to 100 ahead, -1 to -100 back": "节点数无效；向前 1 到 100，向后 -1 到 -100",
	"no such number of rows; 0 to 1000, 0 is all that are kept": "行数无效；0 到 1000，0 表示全部",
	"no such override; 0 to 200 percent": "倍率无效；0 到 200 %", "no such role; viewer, operator or service": "没有此权限；viewer、operator 或 service",
	"no such speed; mm/s or deg/s, + or -, 0 ends it": "速度无效；mm/s 或 度/s，可正可负，0 为结束",
	"no such value; a whole number, -2147483648 to 4294967295": "数值无效；须为 -2147483648 到 4294967295 的整数",
	"no such version; edmctl tech versions has them": "没有此版本；edmctl tech versions 列出全部",
	"no such way; -1 is ahead, 1 is back, -2 before and 2 behind all that wait": "方向无效；-1 提前，1 推后，-2 最前，2 最后",
	"not possible in this state": "在此状态下不可能", "nothing runs; what waits begins at the next start": "没有在运行；等待的任务在下次启动时开始",
	"only a job that waits in the queue can be moved": "只能移动在队列中等待的任务", "outside the travel": "超出行程",
	"removed from the queue": "已从队列移除", "saved; jobs that are loaded from now on have it": "已保存；此后载入的任务使用它",
	"the drives are not up yet": "驱动器还没有上电", "the drives are not up yet; edmd's journal tells which; try again when they are": "驱动器还没有上电；edmd 的日志说明是哪些；上电后请再试",
	"the edmd that had it ended in order, and its record with it: whether it was done is not known; look at the machine": "执行它的 edmd 已正常退出，记录也随之消失：是否完成不得而知；请查看机床",
	"the host's own key is renewed by removing its file and starting edmd-jobs again": "要更新本机密钥，请删除其文件并重新启动 edmd-jobs",
	"the message of this press came too late; press again": "此次按键的消息来得太晚；请再按一次",
	"the path there was not passed before": "那段路径以前没有走过", "the program begins elsewhere": "程序从别处开始",
	"the program is larger than 64 MiB; its values are not read": "程序大于 64 MiB；不读取其数值",
	"the store failed; see the journal of edmd-jobs": "存储失败；见 edmd-jobs 的日志", "there are 256 electrodes already; remove one": "已有 256 个电极；请移除一个",
	"this axis has no drive on a bus; backend = can402 and can402.node_X have one": "此轴没有总线驱动器；须设 backend = can402 和 can402.node_X",
	"this axis has no home_method; the place it starts at is good": "此轴没有 home_method；启动时的位置即有效",
	"this electrode is there already; electrode set changes it, or another number": "已有此电极；用 electrode set 修改，或换一个编号",
	"this job has ended; submit it again": "此任务已结束；请重新发送",
	"this job is not interrupted: it is loaded already; start begins it": "此任务没有中断：它已载入；启动即可开始",
	"this job was interrupted; look at the work, then resume it or remove it": "此任务已中断；请查看工件，然后继续或移除它",
	"this key, or one of this name, is there already; edmctl keys list": "已有此密钥或同名密钥；edmctl keys list",
	"the text is too long; 4000 bytes at most; submit takes a longer one": "文本太长；最多 4000 字节；更长的请发送为任务",
	"too many commands under way; try again": "正在处理的命令太多；请再试",
	"what caused the fault is still there": "故障原因仍然存在",
	"what was not certain counts as seen, and the axes as standing where they are shown; no job waits": "不确定的位置视为已看过，轴视为停在显示的位置；没有任务等待",
	"c: this machine has no C that turns the electrode; c=0, or a work system that is turned": "c：本机没有转动电极的 C 轴；c=0，或转动工件坐标系",
	"starts when its turn comes": "轮到时开始", "it is in the holder": "它在夹头中", "fault": "故障",
};

function put(text: string, table: [RegExp, Put][]): string {
	return table.reduce((s, [from, to]) => typeof to === "string" ? s.replace(from, to) : s.replace(from, to), text);
}

/** @text in Chinese, with its punctuation, as far as it is known. */
export function zhSaid(text: string): string {
	const known = zhHost[text] ?? SHORT[text] ?? (text in zhFaults ? faultOf(text) : undefined);
	if (known) return known;
	const is = put(put(put(text, ASKS), TOLD), HOST);
	return is === text ? text : is.replace(/; /g, "；").replace(/, (?=\S)/g, "，");
}
