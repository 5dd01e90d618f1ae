/* SPDX-License-Identifier: Apache-2.0 */
/* store_work.c - origins that an operator touched off */
#include "store_work.h"

#include "store_sql.h"

#include <errno.h>
#include <stdio.h>

/* One statement: a failure or a kill leaves all of them as they were. */
int store_work_put(struct store *s, int work, uint32_t rows,
		   const double value[WORK_NROWS])
{
	char list[WORK_NROWS * 40 + 2] = "[";
	size_t n = 1;

	for (int i = 0; i < WORK_NROWS; i++)
		if (rows >> i & 1)
			n += (size_t)snprintf(list + n, sizeof(list) - n,
					      "%s[%d,%.17g]", n > 1 ? "," : "",
					      i, value[i]);
	snprintf(list + n, sizeof(list) - n, "]");
	return store_do(s, STORE_MUST, "INSERT OR REPLACE INTO work(job, work, "
			"axis, mm) SELECT 0, ?, json_extract(value, '$[0]'), "
			"json_extract(value, '$[1]') FROM json_each(?)", "is",
			(int64_t)work, list);
}

int store_work_clear(struct store *s, int work)
{
	return store_do(s, STORE_MUST, "DELETE FROM work WHERE job=0 AND "
			"work=?", "i", (int64_t)work);
}

int store_work_read(struct store *s, uint32_t n,
		    double mm[INTERP_NC_NWORK][WORK_NROWS],
		    uint32_t ret_set[INTERP_NC_NWORK])
{
	int err = 0, rc = SQLITE_ROW;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT work, axis, mm FROM work "
				    "WHERE job=?", "i", (int64_t)n);

	for (int i = 0; ret_set && i < INTERP_NC_NWORK; i++)
		ret_set[i] = 0;
	if (!q)
		return err == -ENOENT ? 0 : -EIO;
	for (; rc == SQLITE_ROW; rc = sqlite3_step(q)) {
		const int work = sqlite3_column_int(q, 0);
		const int axis = sqlite3_column_int(q, 1);

		if (work < 0 || work >= INTERP_NC_NWORK || axis < 0 ||
		    axis >= WORK_NROWS)
			continue;
		mm[work][axis] = sqlite3_column_double(q, 2);
		if (ret_set)
			ret_set[work] |= 1u << axis;
	}
	sqlite3_finalize(q);
	return rc == SQLITE_DONE ? 0 : -EIO;
}

int store_work_keep(struct store *s, uint32_t n)
{
	int err = store_do(s, STORE_MUST, "DELETE FROM work WHERE job=?", "i",
			   (int64_t)n);

	if (err == 0)
		err = store_do(s, STORE_MUST, "INSERT INTO work(job, work, "
			       "axis, mm) SELECT ?, work, axis, mm FROM work "
			       "WHERE job=0", "i", (int64_t)n);
	return err;
}
