/* SPDX-License-Identifier: Apache-2.0 */
/*
 * options.c - edmd's command line and machine file
 */
#include "options.h"

#include "cmdline.h"
#include "names.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

#define AT(field)	.at = offsetof(struct options, field)

/* clang-format off */
static const struct cmdline_row rows[] = {
	{ "config", "FILE", CMDLINE_WORD, AT(config), .help =
	  "machine file; default: a built-in simulated machine" },
	{ "name", "NAME", CMDLINE_WORD, AT(name), .help =
	  "name of the machine, instead of [machine] name" },
	{ "check", NULL, CMDLINE_FLAG, AT(check), .help =
	  "check the machine file, and the technology table and\n"
	  "the dialect that it names, exit" },
	{ "print-config", NULL, CMDLINE_FLAG, AT(print_config), .help =
	  "print every key with its value as a machine file, exit" },
};
/* clang-format on */

static const struct cmdline table = {
	.program = "edmd", .row = rows, .nrows = sizeof(rows) / sizeof(*rows),
	.column = 19,
	.head =
"Usage: edmd [options]\n"
"\n"
"Controls one machine: runs the cycle in real time and takes commands from\n"
"edmd-jobs, through edmd.<name>.* in /dev/shm\n"
"\n",
	.tail =
"\n"
"SIGTERM and SIGINT stop all motion and then end edmd; a second signal ends\n"
"it at once.  Exit codes are those of sysexits.h.\n",
};

int options_read(struct options *o, int argc, char **argv)
{
	struct cmdline_given given;

	*o = (struct options) { .config = NULL };
	return cmdline_take(&table, o, argc, argv, &given);
}

static int name_override(const char *name, struct machine_config *c)
{
	if (!names_machine_ok(name))
		return cmdline_refuse("edmd", "--name", name,
				      NAMES_MACHINE_WANTED);
	snprintf(c->name, sizeof(c->name), "%s", name);
	return -1;
}

static int config_refuse(const char *path, int err,
			 const struct interp_diag *d)
{
	if (err != -EINVAL) {
		fprintf(stderr, "edmd: error: %s: %s; a machine file that can "
			"be read\n", path, strerror(-err));
		return err == -ENOENT ? EX_NOINPUT : EX_IOERR;
	}
	interp_diag_tell(d, path);
	return EX_CONFIG;
}

int options_config(const struct options *o, struct machine_config *c)
{
	struct interp_diag diag;
	int err;

	config_defaults(c);
	if (o->config) {
		err = config_read(c, o->config, &diag);
		if (err < 0)
			return config_refuse(o->config, err, &diag);
	}
	if (config_check_contouring(c, &diag) < 0)
		return config_refuse(o->config, -EINVAL, &diag);
	return o->name ? name_override(o->name, c) : -1;
}

/* The readers of tables and dialects are not in this program, but in the one
 * beside it.  Does not return, if that is there.  Return: why they were not
 * read. */
static const char *check_beside(const char *config)
{
	char path[PATH_MAX];
	const ssize_t n = readlink("/proc/self/exe", path, sizeof(path) - 6);
	struct stat st;

	/* A pipe gives its text once. */
	if (stat(config, &st) < 0 || !S_ISREG(st.st_mode))
		return "it is not a file that can be read twice";
	if (n > 0) {
		memcpy(path + n, "-jobs", 6);
		execl(path, path, "--check", "--config", config, (char *)NULL);
	}
	return "no edmd-jobs beside edmd";
}

int options_check(const struct options *o)
{
	const char *why;

	if (!o->config) {
		printf("built-in machine: good\n");
		return EX_OK;
	}
	why = check_beside(o->config);
	printf("%s: good; its technology table and its dialect were not read: "
	       "%s\n", o->config, why);
	return EX_OK;
}
