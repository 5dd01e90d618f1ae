/* SPDX-License-Identifier: Apache-2.0 */
/*
 * check_unused.c - keys of [generator] that its interface does not have
 *
 * What nobody would read must not look as if somebody did.
 */
#include "keys.h"

#include <errno.h>
#include <string.h>

#define ON(interface)	(1u << GENERATOR_##interface)
#define TELLS		(ON(CAN) | ON(MODBUS) | ON(PLC))
#define WAITS		(TELLS | ON(LINES) | ON(NONE))

static const struct {
	const char *key;
	unsigned int interfaces;
	const char *of;
} use[] = {
	{ "can_interface", ON(CAN), "can" },
	{ "can_id", ON(CAN), "can" },
	{ "modbus", ON(MODBUS), "modbus" },
	{ "modbus_unit", ON(MODBUS), "modbus" },
	{ "modbus_baud", ON(MODBUS), "modbus" },
	{ "modbus_parity", ON(MODBUS), "modbus" },
	{ "modbus_timeout_ms", ON(MODBUS), "modbus" },
	{ "modbus_every_ms", ON(MODBUS), "modbus" },
	{ "settle_ms", WAITS, "none, lines, can, modbus or plc" },
	{ "polarity_ms", WAITS, "none, lines, can, modbus or plc" },
	{ "silent_ms", TELLS, "can, modbus or plc" },
	{ "fault_words", TELLS, "can, modbus or plc" },
	{ "confirm_s", TELLS | ON(LINES), "lines, can, modbus or plc" },
};

/* Said in the file, and not just as it is anyway. */
static bool is_said(const struct machine_config *c,
		    const struct config_lines *lines, int row)
{
	const struct config_key *k = config_key(row);
	char text[CONFIG_TEXT_MAX];

	return lines->at[row][0] &&
	       strcmp(config_key_format(k, 0, c, text, sizeof(text)),
		      config_key_default(k, 0)) != 0;
}

static int refuse(const struct config_lines *lines, int row, const char *with,
		  const char *of, struct interp_diag *diag)
{
	diag->line = lines->at[row][0];
	diag->column = 0;
	return interp_diag_say(diag, "generator.%s with %s, which does not "
			       "use it; without it, or %s",
			       config_key(row)->name, with, of);
}

/* Over TCP there is no line that has a speed. */
static int check_tcp(const struct machine_config *c,
		     const struct config_lines *lines, int row,
		     struct interp_diag *diag)
{
	const char *name = config_key(row)->name;
	struct config_modbus_at at;

	if (strcmp(name, "modbus_baud") != 0 &&
	    strcmp(name, "modbus_parity") != 0)
		return 0;
	if (config_modbus_read(c->generator.modbus, &at) || at.serial)
		return 0;
	return refuse(lines, row, c->generator.modbus,
		      "modbus = a serial port", diag);
}

int config_check_unused(const struct machine_config *c,
			const struct config_lines *lines,
			struct interp_diag *diag)
{
	const int interface = config_generator_interface(c);
	char with[32], of[48];

	for (size_t i = 0; i < sizeof(use) / sizeof(use[0]); i++) {
		const int row = config_key_find(SECTION_GENERATOR, use[i].key);

		if (!is_said(c, lines, row))
			continue;
		if (use[i].interfaces >> interface & 1) {
			if (check_tcp(c, lines, row, diag))
				return -EINVAL;
			continue;
		}
		snprintf(with, sizeof(with), "interface %s",
			 config_interface_word(interface));
		snprintf(of, sizeof(of), "interface = %s", use[i].of);
		return refuse(lines, row, with, of, diag);
	}
	return 0;
}
