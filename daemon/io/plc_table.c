/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_table.c - the rows of plc_signals.h as the cycle reads them
 */
#include "plc.h"

#define AT_TELL(field)	false, offsetof(struct plc_tell, field)
#define AT_ASK(field)	true, offsetof(struct plc_ask, field)

#define SIGNAL(index, sub, type, by, field, pdo, byte, min, max, name, ...) \
	{ index, sub, PLC_##type, pdo, byte, AT_##by(field), min, max, name },

const struct plc_signal plc_signal[] = {
	PLC_SIGNAL_ROWS(SIGNAL)
};

const size_t plc_nsignals = sizeof(plc_signal) / sizeof(plc_signal[0]);

#define OBJECT(index, sub, type, value, live, name) \
	{ index, sub, PLC_##type, value, PLC_##live },

const struct plc_constant plc_constant[] = {
	PLC_OBJECT_ROWS(OBJECT)
};

const size_t plc_nconstants = sizeof(plc_constant) / sizeof(plc_constant[0]);
