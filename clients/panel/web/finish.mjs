// SPDX-License-Identifier: Apache-2.0
//
// Compresses what was built, and checks two promises: that the first load is
// small, and that nothing is wanted from outside.
import { readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

const FIRST_LOAD_MAX = 350 * 1024;
// Names that are no addresses: nobody fetches a name of XML.
const NAMES = /^https?:\/\/(www\.w3\.org\/|[^/]*\.?w3\.org\/)/;

const out = process.argv[2];
const html = readFileSync(join(out, "index.html"), "utf8");
const files = ["index.html", ...readdirSync(out).filter((f) => /\.svg$/.test(f)),
	...readdirSync(join(out, "assets")).map((f) => join("assets", f))];
let first = 0, all = 0, bad = 0;

for (const f of files) {
	const bytes = readFileSync(join(out, f));
	const text = bytes.toString("utf8");
	if (/\.(js|css|html|svg)$/.test(f)) {
		for (const [, fetches] of text.matchAll(/(?:src|href|url|import|fetch|from)\s*[=("'\s]+\s*(https?:\/\/[^"'\s)]+)/g))
			if (!NAMES.test(fetches)) { console.error(`finish: ${f} wants ${fetches}; every file has to be in the package`); bad++; }
	}
	if (/<script(?![^>]*\bsrc=)|<style|\son\w+=/.test(f.endsWith(".html") ? text : "")) {
		console.error(`finish: ${f} has inline code; the panel's policy refuses it`);
		bad++;
	}
	const small = gzipSync(bytes, { level: 9 });
	all += small.length;
	if (f === "index.html" || html.includes(`/${f}`)) first += small.length;
	writeFileSync(join(out, `${f}.gz`), small);
	rmSync(join(out, f));
}
// The name of the entry without .gz is what tells that a page is there.
console.log(`  PANEL   first load ${(first / 1024).toFixed(1)} kB, with the 3D part ${(all / 1024).toFixed(1)} kB, compressed`);
if (first > FIRST_LOAD_MAX) { console.error(`finish: the first load is over ${FIRST_LOAD_MAX / 1024} kB`); bad++; }
process.exit(bad ? 1 : 0);
