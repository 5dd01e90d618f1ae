/* SPDX-License-Identifier: Apache-2.0 */
/*
 * times.c - how long each way takes, by edmsim
 *
 * edmsim is in the same folder as this program.  It runs each program twice,
 * with the machine file and [speed] nodes set to the one value and the other.
 */
#include "plan.h"

#include <errno.h>
#include <jansson.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

struct room {
	char dir[64], ini[512], ngc[96], sim[512];
};

/* Beside the machine file, so that the files it names are found.  If nothing
 * can be written there, in the room's own folder. */
static void place_ini(struct room *r, const char *machine)
{
	const char *slash = machine ? strrchr(machine, '/') : NULL;
	const int n = slash ? (int)(slash - machine) + 1 : 0;
	int fd = -1;

	if (machine && n < (int)sizeof(r->ini) - 32) {
		snprintf(r->ini, sizeof(r->ini), "%.*s.edm-plan-XXXXXX.ini", n,
			 machine);
		fd = mkstemps(r->ini, 4);
	}
	if (fd < 0)
		snprintf(r->ini, sizeof(r->ini), "%s/machine.ini", r->dir);
	else
		close(fd);
}

static int make_room(struct room *r, const char *machine)
{
	const ssize_t n = readlink("/proc/self/exe", r->sim,
				   sizeof(r->sim) - 8);
	char *slash;

	if (n <= 0)
		return EX_OSERR;
	r->sim[n] = '\0';
	slash = strrchr(r->sim, '/');
	strcpy(slash ? slash + 1 : r->sim, "edmsim");
	snprintf(r->dir, sizeof(r->dir), "/tmp/edm-plan-XXXXXX");
	if (!mkdtemp(r->dir))
		return EX_CANTCREAT;
	snprintf(r->ngc, sizeof(r->ngc), "%s/way.ngc", r->dir);
	place_ini(r, machine);
	return 0;
}

static void clear_room(const struct room *r)
{
	unlink(r->ini);
	unlink(r->ngc);
	rmdir(r->dir);
}

static int put_machine(const struct room *r, const struct machine_config *c,
		       int nodes)
{
	static struct machine_config with;
	FILE *f = fopen(r->ini, "w");

	if (!f)
		return EX_CANTCREAT;
	with = *c;
	with.nodes = nodes;
	config_print(&with, f);
	return fclose(f) ? EX_IOERR : 0;
}

/* It writes its report at its end; until then Ctrl-C is for it too. */
static json_t *wait_report(FILE *f, pid_t pid)
{
	struct pollfd p = { .fd = fileno(f), .events = POLLIN };

	while (poll(&p, 1, 200) <= 0)
		if (bar_interrupted())
			kill(pid, SIGINT);
	return json_loadf(f, 0, NULL);
}

/* What edmsim writes to its standard output. */
static json_t *run(const struct room *r, const char *program,
		   const char *dialect)
{
	json_t *o = NULL;
	int end[2], status;
	pid_t pid;
	FILE *f;

	if (pipe(end) < 0)
		return NULL;
	pid = fork();
	if (pid == 0) {
		dup2(end[1], STDOUT_FILENO);
		close(end[0]);
		close(end[1]);
		execl(r->sim, "edmsim", "--quiet", "--seed", "1", "--machine",
		      r->ini, "--report", "-", program,
		      dialect ? "--dialect" : NULL, dialect, (char *)NULL);
		_exit(127);
	}
	close(end[1]);
	f = pid > 0 ? fdopen(end[0], "r") : NULL;
	if (f) {
		o = wait_report(f, pid);
		fclose(f);
	} else {
		close(end[0]);
	}
	if (pid > 0)
		waitpid(pid, &status, 0);
	return o;
}

static int ask(const struct room *r, const struct machine_config *c,
	       const struct route_text *program, double ret_s[2])
{
	for (int nodes = 0; nodes < 2; nodes++) {
		const char *outcome;
		json_t *o;
		int err = put_machine(r, c, nodes);

		if (err)
			return err;
		o = run(r, program->path, program->dialect);
		outcome = json_string_value(json_object_get(o, "outcome"));
		ret_s[nodes] = json_number_value(json_object_get(o,
							"virtual_s"));
		err = outcome && strcmp(outcome, "done") == 0 ? 0 : EX_SOFTWARE;
		if (bar_interrupted())
			err = -EINTR;
		else if (err)
			fprintf(stderr, "edm-plan: %s on %s: %s; a program "
				"that it runs to its end\n", r->sim,
				program->path, outcome ? outcome : "no report");
		json_decref(o);
		if (err) {
			ret_s[0] = ret_s[1] = 0;
			return err;
		}
	}
	return 0;
}

static int ask_way(struct plan *p, const struct room *r,
		   struct plan_way *w)
{
	struct route_text from = { .path = r->ngc };
	double s[2] = { 0, 0 };
	char *text;
	int err;

	if (!w->how)
		return 0;
	text = text_write(p, w);
	err = text ? put_text(r->ngc, text) : EX_OSERR;
	free(text);
	from.dialect = p->written_dialect;
	if (err == 0)
		err = ask(r, &p->j->config, &from, s);
	w->time_pass_s = s[0];
	w->time_stop_s = s[1];
	return err;
}

int times_ask(struct plan *p)
{
	const struct route_text dense = { .path = p->j->o->program,
					  .dialect = p->j->o->dialect };
	double s[2] = { 0, 0 };
	struct room r;
	int err = make_room(&r, p->j->o->machine_file);

	if (err) {
		fprintf(stderr, "edm-plan: %s; a folder in /tmp\n",
			strerror(errno));
		return err;
	}
	bar_show(p->j, 0.1, "edmsim runs the dense way");
	if (p->j->o->program)
		err = ask(&r, &p->j->config, &dense, s);
	p->dense_pass_s = s[0];
	p->dense_stop_s = s[1];
	bar_show(p->j, 0.4, "edmsim runs the greedy way");
	if (err == 0)
		err = ask_way(p, &r, &p->greedy);
	bar_show(p->j, 0.7, "edmsim runs the way to be written");
	if (err == 0)
		err = ask_way(p, &r, &p->best);
	bar_end(p->j);
	clear_room(&r);
	if (err != -EINTR)
		return err;
	fprintf(stderr, "edm-plan: interrupted; the program is written, but "
		"not all times are told\n");
	return 0;
}
