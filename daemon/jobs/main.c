/* SPDX-License-Identifier: Apache-2.0 */
/* main.c - edmd-jobs: options, the event loop, start and end */
#include "jobs.h"

#include "clocks.h"
#include "cmdline.h"
#include "compiling.h"
#include "files.h"
#include "interrupt.h"
#include "keyring.h"
#include "jobs_log.h"
#include "logger.h"
#include "mdi.h"
#include "names.h"
#include "values.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <time.h>

#define TICK_US		20000
#define TICK_SLACK_US	1000

struct options {
	const char *config, *name, *store;
	bool check;
};

#define AT(field)	.at = offsetof(struct options, field)

/* clang-format off */
static const struct cmdline_row rows[] = {
	{ "config", "FILE", CMDLINE_WORD, AT(config), .help =
	  "machine file, the same as for edmd" },
	{ "name", "NAME", CMDLINE_WORD, AT(name), .help =
	  "name of the machine; default: [machine] name" },
	{ "store", "DIR", CMDLINE_WORD, AT(store), .help =
	  "folder of the database; default: [jobs] store" },
	{ "check", NULL, CMDLINE_FLAG, AT(check), .help =
	  "check the machine file, and the technology table and\n"
	  "the dialect that it names, exit" },
};
/* clang-format on */

static const struct cmdline table = {
	.program = "edmd-jobs",
	.row = rows, .nrows = sizeof(rows) / sizeof(*rows), .column = 17,
	.head =
	"Usage: edmd-jobs --config FILE [options]\n"
	"\n"
	"Receives jobs over LCM, keeps them in a queue, loads them into edmd and\n"
	"reports how they proceed.  A running job goes on without it.\n"
	"\n",
};

int64_t jobs_now_us(void)
{
	return clock_us(CLOCK_MONOTONIC);
}

int64_t jobs_utime(void)
{
	return clock_us(CLOCK_REALTIME);
}

/* An act is one transaction anyhow. */
void jobs_with_note(struct jobs *j)
{
	if (!j->act_open && !j->note_open)
		j->note_open = store_together(j->store, true) == 0;
}

/* Return: as act_commit(). */
static int commit_note(struct jobs *j)
{
	const int err = j->note_open ? store_commit(j->store) : 0;

	j->note_open = false;
	return err;
}

static void publish(struct jobs *j, const struct jobs_note *n, const char *text)
{
	jobs_lcm_event(j->lcm, &(struct jobs_lcm_event) {
		.kind = n->kind, .job = n->job, .outcome = n->outcome,
		.text = text, .place_mm = n->place_mm,
	});
}

void jobs_note(struct jobs *j, const struct jobs_note *n,
	       const char *text, ...)
{
	char words[700];
	va_list ap;
	int err;

	va_start(ap, text);
	vsnprintf(words, 512, text, ap);
	va_end(ap);
	log_notice("%s: %s", n->kind, words);
	err = store_note(j->store, &(struct store_note) {
		.kind = n->kind, .job = n->job ? n->job : "",
		.outcome = n->outcome ? n->outcome : "", .text = words,
		.place_mm = n->place_mm, .now_us = jobs_utime(),
	});
	if (commit_note(j) != 0 && err == 0)
		err = STORE_KEPT;
	/* What is reported is true.  If the disk does not have it, that is
	 * reported too. */
	if (err != 0)
		snprintf(words + strlen(words), sizeof(words) - strlen(words),
			 " (%s: %s)", err == STORE_MISSED ?
			 "not kept, too much is in memory" :
			 "kept in memory, not on the disk",
			 store_why(j->store));
	publish(j, n, words);
}

int jobs_add(struct jobs *j, const struct store_new *n)
{
	const struct jobs_note note = { .kind = "queued", .job = n->id };
	uint32_t number;
	const int err = store_add(j->store, n, &number);

	if (err != 0)
		return err;
	log_notice("%s: %s", note.kind, n->told);
	publish(j, &note, n->told);
	return 0;
}

