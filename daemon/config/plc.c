/* SPDX-License-Identifier: Apache-2.0 */
/* plc.c - [plc]: the lists of M codes as a table, and keys that must agree */
#include "keys.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define A_LIST	"M codes of 6 ... 255 as in 60 62 70-75, but for 30 98 99; " \
		"or none"

struct list {
	const char *key;
	size_t at;			/* of its text in config_plc */
	uint8_t sync;			/* enum interp_mcode_sync; 0: it is */
	uint8_t back;			/* ... of enum interp_mcode_back */
};

static const struct list lists[] = {
	{ "m_before", offsetof(struct config_plc, m_before),
	  INTERP_MCODE_BEFORE, 0 },
	{ "m_after", offsetof(struct config_plc, m_after),
	  INTERP_MCODE_AFTER, 0 },
	{ "m_free", offsetof(struct config_plc, m_free),
	  INTERP_MCODE_FREE, 0 },
	{ "m_redo", offsetof(struct config_plc, m_redo), 0,
	  INTERP_MCODE_REDO },
	{ "m_stop", offsetof(struct config_plc, m_stop), 0,
	  INTERP_MCODE_STOP },
};

#define CHANGER	6			/* M6 */
#define NLISTS	(sizeof(lists) / sizeof(lists[0]))

static int refuse(struct interp_diag *d, const struct list *l,
		  const char *what, const char *wanted)
{
	return interp_diag_say(d, "plc.%s: %.120s; %s", l->key, what, wanted);
}

/* M0 ... M5, M30, M98 and M99 belong to the program itself. */
static bool is_own(unsigned long n)
{
	return n <= 5 || n == 30 || n == 98 || n == 99;
}

static int put(struct interp_mcode *table, const struct list *l,
	       unsigned long n, struct interp_diag *d)
{
	struct interp_mcode *m = &table[n];
	char what[32];

	snprintf(what, sizeof(what), "M%lu", n);
	if (is_own(n))
		return refuse(d, l, what, A_LIST);
	if (l->sync && m->sync)
		return refuse(d, l, what, "each M code in one of m_before, "
			      "m_after and m_free, once");
	if (!l->sync && (!m->sync || (m->back && n != CHANGER)))
		return refuse(d, l, what, "M codes of m_before, m_after or "
			      "m_free, in one of m_redo and m_stop");
	if (n == CHANGER && l->back == INTERP_MCODE_REDO)
		return refuse(d, l, what, "M6 not here: no way back leads over "
			      "a change of the electrode");
	if (l->sync)
		m->sync = l->sync;
	else
		m->back = l->back;
	/* Another electrode would go where the last one has cut. */
	if (n == CHANGER)
		m->back = INTERP_MCODE_STOP;
	return 0;
}

/* Read "60" or "70-75" at @*at, and move @*at behind it. */
static bool range(const char **at, unsigned long *a, unsigned long *b)
{
	char *end;

	if (**at < '0' || **at > '9')
		return false;
	*b = *a = strtoul(*at, &end, 10);
	if (*end == '-' && end[1] >= '0' && end[1] <= '9')
		*b = strtoul(end + 1, &end, 10);
	*at = end;
	return (*end == ' ' || *end == '\0') && *a <= *b && *b < INTERP_NMCODES;
}

static int read_list(struct interp_mcode *table, const struct list *l,
		     const char *text, struct interp_diag *d)
{
	const char *at = text;
	unsigned long a, b;

	if (strcmp(text, "none") == 0)
		return 0;
	for (at += strspn(at, " "); *at; at += strspn(at, " ")) {
		if (!range(&at, &a, &b))
			return refuse(d, l, text, A_LIST);
		for (unsigned long n = a; n <= b; n++) {
			const int err = put(table, l, n, d);

			if (err)
				return err;
		}
	}
	return 0;
}

static int read_lists(const struct config_plc *c,
		      struct interp_mcode table[INTERP_NMCODES], size_t *ret_i,
		      struct interp_diag *d)
{
	memset(table, 0, INTERP_NMCODES * sizeof(table[0]));
	for (size_t i = 0; i < NLISTS; i++) {
		const int err = read_list(table, &lists[i],
					  (const char *)c + lists[i].at, d);

		*ret_i = i;
		if (err)
			return err;
	}
	return 0;
}

void config_mcodes(const struct machine_config *c,
		   struct interp_mcode table[INTERP_NMCODES])
{
	struct interp_diag none;
	size_t i;

	read_lists(&c->plc, table, &i, &none);
}

bool config_has_plc(const struct machine_config *c)
{
	return strcmp(c->plc.interface, "none") != 0;
}

/* -- Check ---------------------------------------------------------------- */

static uint32_t line_of(const struct config_lines *lines, const char *key)
{
	return lines->at[config_key_find(SECTION_PLC, key)][0];
}

static bool has_mcodes(const struct interp_mcode *table)
{
	for (int n = 0; n < INTERP_NMCODES; n++) {
		if (table[n].sync)
			return true;
	}
	return false;
}

/* On the bus of the drives, the node must not be that of a drive. */
static int check_node(const struct machine_config *c, struct interp_diag *d)
{
	bool taken = c->plc.node == c->can402.master_node;

	for (int i = 0; i < INTERP_NAXES; i++)
		taken = taken || c->plc.node == c->can402.node[i];
	if (!taken || !config_machine_is(c, MACHINE_DRIVES) ||
	    strcmp(c->plc.interface, c->can402.interface) != 0)
		return 0;
	return interp_diag_say(d, "plc.node %g is a node of [can402] on %s; a "
			       "node of its own, or an interface of its own",
			       c->plc.node, c->plc.interface);
}

int config_check_plc(const struct machine_config *c,
		     const struct config_lines *lines,
		     struct interp_diag *diag)
{
	struct interp_mcode table[INTERP_NMCODES];
	size_t i;

	diag->column = 0;
	if (read_lists(&c->plc, table, &i, diag)) {
		diag->line = line_of(lines, lists[i].key);
		return -EINVAL;
	}
	diag->line = line_of(lines, "interface");
	if (!config_has_plc(c) && has_mcodes(table) &&
	    !config_machine_is(c, MACHINE_NO_WIRES))
		return refuse(diag, &lists[0], "M codes and no PLC",
			      "plc.interface, as in can1, or no M codes");
	diag->line = line_of(lines, "node");
	return config_has_plc(c) ? check_node(c, diag) : 0;
}
