/* SPDX-License-Identifier: Apache-2.0 */
/*
 * table.h - machines as lines of text or as JSON
 *
 * In text from the network everything that is not printable ASCII is replaced,
 * so that a sample cannot control the terminal.
 *
 * Threads: any thread; nothing here has state.
 */
#ifndef DDS_TABLE_H
#define DDS_TABLE_H

#include "edm.h"

#include <stdio.h>

struct table_row {
	const edm_MachineState *m;
	bool gone;			/* its writer left, died or hangs */
	int64_t heard_ns;		/* CLOCK_REALTIME of its last sample */
};

/** table_sort() - by the machine's name. */
void table_sort(struct table_row *row, size_t n);

/** table_print() - a heading, and a line for each machine. */
void table_print(const struct table_row *row, size_t n, FILE *f);

/** table_print_json() - {"machines": [...]} on one line. */
void table_print_json(const struct table_row *row, size_t n, FILE *f);

#endif /* DDS_TABLE_H */
