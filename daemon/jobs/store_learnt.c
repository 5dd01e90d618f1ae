/* SPDX-License-Identifier: Apache-2.0 */
/* store_learnt.c - what jobs took to cut, of what was forecast */
#include "store_learnt.h"

#include "store_sql.h"

int store_learnt_add(struct store *s, const struct store_learnt *l,
		     double passed_s, double expected_s)
{
	return store_do(s, STORE_KEEP, "INSERT INTO learnt(condition, "
			"electrode, work, passed_s, expected_s, jobs) "
			"VALUES(?, ?, ?, ?, ?, 1) "
			"ON CONFLICT(condition, electrode, work) DO UPDATE SET "
			"passed_s=excluded.passed_s + passed_s / 2, "
			"expected_s=excluded.expected_s + expected_s / 2, "
			"jobs=jobs + 1",
			"sssdd", l->condition, l->electrode, l->work, passed_s,
			expected_s);
}

double store_learnt_factor(struct store *s, const struct store_learnt *l)
{
	double factor = 0;
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT passed_s / expected_s "
				    "FROM learnt WHERE condition=? AND "
				    "electrode=? AND work=?", "sss",
				    l->condition, l->electrode, l->work);

	if (q)
		factor = sqlite3_column_double(q, 0);
	sqlite3_finalize(q);
	return factor;
}
