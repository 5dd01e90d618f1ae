/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_dbc.c - the table of signals as frames: a DBC, and a page to read
 */
#include "plc.h"

static const struct {
	uint16_t id;
	bool asked;
	uint8_t pdo;
	const char *name;
} frames[] = {
	{ 0x180, false, 1, "EdmdStatus" },
	{ 0x280, false, 2, "EdmdJob" },
	{ 0x380, false, 3, "EdmdPositionXY" },
	{ 0x480, false, 4, "EdmdPositionZC" },
	{ 0x200, true, 1, "PlcRequest" },
};

#define NFRAMES	(sizeof(frames) / sizeof(frames[0]))

/* The bits of a byte are signals of their own in a DBC. */
struct bit {
	const char *of, *name;
	uint8_t bit;
	const char *help;
};

static const struct bit bits[] = {
	{ "Flags", "Toggle", 0, "turns with every frame" },
	{ "Flags", "Spark", 1, "spark power is asked for" },
	{ "Flags", "Runs", 2, "a job is under way" },
	{ "Flags", "Held", 3, "stands on the path" },
	{ "Flags", "Faulty", 4, "there is a fault, `Fault` says which" },
	{ "Flags", "Pump", 5, "dielectric is asked for" },
	{ "Flags", "Loaded", 6, "a job is there to be started, or under way" },
	{ "Command", "Permit", 0, "1: sparks and motion are allowed" },
	{ "Command", "Start", 1, "rising edge: start, or go on" },
	{ "Command", "Hold", 2, "as long as it is 1" },
	{ "Command", "Reset", 3, "rising edge: leave a fault, to hold" },
	{ "Command", "Alive", 7, "to be turned at least each `alive_ms`" },
	{ "Interlocks", "DoorClosed", 0, "interlock" },
	{ "Interlocks", "LevelOk", 1, "interlock: dielectric covers the work" },
	{ "Interlocks", "TemperatureOk", 2, "interlock: of the dielectric" },
	{ "Interlocks", "NoFire", 3, "interlock" },
	{ "Interlocks", "WireWhole", 4, "interlock, wire machines only" },
};

#define NBITS	(sizeof(bits) / sizeof(bits[0]))

static bool same(const char *a, const char *b)
{
	while (*a && *a == *b)
		a++, b++;
	return *a == *b;
}

/* What is done with each signal of a frame that the tools see: bits, or whole. */
typedef void each_fn(FILE *f, const struct plc_signal *s, const struct bit *b);

static bool is_in(const struct plc_signal *s, size_t frame)
{
	return s->asked == frames[frame].asked && s->pdo == frames[frame].pdo;
}

static void each_signal(FILE *f, size_t frame, each_fn *what)
{
	for (size_t i = 0; i < plc_nsignals; i++) {
		const struct plc_signal *s = &plc_signal[i];
		bool any = false;

		if (!is_in(s, frame))
			continue;
		for (size_t k = 0; k < NBITS; k++) {
			if (!same(bits[k].of, s->name))
				continue;
			any = true;
			what(f, s, &bits[k]);
		}
		if (!any)
			what(f, s, NULL);
	}
}

static bool is_signed(const struct plc_signal *s)
{
	return s->type == PLC_I16 || s->type == PLC_I32;
}

/* -- DBC -------------------------------------------------------------------------- */

static void dbc_signal(FILE *f, const struct plc_signal *s, const struct bit *b)
{
	const char *to = s->asked ? "edmd" : "plc";

	if (b) {
		fprintf(f, " SG_ %s : %d|1@1+ (1,0) [0|1] \"\" %s\n", b->name,
			8 * s->byte + b->bit, to);
		return;
	}
	fprintf(f, " SG_ %s : %d|%zu@1%c (%g,0) [%.10g|%.10g] \"%s\" %s\n",
		s->name, 8 * s->byte, 8 * plc_bytes(s->type),
		is_signed(s) ? '-' : '+', s->scale, (double)s->min * s->scale,
		(double)s->max * s->scale, s->unit, to);
}

void plc_dbc(FILE *f, uint8_t node)
{
	fputs("VERSION \"\"\n\nNS_ :\n\nBS_:\n\nBU_: edmd plc\n\n", f);
	for (size_t k = 0; k < NFRAMES; k++) {
		fprintf(f, "BO_ %d %s: 8 %s\n", frames[k].id + node,
			frames[k].name, frames[k].asked ? "plc" : "edmd");
		each_signal(f, k, dbc_signal);
		fputc('\n', f);
	}
	fprintf(f, "CM_ \"edmd as node %d, printed by: edmd --print-dbc\";\n",
		node);
}

/* -- docs/plc-signals.md ------------------------------------------------------------ */

static void row_of(FILE *f, const struct plc_signal *s, const struct bit *b)
{
	fprintf(f, "| %04X:%02X | ", s->index, s->sub);
	if (b) {
		fprintf(f, "%s | %d | bit %d | | | %s |\n", b->name, s->byte,
			b->bit, b->help);
		return;
	}
	fprintf(f, "%s | %d | %zu%s | %s | %.10g to %.10g | %s |\n", s->name,
		s->byte, 8 * plc_bytes(s->type), is_signed(s) ? " signed" : "",
		s->unit, (double)s->min * s->scale, (double)s->max * s->scale,
		s->help);
}

static const char head[] =
"| object | signal | byte | bits | unit | range | meaning |\n"
"|---|---|---|---|---|---|---|\n";

void plc_document(FILE *f)
{
	fputs("# Signals between edmd and a PLC\n\n"
	      "Printed by `edmd --document-plc`; do not edit.  What they mean "
	      "together is in\n[plc.md](plc.md).\n\n"
	      "Numbers are little-endian; the range is in the unit.  Faults "
	      "have their names in\n`messages/edmd.dbc`.\n", f);
	for (size_t k = 0; k < NFRAMES; k++) {
		fprintf(f, "\n## %s: %03X + node, %s\n\n%s", frames[k].name,
			frames[k].id, frames[k].asked ? "from the PLC" :
			"to the PLC", head);
		each_signal(f, k, row_of);
	}
	fprintf(f, "\n## By SDO only\n\n%s", head);
	for (size_t i = 0; i < plc_nsignals; i++) {
		if (plc_signal[i].pdo == 0)
			row_of(f, &plc_signal[i], NULL);
	}
}
