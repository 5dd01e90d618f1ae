/* SPDX-License-Identifier: Apache-2.0 */
/*
 * setting_text.h - reads the settings that a job brings
 *
 * Threads: any.
 */
#ifndef INTERP_SETTING_TEXT_H
#define INTERP_SETTING_TEXT_H

#include "interp/diag.h"
#include "interp/setting.h"
#include "interp/wire.h"

/**
 * interp_setting_read() - words as "taper=3 turn=90" into @s and into the
 * heights of @w; what no word names stays as it is.
 *
 * Return: 0, or -EINVAL with @diag filled.
 */
int interp_setting_read(const char *text, struct interp_setting *s,
			struct interp_wire *w, struct interp_diag *diag);

#endif /* INTERP_SETTING_TEXT_H */