void jobs_answer(struct jobs *j, const struct jobs_lcm_ack *a)
{
	reply_keep(&j->replies, a);
	jobs_lcm_ack(j->lcm, a);
}

static void on_link_event(void *arg, const struct shm_event *e)
{
	queue_event(arg, e);
}

static void on_link_changed(void *arg)
{
	struct jobs *j = arg;
	bool ok = j->link.state == LINK_OK;

	jobs_note(j, &(struct jobs_note) {
		.kind = ok ? "back" : "lost", .job = j->queue.job.id,
		.place_mm = j->link.snap.place_mm,
	}, ok ? "edmd is there" : "edmd is lost: its cycle stands still");
	if (ok)
		queue_attach(j);
}

static int on_lcm(sd_event_source *s, int fd, uint32_t events, void *arg)
{
	struct jobs *j = arg;

	(void)s, (void)fd, (void)events;
	jobs_lcm_handle(j->lcm);
	return 0;
}

static void tell_mended(struct jobs *j)
{
	jobs_note(j, &(struct jobs_note) {
		.kind = "store", .outcome = "mended",
	}, "%s", store_mended(j->store));
}

static void tell_store(struct jobs *j, const char *why)
{
	const struct jobs_note note = {
		.kind = "store", .outcome = *why ? "degraded" : "ok",
	};
	const uint64_t missed = store_missed(j->store);

	if (*why)
		jobs_note(j, &note, "store degraded: %s", why);
	else if (missed > 0)
		jobs_note(j, &note, "store is whole again; %" PRIu64 " events, "
			  "alarms and changes were too many and are not in it",
			  missed);
	else
		jobs_note(j, &note, "store is whole again");
}

/* Report when the store becomes degraded, and when it is whole again. */
static void watch_store(struct jobs *j, int64_t now_us)
{
	const bool whole = store_tick(j->store, now_us);
	const char *why = store_why(j->store);

	if (strcmp(why, j->store_told) == 0)
		return;
	j->store_told = why;
	tell_store(j, why);
	if (whole && *store_mended(j->store))
		tell_mended(j);
	/* Until now nothing was known of what is in the store. */
	if (whole && j->queue.job.n == 0) {
		queue_init(j);
		interrupt_init(j);
	}
}

static int on_tick(sd_event_source *s, uint64_t usec, void *arg)
{
	struct jobs *j = arg;
	int64_t now_us = jobs_now_us();
	int dropped;

	(void)usec;
	link_poll(&j->link, now_us);
	twin_poll(&j->twin, j->link.state == LINK_OK ? j->link.status : NULL,
		  &j->link.snap);
	if (j->link.state == LINK_OK)
		queue_step(j, now_us);
	dropped = upload_expire(&j->uploads, now_us);
	if (dropped)
		log_notice("submit: dropped %d uploads that did not go on for "
			   "30 s", dropped);
	watch_store(j, now_us);
	jobs_lcm_look(j->lcm, now_us);
	checkpoint_tick(j, now_us);
	interrupt_tick(j);
	store_retain(j->store, (int64_t)j->config->keep_jobs,
		     (int64_t)j->config->keep_days, jobs_utime());
	status_tick(j, now_us);
	sd_event_source_set_enabled(s, SD_EVENT_ONESHOT);
	return sd_event_source_set_time_relative(s, TICK_US);
}

/* Return: -1 to go on, or the exit code. */
static int parse(int argc, char **argv, struct options *o)
{
	struct cmdline_given given;
	const int code = cmdline_take(&table, o, argc, argv, &given);

	if (code >= 0 || o->config)
		return code;
	return cmdline_refuse("edmd-jobs", "no", "--config",
			      "--config FILE, the machine file");
}

