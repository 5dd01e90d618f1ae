/* SPDX-License-Identifier: Apache-2.0 */
/* stands.c - the table of stands */
#include "stands.h"

#define STAND_ROW(id, ...)	[STAND_##id] = { __VA_ARGS__ },

const struct stand_row stand_table[STAND_NREASONS] = {
	STAND_ROWS(STAND_ROW)
};

const struct stand_row *stand_row(uint32_t reason)
{
	return &stand_table[reason < STAND_NREASONS ? reason : STAND_NONE];
}
