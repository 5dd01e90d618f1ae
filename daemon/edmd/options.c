/* SPDX-License-Identifier: Apache-2.0 */
/*
 * options.c - edmd's command line and machine file
 */
#include "options.h"

#include <errno.h>
#include <getopt.h>
#include <string.h>
#include <sysexits.h>

static const char help[] =
"usage: edmd [options]\n"
"\n"
"The controller of one machine: runs the cycle in real time and answers to\n"
"edmd-jobs through shared memory, /dev/shm/edmd.<name>.*\n"
"\n"
"  --config FILE    machine file; without it, a built-in simulated machine\n"
"  --name NAME      in place of [machine] name\n"
"  --check          read the machine file, say whether it is good, end\n"
"  --print-config   every key with its value, as a machine file, end\n"
"  --print-eds      what a PLC tool imports of a CANopen slave, end\n"
"  --print-dbc      the same frames for tools without CANopen, end\n"
"  --document-plc   the same as a page to read, docs/plc-signals.md, end\n"
"  --help           this\n"
"  --version        version\n"
"\n"
"SIGTERM and SIGINT bring the machine to a stand, then end edmd; a second\n"
"one ends it at once.  Exit codes are those of sysexits.h.\n";

enum { OPT_CONFIG = 1, OPT_NAME, OPT_CHECK, OPT_PRINT, OPT_EDS,
       OPT_DBC, OPT_DOCUMENT_PLC, OPT_HELP, OPT_VERSION };

static const struct option longs[] = {
	{ "config", required_argument, NULL, OPT_CONFIG },
	{ "name", required_argument, NULL, OPT_NAME },
	{ "check", no_argument, NULL, OPT_CHECK },
	{ "print-config", no_argument, NULL, OPT_PRINT },
	{ "print-eds", no_argument, NULL, OPT_EDS },
	{ "print-dbc", no_argument, NULL, OPT_DBC },
	{ "document-plc", no_argument, NULL, OPT_DOCUMENT_PLC },
	{ "help", no_argument, NULL, OPT_HELP },
	{ "version", no_argument, NULL, OPT_VERSION },
	{ NULL, 0, NULL, 0 }
};

static int option_take(struct options *o, int opt)
{
	switch (opt) {
	case OPT_CONFIG:
		o->config = optarg;
		return -1;
	case OPT_NAME:
		o->name = optarg;
		return -1;
	case OPT_CHECK:
		o->check = true;
		return -1;
	case OPT_PRINT:
		o->print_config = true;
		return -1;
	case OPT_EDS:
		o->print_eds = true;
		return -1;
	case OPT_DBC:
		o->print_dbc = true;
		return -1;
	case OPT_DOCUMENT_PLC:
		o->document_plc = true;
		return -1;
	case OPT_HELP:
		fputs(help, stdout);
		return EX_OK;
	case OPT_VERSION:
		puts("edmd " EDM_VERSION);
		return EX_OK;
	}
	fputs("edmd: --help lists the options\n", stderr);
	return EX_USAGE;
}

int options_read(struct options *o, int argc, char **argv)
{
	int opt;

	*o = (struct options) { .config = NULL };
	while ((opt = getopt_long(argc, argv, "", longs, NULL)) != -1) {
		int code = option_take(o, opt);

		if (code >= 0)
			return code;
	}
	if (optind == argc)
		return -1;
	fprintf(stderr, "edmd: error: argument '%s'; options only, "
		"--config FILE names a machine file\n", argv[optind]);
	return EX_USAGE;
}

static int name_override(const char *name, struct machine_config *c)
{
	size_t n = strlen(name);

	if (n == 0 || n >= sizeof(c->name) ||
	    strspn(name, "abcdefghijklmnopqrstuvwxyz"
		   "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") != n) {
		fprintf(stderr, "edmd: error: --name '%s'; 1 to %zu letters, "
			"digits, - and _\n", name, sizeof(c->name) - 1);
		return EX_USAGE;
	}
	memcpy(c->name, name, n + 1);
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
	config_say(path, d);
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
