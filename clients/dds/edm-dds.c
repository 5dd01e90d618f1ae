/* SPDX-License-Identifier: Apache-2.0 */
/*
 * edm-dds - publishes the state of one machine to the fleet
 *
 * It reads edmd's shared memory and publishes an edm::MachineState at a fixed
 * rate.  It asks edmd-jobs for the jobs that have ended and for alarms.  A job
 * that is offered over DDS it hands on to edmd-jobs, which judges it.
 */
#include "cmdline.h"
#include "clocks.h"
#include "config.h"
#include "names.h"
#include "relay.h"
#include "reports.h"
#include "scope.h"
#include "tool.h"
#include "topic.h"
#include "watch.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define NS	1000000000LL
#define STEP_NS	(NS / 20)		/* edmd-jobs is heard as often */
#define OTHERS_MAX	2048
#define ONCE_NS	(2 * NS)		/* --once waits this long for a
					 * reader */

struct options {
	const char *machine, *fault_words, *key;
	dds_domainid_t domain;
	double hz;
	bool once;
};

struct bridge {
	struct watch watch;
	dds_entity_t participant, others, writer;
	int64_t counted_ns;
	uint32_t known;
	struct reports reports;
	struct relay relay;
	struct scope scope;
	int epoll;
	char host[sizeof(((edm_MachineState *)0)->host)];
	char said[sizeof(((edm_MachineState *)0)->state)];
};

static int take_machine(void *to, const char *name)
{
	struct options *o = to;

	if (!names_machine_ok(name))
		return cmdline_refuse("edm-dds", "--machine", name,
				      NAMES_MACHINE_WANTED);
	o->machine = name;
	return -1;
}

static int take_config(void *to, const char *path)
{
	static struct machine_config config;
	struct options *o = to;
	struct interp_diag d = { 0 };
	const int err = config_read(&config, path, &d);

	if (err == -EINVAL)
		interp_diag_tell(&d, path);
	else if (err < 0)
		fprintf(stderr, "edm-dds: error: %s: %s; a machine file\n",
			path, strerror(-err));
	if (err < 0)
		return err == -EINVAL ? EX_CONFIG : EX_NOINPUT;
	o->machine = config.name;
	o->fault_words = config.generator.fault_words;
	o->domain = (dds_domainid_t)config.dds_domain;
	o->hz = config.dds_hz;
	return -1;
}

static int take_domain(void *to, const char *text)
{
	struct options *o = to;

	return tool_domain("edm-dds", text, &o->domain);
}

#define AT(field)	.at = offsetof(struct options, field)

/* clang-format off */
static const struct cmdline_row rows[] = {
	{ "config", "FILE", CMDLINE_CALL, .take = take_config, .help =
	  "machine file: gives name, [dds] domain and hz;\n"
	  "options after it replace them" },
	{ "machine", "NAME", CMDLINE_CALL, .take = take_machine, .help =
	  "name of the machine to read (edm)" },
	{ "key", "FILE", CMDLINE_WORD, AT(key), .help =
	  "key file by which jobs and alarms are asked for;\n"
	  "the role viewer is enough ($EDM_KEY, else the\n"
	  "host's own)" },
	{ "domain", "N", CMDLINE_CALL, .take = take_domain, .help =
	  "DDS domain, 0 to 230 (0)" },
	{ "hz", "N", CMDLINE_NUMBER, AT(hz), .min = TOPIC_HZ_MIN, .max = 100,
	  .help = "samples a second, 2 to 100 (10)" },
	{ "once", NULL, CMDLINE_FLAG, AT(once), .help =
	  "publish one sample to everybody who listens\n"
	  "within 2 s, then exit; 1 if nobody listens" },
};
/* clang-format on */

static const struct cmdline table = {
	.program = "edm-dds", .row = rows,
	.nrows = sizeof(rows) / sizeof(*rows), .column = 18,
	.head =
	"Usage: edm-dds [options]\n"
	"Publish a machine's state to the fleet over DDS.\n"
	"\n",
	.tail =
	"\n"
	"CYCLONEDDS_URI chooses the network interface and peers;\n"
	"see docs/fleet.md.\n",
};

static int bridge_open(struct bridge *b, const struct options *o)
{
	char name[sizeof(TOPIC_DDS) + SHM_NAME_MAX];
	dds_entity_t part;
	int err;

	watch_init(&b->watch, o->machine);
	if (o->fault_words)
		b->watch.fault_words = o->fault_words;
	gethostname(b->host, sizeof(b->host) - 1);
	b->epoll = tool_block_stops();

	snprintf(name, sizeof(name), TOPIC_DDS "%s", o->machine);
	b->participant = tool_participant(table.program, o->domain, name);
	if (b->participant < 0)
		return b->participant;
	b->others = dds_create_reader(b->participant,
				      DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, NULL,
				      NULL);
	part = topic_part_create(b->participant, true, o->machine);
	b->writer = topic_writer_create(part, TOPIC_STATE);
	if (b->others < 0 || b->writer < 0)
		return b->others < 0 ? b->others : b->writer;
	if (o->once)
		return 0;
	err = scope_open(&b->scope, part);
	if (err == 0)
		err = relay_open(&b->relay, b->participant, o->machine,
				 b->epoll);
	return err < 0 ? err : reports_open(&b->reports, part, o->machine,
					    o->key);
}