static int configure(struct jobs *j, struct machine_config *config,
		     const struct options *o)
{
	struct interp_diag d = { .line = 0 };
	int err = config_read(config, o->config, &d);
	const char *wrong;

	if (err == 0)
		err = config_check_kinematics(config, &d);
	if (err == -EINVAL) {
		interp_diag_tell(&d, o->config);
		return EX_CONFIG;
	}
	if (err < 0) {
		fprintf(stderr, "edmd-jobs: %s: %s; a machine file that can be "
			"read\n", o->config, strerror(-err));
		return EX_NOINPUT;
	}
	wrong = udpm_url_read(&j->url, config->lcm_url);
	if (wrong) {
		fprintf(stderr, "%s: error: [lcm] url %s: %s\n", o->config,
			config->lcm_url, wrong);
		return EX_CONFIG;
	}
	j->config = config;
	if (!realpath(o->config, j->config_path))
		snprintf(j->config_path, sizeof(j->config_path), "%s",
			 o->config);
	j->machine = o->name ? o->name : config->name;
	if (!names_machine_ok(j->machine))
		return cmdline_refuse("edmd-jobs", "machine name", j->machine,
				      NAMES_MACHINE_WANTED);
	return 0;
}

static int open_store(struct jobs *j, const char *dir)
{
	int err = store_open(&j->store, dir, j->machine);

	if (err == 0)
		return 0;
	if (err == -EALREADY) {
		log_error("store: %s/%s.db is in use; one edmd-jobs for a "
			  "machine", dir, j->machine);
		return EX_TEMPFAIL;
	}
	if (err == -EPROTO) {
		log_error("store: %s/%s.db is of a newer edmd-jobs", dir,
			  j->machine);
		return EX_CONFIG;
	}
	if (err == -ELOOP)		/* store_open() has said which file */
		return EX_CONFIG;
	log_error("store: %s: %s; a folder that can be written, by --store or "
		  "[jobs] store", dir, strerror(-err));
	return EX_CANTCREAT;
}

/* Two services would give one machine two different queues. */
static int claim(struct jobs *j)
{
	char path[SHM_PATH_MAX];

	j->claim = shm_writer_claim(j->machine);
	if (j->claim >= 0) {
		shm_program_remove(j->machine, SHM_PROGRAM_AHEAD);
		return 0;
	}
	if (j->claim == -EBUSY) {
		log_error("machine %s: another edmd-jobs commands it; one "
			  "edmd-jobs for a machine", j->machine);
		return EX_TEMPFAIL;
	}
	shm_path(path, j->machine, "writer");
	log_error("machine %s: %s: %s; remove it, or run as the user who made "
		  "it", j->machine, path, strerror(-j->claim));
	return EX_CANTCREAT;
}

static int open_lcm(struct jobs *j)
{
	struct jobs_lcm_handlers h = {
		.command = verbs_take, .chunk = submit_take,
		.want = verbs_want,
		.guest = status_guest,
		.trust = &j->trust, .arg = j,
	};

	if (j->url.ttl > 0 && j->trust.nkeys < 2) {
		log_error("lcm: %s leaves this host, and no other host has a "
			  "key; with ttl=0, edmctl keys add NAME operator "
			  "makes one; then set the ttl", j->config->lcm_url);
		return EX_CONFIG;
	}
	return jobs_lcm_open(&j->lcm, &j->url, j->machine, &h) < 0 ?
	       EX_UNAVAILABLE : 0;
}

static const int signals[] = { SIGTERM, SIGINT };

/* A signal that comes before the loop waits for the loop.  So a service that is
 * ended while it starts leaves nothing behind. */
static void block_signals(void)
{
	sigset_t set;

	sigemptyset(&set);
	for (int i = 0; i < 2; i++)
		sigaddset(&set, signals[i]);
	sigprocmask(SIG_BLOCK, &set, NULL);
	signal(SIGPIPE, SIG_IGN);
}

