/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compile.c - how many lines of NC code are compiled in a second, from text to
 * program
 *
 *	compile JOB.ngc
 */
#include "bench.h"

#include "config.h"
#include "interp/nc.h"

struct text {
	char *at;
	size_t n;
};

static struct text load(const char *path)
{
	FILE *f = fopen(path, "rb");
	struct text t = { 0 };
	long n;

	if (!f || fseek(f, 0, SEEK_END) || (n = ftell(f)) < 0)
		exit(66);
	rewind(f);
	t.n = (size_t)n;
	t.at = malloc(t.n);
	if (!t.at || fread(t.at, 1, t.n, f) != t.n)
		exit(66);
	fclose(f);
	return t;
}

/* From text to the finished block, as the daemon's compiler does. */
static double lines_s(const struct text *t, const struct machine_config *k)
{
	const struct interp_build_options bo = { .machine = &k->axes };
	const struct interp_nc_options no = { .machine = &k->axes };
	const struct interp_build_about about = { .name = "bench" };
	const double from_s = bench_now_s();
	struct interp_build *b = interp_build_create(&bo);
	struct interp_nc_result done;
	struct interp_diag diag;
	size_t bytes;
	void *block;
	double s;

	if (interp_nc_compile(&(struct interp_text) {
			.at = t->at, .bytes = t->n }, &no, b, &done, &diag)) {
		fprintf(stderr, "%u:%u: %s\n", diag.line, diag.column,
			diag.found);
		exit(65);
	}
	block = interp_build_take(b, &about, &bytes);
	interp_build_destroy(b);
	s = bench_now_s() - from_s;
	free(block);
	return done.lines / s;
}

int main(int argc, char **argv)
{
	static struct machine_config k;
	double v[BENCH_RUNS];
	struct text t;

	if (argc != 2)
		return 64;
	config_defaults(&k);
	t = load(argv[1]);
	for (int i = 0; i < BENCH_RUNS; i++)
		v[i] = lines_s(&t, &k);
	bench_say("lines_s", bench_median(v, BENCH_RUNS));
	return 0;
}
