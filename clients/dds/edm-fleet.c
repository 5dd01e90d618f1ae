/* SPDX-License-Identifier: Apache-2.0 */
/*
 * edm-fleet - lists the machines that are heard over DDS, one line each; keeps
 * what they did, and tells it; gives a job to one of them; records the cycles
 * of one
 *
 * For each picture what has come is taken: hall.c keeps the last sample of each
 * machine, and whether its writer is still there.
 */
#include "cmdline.h"
#include "dispatch.h"
#include "hall.h"
#include "ledger.h"
#include "names.h"
#include "scope.h"
#include "sink.h"
#include "standard.h"
#include "submission.h"
#include "table.h"
#include "tool.h"
#include "topic.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define MS		1000000LL
#define LONGEST	10		/* --once listens so many times --wait */
#define LOOK_NS		(200 * MS)	/* time between two pictures on a
					 * terminal */
#define DAYS_OF_WEEK	7
#define LINE_NS		(1000 * MS)	/* time between two lines where they
					 * pile up */

enum mode { MODE_AUTO, MODE_ONCE, MODE_WATCH };

struct options {
	dds_domainid_t domain;
	const char *database;
	bool today, week;
	enum mode mode;
	double wait_s, expect;
	const char *machine, *keys, *id;
	bool any, hold, start;
	bool json;
};

struct fleet {
	dds_entity_t participant;
	int epoll;			/* of signals to stop */
	struct hall hall;
	struct sink sink;
	bool settled;			/* --once: nothing is new any more */
	struct ledger *ledger;		/* NULL: only the list is wanted */
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
	  .help =
	  "--once ends when nothing was new for so long and\n"
	  "all that are known are heard, or after 10 times\n"
	  "as long, 0.1 to 3600 s (2)" },
	{ "expect", "N", CMDLINE_NUMBER, AT(expect), .min = 1, .max = HALL_MAX,
	  .help = "so many machines are there, 1 to 1024" },
	{ "database", "FILE", CMDLINE_WORD, AT(database), .help =
	  "SQLite file that record writes; report and\n"
	  "alarms read it instead of listening" },
	{ "today", NULL, CMDLINE_FLAG, AT(today), .help =
	  "report, alarms: of today (default)" },
	{ "week", NULL, CMDLINE_FLAG, AT(week), .help =
	  "report, alarms: of today and the six days before" },
	{ "machine", "NAME", CMDLINE_WORD, AT(machine), .help =
	  "submit: to this one; scope: of this one" },
	{ "any", NULL, CMDLINE_FLAG, AT(any), .help =
	  "submit: to the first idle one that takes it" },
	{ "hold", NULL, CMDLINE_FLAG, AT(hold), .help =
	  "submit: the job waits for a start (default)" },
	{ "start", NULL, CMDLINE_FLAG, AT(start), .help =
	  "submit: it starts when those before it are done" },
	{ "id", "ID", CMDLINE_WORD, AT(id), .help =
	  "submit: id of the job, wants --machine (drawn)" },
	{ "keys", "FOLDER", CMDLINE_WORD, AT(keys), .help =
	  "submit: keys by which the machines know you, each\n"
	  "MACHINE.key (/etc/edmd/fleet)" },
	{ "json", NULL, CMDLINE_FLAG, AT(json), .help =
	  "print each table as JSON, on one line" },
};
/* clang-format on */

static const struct cmdline table = {
	.program = "edm-fleet", .row = rows,
	.nrows = sizeof(rows) / sizeof(*rows), .column = 18, .args_max = 2,
	.head =
	"Usage: edm-fleet [options] [COMMAND]\n"
	"List the machines heard over DDS.\n"
	"\n"
	"  record          keep jobs, alarms and times in --database FILE\n"
	"  report          hours, jobs and why machines stood, by machine\n"
	"  alarms          alarms of all machines, newest first\n"
	"  submit FILE     give a job to --machine NAME or to --any\n"
	"  scope FILE      write each cycle of --machine NAME to a CSV\n"
	"\n",
	.tail =
	"\n"
	"Exit code: 0 if all known machines were heard, or the\n"
	"database was read, or the job was given, else 1 or\n"
	"as edmctl has it.\n"
	"CYCLONEDDS_URI chooses the network interface and peers;\n"
	"see docs/fleet.md.\n",
};

static int fleet_open(struct fleet *f, dds_domainid_t domain)
{
	int err;

	f->participant = tool_participant(table.program, domain, NULL);
	if (f->participant < 0)
		return f->participant;
	err = hall_open(&f->hall, f->participant);
	return err < 0 || !f->ledger ? err :
	       sink_open(&f->sink, f->participant, f->ledger);
}

static void print(const struct fleet *f, bool json)
{
	if (json)
		table_print_json(f->hall.row, f->hall.n, stdout);
	else
		table_print(f->hall.row, f->hall.n, stdout);
	fflush(stdout);
}

