/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ledger.h - what a fleet did, in one SQLite file or in memory
 *
 * docs/fleet.md has the tables.  A report or an alarm that is there already is
 * not put in again, but for a job that ended again, later.  So whoever comes
 * late, or again, may put in all it hears.  What ledger_end() returned 0 for is
 * on the disk; otherwise nothing of it is, and it is to be put in again.
 *
 * Threads: one.
 */
#ifndef DDS_LEDGER_H
#define DDS_LEDGER_H

#include "edm.h"
#include "hall.h"

#include <stdbool.h>
#include <stdio.h>

struct ledger;

/**
 * ledger_open() - @path: lent; NULL is in memory.  @write: make it if it is not
 * there, also when it is moved or removed later, and keep a second one out that
 * writes.
 *
 * Return: 0; -EALREADY: another program writes it; -EPROTO: of a newer release;
 * else -errno.  @why: in words.
 */
int ledger_open(struct ledger **ret, const char *path, bool write,
		const char **why);
void ledger_close(struct ledger *l);

/** ledger_report(), ledger_alarm() - Return: 0 or -errno. */
int ledger_report(struct ledger *l, const edm_JobReport *m);
int ledger_alarm(struct ledger *l, const edm_Alarm *m);

/** ledger_spend() - the machine has been so for @s; it waits in memory. */
void ledger_spend(struct ledger *l, const struct hall_machine *r, double s);

/**
 * ledger_begin(), ledger_end() - around what is put in; with it goes what was
 * spent.  @err: what went wrong between, or 0.
 *
 * Return: 0, or -errno: nothing of it is there.
 */
int ledger_begin(struct ledger *l);
int ledger_end(struct ledger *l, int err);

/** ledger_why() - what went wrong last, in words. */
const char *ledger_why(const struct ledger *l);

/** ledger_print() - @days: of today and so many days before; @json: one object
 *  on one line, else a table.  Return: rows, or -errno. */
int ledger_print_report(struct ledger *l, int days, bool json, FILE *f);
int ledger_print_alarms(struct ledger *l, int days, bool json, FILE *f);

#endif /* DDS_LEDGER_H */
