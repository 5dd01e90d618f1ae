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

#include "hall.h"

#include <stdio.h>

/** table_print() - a heading, and a line for each machine. */
void table_print(const struct hall_machine *row, size_t n, FILE *f);

/** table_print_json() - {"machines": [...]} on one line. */
void table_print_json(const struct hall_machine *row, size_t n, FILE *f);

#endif /* DDS_TABLE_H */
