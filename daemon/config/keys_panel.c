/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_panel.c - keys of the operator's page
 */
#include "keys_rows.h"

static const char *role_word(int i)
{
	static const char *const words[] = { "viewer", "operator", "service" };

	return WORD_OF(words, i);
}

/* clang-format off */
static const struct config_key row[] = {
	STRING(PANEL, "address", "127.0.0.1", panel.address,
	       "address that edm-panel listens on; if it is not the "
	       "loopback, certificate and key are needed"),
	WHOLE(PANEL, "port", "", "7680", 1, 65535, AT(panel.port),
	      "port it listens on"),
	STRING(PANEL, "names", "none", panel.names,
	       "names or addresses by which browsers may call it, besides "
	       "the address"),
	STRING(PANEL, "certificate", "none", panel.certificate,
	       "file of the TLS certificate, PEM"),
	STRING(PANEL, "key", "none", panel.key,
	       "file of its private key, PEM"),
	STRING(PANEL, "users", "/etc/edmd/panel.users", panel.users,
	       "who may log in; written by edm-panel --add-user"),
	WORDS(PANEL, "local_role", "operator", AT(panel.local_role), role_word,
	      "role of a user of this host who is root or in group edm"),
	STRING(PANEL, "assets", "none", panel.assets,
	       "folder of the page's files; none: that which came with the "
	       "program"),
};
/* clang-format on */

const struct config_keys config_keys_panel = { row, ROWS_IN(row) };
