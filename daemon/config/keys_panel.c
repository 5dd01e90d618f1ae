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
	       "where edm-panel listens; another than this host's own wants "
	       "certificate and key"),
	WHOLE(PANEL, "port", "", "7680", 1, 65535, AT(panel.port),
	      "port it listens on"),
	STRING(PANEL, "names", "none", panel.names,
	       "names or addresses browsers may call it by, apart from the "
	       "address"),
	STRING(PANEL, "certificate", "none", panel.certificate,
	       "file of the TLS certificate, PEM"),
	STRING(PANEL, "key", "none", panel.key,
	       "file of its private key, PEM"),
	STRING(PANEL, "users", "/etc/edmd/panel.users", panel.users,
	       "who may log in; written by edm-panel --add-user"),
	WORDS(PANEL, "local_role", "operator", AT(panel.local_role), role_word,
	      "of who is at this host and is root or in group edm"),
	STRING(PANEL, "assets", "/usr/local/share/edmd/panel", panel.assets,
	       "folder of the page"),
};
/* clang-format on */

const struct config_keys config_keys_panel = { row, ROWS_IN(row) };
