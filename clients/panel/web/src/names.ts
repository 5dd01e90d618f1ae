// SPDX-License-Identifier: Apache-2.0
//
// Names and texts of files, as the machine takes them.

const NAME_BYTES = 63;
const utf8 = new TextEncoder();

/** A name that edmd takes: short, its ending kept (the dialect goes by it), and
 *  no characters that control a terminal or turn the direction of writing. */
export function fitName(name: string): string {
	const plain = name.replace(/[\p{Cc}\p{Cs}\p{Zl}\p{Zp}\p{DI}\ufff9-\ufffb/]/gu, "_") || "job.ngc";
	const end = plain.match(/\.[^.]{1,12}$/)?.[0] ?? "";
	const head = [...plain.slice(0, plain.length - end.length)];
	while (utf8.encode(head.join("") + end).length > NAME_BYTES) head.pop();
	return head.join("") + end;
}

/** Lines as a text field counts them. */
export function ownLines(text: string): string {
	return text.replace(/\r\n?/g, "\n");
}

/** Where in @line the machine's column is: it counts bytes of UTF-8 from 1. */
export function unitOf(line: string, column: number): number {
	let bytes = 1, at = 0;
	for (const c of line) {
		if (bytes >= column) break;
		bytes += utf8.encode(c).length;
		at += c.length;
	}
	return at;
}
