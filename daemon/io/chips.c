/* SPDX-License-Identifier: Apache-2.0 */
/*
 * chips.c - GPIO chips and lines as a machine file names them, or why not
 */
#include "chips.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

int lines_chip_refuse(struct interp_diag *diag, int err, const char *key,
		      const char *name)
{
	interp_diag_say(diag, err == -EACCES || err == -EPERM ?
			"%s: chip %s: %s; a user of group gpio: usermod -aG "
			"gpio USER, and 60-edmd.rules in /usr/lib/udev/rules.d" :
			"%s: chip %s: %s; [gpio] chip = a name or label that "
			"gpiodetect lists", key, name, strerror(-err));
	return err;
}

/*
 * Find a chip by its label, for boards that number their chips anew at each
 * start.  If a chip may not be opened, it may be the one that is looked for.
 */
static int chip_by_label(struct lines_chip **ret, const char *label)
{
	char path[32], has[64];
	int err = -ENOENT;

	for (int i = 0; i < 64; i++) {
		int e;

		snprintf(path, sizeof(path), "/dev/gpiochip%d", i);
		e = lines_chip_open(ret, path);
		if (e == -EACCES || e == -EPERM)
			err = e;
		if (e < 0)
			continue;
		lines_chip_label(*ret, has, sizeof(has));
		if (strcmp(has, label) == 0)
			return 0;
		lines_chip_close(*ret);
	}
	return err;
}

int lines_chip_named(struct lines_chip **ret, const char *name)
{
	char path[96];
	int err;

	snprintf(path, sizeof(path), "%s%s", *name == '/' ? "" : "/dev/", name);
	err = lines_chip_open(ret, path);
	return err == -ENOENT && *name != '/' ? chip_by_label(ret, name) : err;
}

int lines_chip_offers(struct lines_chip *chip, const char *name,
		      const struct lines_use *use, struct interp_diag *diag)
{
	const unsigned int n = lines_chip_count(chip);
	char user[32];

	if (use->offset >= n) {
		interp_diag_say(diag, "%s: line %u of %s, which has %u; 0 to "
				"%u; gpioinfo %s", use->key, use->offset, name,
				n, n - 1, name);
		return -ERANGE;
	}
	if (lines_chip_user(chip, use->offset, user, sizeof(user))) {
		interp_diag_say(diag, "%s: line %u of %s is in use by %s; a "
				"free line; gpioinfo %s lists them; or end %s",
				use->key, use->offset, name, user, name, user);
		return -EBUSY;
	}
	return 0;
}
