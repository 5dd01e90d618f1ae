/* SPDX-License-Identifier: Apache-2.0 */
/* setting.c - the words for what is set at the machine */
#include "interp/setting.h"

#include <stddef.h>

const char *interp_set_name(int i)
{
	static const char *const names[INTERP_NSETS] = {
		"taper", "wire-offset", "scale", "turn", "mirror", "plane",
		"second-plane"
	};

	return i >= 0 && i < INTERP_NSETS ? names[i] : NULL;
}

const char *interp_mirror_name(int i)
{
	static const char *const names[INTERP_NMIRRORS] = {
		"none", "x", "y", "exchange"
	};

	return i >= 0 && i < INTERP_NMIRRORS ? names[i] : NULL;
}