/* Signals end the loop.  The exit code of the loop is that of the program. */
static int add_sources(struct jobs *j)
{
	int err;

	for (int i = 0; i < 2; i++) {
		err = sd_event_add_signal(j->event, NULL, signals[i], NULL,
					  NULL);
		if (err < 0)
			return err;
	}
	err = sd_event_add_io(j->event, NULL, jobs_lcm_fd(j->lcm), EPOLLIN,
			      on_lcm, j);
	if (err < 0)
		return err;
	err = sd_event_add_time_relative(j->event, NULL, CLOCK_MONOTONIC, 0,
					 TICK_SLACK_US, on_tick, j);
	if (err < 0)
		return err;
	return sd_event_set_watchdog(j->event, true);
}

static int run(struct jobs *j)
{
	struct link_handlers h = {
		.event = on_link_event, .changed = on_link_changed, .arg = j,
	};
	int err = sd_event_new(&j->event);

	j->begun_us = jobs_now_us();
	link_init(&j->link, j->machine, &h);
	twin_init(&j->twin, j->config);
	j->store_told = "";
	if (*store_mended(j->store))
		tell_mended(j);
	if (err >= 0)
		err = queue_init(j);
	interrupt_init(j);
	if (err >= 0)
		err = add_sources(j);
	if (err >= 0) {
		log_notice("machine %s on %s", j->machine, j->config->lcm_url);
		sd_notify(0, "READY=1\nSTATUS=taking jobs");
		err = sd_event_loop(j->event);
		sd_notify(0, "STOPPING=1");
	}
	if (err < 0)
		log_error("ends: %s", strerror(-err));
	submit_fini(j);
	mdi_fini(j);
	queue_fini(j);
	link_fini(&j->link);
	sd_event_unref(j->event);
	return err < 0 ? EX_SOFTWARE : EX_OK;
}

static int file_refuse(const char *why, int err)
{
	fprintf(stderr, "edmd-jobs: %s\n", why);
	return err == -ENOENT ? EX_NOINPUT : err == -ENOMEM ? EX_OSERR :
	       EX_CONFIG;
}

/* The files that are read for each job. */
static int check_files(const struct machine_config *config,
		       const struct options *o)
{
	struct config_tech tech;
	struct config_dialect dialect;
	char why[1024];
	int code = EX_OK, err = config_tech_load(&tech, config, NULL);

	if (err) {
		config_tech_why(&tech, err, why, sizeof(why));
		code = file_refuse(why, err);
	}
	config_tech_free(&tech);
	err = config_dialect_load(&dialect, config, NULL, "");
	if (err) {
		config_dialect_why(&dialect, err, why, sizeof(why));
		code = file_refuse(why, err);
	}
	config_dialect_free(&dialect);
	if (code == EX_OK)
		printf("%s: good\n", o->config);
	return code;
}

int main(int argc, char **argv)
{
	static struct machine_config config;
	static struct jobs jobs;
	struct options o = { .config = NULL };
	int err = parse(argc, argv, &o);

	if (err >= 0)
		return err;
	if (sodium_init() < 0)
		return EX_SOFTWARE;
	/* A file that others may read gets its mode explicitly. */
	umask(0077);
	err = configure(&jobs, &config, &o);
	if (err)
		return err;
	if (o.check)
		return check_files(&config, &o);
	block_signals();
	logger_start();
	err = open_store(&jobs, o.store ? o.store : config.store_dir);
	jobs.claim = -1;
	if (err == 0)
		err = claim(&jobs);
	jobs.store_dir = o.store ? o.store : config.store_dir;
	/* A service without checkpoints is better than no service. */
	if (err == 0)
		checkpoint_open(&jobs.checkpoint, jobs.store_dir, jobs.machine,
				&jobs.last);
	files_read(&jobs, o.config);
	if (err == 0)
		err = keyring_open(&jobs, o.store ? o.store : config.store_dir);
	if (err == 0)
		err = open_lcm(&jobs);
	if (err == 0)
		err = run(&jobs);
	reply_fini(&jobs.replies);
	values_destroy(jobs.values);
	jobs_lcm_close(jobs.lcm);
	keyring_close(&jobs);
	shm_writer_leave(jobs.claim, jobs.machine);
	checkpoint_close(jobs.checkpoint);
	store_close(jobs.store);
	logger_stop();
	return err;
}
