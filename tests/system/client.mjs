// SPDX-License-Identifier: Apache-2.0
//
// client.mjs - a client in another language, from messages/README.md alone
//
//	node client.mjs vectors FILE
//	node client.mjs KEYFILE VERB [TEXT ARG]
//	node client.mjs KEYFILE submit NC-FILE
//
// Prints the answer's code, reason and body as JSON.

import crypto from "node:crypto"
import dgram from "node:dgram"
import fs from "node:fs"

const URL = process.env.LCM_DEFAULT_URL ?? "udpm://239.255.76.67:7667?ttl=0"
const [, GROUP, port] = URL.match(/^udpm:\/\/([0-9.]+):(\d+)\?ttl=0$/)
const PORT = Number(port)
const TYPE = {
	signed: "49657b54b950317d", command: "633b130fba8a2ccf",
	ack: "e7a36102b59e523d", chunk: "02d6b52732df0242",
}

// -- Laying out and reading

const hex = (s) => Buffer.from(s, "hex")
const i32 = (v) => { const b = Buffer.alloc(4); b.writeInt32BE(v); return b }
const i64 = (v) => { const b = Buffer.alloc(8); b.writeBigInt64BE(BigInt(v)); return b }
const f64 = (v) => { const b = Buffer.alloc(8); b.writeDoubleBE(v); return b }
const str = (s) => { const b = Buffer.from(s + "\0"); return Buffer.concat([i32(b.length), b]) }
const all = (...parts) => Buffer.concat(parts)

class Reader {
	constructor(data, type) {
		if (!data.subarray(0, 8).equals(hex(type)))
			throw new Error("another type")
		this.data = data
		this.at = 8
	}
	take(n) {
		if (n < 0 || this.at + n > this.data.length)
			throw new Error("cut short")
		this.at += n
		return this.data.subarray(this.at - n, this.at)
	}
	i32() { return this.take(4).readInt32BE() }
	i64() { return this.take(8).readBigInt64BE() }
	str() { return this.take(this.i32()).subarray(0, -1).toString() }
}

// -- Signing

const privateKey = (seed) => crypto.createPrivateKey({
	key: all(hex("302e020100300506032b657004220420"), seed),
	format: "der", type: "pkcs8" })
const publicKey = (raw) => crypto.createPublicKey({
	key: all(hex("302a300506032b6570032100"), raw), format: "der", type: "spki" })
const toBeSigned = (channel, boot, count, data) =>
	all(Buffer.from(`edmd 1\n${channel}\n`), i64(boot), i64(count), data)

function seal(key, channel, boot, count, data) {
	const signature = crypto.sign(null, toBeSigned(channel, boot, count, data), key.secret)

	return all(hex(TYPE.signed), key.public, i64(boot), i64(count), signature,
		   i32(data.length), data)
}

function unseal(machineKey, channel, packet) {
	const r = new Reader(packet, TYPE.signed)
	const s = { key: r.take(32), boot: r.i64(), count: r.i64(), signature: r.take(64) }

	s.data = r.take(r.i32())
	if (!s.key.equals(machineKey) || !crypto.verify(null,
	    toBeSigned(channel, s.boot, s.count, s.data), publicKey(machineKey), s.signature))
		throw new Error("not the machine's")
	return s
}

function readKey(path) {
	const words = {}

	if (fs.statSync(path).mode & 0o027)
		throw new Error(`${path}: others may read or write it`)
	for (const line of fs.readFileSync(path, "ascii").split("\n")) {
		const [word, value] = line.split("#")[0].trim().split(/\s+/)

		if (word)
			words[word] = value
	}
	return { machine: words.machine, public: hex(words.public),
		 machineKey: hex(words["machine-key"]), secret: privateKey(hex(words.secret)) }
}

function vectors(path) {
	const v = Object.fromEntries(fs.readFileSync(path, "ascii").split("\n")
		.filter((l) => l && l[0] !== "#").map((l) => l.split(" ")))
	const key = { public: hex(v.public), secret: privateKey(hex(v.seed)) }
	const data = hex(v.data)
	const packet = seal(key, v.channel, v.boot, v.count, data)

	if (toBeSigned(v.channel, v.boot, v.count, data).toString("hex") !== v.signed ||
	    packet.toString("hex") !== v.packet)
		throw new Error("the vectors do not hold")
	unseal(key.public, v.channel, packet)
	console.log("the vectors hold")
}

// -- Asking

function ask(key, channel, message, isOver) {
	const client = `node-${crypto.randomBytes(8).toString("hex")}`
	const name = (what) => `EDM.${key.machine}.${what}`
	const socket = dgram.createSocket({ type: "udp4", reuseAddr: true })
	const out = dgram.createSocket("udp4")
	const now = () => process.hrtime.bigint() / 1000n
	let boot = 0n, ahead = 0n, count = 0n

	function send() {
		const here = boot ? now() + ahead : 0n

		count = here > count ? here : count + 1n
		out.send(all(Buffer.from("LC02"), i32(0), Buffer.from(`${name(channel)}\0`),
			     seal(key, name(channel), boot, count, message(client, 1))),
			 PORT, GROUP)
	}

	function take(packet) {
		const end = packet.indexOf(0, 8)

		if (packet.toString("latin1", 0, 4) !== "LC02" ||
		    packet.toString("latin1", 8, end) !== name("ACK"))
			return
		const s = unseal(key.machineKey, name("ACK"), packet.subarray(end + 1))
		const r = new Reader(s.data, TYPE.ack)
		const a = { utime: r.i64(), key: r.take(32), client: r.str(), seq: r.i64(),
			    code: r.i32(), reason: r.str(), body: r.str() }

		if (a.client !== client || !a.key.equals(key.public))
			return
		if (a.code === 100) {
			boot = s.boot
			ahead = s.count - now()
			send()
		} else if (isOver(a)) {
			console.log(JSON.stringify({ code: a.code, reason: a.reason, body: a.body }))
			process.exit(0)
		}
	}

	socket.on("message", (packet) => { try { take(packet) } catch { /* not for us */ } })
	socket.bind(PORT, GROUP, () => {
		socket.addMembership(GROUP)
		out.bind(() => { out.setMulticastTTL(0); send(); setInterval(send, 500) })
	})
	setTimeout(() => { console.error("no answer"); process.exit(69) }, 30000)
}

function submit(key, path) {
	const text = fs.readFileSync(path)
	const job = crypto.randomBytes(8).toString("hex")

	ask(key, "JOB", (client, seq) => all(hex(TYPE.chunk), i64(0), str(client), i64(seq),
		str(job), str("job.ngc"), i64(text.length),
		crypto.createHash("sha256").update(text).digest(), i32(0), i32(1), i64(0),
		Buffer.from([0]), i32(0), f64(0), i32(0), str(""), i32(text.length), text), (a) => a.code || a.body)
}

const [what, verb, text = "", arg = "0"] = process.argv.slice(2)

if (what === "vectors")
	vectors(verb)
else if (verb === "submit")
	submit(readKey(what), text)
else
	ask(readKey(what), "COMMAND", (client, seq) => all(hex(TYPE.command), i64(0), str(client),
		i64(seq), str(verb), str(""), f64(Number(arg)), str(text)), () => true)
