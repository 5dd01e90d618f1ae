/* SPDX-License-Identifier: Apache-2.0 */
/*
 * passes.h - what the two halves of G150 G151 G152 share
 *
 * passes.c has the words, and reads contours onto tapes.  passes_cut.c makes
 * cuts of the tapes.
 */
#ifndef CODE_PASSES_H
#define CODE_PASSES_H

#include "code/reader.h"
#include "wire/replay.h"

/**
 * nc_cut_passes() - cut all passes of the contours of @tape, one for each
 * cavity.  Return: 0, -ENOMEM, or -EINVAL with r->diag.
 */
int nc_cut_passes(struct nc_reader *r, const struct contour_tape *tape);

#endif /* CODE_PASSES_H */
