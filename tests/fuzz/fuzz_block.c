/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_block.c - run a program block with any bytes changed through the cycle
 *
 * The input says which of some random programs is used, with which strategy,
 * how much of its end is missing, and which bytes are written where.  If the
 * checks accept the block, nothing may move before its start, and all motion
 * must stay within the travel.
 */
#include "cycle_help.h"
#include "random_program.h"

#include "fuzz_help.h"
#include "interp/compile.h"

#define TEXTS		48
#define WAITS		20		/* periods before the start */
#define RUNS		300
#define BACK		60

static struct made compiled(int text, enum interp_strategy how)
{
	static struct script script;
	uint64_t seed = 1000003 * (uint64_t)(text + 1);
	const char *dialect = random_text(&script, &seed);
	const struct interp_machine m = fuzz_machine(200);
	const struct interp_wire wire = {
		.guides = INTERP_GUIDES_ABSOLUTE, .z_lower_mm = -20,
		.z_upper_mm = 80, .z_second_mm = 40, .angle_max_deg = 45,
	};
	const struct interp_compile_options o = {
		.nc = {
			.machine = &m, .tech = fuzz_tech(), .feed_mm_s = 20,
			.wire = strcmp(dialect, "generic") ? &wire : NULL,
			.offset_mm = { [1] = 0.05 }, .executed_max = 100000,
		},
		.threeb.offset_um = 5,
	};
	const struct interp_build_options bo = {
		.machine = &m, .strategy = how, .tolerance_milli = 2000,
		.fit_mm = text % 4 ? 0 : 0.01,
	};
	const struct interp_text t = {
		script.at, (size_t)script.n, interp_dialect_by_name(dialect),
	};
	struct interp_build *b = interp_build_create(&bo);
	struct interp_diag d;
	uint32_t lines;

	assert(b);
	if (interp_compile(&t, &o, b, &lines, &d) == 0)
		return finish(b);
	interp_build_destroy(b);
	return (struct made) { .block = NULL };
}

static const struct made *program(uint8_t text, uint8_t how)
{
	static struct made made[TEXTS][INTERP_NSTRATEGIES];
	static bool tried[TEXTS][INTERP_NSTRATEGIES];
	const int t = text % TEXTS, s = how % INTERP_NSTRATEGIES;

	if (!tried[t][s])
		made[t][s] = compiled(t, (enum interp_strategy)s);
	tried[t][s] = true;
	return &made[t][s];
}

/* Five bytes each: a place and a byte; half of them in the head. */
static void change(uint8_t *block, size_t bytes, const uint8_t *data,
		   size_t size)
{
	const size_t head = sizeof(struct interp_program_head);
	uint32_t at;

	for (size_t i = 0; i + 5 <= size; i += 5) {
		memcpy(&at, data + i, sizeof(at));
		at %= (uint32_t)(i & 1 || bytes < head ? bytes : head);
		block[at] = data[i + 4];
	}
}

/* A period; @x draws what the gap does. */
static void turn(struct cycle *c, struct io_outputs *out, uint64_t *x)
{
	static const double v[] = {
		SHORTED_V, NARROW_V, SPARKING_V, SPARKING_V, OPEN_V,
	};
	const struct io_inputs in = {
		.gap_valid = true, .gap_v = v[rnd(x) / 32 % 5],
	};
	int32_t was[INTERP_NAXES];

	memcpy(was, c->out.target, sizeof(was));
	cycle_step(c, &in, out);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int64_t step = (int64_t)c->out.target[i] - was[i];

		assert(c->out.target[i] >= c->config.travel_min[i]);
		assert(c->out.target[i] <= c->config.travel_max[i]);
		assert(llabs(step) <= c->config.points_max);
	}
}

static void turns(struct cycle *c, int n, bool stands, uint64_t *x)
{
	const struct io_outputs before = c->out;
	struct io_outputs out;

	while (n-- > 0) {
		turn(c, &out, x);
		if (!stands)
			continue;
		assert(!out.power);
		assert(memcmp(c->out.target, before.target,
			      sizeof(before.target)) == 0);
	}
}

static void walk(const struct interp_program *p, bool dry, uint64_t x)
{
	static const struct cycle_command start = { .verb = CYCLE_START },
		retract = { .verb = CYCLE_RETRACT, .arg_mm = 0.5 },
		stop = { .verb = CYCLE_STOP };
	struct cycle_config k = usual_config();
	static struct cycle c;
	struct interp_cursor at;

	k.dry_run = dry;
	k.jump.height_mm = 0.2;
	cycle_init(&c, &k);
	/* As edmd does. */
	if (interp_cursor_init(&at, p) < 0 ||
	    !probe_is_start(&c, &at) ||
	    cycle_load(&c, p) != ANSWER_DONE)
		return;
	turns(&c, WAITS, true, &x);
	cycle_command(&c, &start);
	turns(&c, RUNS, false, &x);
	cycle_command(&c, &retract);
	turns(&c, BACK, false, &x);
	cycle_command(&c, &stop);
	turns(&c, BACK, false, &x);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct made *m = size >= 4 ? program(data[0], data[1]) : NULL;
	struct interp_program p;
	size_t bytes;
	void *block;

	if (!m || !m->block)
		return 0;
	bytes = data[2] & 1 ? m->bytes - data[3] % m->bytes : m->bytes;
	/* No byte more than there are: what reads beyond is seen. */
	block = malloc(bytes);
	assert(block);
	memcpy(block, m->block, bytes);
	change(block, bytes, data + 4, size - 4);
	if (interp_program_map(&p, block, bytes) == 0)
		walk(&p, data[2] & 2, data[3]);
	free(block);
	return 0;
}
