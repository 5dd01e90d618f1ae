/* SPDX-License-Identifier: Apache-2.0 */
/*
 * folder_help.h - an empty folder for each test, gone when the test ends
 */
#ifndef FOLDER_HELP_H
#define FOLDER_HELP_H

#include <stdio.h>
#include <stdlib.h>

static char folder[32];

/** folder_make() - for cmocka's set-up. */
static inline int folder_make(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/edmd-test.XXXXXX");
	return mkdtemp(folder) ? 0 : -1;
}

/** folder_remove() - for cmocka's teardown. */
static inline int folder_remove(void **state)
{
	char line[100];

	(void)state;
	snprintf(line, sizeof(line), "rm -rf %s", folder);
	return system(line);
}

#endif /* FOLDER_HELP_H */
