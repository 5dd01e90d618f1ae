/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mouth.c - from where the machine stands to the mouth of a way in
 */
#include "mouth.h"

#include "check.h"

#include <errno.h>
#include <string.h>

static bool is_free(const struct job *j, const struct clearance *c,
		    const double *from, const double *to)
{
	struct near_pair pair = { 0 };

	return check_block(j, from, to, c, &pair);
}

bool mouth_find(const struct job *j, const struct clearance *c,
		  const double mouth[INTERP_NAXES], struct mouth_lead *ret)
{
	memcpy(ret->q[0], j->config.start_mm, sizeof(ret->q[0]));
	memcpy(ret->q[1], mouth, sizeof(ret->q[1]));
	memcpy(ret->q[2], mouth, sizeof(ret->q[2]));
	if (is_free(j, c, ret->q[0], mouth))
		return true;
	ret->q[1][INTERP_Z] = ret->q[0][INTERP_Z];
	return is_free(j, c, ret->q[0], ret->q[1]) &&
	       is_free(j, c, ret->q[1], mouth);
}

int mouth_put(const struct mouth_lead *in, struct route *w)
{
	for (uint32_t i = 0; i < MOUTH_NODES; i++) {
		struct route_node n = { .rapid = true };

		memcpy(n.q, in->q[i], sizeof(n.q));
		if (w->n > i)
			memcpy(w->node[i].q, n.q, sizeof(n.q));
		else if (route_add(w, &n))
			return -ENOMEM;
	}
	return 0;
}
