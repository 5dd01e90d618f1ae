/* SPDX-License-Identifier: Apache-2.0 */
/*
 * backends.h - the machines that edmd can run: one row for each
 *
 * A new backend is a file of daemon/io with its open function, and a row here.
 *
 * Threads: any; plain data.
 */
#ifndef CONFIG_BACKENDS_H
#define CONFIG_BACKENDS_H

#include <stdbool.h>
#include <stdint.h>

/*
 * BACKEND_<id>, the word in a machine file, the function that opens it, the
 * period unless the file gives one, what it is (enum config_machine_is),
 * whether it has a gap, what of the file is checked for it alone, how many
 * points it makes in a second.
 *
 * A pulse of gpio is made of periods.  Six drives on a bus fit into 2 ms.
 */
#define CONFIG_BACKENDS(ROW) \
	ROW(SIM, "sim", io_sim_open, 1000000, \
	    MACHINE_NO_WIRES | MACHINE_MODEL | MACHINE_SWITCHES | \
	    MACHINE_INDEX | MACHINE_OWN_PLACE, \
	    backend_has_gap, NULL, NULL) \
	ROW(NULL, "null", io_null_open, 1000000, \
	    MACHINE_NO_WIRES | MACHINE_NONE, \
	    backend_has_no_gap, NULL, NULL) \
	ROW(GPIO, "gpio", io_gpio_open, 50000, MACHINE_SWITCHES, \
	    config_gpio_has_gap, config_check_gpio, config_gpio_points_s) \
	ROW(CAN402, "can402", io_can402_open, 2000000, \
	    MACHINE_DRIVES | MACHINE_OWN_PLACE | MACHINE_HOMES | \
	    MACHINE_SWITCHES | MACHINE_INDEX, \
	    backend_can402_has_gap, config_check_can402, NULL)

#define CONFIG_BACKEND_ID(id, name, open, period_ns, is, has_gap, check, \
			  points_s) \
	BACKEND_##id,

enum config_backend_id {
	CONFIG_BACKENDS(CONFIG_BACKEND_ID)
	CONFIG_NBACKENDS
};

enum config_machine_is {
	MACHINE_NO_WIRES = 1,		/* nothing outside is needed */
	MACHINE_MODEL = 2,		/* [sim]: a model of gap and axes
					 * answers, in a time of its own */
	MACHINE_DRIVES = 4,		/* drives on a bus: they are sent
					 * places, and follow with a lag */
	MACHINE_NONE = 8,		/* every place is reached at once */
	MACHINE_SWITCHES = 16,		/* home and limit switches are read */
	MACHINE_INDEX = 32,		/* index marks are read */
	MACHINE_OWN_PLACE = 64,		/* a drive may tell a place of its
					 * own: io_inputs.own */
	MACHINE_HOMES = 128,		/* a drive finds its zero by itself */
};

struct machine_config;
struct config_lines;
struct interp_diag;

struct config_backend {
	const char *name;
	int64_t period_ns;
	uint32_t is;			/* set of enum config_machine_is */
	bool (*has_gap)(const struct machine_config *c);
	/* As config_check(); NULL: nothing to check. */
	int (*check)(const struct machine_config *c,
		     const struct config_lines *lines,
		     struct interp_diag *diag);
	/* NULL: as many as the cycle. */
	double (*points_s)(const struct machine_config *c);
};

/** config_backend() - the row of the backend that @c names. */
const struct config_backend *config_backend(const struct machine_config *c);

/** config_machine_is() - whether the backend that @c names is @what. */
bool config_machine_is(const struct machine_config *c,
		       enum config_machine_is what);

/** config_backend_name() - of row @i; NULL past the last. */
const char *config_backend_name(int i);

#endif /* CONFIG_BACKENDS_H */
