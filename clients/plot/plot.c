/* SPDX-License-Identifier: Apache-2.0 */
/* plot.c - a picture of a job: its rows are thinned, and gnuplot draws them */
#include "plot.h"
#include "data.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static bool ends_with(const char *s, const char *ending)
{
	size_t n = strlen(s), m = strlen(ending);

	return n > m && !strcasecmp(s + n - m, ending);
}

/*
 * gnuplot reads the script from @in and writes the picture to @out.  So no file
 * name has to be quoted for it.  Return: its exit code, or -errno.
 */
static int run_gnuplot(char *const argv[], int in, int out)
{
	posix_spawn_file_actions_t files;
	pid_t pid;
	int err, status;

	posix_spawn_file_actions_init(&files);
	if (in >= 0)
		posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO);
	if (out >= 0)
		posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
	err = posix_spawnp(&pid, "gnuplot", &files, NULL, argv, environ);
	posix_spawn_file_actions_destroy(&files);
	if (err)
		return -err;
	while (waitpid(pid, &status, 0) < 0)
		if (errno != EINTR)
			return -errno;
	return WIFEXITED(status) ? WEXITSTATUS(status) : -EIO;
}

static int check_gnuplot(const char *program)
{
	char *argv[] = { "gnuplot", "--version", NULL };
	int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
	int r = run_gnuplot(argv, -1, null);

	if (null >= 0)
		close(null);
	if (r == 0)
		return 0;
	fprintf(stderr, "%s: error: plot: gnuplot does not start; "
		"the Debian package gnuplot-nox is wanted\n", program);
	return -ENOPKG;
}

/* Can the picture be written there?  An old file is overwritten; a new file
 * needs its folder. */
static int check_output(const char *program, const char *output)
{
	const char *slash = strrchr(output, '/');
	char *folder = slash ? strndup(output, (size_t)(slash - output) + 1) :
			       strdup(".");
	int err = 0;

	if (!folder)
		err = ENOMEM;
	else if (access(output, F_OK) == 0 ? access(output, W_OK) < 0 :
					     access(folder, W_OK | X_OK) < 0)
		err = errno;
	free(folder);
	if (err)
		fprintf(stderr, "%s: error: plot: %s: %s; a folder that may "
			"be written is wanted\n", program, output,
			strerror(err));
	return -err;
}

int plot_check(const char *program, const char *output)
{
	int err;

	if (!ends_with(output, ".png") && !ends_with(output, ".svg")) {
		fprintf(stderr, "%s: error: plot: %s; a name ending in .png "
			"or .svg is wanted\n", program, output);
		return -EINVAL;
	}
	err = check_output(program, output);
	return err < 0 ? err : check_gnuplot(program);
}

/*
 * Find @name of share/edmd: below EDM_SHARE, beside the installed programs, or
 * beside the programs in the build folder.
 */
static int find_script(char path[PATH_MAX], const char *name)
{
	const char *own = getenv("EDM_SHARE");
	char exe[PATH_MAX / 2] = "";
	ssize_t n = readlink("/proc/self/exe", exe, sizeof(exe) - 1);
	char *slash = n > 0 ? strrchr(exe, '/') : NULL;

	if (own) {
		snprintf(path, PATH_MAX, "%s/%s", own, name);
		return access(path, R_OK) < 0 ? -errno : 0;
	}
	if (slash)
		*slash = '\0';
	snprintf(path, PATH_MAX, "%s/../share/edmd/%s", exe, name);
	if (access(path, R_OK) < 0)
		snprintf(path, PATH_MAX, "%s/share/edmd/%s", exe, name);
	return access(path, R_OK) < 0 ? -errno : 0;
}

/* Write variables, data and script to memory, ready to be read. */
static int write_all(FILE *f, const struct plot_sheet *s)
{
	char path[PATH_MAX];
	int err = find_script(path, s->script);

	if (err < 0) {
		fprintf(stderr, "%s: error: plot: %s: %s; it comes with the "
			"programs, and EDM_SHARE may name its folder\n",
			s->program, path, strerror(-err));
		return err;
	}
	fprintf(f, "svg = %d\n", ends_with(s->output, ".svg"));
	s->write(f, s->arg);
	/* In single quotes gnuplot knows one escape: a doubled quote. */
	fputs("load '", f);
	for (const char *p = path; *p; p++)
		fputs(*p == '\'' ? "''" : (char[]) { *p, '\0' }, f);
	fputs("'\n", f);
	return ferror(f) ? -EIO : 0;
}

