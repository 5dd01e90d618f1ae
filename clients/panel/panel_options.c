/* SPDX-License-Identifier: Apache-2.0 */
/*
 * panel_options.c - the command line of edm-panel
 */
#include "panel_options.h"

#include "cmdline.h"

#include <stdlib.h>
#include <string.h>

#define PROGRAM	"edm-panel"

#define AT(field)	offsetof(struct panel_options, field)

static const struct cmdline_row rows[] = {
	{ "config", "FILE", CMDLINE_WORD, AT(config), .help =
	  "machine file (/etc/edmd/machine.ini)" },
	{ "machine", "NAME", CMDLINE_WORD, AT(machine), .help =
	  "instead of the machine file's [machine] name" },
	{ "port", "N", CMDLINE_NUMBER, AT(port), 1, 65535, .help =
	  "instead of its [panel] port" },
	{ "assets", "DIR", CMDLINE_WORD, AT(assets), .help =
	  "instead of its [panel] assets" },
	{ "add-user", "NAME", CMDLINE_WORD, AT(add_user), .help =
	  "add or change a user; ROLE is viewer, operator or\n"
	  "service; the password is read from the terminal or\n"
	  "from standard input" },
	{ "print-words", NULL, CMDLINE_FLAG, AT(print_words), .help =
	  "the machine's own words as JSON, for the page" },
};

static const struct cmdline table = {
	.program = PROGRAM,
	.head =
"Usage: edm-panel [options]\n"
"       edm-panel [--config FILE] --add-user NAME ROLE\n"
"Serves the operator's page: the machine's state to browsers, and what they ask\n"
"for to edmd-jobs.  docs/panel.md\n"
"\n",
	.tail =
"\n"
"Exit: 0 ended in order, 64 usage, 65 no such password, 66 no such file, 69 a\n"
"port or the channels cannot be opened, 73 the file of users cannot be written,\n"
"78 bad machine file.\n",
	.row = rows, .nrows = sizeof(rows) / sizeof(rows[0]), .args_max = 1,
	.column = 24,
};

/* The panel calls itself with these, in a process of its own: work.h. */
static const struct cmdline_row work_rows[] = {
	{ "work", "WHAT", CMDLINE_WORD, AT(work.what), .help =
	  "check, path, verify or tech" },
	{ "config", "FILE", CMDLINE_WORD, AT(work.config), .help =
	  "machine file" },
	{ "machine", "NAME", CMDLINE_WORD, AT(work.machine), .help =
	  "path: whose program" },
	{ "program", "N", CMDLINE_WHOLE, AT(work.program), 0, 4294967295,
	  .help = "path: its number" },
	{ "file-name", "NAME", CMDLINE_WORD, AT(work.name), .help =
	  "check: of the text" },
	{ "start", "PLACES", CMDLINE_WORD, AT(work.start), .help =
	  "check: eight places, mm" },
	{ "setting", "WORDS", CMDLINE_WORD, AT(work.setting), .help =
	  "check: what is set for the job" },
	{ "tolerance", "MM", CMDLINE_NUMBER, AT(work.tolerance_mm), 0, 1000,
	  .help = "path: how fine" },
};

static const struct cmdline work_table = {
	.program = PROGRAM,
	.head =
"Usage: edm-panel --work WHAT ...; the panel calls it itself\n\n",
	.tail = "", .row = work_rows,
	.nrows = sizeof(work_rows) / sizeof(work_rows[0]), .column = 24,
};

int panel_options_take(struct panel_options *ret, int argc, char **argv)
{
	const bool work = argc > 1 && strcmp(argv[1], "--work") == 0;
	struct cmdline_given given;
	int rc;

	*ret = (struct panel_options) {
		.config = "/etc/edmd/machine.ini",
		.work = { .config = "/etc/edmd/machine.ini",
			  .name = "job.ngc", .setting = "" },
	};
	rc = cmdline_take(work ? &work_table : &table, ret, argc, argv,
			  &given);
	if (rc >= 0 || work)
		return rc;
	ret->role = given.first < argc ? argv[given.first] : NULL;
	if (!ret->role == !ret->add_user)
		return -1;
	return cmdline_refuse(PROGRAM, ret->role ? ret->role : "--add-user",
			      ret->role ? "without --add-user" :
			      "without a role",
			      "--add-user NAME, and viewer, operator or "
			      "service");
}
