/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_trust.c - keys, and commands handed over, in the store
 */
#include "store_trust.h"

#include "jobs_log.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

static const char tables[] =
	"CREATE TABLE IF NOT EXISTS key("
	" public TEXT PRIMARY KEY, name TEXT NOT NULL UNIQUE,"
	" role TEXT NOT NULL, added_us INTEGER NOT NULL);"
	"CREATE TABLE IF NOT EXISTS act("
	" id INTEGER PRIMARY KEY, instance INTEGER NOT NULL,"
	" born INTEGER NOT NULL, verb TEXT NOT NULL, by TEXT NOT NULL,"
	" begun_us INTEGER NOT NULL, code INTEGER, reason TEXT);";

/* Nobody repeats a command as old as this. */
#define ACT_OLD_US	(3600 * INT64_C(1000000))

static int complain(struct store *s)
{
	log_error("store: %s", sqlite3_errmsg(store_db(s)));
	return -EIO;
}

static sqlite3_stmt *prepare(struct store *s, const char *sql)
{
	sqlite3_stmt *q = NULL;

	if (sqlite3_prepare_v2(store_db(s), sql, -1, &q, NULL) != SQLITE_OK)
		complain(s);
	return q;
}

static void bind_text(sqlite3_stmt *q, int i, const char *text)
{
	sqlite3_bind_text(q, i, text, -1, SQLITE_TRANSIENT);
}

static int finish(struct store *s, sqlite3_stmt *q)
{
	int rc = sqlite3_step(q);

	sqlite3_finalize(q);
	return rc == SQLITE_DONE ? 0 : complain(s);
}

int store_trust_init(struct store *s)
{
	if (sqlite3_exec(store_db(s), tables, NULL, NULL, NULL) != SQLITE_OK)
		return complain(s);
	return 0;
}

/* -- Transactions ----------------------------------------------------------- */

static int execute(struct store *s, const char *sql)
{
	if (sqlite3_exec(store_db(s), sql, NULL, NULL, NULL) != SQLITE_OK)
		return complain(s);
	return 0;
}

int store_together(struct store *s, bool durable)
{
	int err = execute(s, durable ? "PRAGMA synchronous=FULL" :
				       "PRAGMA synchronous=NORMAL");

	return err ? err : execute(s, "BEGIN IMMEDIATE");
}

int store_commit(struct store *s)
{
	int err = execute(s, "COMMIT");

	if (err)
		execute(s, "ROLLBACK");
	execute(s, "PRAGMA synchronous=FULL");
	return err;
}

/* -- Acts ------------------------------------------------------------------- */

int store_act_find(struct store *s, uint64_t id, struct store_act *ret)
{
	sqlite3_stmt *q = prepare(s, "SELECT instance, born, code, reason "
				  "FROM act WHERE id=?");
	const unsigned char *reason;
	int err = -ENOENT;

	if (!q)
		return err;
	sqlite3_bind_int64(q, 1, (int64_t)id);
	if (sqlite3_step(q) == SQLITE_ROW) {
		ret->instance = (uint32_t)sqlite3_column_int64(q, 0);
		ret->born = (uint64_t)sqlite3_column_int64(q, 1);
		ret->answered = sqlite3_column_type(q, 2) != SQLITE_NULL;
		ret->code = sqlite3_column_int(q, 2);
		reason = sqlite3_column_text(q, 3);
		snprintf(ret->reason, sizeof(ret->reason), "%s",
			 reason ? (const char *)reason : "");
		err = 0;
	}
	sqlite3_finalize(q);
	return err;
}

static void acts_forget(struct store *s, int64_t before_us)
{
	sqlite3_stmt *q = prepare(s, "DELETE FROM act WHERE begun_us<?");

	if (!q)
		return;
	sqlite3_bind_int64(q, 1, before_us);
	finish(s, q);
}

int store_act_begin(struct store *s, const struct store_act *a)
{
	sqlite3_stmt *q = prepare(s, "INSERT INTO act(id, instance, born, "
				  "verb, by, begun_us) VALUES"
				  "(?, ?, ?, ?, ?, ?)");

	if (!q)
		return -EIO;
	if (a->id % 256 == 0)
		acts_forget(s, a->now_us - ACT_OLD_US);
	sqlite3_bind_int64(q, 1, (int64_t)a->id);
	sqlite3_bind_int64(q, 2, a->instance);
	sqlite3_bind_int64(q, 3, (int64_t)a->born);
	bind_text(q, 4, a->verb);
	bind_text(q, 5, a->by);
	sqlite3_bind_int64(q, 6, a->now_us);
	return finish(s, q);
}

int store_act_end(struct store *s, uint64_t id, int code, const char *reason)
{
	sqlite3_stmt *q = prepare(s, "UPDATE act SET code=?, reason=? WHERE "
				  "id=?");

	if (!q)
		return -EIO;
	sqlite3_bind_int(q, 1, code);
	bind_text(q, 2, reason ? reason : "");
	sqlite3_bind_int64(q, 3, (int64_t)id);
	return finish(s, q);
}

/* -- Keys ------------------------------------------------------------------- */

static bool key_get(sqlite3_stmt *q, struct trust_key *ret)
{
	const char *public = (const char *)sqlite3_column_text(q, 0);
	const char *name = (const char *)sqlite3_column_text(q, 1);
	const char *role = (const char *)sqlite3_column_text(q, 2);

	if (!public || !name || !role || !keyfile_name_fits(name) ||
	    !keyfile_unhex(ret->key, public))
		return false;
	snprintf(ret->name, sizeof(ret->name), "%s", name);
	ret->role = trust_role_of(role);
	return ret->role != ROLE_NONE;
}

int store_keys_load(struct store *s, struct trust *t)
{
	sqlite3_stmt *q = prepare(s, "SELECT public, name, role FROM key "
				  "ORDER BY added_us");
	struct trust_key k;

	if (!q)
		return -EIO;
	while (sqlite3_step(q) == SQLITE_ROW)
		if (!key_get(q, &k) || trust_add(t, &k) < 0)
			log_warning("trust: a key in the store is not fit and "
				    "left out; edmctl keys list shows the "
				    "others");
	sqlite3_finalize(q);
	return 0;
}

int store_key_add(struct store *s, const struct trust_key *k, int64_t now_us)
{
	sqlite3_stmt *q = prepare(s, "INSERT INTO key VALUES(?, ?, ?, ?)");
	char hex[KEYFILE_HEX];

	if (!q)
		return -EIO;
	keyfile_hex(hex, k->key);
	bind_text(q, 1, hex);
	bind_text(q, 2, k->name);
	bind_text(q, 3, trust_role_name(k->role));
	sqlite3_bind_int64(q, 4, now_us);
	return finish(s, q);
}

int store_key_remove(struct store *s, const char *name)
{
	sqlite3_stmt *q = prepare(s, "DELETE FROM key WHERE name=?");

	if (!q)
		return -EIO;
	bind_text(q, 1, name);
	return finish(s, q);
}
