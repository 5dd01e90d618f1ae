/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_count.c - how many jobs wait, and how many have ended
 *
 * To count rows takes the longer the more there are, also by an index.  So the
 * connection counts along, by triggers of its own: what is rolled back is not
 * counted, and nothing of it is on the disk.
 */
#include "store_sql.h"

#define WAITS(ROW)	"(" ROW ".state='queued' AND " ROW ".loaded=0)"
/* For a trigger that is cheaper than a list of STORE_ENDED. */
#define ENDED(ROW)	"(" ROW ".state='done' OR " ROW ".state='stopped' OR " \
			ROW ".state='fault')"

static const char count[] =
	"PRAGMA temp_store=MEMORY;"
	"CREATE TEMP TABLE job_count(waiting INTEGER, ended INTEGER);"
	"INSERT INTO job_count SELECT "
	"(SELECT count(*) FROM job WHERE " WAITS("job") "),"
	"(SELECT count(*) FROM job WHERE " ENDED("job") ");"
	"CREATE TEMP TRIGGER job_count_in AFTER INSERT ON main.job BEGIN"
	" UPDATE job_count SET waiting=waiting+" WAITS("new") ","
	" ended=ended+" ENDED("new") "; END;"
	"CREATE TEMP TRIGGER job_count_out AFTER DELETE ON main.job BEGIN"
	" UPDATE job_count SET waiting=waiting-" WAITS("old") ","
	" ended=ended-" ENDED("old") "; END;"
	"CREATE TEMP TRIGGER job_count_on AFTER UPDATE OF state, loaded ON "
	"main.job BEGIN"
	" UPDATE job_count SET waiting=waiting+" WAITS("new") "-" WAITS("old")
	", ended=ended+" ENDED("new") "-" ENDED("old") "; END;";

int store_count_begin(sqlite3 *db)
{
	const int rc = sqlite3_exec(db, count, NULL, NULL, NULL);

	return rc == SQLITE_OK ? 0 : store_file_errno(db, rc);
}

uint32_t store_waiting(struct store *s)
{
	return (uint32_t)store_number_of(s, 0, "SELECT waiting FROM job_count",
					 "");
}
