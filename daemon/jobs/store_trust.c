/* SPDX-License-Identifier: Apache-2.0 */
/* store_trust.c - keys, and commands that were handed over, in the store */
#include "store_sql.h"
#include "store_trust.h"

#include "jobs_log.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

/* A command that is older than this is not repeated by anybody. */
#define ACT_OLD_US	(3600 * INT64_C(1000000))

/* -- Acts ----------------------------------------------------------------- */

int store_act_find(struct store *s, uint64_t id, struct store_act *ret)
{
	const unsigned char *reason;
	sqlite3_stmt *q;
	int err;

	q = store_ask(s, &err, "SELECT instance, born, code, reason FROM act "
		      "WHERE id=?", "i", (int64_t)id);
	if (!q)
		return err;
	ret->instance = (uint32_t)sqlite3_column_int64(q, 0);
	ret->born = (uint64_t)sqlite3_column_int64(q, 1);
	ret->answered = sqlite3_column_type(q, 2) != SQLITE_NULL;
	ret->code = sqlite3_column_int(q, 2);
	reason = sqlite3_column_text(q, 3);
	snprintf(ret->reason, sizeof(ret->reason), "%s",
		 reason ? (const char *)reason : "");
	sqlite3_finalize(q);
	return 0;
}

int store_act_begin(struct store *s, const struct store_act *a)
{
	if (a->id % 256 == 0)
		store_do(s, STORE_MAY_GO, "DELETE FROM act WHERE begun_us<?",
			 "i", a->now_us - ACT_OLD_US);
	return store_do(s, STORE_MAY_GO, "INSERT INTO act(id, instance, born, "
			"verb, by, begun_us) VALUES(?, ?, ?, ?, ?, ?)",
			"iiissi", (int64_t)a->id, (int64_t)a->instance,
			(int64_t)a->born, a->verb, a->by, a->now_us);
}

int store_act_end(struct store *s, uint64_t id, int code, const char *reason)
{
	return store_do(s, STORE_MAY_GO, "UPDATE act SET code=?, reason=? "
			"WHERE id=?", "isI", (int64_t)code,
			reason ? reason : "", (int64_t)id);
}

/* -- Keys ----------------------------------------------------------------- */

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
	struct trust_key k;
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT public, name, role FROM "
				    "key ORDER BY added_us", "");

	for (int rc = SQLITE_ROW; q && rc == SQLITE_ROW; rc = sqlite3_step(q))
		if (!key_get(q, &k) || trust_add(t, &k) < 0)
			log_warning("trust: a key in the store is damaged "
				    "and is left out; edmctl keys list "
				    "shows the others");
	sqlite3_finalize(q);
	return err == -ENOENT ? 0 : err;
}

int store_key_add(struct store *s, const struct trust_key *k, int64_t now_us)
{
	char hex[KEYFILE_HEX];

	keyfile_hex(hex, k->key);
	return store_do(s, STORE_MUST, "INSERT INTO key VALUES(?, ?, ?, ?)",
			"sssi", hex, k->name, trust_role_name(k->role), now_us);
}

int store_key_remove(struct store *s, const char *name)
{
	return store_do(s, STORE_MUST, "DELETE FROM key WHERE name=?", "s",
			name);
}
