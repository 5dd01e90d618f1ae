/* SPDX-License-Identifier: Apache-2.0 */
/* parse.c - a chain of joints as the machine file writes it */
#include "interp/kinematics.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXAMPLE	"axes from work to tool, as in C(0 0 -120) A(0 15 -80) X Y Z"

struct text {
	const char *at, *begin;
	struct interp_diag *diag;
};

static int refuse_here(const struct text *t, const char *wanted)
{
	snprintf(t->diag->wanted, sizeof(t->diag->wanted), "%s", wanted);
	if (*t->at)
		snprintf(t->diag->found, sizeof(t->diag->found),
			 "%.20s at character %d of the chain", t->at,
			 (int)(t->at - t->begin) + 1);
	else
		snprintf(t->diag->found, sizeof(t->diag->found),
			 "the chain's end");
	return -EINVAL;
}

static void skip(struct text *t)
{
	t->at += strspn(t->at, " \t,");
}

static int three(struct text *t, double ret[3])
{
	for (int i = 0; i < 3; i++) {
		char *end;

		skip(t);
		ret[i] = strtod(t->at, &end);
		if (end == t->at)
			return refuse_here(t, "three numbers, as in 0 15 -80");
		t->at = end;
	}
	skip(t);
	return 0;
}

static int brackets(struct text *t, struct interp_kin_joint *j)
{
	int err;

	t->at++;
	err = three(t, j->at_mm);
	if (!err && *t->at == '/') {
		t->at++;
		err = three(t, j->dir);
	}
	if (err)
		return err;
	if (*t->at != ')')
		return refuse_here(t, "a ) behind the numbers");
	t->at++;
	return 0;
}

static int joint(struct text *t, struct interp_kin_joint *j)
{
	const char *letter = strchr(INTERP_AXIS_LETTERS, *t->at);

	if (!letter)
		return refuse_here(t, EXAMPLE);
	*j = (struct interp_kin_joint) {
		.axis = (enum interp_axis)(letter - INTERP_AXIS_LETTERS)
	};
	/* X A U are along or about X, Y B V along or about Y, Z C along or
	 * about Z. */
	j->dir[j->axis < INTERP_U ? j->axis % 3 : j->axis - INTERP_U] = 1;
	t->at++;
	skip(t);
	return *t->at == '(' ? brackets(t, j) : 0;
}

int interp_kin_parse(struct interp_kinematics *k, const char *chain,
		     struct interp_diag *diag)
{
	struct text t = { chain, chain, diag };

	k->njoints = 0;
	for (skip(&t); *t.at; skip(&t)) {
		int err;

		if (k->njoints == INTERP_NAXES)
			return refuse_here(&t, "at most 8 axes");
		err = joint(&t, &k->joint[k->njoints]);
		if (err)
			return err;
		k->njoints++;
	}
	return interp_kin_prepare(k, diag);
}