static size_t expected(const struct fleet *f, const struct options *o)
{
	const size_t known = hall_known(&f->hall);

	return known > (size_t)o->expect ? known : (size_t)o->expect;
}

static void tell(const struct fleet *f, const struct options *o, double s)
{
	standard_control(stderr, "\r");
	fprintf(stderr, "edm-fleet: domain %u, listens %.1f s, machines: %zu "
		"of %zu ", o->domain, s, f->hall.n, expected(f, o));
}

/* Listen until nothing is new for a while and all are there that anybody knows
 * of. */
static int run_once(struct fleet *f, const struct options *o)
{
	const bool tty = isatty(STDERR_FILENO);
	double s = 0, new_s = 0;
	uint64_t news = 0;
	int err;

	do {
		if (tty)
			tell(f, o, s);
		err = hall_look(&f->hall);
		if (err == 0 && f->ledger)
			sink_step(&f->sink, &f->hall, false);
		if (f->hall.news + f->sink.news != news)
			new_s = s;
		news = f->hall.news + f->sink.news;
		s += 0.1;
		f->settled = s - new_s >= o->wait_s;
	} while (err == 0 && s < LONGEST * o->wait_s &&
		 !(f->settled && (!f->hall.n || f->hall.n >= expected(f, o))) &&
		 !tool_wait(f->epoll, 100 * MS));
	if (tty)
		standard_control(stderr, "\r\033[K");
	if (err == 0 && !f->ledger)
		print(f, o->json);
	return err;
}

static int run_watch(struct fleet *f, const struct options *o)
{
	bool redraw = !o->json && isatty(STDOUT_FILENO);
	int err;

	f->settled = true;
	do {
		err = hall_look(&f->hall);
		if (err < 0)
			return err;
		if (redraw) {
			standard_control(stdout, "\033[H\033[J");
			printf("EDM fleet, DDS domain %u, machines: %zu "
			       "(Ctrl-C ends)\n\n", o->domain, f->hall.n);
		}
		print(f, o->json);
	} while (!tool_wait(f->epoll, redraw ? LOOK_NS : LINE_NS));
	return 0;
}

/* Say what is missing. */
static bool all_there(const struct fleet *f, const struct options *o)
{
	if (f->hall.beyond)
		fprintf(stderr, "edm-fleet: more than %d machines; the others "
			"are not shown\n", HALL_MAX);
	if (f->hall.n == 0)
		fprintf(stderr, "edm-fleet: no machine heard in domain %u; "
			"edm-dds runs beside each machine's edmd\n", o->domain);
	else if (f->hall.n < expected(f, o))
		fprintf(stderr, "edm-fleet: heard %zu of %zu machines; the "
			"others are not there, or packets are lost\n",
			f->hall.n, expected(f, o));
	else if (!f->settled)
		fputs("edm-fleet: new ones still came at the end; a longer "
		      "--wait is wanted\n", stderr);
	return f->settled && f->hall.n && f->hall.n >= expected(f, o);
}

static int run_list(struct fleet *f, const struct options *o)
{
	const bool once = o->mode == MODE_ONCE || f->ledger ||
			  (o->mode == MODE_AUTO && !isatty(STDOUT_FILENO));
	int err = fleet_open(f, o->domain);

	if (err == 0)
		err = once ? run_once(f, o) : run_watch(f, o);
	if (f->participant > 0)
		dds_delete(f->participant);
	err = err < 0 ? tool_fail(table.program, o->domain, err) :
			all_there(f, o) ? EX_OK : 1;
	hall_close(&f->hall);
	return err;
}

/* -- What was done --------------------------------------------------------- */

static int open_ledger(struct fleet *f, const char *path, bool write)
{
	const char *why;
	const int err = ledger_open(&f->ledger, path, write, &why);

	if (err < 0)
		fprintf(stderr, "edm-fleet: error: %s: %s; a file of edm-fleet "
			"record\n", path ? path : "memory", why);
	return err == 0 ? EX_OK : err == -EALREADY ? EX_TEMPFAIL : EX_NOINPUT;
}

/* Say once what is wrong with the disk, and that it is mended. */
static void say_disk(const struct fleet *f, int err, int *said)
{
	if (err < 0 && !*said)
		fprintf(stderr, "edm-fleet: nothing is stored: %s; what comes "
			"is kept and stored as soon as that is possible\n",
			ledger_why(f->ledger));
	else if (err == 0 && *said)
		fputs("edm-fleet: all is stored again\n", stderr);
	*said = err;
}

static int run_record(struct fleet *f, const struct options *o)
{
	bool stop = false;
	int said = 0, err;

	if (!o->database)
		return cmdline_refuse("edm-fleet", "record", "",
				      "record --database FILE");
	err = open_ledger(f, o->database, true);
	if (err)
		return err;
	err = fleet_open(f, o->domain);
	while (err == 0 && !stop) {
		stop = tool_wait(f->epoll, said ? LINE_NS : LOOK_NS);
		err = hall_look(&f->hall);
		if (err == 0)
			say_disk(f, sink_step(&f->sink, &f->hall, stop),
				 &said);
	}
	if (f->participant > 0)
		dds_delete(f->participant);
	hall_close(&f->hall);
	if (err < 0)
		return tool_fail(table.program, o->domain, err);
	return said ? EX_IOERR : EX_OK;
}

