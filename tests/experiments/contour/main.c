/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - contour error on the butterfly: baseline, methods, models
 *
 * Prints docs/experiments-contour.md; with a folder, draws its pictures there
 * instead.
 */
#include "contour_try.h"

static const char head[] =
"# Contour error, measured on models\n"
"\n"
"Printed by `make experiments`.  The path is the butterfly of\n"
"`tests/experiments/curves.json`, normal acceleration at most 100 mm/s^2, set\n"
"values every millisecond.  Machine: position loops of 30 and 21.5 1/s, velocity\n"
"loops of 60 Hz with damping 0.7 (`interp/axis_model.h`).  The error is the\n"
"distance of the true place from the path (`interp/foot.h`).\n"
"\n";

static const char pictures[] =
"## Pictures\n"
"\n"
"![contour error over time](pictures/contour-error.svg)\n"
"\n"
"![the path, errors magnified](pictures/contour-path.svg)\n";

int main(int argc, char **argv)
{
	static struct spline curve;
	static struct speeds s;

	spline_load(&curve, "butterfly");
	for (int i = 0; i < 3; i++)
		feed_make(&s.feed[i], &curve, speed_mm_min[i]);
	if (argc > 1) {
		draw(&s, argv[1]);
	} else {
		fputs(head, stdout);
		table_baseline(&s);
		table_methods(&s);
		table_tuning(&s);
		table_noise(&s);
		table_gains(&s);
		table_identify(&s);
		table_learned(&s);
		table_maps(&s);
		table_foot(&s);
		fputs(pictures, stdout);
	}
	for (int i = 0; i < 3; i++)
		feed_free(&s.feed[i]);
	return 0;
}
