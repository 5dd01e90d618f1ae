/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tech.h - the machine's technology table, for the page that shows it
 *
 * Threads: any.
 */
#ifndef PANEL_TECH_H
#define PANEL_TECH_H

struct machine_config;

/** tech_put() - the table as JSON on standard output. Return: to exit with. */
int tech_put(const struct machine_config *c);

#endif /* PANEL_TECH_H */