/* Deleting the writer disposes of its instance, so readers see that it
 * leaves. */
static void bridge_close(struct bridge *b)
{
	relay_close(&b->relay);
	if (b->participant > 0)
		dds_delete(b->participant);
	reports_close(&b->reports);
	watch_fini(&b->watch);
}

static bool is_missing(const char *state)
{
	return !strcmp(state, "absent") || !strcmp(state, "lost");
}

/* Print a line each time the machine comes or goes, but not for every state. */
static void say(struct bridge *b, const edm_MachineState *m)
{
	const char *word = is_missing(m->state) ? m->state : "here";

	if (!strcmp(b->said, word))
		return;

	snprintf(b->said, sizeof(b->said), "%s", word);
	if (is_missing(word) && b->watch.open_error < 0 &&
	    b->watch.open_error != -ENOENT)
		fprintf(stderr, "edm-dds: machine %s is %s: %s\n", m->machine,
			word, b->watch.open_error == -EPROTO ?
			"its edmd is of another release" :
			strerror(-b->watch.open_error));
	else
		fprintf(stderr, "edm-dds: machine %s is %s\n", m->machine,
			word);
}

static bool is_ours(const dds_builtintopic_participant_t *p)
{
	char *name = NULL;
	const bool ours = dds_qget_entity_name(p->qos, &name) && name &&
			  !strncmp(name, TOPIC_DDS, strlen(TOPIC_DDS));

	dds_free(name);
	return ours;
}

/* The others that DDS has found, once a second. */
static void count(struct bridge *b)
{
	const int64_t now = clock_ns(CLOCK_MONOTONIC);
	static dds_sample_info_t info[OTHERS_MAX];
	static void *at[OTHERS_MAX];
	int n;

	if (b->counted_ns && now - b->counted_ns < NS)
		return;
	b->counted_ns = now;
	b->known = 0;
	at[0] = NULL;
	n = dds_read(b->others, at, info, OTHERS_MAX, OTHERS_MAX);
	for (int i = 0; i < n; i++)
		b->known += info[i].valid_data &&
			    info[i].instance_state == DDS_IST_ALIVE &&
			    is_ours(at[i]);
	if (n > 0)
		dds_return_loan(b->others, at, n);
}

static int publish(struct bridge *b)
{
	edm_MachineState m;

	watch_look(&b->watch, clock_ns(CLOCK_MONOTONIC), &m);
	memcpy(m.host, b->host, sizeof(m.host));
	count(b);
	m.known = b->known;
	say(b, &m);
	return dds_write(b->writer, &m);
}

/* Wait until @until_ns.  Return: true if it was told to stop meanwhile. */
static bool wait_until(struct bridge *b, int64_t until_ns)
{
	int64_t left;
	bool stop;

	do {
		relay_step(&b->relay);
		reports_step(&b->reports);
		scope_step(&b->scope, &b->watch);
		left = until_ns - clock_ns(CLOCK_MONOTONIC);
		stop = tool_wait(b->epoll, left < 0 ? 0 : left < STEP_NS ?
				 left : STEP_NS);
	} while (!stop && left > 0);
	return stop;
}

static int run(struct bridge *b, double hz)
{
	int64_t period = (int64_t)((double)NS / hz);
	int64_t next = clock_ns(CLOCK_MONOTONIC);
	int err;

	do {
		err = publish(b);
		/* A slow reader costs this sample, but not the next one. */
		if (err < 0 && err != DDS_RETCODE_TIMEOUT)
			return err;
		next += period;
		if (next < clock_ns(CLOCK_MONOTONIC))
			next = clock_ns(CLOCK_MONOTONIC);
	} while (!wait_until(b, next));
	return 0;
}

static bool has_reader(const struct bridge *b)
{
	dds_publication_matched_status_t s;

	return dds_get_publication_matched_status(b->writer, &s) == 0 &&
	       s.current_count > 0;
}

/* Return: 0, 1 if nobody listened, or a negative DDS code. */
static int run_once(struct bridge *b)
{
	int64_t until = clock_ns(CLOCK_MONOTONIC) + ONCE_NS;
	int err;

	while (!has_reader(b) && clock_ns(CLOCK_MONOTONIC) < until)
		if (wait_until(b, clock_ns(CLOCK_MONOTONIC) + NS / 50))
			break;
	if (!has_reader(b)) {
		fputs("edm-dds: nobody listened within 2 s\n", stderr);
		return 1;
	}
	err = publish(b);
	return err < 0 ? err : dds_wait_for_acks(b->writer, DDS_SECS(2));
}

int main(int argc, char **argv)
{
	struct options o = { .machine = "edm", .hz = 10 };
	struct bridge b = { 0 };
	struct cmdline_given given;
	int err = cmdline_take(&table, &o, argc, argv, &given);

	if (err >= 0)
		return err;
	err = bridge_open(&b, &o);
	if (err == 0)
		err = o.once ? run_once(&b) : run(&b, o.hz);
	bridge_close(&b);
	return err < 0 ? tool_fail(table.program, o.domain, err) : err;
}
