/* SPDX-License-Identifier: Apache-2.0 */
#include "pullout.h"
int pullout_way(struct plan *p) { (void)p; return 70; }
