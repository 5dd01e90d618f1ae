/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_count.c - how many jobs wait, what they will take, and how many have
 * ended
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

#define TOLD(ROW)	"(" WAITS(ROW) " AND coalesce(" ROW ".forecast_s," \
			" -1) >= 0)"
/* Whole numbers: their sum comes back to 0. */
#define TAKES_MS(ROW)	"iif(" TOLD(ROW) ", CAST(" ROW ".forecast_s * 1e3 AS " \
			"INTEGER), 0)"

static const char count[] =
	"PRAGMA temp_store=MEMORY;"
	"CREATE TEMP TABLE job_count(waiting INTEGER, ended INTEGER, "
	"told INTEGER, ms INTEGER);"
	"INSERT INTO job_count SELECT "
	"(SELECT count(*) FROM job WHERE " WAITS("job") "),"
	"(SELECT count(*) FROM job WHERE " ENDED("job") "),"
	"(SELECT count(*) FROM job WHERE " TOLD("job") "),"
	"(SELECT coalesce(sum(" TAKES_MS("job") "), 0) FROM job);"
	"CREATE TEMP TRIGGER job_count_in AFTER INSERT ON main.job BEGIN"
	" UPDATE job_count SET waiting=waiting+" WAITS("new") ","
	" ended=ended+" ENDED("new") "; END;"
	"CREATE TEMP TRIGGER job_count_out AFTER DELETE ON main.job BEGIN"
	" UPDATE job_count SET waiting=waiting-" WAITS("old") ","
	" ended=ended-" ENDED("old") ", told=told-" TOLD("old") ","
	" ms=ms-" TAKES_MS("old") "; END;"
	"CREATE TEMP TRIGGER job_count_on AFTER UPDATE OF state, loaded, "
	"forecast_s ON main.job BEGIN"
	" UPDATE job_count SET waiting=waiting+" WAITS("new") "-" WAITS("old")
	", ended=ended+" ENDED("new") "-" ENDED("old")
	", told=told+" TOLD("new") "-" TOLD("old")
	", ms=ms+" TAKES_MS("new") "-" TAKES_MS("old") "; END;";

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

double store_waiting_s(struct store *s, uint32_t *ret_untold)
{
	*ret_untold = (uint32_t)store_number_of(s, 0, "SELECT waiting - told "
						"FROM job_count", "");
	return (double)store_number_of(s, 0, "SELECT ms FROM job_count", "") /
	       1e3;
}
