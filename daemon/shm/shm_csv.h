/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shm_csv.h - the trace of a machine as CSV, which `edmctl` and `edm-limits`
 * read
 *
 * Threads: one.
 */
#ifndef EDM_SHM_CSV_H
#define EDM_SHM_CSV_H

#include "shm.h"

#include <stdio.h>

void shm_csv_head(FILE *f);

/** shm_csv_row() - @t_s: since the first row.  @pulse_mm: of each axis. */
void shm_csv_row(FILE *f, const struct shm_trace *t, double t_s,
		   const double pulse_mm[SHM_NAXES]);

#endif /* EDM_SHM_CSV_H */
