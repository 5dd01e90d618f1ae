/* SPDX-License-Identifier: Apache-2.0 */
/* store_turn.c - the order of the queue */
#include "store_turn.h"
#include "store_sql.h"

static int set_turn(struct store *s, uint32_t n, int64_t turn)
{
	const int err = store_do(s, STORE_KEEP, "UPDATE job SET turn=? WHERE "
				 "n=?", "iI", turn, (int64_t)n);

	return err < 0 ? err : 0;
}

/* By the index of the order, which has those that were interrupted, too. */
#define NEIGHBOUR(THAN, ORDER) \
	"SELECT n, " STORE_TURN ", (SELECT " STORE_TURN " FROM job WHERE n=?1) " \
	"FROM job INDEXED BY job_by_turn WHERE state IN ('queued', " \
	"'interrupted') AND +state='queued' AND loaded=0 AND " STORE_IN_QUEUE \
	THAN "(SELECT " STORE_IN_QUEUE " FROM job WHERE n=?1) " \
	"ORDER BY " STORE_IN_QUEUE ORDER " LIMIT 1"

int store_move(struct store *s, uint32_t n, bool ahead)
{
	int64_t theirs, mine;
	uint32_t other;
	int err;
	sqlite3_stmt *q = ahead ?
		store_ask(s, &err, NEIGHBOUR(" < ", " DESC"), "i", (int64_t)n) :
		store_ask(s, &err, NEIGHBOUR(" > ", ""), "i", (int64_t)n);

	if (!q)
		return err;
	other = (uint32_t)sqlite3_column_int64(q, 0);
	theirs = sqlite3_column_int64(q, 1);
	mine = sqlite3_column_int64(q, 2);
	sqlite3_finalize(q);
	err = set_turn(s, n, theirs);
	return err ? err : set_turn(s, other, mine);
}

/* Who is passed gets the turn of the next one, and it that of the last. */
#define MOVE_ALL(ORDER) \
	"UPDATE job SET turn=t FROM (SELECT n AS m, CASE WHEN n=?1 THEN " \
	"last_value(own) OVER w ELSE lag(own) OVER w END AS t FROM (" \
	"SELECT n, " STORE_TURN " AS own FROM job INDEXED BY job_by_turn " \
	"WHERE state IN ('queued', 'interrupted') AND +state='queued' AND " \
	"loaded=0) " \
	"WHERE own*" ORDER " >= (SELECT " STORE_TURN " FROM job WHERE n=?1)*" \
	ORDER " WINDOW w AS (ORDER BY own*" ORDER " ROWS BETWEEN UNBOUNDED " \
	"PRECEDING AND UNBOUNDED FOLLOWING)) WHERE n=m"

int store_move_all(struct store *s, uint32_t n, bool ahead)
{
	const int err = ahead ?
		store_do(s, STORE_KEEP, MOVE_ALL("-1"), "I", (int64_t)n) :
		store_do(s, STORE_KEEP, MOVE_ALL("1"), "I", (int64_t)n);

	return err < 0 ? err : 0;
}
