/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys.c - who may command the machine: list, add, remove
 *
 * A new key pair is made here, and only its public half is sent.
 */
#include "ctl.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static int list(struct ctl *c)
{
	struct talk_answer a;
	const char *name, *role, *public;
	json_t *rows, *row;
	size_t i;
	int err = ctl_ask(c, &(struct talk_question) { .verb = "keys" }, &a);

	if (err)
		return err;
	rows = json_loads(a.body, 0, NULL);
	if (c->json)
		printf("%s\n", a.body);
	else
		json_array_foreach(rows, i, row)
			if (json_unpack(row, "{s:s,s:s,s:s}", "name", &name,
					"role", &role, "public", &public) == 0)
				printf("%-31s %-8s %s\n", name, role, public);
	json_decref(rows);
	talk_answer_free(&a);
	return 0;
}

static int send(struct ctl *c, const char *verb, const char *text)
{
	struct talk_answer a;
	int err = ctl_ask(c, &(struct talk_question) {
		.verb = verb, .text = text,
	}, &a);

	if (err)
		return err;
	printf("%s: %s\n", c->value, a.reason);
	talk_answer_free(&a);
	return 0;
}

static int refuse_file(const char *path, int err)
{
	fprintf(stderr, "edmctl: %s: %s; the new key goes there\n", path,
		err == -EEXIST ? "is there already" : strerror(-err));
	return EX_CANTCREAT;
}

/* The file is written first.  A key that only the machine knows is useless; a
 * key that the machine does not know does no harm. */
static int add(struct ctl *c)
{
	struct keyfile k = { .machine = "" };
	char path[KEYFILE_NAME_MAX + 8], hex[KEYFILE_HEX], text[160];
	int err, rc;

	if (!c->talk)
		return ctl_unanswered(c, -ETIMEDOUT);
	snprintf(path, sizeof(path), "%s.key", c->value);
	if (access(path, F_OK) == 0)
		return refuse_file(path, -EEXIST);
	snprintf(k.machine, sizeof(k.machine), "%s", c->machine);
	snprintf(k.name, sizeof(k.name), "%s", c->value);
	snprintf(k.role, sizeof(k.role), "%s", c->third);
	memcpy(k.machine_key, talk_key(c->talk)->machine_key,
	       sizeof(k.machine_key));
	keyfile_draw(&k);
	err = keyfile_write(&k, path, 0600);
	if (err < 0)
		return refuse_file(path, err);
	keyfile_hex(hex, k.public);
	snprintf(text, sizeof(text), "%s %s %s", k.name, k.role, hex);
	rc = send(c, "keys-add", text);
	if (rc)
		unlink(path);
	else
		printf("its key is in %s: carry it to who is to use it, as a "
		       "secret, and name it with --key or EDM_KEY\n", path);
	return rc;
}

int ctl_keys(struct ctl *c)
{
	const bool named = c->value && keyfile_name_fits(c->value);

	if (strcmp(c->arg, "list") == 0 && !c->value)
		return list(c);
	if (strcmp(c->arg, "add") == 0 && named && c->third)
		return add(c);
	if (strcmp(c->arg, "remove") == 0 && named && !c->third)
		return send(c, "keys-remove", c->value);
	fprintf(stderr, "edmctl: keys: not understood; keys list, keys add "
		"NAME ROLE, or keys remove NAME; a name is 1 to 31 of A-Z a-z "
		"0-9 . _ -, a role viewer, operator or service\n");
	return EX_USAGE;
}