/* From the database; without one of what is heard, which is the last day. */
static int run_told(struct fleet *f, const struct options *o,
		    int (*print_sheet)(struct ledger *l, int days, bool json,
				       FILE *f))
{
	int code = o->week && !o->database ?
		   cmdline_refuse("edm-fleet", "--week", "",
				  "--database FILE of edm-fleet record; "
				  "without it only the last day is heard") :
		   open_ledger(f, o->database, !o->database);

	if (code == EX_OK && !o->database)
		code = run_list(f, o);
	if (!f->ledger || (code != EX_OK && code != 1))
		return code;
	if (print_sheet(f->ledger, o->week ? DAYS_OF_WEEK - 1 : 0, o->json,
			stdout) < 0) {
		fprintf(stderr, "edm-fleet: error: %s: %s\n",
			o->database ? o->database : "memory",
			ledger_why(f->ledger));
		return EX_NOINPUT;
	}
	return code;
}

/* -- What is to be done ---------------------------------------------------- */

static int run_submit(struct fleet *f, const struct options *o,
		      const char *path)
{
	const struct dispatch_options x = {
		.path = path, .machine = o->machine, .keys = o->keys,
		.id = o->id, .start = o->start, .json = o->json,
		.wait_s = o->wait_s, .expect = (size_t)o->expect,
	};
	int err;

	if (!path || !o->machine == !o->any)
		return cmdline_refuse("edm-fleet", "submit", path ? path : "",
				      "submit FILE and either --machine NAME "
				      "or --any");
	if (o->machine && !names_machine_ok(o->machine))
		return cmdline_refuse("edm-fleet", "--machine", o->machine,
				      NAMES_MACHINE_WANTED);
	if (o->hold && o->start)
		return cmdline_refuse("edm-fleet", "--hold", "with --start",
				      "one of them");
	if (o->id && o->any)
		return cmdline_refuse("edm-fleet", "--id", o->id,
				      "--machine NAME with it: only one "
				      "machine knows whether it has this id");
	if (o->id && strlen(o->id) >= SUBMISSION_ID_MAX)
		return cmdline_refuse("edm-fleet", "--id", o->id,
				      "1 to 63 of A-Z a-z 0-9 . _ -");
	err = fleet_open(f, o->domain);
	if (err == 0)
		err = dispatch_run(f->participant, &f->hall, &x);
	else
		err = tool_fail(table.program, o->domain, err);
	if (f->participant > 0)
		dds_delete(f->participant);
	hall_close(&f->hall);
	return err;
}

static int run_scope(struct fleet *f, const struct options *o, const char *path)
{
	int err;

	if (!path || !o->machine)
		return cmdline_refuse("edm-fleet", "scope", path ? path : "",
				      "scope FILE --machine NAME");
	if (!names_machine_ok(o->machine))
		return cmdline_refuse("edm-fleet", "--machine", o->machine,
				      NAMES_MACHINE_WANTED);
	err = fleet_open(f, o->domain);
	if (err == 0)
		err = scope_record(f->participant, f->epoll, o->machine, path);
	if (f->participant > 0)
		dds_delete(f->participant);
	hall_close(&f->hall);
	return err < 0 ? tool_fail(table.program, o->domain, err) : err;
}

static int run(struct fleet *f, const struct options *o, char **arg)
{
	const char *command = arg[0];

	if (command && !strcmp(command, "submit"))
		return run_submit(f, o, arg[1]);
	if (command && !strcmp(command, "scope"))
		return run_scope(f, o, arg[1]);
	if (command && arg[1])
		return cmdline_refuse("edm-fleet", command, arg[1],
				      "nothing after it; submit and scope take "
				      "a FILE");
	if (!command)
		return run_list(f, o);
	if (!strcmp(command, "record"))
		return run_record(f, o);
	if (!strcmp(command, "report"))
		return run_told(f, o, ledger_print_report);
	if (!strcmp(command, "alarms"))
		return run_told(f, o, ledger_print_alarms);
	return cmdline_refuse("edm-fleet", "command", command,
			      "record, report, alarms, submit FILE, scope FILE, "
			      "or nothing");
}

int main(int argc, char **argv)
{
	struct options o = { .wait_s = 2, .keys = "/etc/edmd/fleet" };
	static struct fleet f;
	struct cmdline_given given;
	int err = cmdline_take(&table, &o, argc, argv, &given);

	if (err >= 0)
		return err;
	/* The wait between two pictures takes them. */
	f.epoll = tool_block_stops();
	err = run(&f, &o, &argv[given.first]);
	ledger_close(f.ledger);
	return err;
}
