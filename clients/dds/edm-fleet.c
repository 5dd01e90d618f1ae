/* SPDX-License-Identifier: Apache-2.0 */
/*
 * edm-fleet - lists the machines that are heard over DDS, one line each
 *
 * The reader's cache keeps the last sample of every machine, and whether its
 * writer is still there.  For each picture the cache is read again.
 */
#include "cmdline.h"
#include "standard.h"
#include "table.h"
#include "tool.h"
#include "topic.h"

#include <stdio.h>
#include <sysexits.h>
#include <unistd.h>

#define MACHINES_MAX	256
#define MS		1000000LL
#define LOOK_NS		(200 * MS)	/* time between two pictures on a
					 * terminal */
#define LINE_NS		(1000 * MS)	/* time between two lines where they
					 * pile up */

enum mode { MODE_AUTO, MODE_ONCE, MODE_WATCH };

struct options {
	dds_domainid_t domain;
	enum mode mode;
	double wait_s;
	bool json;
};

struct fleet {
	dds_entity_t participant, reader;
	sigset_t stops;
	edm_MachineState sample[MACHINES_MAX];
	struct table_row row[MACHINES_MAX];
	size_t nrows;
};

static int take_domain(void *to, const char *text)
{
	struct options *o = to;

	return tool_domain("edm-fleet", text, &o->domain);
}

static int take_once(void *to, const char *text)
{
	struct options *o = to;

	(void)text;
	o->mode = MODE_ONCE;
	return -1;
}

static int take_watch(void *to, const char *text)
{
	struct options *o = to;

	(void)text;
	o->mode = MODE_WATCH;
	return -1;
}

#define AT(field)	.at = offsetof(struct options, field)

/* clang-format off */
static const struct cmdline_row rows[] = {
	{ "domain", "N", CMDLINE_CALL, .take = take_domain, .help =
	  "DDS domain, 0 to 230 (0)" },
	{ "once", NULL, CMDLINE_CALL, .take = take_once, .help =
	  "listen for a while, print one table, exit" },
	{ "watch", NULL, CMDLINE_CALL, .take = take_watch, .help =
	  "redraw until Ctrl-C (default on a terminal)" },
	{ "wait", "S", CMDLINE_NUMBER, AT(wait_s), .min = 0.1, .max = 3600,
	  .help = "how long --once listens, 0.1 to 3600 s (2)" },
	{ "json", NULL, CMDLINE_FLAG, AT(json), .help =
	  "print each table as JSON, on one line" },
};
/* clang-format on */

static const struct cmdline table = {
	.program = "edm-fleet", .row = rows,
	.nrows = sizeof(rows) / sizeof(*rows), .column = 18,
	.head =
	"Usage: edm-fleet [options]\n"
	"List the machines heard over DDS.\n"
	"\n",
	.tail =
	"\n"
	"Exit code: 0 if any machine was heard, 1 if none.\n"
	"CYCLONEDDS_URI chooses the network interface and peers;\n"
	"see docs/fleet.md.\n",
};

static int fleet_open(struct fleet *f, dds_domainid_t domain)
{
	dds_entity_t topic;

	/* The wait between two pictures takes them. */
	tool_block_stops(&f->stops);

	f->participant = dds_create_participant(domain, NULL, NULL);
	if (f->participant < 0)
		return f->participant;
	topic = topic_create(f->participant);
	if (topic < 0)
		return topic;
	f->reader = topic_reader_create(f->participant, topic);
	return f->reader < 0 ? f->reader : 0;
}

/* Read the cache as rows, sorted.  Return: 0 or a negative DDS code. */
static int fleet_look(struct fleet *f)
{
	static dds_sample_info_t info[MACHINES_MAX];
	static void *at[MACHINES_MAX];
	int n;

	for (size_t i = 0; i < MACHINES_MAX; i++)
		at[i] = &f->sample[i];
	f->nrows = 0;
	n = dds_read(f->reader, at, info, MACHINES_MAX, MACHINES_MAX);
	for (int i = 0; i < n; i++) {
		if (!info[i].valid_data)
			continue;
		f->row[f->nrows++] = (struct table_row) {
			.m = &f->sample[i],
			.gone = info[i].instance_state != DDS_IST_ALIVE,
			.heard_ns = info[i].source_timestamp,
		};
	}
	table_sort(f->row, f->nrows);
	return n < 0 ? n : 0;
}

static void print(const struct fleet *f, bool json)
{
	if (json)
		table_print_json(f->row, f->nrows, stdout);
	else
		table_print(f->row, f->nrows, stdout);
	fflush(stdout);
}

/* Listen, and say so in a line where a person waits. */
static int run_once(struct fleet *f, const struct options *o)
{
	bool tty = isatty(STDERR_FILENO);
	bool stop = false;
	int err = 0;

	for (double s = 0; s < o->wait_s && !stop && err == 0; s += 0.1) {
		if (tty) {
			standard_control(stderr, "\r");
			fprintf(stderr, "edm-fleet: domain %u, listened "
				"%.1f of %.1f s, machines: %zu ", o->domain,
				s, o->wait_s, f->nrows);
		}
		stop = tool_wait(&f->stops, 100 * MS);
		err = fleet_look(f);
	}
	if (tty)
		standard_control(stderr, "\r\033[K");
	if (err < 0)
		return err;
	print(f, o->json);
	return 0;
}

static int run_watch(struct fleet *f, const struct options *o)
{
	bool redraw = !o->json && isatty(STDOUT_FILENO);
	int err;

	do {
		err = fleet_look(f);
		if (err < 0)
			return err;
		if (redraw) {
			standard_control(stdout, "\033[H\033[J");
			printf("EDM fleet, DDS domain %u, machines: %zu "
			       "(Ctrl-C ends)\n\n", o->domain, f->nrows);
		}
		print(f, o->json);
	} while (!tool_wait(&f->stops, redraw ? LOOK_NS : LINE_NS));
	return 0;
}

int main(int argc, char **argv)
{
	struct options o = { .wait_s = 2 };
	static struct fleet f;
	struct cmdline_given given;
	int err = cmdline_take(&table, &o, argc, argv, &given);

	if (err >= 0)
		return err;
	if (o.mode == MODE_AUTO)
		o.mode = isatty(STDOUT_FILENO) ? MODE_WATCH : MODE_ONCE;

	err = fleet_open(&f, o.domain);
	if (err == 0)
		err = o.mode == MODE_ONCE ? run_once(&f, &o) :
					    run_watch(&f, &o);
	if (f.participant > 0)
		dds_delete(f.participant);
	if (err < 0)
		return tool_fail(table.program, o.domain, err);
	if (f.nrows == 0)
		fprintf(stderr, "edm-fleet: no machine heard in domain %u; "
			"edm-dds runs beside each machine's edmd\n", o.domain);
	return f.nrows ? EX_OK : 1;
}
