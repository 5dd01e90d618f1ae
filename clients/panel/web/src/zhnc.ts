// SPDX-License-Identifier: Apache-2.0
//
// What is refused most often in a program, in Chinese: what was found, and what is
// accepted.  libinterp words some hundred refusals; what is not known here is shown
// as it was said.
type Put = string | ((...m: string[]) => string);

const NC: [RegExp, Put][] = [
	// What was found.
	[/^unknown word (\S+)$/, "无法识别的字 $1"],
	[/^'(.)', which begins no word$/, "“$1” 不能作为字的开头"],
	[/^byte (0x\w+)$/, "字节 $1"],
	[/^(\S+) is not a word with a number$/, "$1 不是带数字的字"],
	[/^(\S+) has no use on this line$/, "$1 在此行没有用处"],
	[/^(\S+) is out of range$/, "$1 超出范围"],
	[/^a second word (\S+)$/, "重复的字 $1"],
	[/^(\S+) on a line with (\S+)$/, "$1 与 $2 在同一行"],
	[/^(\S+) with no motion mode in force$/, "$1 之前没有有效的运动方式"],
	[/^(\w) (\S+) is beyond the travel$/, "$1 $2 超出行程"],
	[/^axis (\w), which this machine has not$/, "机床没有 $1 轴"],
	[/^(\S+), which is not in the technology table$/, "$1 不在工艺表中"],
	[/^no electrode has the number (\S+)$/, "没有编号为 $1 的电极"],
	[/^the arc starts (\S+) mm from its centre and ends (\S+) mm from it$/, "圆弧起点距圆心 $1 mm，终点距圆心 $2 mm"],
	[/^an arc without a centre$/, "圆弧没有圆心"],
	[/^a radius of (\S+) mm, too small to reach the end$/, "半径 $1 mm 太小，到不了终点"],
	[/^an offset by register (\d+), which is not defined$/, "补偿寄存器 $1 没有定义"],
	[/^a call of O(\d+), which is not there$/, "调用的 O$1 不存在"],
	[/^recursion: O(\d+) is being carried out already$/, "递归：O$1 正在执行"],
	[/^M99 outside a subprogram$/, "M99 在子程序之外"],
	[/^the next program, O(\d+), without an end of this one$/, "本程序没有结束就开始了下一个程序 O$1"],
	[/^a \( comment without an end$/, "注释的 ( 没有结束"],
	[/^G4 without a time$/, "G4 没有时间"], [/^a dwell of (\S+) s$/, "暂停 $1 s"],
	[/^(\w) without a sign$/, "$1 没有符号"],
	[/^(\S+) without axis words.*$/, "$1 没有轴字"], [/^(\S+) without a motion$/, "$1 没有运动"],
	[/^empty program$/, "空程序"],
	// What is accepted.
	[/^one of (.*), or one of the machine's own, (.*)$/, "须为 $1 之一，或机床自有的 M 代码（$2）"],
	[/^one of ([A-Z0-9. :]+) with a way to go, as in (\S+) (\S+) or (\S+) (\S+)$/, "$1 之一带上方向，如 $2 $3 或 $4 $5"],
	[/^one of ([A-Z0-9. :]+)$/, "须为 $1 之一"],
	[/^a sign, digits and one decimal point, as in (\S+); no exponent$/, "须为符号、数字和一个小数点，如 $1；不能有指数"],
	[/^ASCII text; other characters in comments only, and no NUL$/, "须为 ASCII 文本；其他字符只能在注释中，且不能有 NUL"],
	[/^(\w) goes with (.*)$/, (_, w, what) => `${w} 用于 ${(what as string).replace(/, a curve/, "、曲线").replace(/, or /g, " 或 ").replace(/ or /g, " 或 ").replace(/ and /g, " 和 ").replace(/ under /g, " 在 ").replace(/, /g, "、")}`],
	[/^a feed of (\S+) to (\S+) per minute$/, "进给须为每分钟 $1 到 $2"],
	[/^each letter once on a line$/, "每个字母每行只能出现一次"],
	[/^one word of a modal group on a line$/, "同一模态组每行只能有一个字"],
	[/^G0 G1 G2 or G3 in this line or before it$/, "本行或之前须有 G0 G1 G2 或 G3"],
	[/^(\w) from (\S+) to (\S+) in machine coordinates$/, "机床坐标 $1 须在 $2 到 $3 之间"],
	[/^a condition of the technology table; the nearest are (.*)$/, "须为工艺表中的条件；最接近的是 $1"],
	[/^T1 to T(\d+), or T0: none$/, "须为 T1 到 T$1，或 T0：不装电极"],
	[/^radii that agree within (\S+) mm, as its last digits can say them$/, "两个半径之差须在 $1 mm 以内"],
	[/^I and J, or R$/, "须有 I 和 J，或 R"],
	[/^R of at least (\S+) mm, half the way from start to end$/, "R 至少为 $1 mm，即起点到终点的一半"],
	[/^(\S+) before it; or \[wire\] (\S+) of the machine file$/, "之前须有 $1，或在机床文件 [wire] 中设 $2"],
	[/^the number of an O word that begins a line of this text$/, "须为本文中某行开头的 O 字编号"],
	[/^calls of other subprograms$/, "只能调用其他子程序"],
	[/^M2 or M30 at the end of the main program$/, "主程序末尾须有 M2 或 M30"],
	[/^a \) on the same line$/, "同一行须有 )"],
	[/^G4 with P or X in seconds, as in G4 P0\.5$/, "G4 须带 P 或 X，单位秒，如 G4 P0.5"],
	[/^0 to (\d+) seconds$/, "须为 0 到 $1 秒"],
	[/^the axes to send to machine zero, as in (.*)$/, "须写出要回机床零点的轴，如 $1"],
	[/^the place to call this one, as in (.*); (\S+) to cancel$/, "须写出此处的坐标，如 $1；用 $2 取消"],
	[/^G53 with axis words, under G0 or G1$/, "G53 须带轴字，并在 G0 或 G1 下"],
	[/^at least one motion or action$/, "至少要有一个运动或动作"],
];

/** What was found in a program, or what is accepted, as far as it is known. */
export function zhRefused(text: string): string {
	const known = NC.find(([from]) => from.test(text));
	if (!known) return text;
	const [from, to] = known;
	return typeof to === "string" ? text.replace(from, to) : text.replace(from, to);
}
