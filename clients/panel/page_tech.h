/* SPDX-License-Identifier: Apache-2.0 */
/*
 * page_tech.h - the machine's technology table, for the page that shows it
 *
 * Threads: any.
 */
#ifndef PANEL_PAGE_TECH_H
#define PANEL_PAGE_TECH_H

struct machine_config;

/**
 * page_tech_put() - print the table as JSON on standard output.
 *
 * Return: the exit code.
 */
int page_tech_put(const struct machine_config *c);

#endif /* PANEL_PAGE_TECH_H */
