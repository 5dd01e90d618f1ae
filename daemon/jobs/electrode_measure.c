/* SPDX-License-Identifier: Apache-2.0 */
/*
 * electrode_measure.c - how long an electrode is: a job that the service makes
 *
 * The electrode is put in, goes over the reference of the machine file, and
 * feels down to it.  docs/electrodes.md has the equation.
 */
#include "act.h"
#include "electrode.h"
#include "jobs.h"
#include "verb.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TEXT_MAX	600

static const struct config_measure *of(const struct jobs *j)
{
	return &j->config->measure;
}

/* X and Y of the reference, as far as the machine has them. */
static void put_over(const struct jobs *j, char *to, size_t size)
{
	const struct config_measure *m = of(j);
	const uint32_t has = j->config->axes.present;
	size_t n = 0;

	*to = '\0';
	if (has >> INTERP_X & 1)
		n += (size_t)snprintf(to, size, " X%.4f", m->x_mm);
	if (has >> INTERP_Y & 1)
		n += (size_t)snprintf(to + n, size - n, " Y%.4f", m->y_mm);
	if (n)
		snprintf(to + n, size - n, "\n");
}

/* The first line is that of touch.h. */
static void make_text(const struct jobs *j, uint32_t number, bool is_new,
		      char *to)
{
	const struct config_measure *m = of(j);
	const double way_mm = m->from_z_mm - m->to_z_mm;
	char over[80];

	put_over(j, over, sizeof(over));
	/* Behind the contact only distances mean anything. */
	snprintf(to, TEXT_MAX, "(T%u Z=probe-%.4f%s)\nG10 L2 P0 R0\n"
		 "G21 G90 F60\n"
		 "G53 G0 Z%.4f\n%s%sG53 G0 Z%.4f\nG91 G80 Z-%.4f\n"
		 "G0 Z%.4f\nM2\n", number, way_mm, is_new ? " new" : "",
		 m->clear_z_mm,
		 *over ? "G53 G0" : "", over, m->from_z_mm, way_mm, way_mm);
}

const char *electrode_no_length(const struct store_electrode *e, bool is_new)
{
	return is_new || e->length_mm > 0 ? NULL :
	       "its length is not known yet; electrode measure N new takes "
	       "what is measured as the length of a new one, and so does "
	       "offset TN Z=probe-20 new";
}

/* Why it cannot be measured; NULL: it can. */
static const char *why_not(const struct jobs *j,
			   const struct store_electrode *e, bool is_new)
{
	const struct config_measure *m = of(j);
	const struct interp_axis_limits *z = &j->config->axes.axis[INTERP_Z];

	if (!j->config->measure.there)
		return "the machine has no reference to measure at; [electrode] "
		       "measure = yes in the machine file, and where it is";
	if (!(j->config->axes.present >> INTERP_Z & 1))
		return "the machine has no Z axis, along which an electrode is "
		       "measured";
	if (!(m->clear_z_mm >= m->from_z_mm && m->from_z_mm > m->to_z_mm))
		return "[electrode] of the machine file must have clear_z_mm >= "
		       "measure_from_z_mm > measure_to_z_mm";
	if (!(2 * m->from_z_mm - m->to_z_mm <= z->travel_max_mm))
		return "measure_from_z_mm plus the way down to measure_to_z_mm "
		       "is beyond the travel of Z; a shorter way";
	if (e->state == ELECTRODE_ABSENT)
		return "this electrode is absent; bring it, and electrode set N "
		       "state=there";
	return electrode_no_length(e, is_new);
}

static int add_job(struct jobs *j, const struct jobs_lcm_command *c,
		   uint32_t number, bool is_new, char id[64])
{
	char text[TEXT_MAX], name[64], hex[65], told[64];
	unsigned char hash[crypto_hash_sha256_BYTES];

	make_text(j, number, is_new, text);
	snprintf(id, 64, "measure-%u-%llx", number, (unsigned long long)c->act);
	snprintf(name, sizeof(name), "measure electrode %u%s", number,
		 is_new ? " new" : "");
	crypto_hash_sha256(hash, (const unsigned char *)text, strlen(text));
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	snprintf(told, sizeof(told), "job measure electrode %u queued", number);
	return jobs_add(j, &(struct store_new) {
		.id = id, .name = name, .sha256 = hex, .tech_sha256 = "",
		.text = text, .bytes = strlen(text), .lines = 9, .hold = true,
		.now_us = jobs_utime(), .electrode = number,
		.measures = true, .told = told,
	});
}

void electrode_measure(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c)
{
	const bool is_new = strcmp(c->text, "new") == 0;
	struct store_electrode e;
	char reason[160], id[64];
	const char *why;
	int err;

	(void)v;
	if (!electrode_find_named(j, c, &e))
		return;
	why = *c->text && !is_new ? "measure: not understood; N, or N new" :
	      why_not(j, &e, is_new);
	if (why) {
		verbs_answer(j, c, REFUSED, why);
		return;
	}
	/* The job has a transaction of its own. */
	err = act_commit(j) ? -EIO : add_job(j, c, e.n, is_new, id);
	if (err && err != -EEXIST) {
		verbs_answer(j, c, EX_IOERR, "the store failed");
		return;
	}
	queue_recount(j);
	snprintf(reason, sizeof(reason), "job %s measures it; it waits for "
		 "start", id);
	verbs_answer(j, c, 0, reason);
}

int electrode_put_length(struct jobs *j, uint32_t number, double length_mm,
			 bool is_new, char told[ELECTRODE_WHY_MAX])
{
	struct store_electrode e, was;
	int err = store_electrode_find(j->store, number, &e);

	if (err < 0)
		return err;
	was = e;
	if (is_new) {
		e.length_mm = length_mm;
		e.wear_mm = e.spark_s = 0;
		e.state = ELECTRODE_THERE;
	} else {
		e.wear_mm = e.length_mm - length_mm;
		if (electrode_is_worn(&e))
			e.state = ELECTRODE_WORN;
	}
	snprintf(told, ELECTRODE_WHY_MAX,
		 "electrode %u %s was measured: it was %.4f mm long, is %.4f mm long; wear %.4f mm, the table had %.4f mm",
		 e.n, e.name, was.length_mm - was.wear_mm, length_mm,
		 e.wear_mm, was.wear_mm);
	return store_electrode_put(j->store, &e);
}