/* Return: descriptor or -errno. */
static int script_fd(const struct plot_sheet *s)
{
	int fd = memfd_create("edm-plot", MFD_CLOEXEC);
	FILE *f = fd < 0 ? NULL : fdopen(dup(fd), "w");
	int err;

	if (!f) {
		err = -errno;
		if (fd >= 0)
			close(fd);
		return err;
	}
	err = write_all(f, s);
	if (fclose(f) != 0 && err == 0)
		err = -errno;
	if (err < 0) {
		close(fd);
		return err;
	}
	lseek(fd, 0, SEEK_SET);
	return fd;
}

static int draw(const struct plot_sheet *s, int out)
{
	/* Of "-" it would read each byte by a system call of its own. */
	char *argv[] = { "gnuplot", "-d", "/dev/stdin", NULL };
	int in = script_fd(s);
	int err;

	if (in < 0)
		return in;
	err = run_gnuplot(argv, in, out);
	close(in);
	if (err > 0)
		fprintf(stderr, "%s: error: plot: gnuplot ended with %d\n",
			s->program, err);
	return err > 0 ? -EIO : err;
}

static int copy_all(int to, int from)
{
	char part[16384];
	ssize_t n, put;

	if (lseek(from, 0, SEEK_SET) < 0)
		return -errno;
	while ((n = read(from, part, sizeof(part))) > 0) {
		for (ssize_t at = 0; at < n; at += put) {
			put = write(to, part + at, (size_t)(n - at));
			if (put < 0)
				return -errno;
		}
	}
	return n < 0 ? -errno : 0;
}

/* gnuplot does not say when the disk is full, so it draws into memory. */
static int draw_whole(const struct plot_sheet *s, int out)
{
	int mem = memfd_create("edm-picture", MFD_CLOEXEC);
	int err = mem < 0 ? -errno : draw(s, mem);

	if (err == 0)
		err = copy_all(out, mem);
	if (mem >= 0)
		close(mem);
	return err;
}

int plot_draw(const struct plot_sheet *s)
{
	int out = open(s->output, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC,
		       0666);
	int err;

	if (out < 0) {
		err = -errno;
		fprintf(stderr, "%s: error: plot: %s: %s; a folder that may "
			"be written is wanted\n", s->program, s->output,
			strerror(-err));
		return err;
	}
	err = draw_whole(s, out);
	if (close(out) < 0 && err == 0)
		err = -errno;
	if (err == -ENOSPC || err == -EDQUOT)
		fprintf(stderr, "%s: error: plot: %s: %s\n", s->program,
			s->output, strerror(-err));
	/* Half a picture is worse than none. */
	if (err < 0)
		unlink(s->output);
	return err;
}

struct plot {
	struct plot_options o;
	struct thin thin;
};

struct plot *plot_begin(const struct plot_options *o)
{
	struct plot *p = malloc(sizeof(*p));

	if (!p)
		return NULL;
	p->o = *o;
	thin_init(&p->thin, o->state_name);
	return p;
}

void plot_add(struct plot *p, const struct plot_row *r)
{
	thin_add(&p->thin, r);
}

static int finish(struct plot *p)
{
	if (p->thin.rows == 0) {
		fprintf(stderr, "%s: error: plot: nothing was recorded\n",
			p->o.program);
		return -ENODATA;
	}
	thin_end(&p->thin);
	return plot_draw(&(struct plot_sheet) {
		.program = p->o.program, .output = p->o.output,
		.script = "trace.gp", .write = data_write,
		.arg = &(struct data) { &p->thin, &p->o },
	});
}

int plot_finish(struct plot *p)
{
	int err = p ? finish(p) : 0;

	free(p);
	return err;
}
