/* SPDX-License-Identifier: Apache-2.0 */
/*
 * main.c - edm-panel: the event loop, users
 */
#include "panel_options.h"
#include "clocks.h"
#include "panel.h"
#include "plain.h"
#include "answer.h"
#include "page_words.h"
#include "work.h"

#include <errno.h>
#include <signal.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sysexits.h>
#include <systemd/sd-daemon.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define TICK_US		10000
#define CONNECTIONS_MAX	448		/* more than SHARE_CONNECTION: one more
					 * can always be accepted, and then
					 * another makes room */

static volatile sig_atomic_t over;

static void on_signal(int number)
{
	(void)number;
	over = 1;
}

/* -- The log -------------------------------------------------------------- */

void panel_note(struct panel *p, const char *text, ...)
{
	struct panel_note *n = &p->note[p->notes++ % PANEL_NOTES];
	va_list ap;

	n->utime_ms = clock_ms(CLOCK_REALTIME);
	va_start(ap, text);
	vsnprintf(n->text, sizeof(n->text), text, ap);
	va_end(ap);
	plain_copy(n->text, sizeof(n->text), n->text);
	fprintf(stderr, SD_NOTICE "edm-panel: %s\n", n->text);
}

json_t *panel_notes(const struct panel *p)
{
	json_t *rows = json_array();

	for (uint64_t i = 0; i < PANEL_NOTES && i < p->notes; i++) {
		const struct panel_note *n =
			&p->note[(p->notes - 1 - i) % PANEL_NOTES];

		json_array_append_new(rows, json_pack("{s:I,s:s}", "t",
					(json_int_t)n->utime_ms, "text",
					n->text));
	}
	return rows;
}

/* -- The loop ------------------------------------------------------------- */

static void on_tick(lws_sorted_usec_list_t *timer)
{
	struct panel *p = lws_container_of(timer, struct panel, timer);

	service_look(p->service);
	children_look(p->children);
	live_look(p->live);
	if (live_is_new_point(p->live)) {
		shares_look(p->shares);
		socket_tell_all(p);
	}
	lws_sul_schedule(p->lws, 0, &p->timer, on_tick, TICK_US);
}

static void on_event(void *arg, const char *kind, const char *text)
{
	socket_tell_event(arg, kind, text);
}

static bool is_loopback(const char *address)
{
	return strncmp(address, "127.", 4) == 0 || strcmp(address, "::1") == 0;
}

static bool is_given(const char *file)
{
	return *file && strcmp(file, "none") != 0;
}

static int open_server(struct panel *p)
{
	static const struct lws_protocols protocols[] = {
		{ .name = "http", .callback = http_callback,
		  .per_session_data_size = sizeof(struct request) },
		{ .name = "edm-panel", .callback = socket_callback,
		  .rx_buffer_size = 8192 },
		{ .name = NULL },
	};
	static struct lws_protocols mine[3];
	struct lws_context_creation_info info = { .port = 0 };

	memcpy(mine, protocols, sizeof(mine));
	mine[1].per_session_data_size = socket_browser_size();
	info.iface = p->config.panel.address;
	info.port = (int)p->config.panel.port;
	info.protocols = mine;
	info.user = p;
	/* Versions of the library differ in the sign of their type. */
	info.gid = (__typeof__(info.gid))-1;
	info.uid = (__typeof__(info.uid))-1;
	info.alpn = "http/1.1";
	info.fd_limit_per_thread = CONNECTIONS_MAX;
	info.timeout_secs = 10;
	info.keepalive_timeout = 15;
	info.timeout_secs_ah_idle = 5;
	info.max_http_header_data = 4096;
	info.max_http_header_pool = CONNECTIONS_MAX;
	info.ka_time = 10;
	info.ka_interval = 5;
	info.ka_probes = 3;
	info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
	if (p->tls) {
		info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
		info.ssl_cert_filepath = p->config.panel.certificate;
		info.ssl_private_key_filepath = p->config.panel.key;
		info.simultaneous_ssl_restriction = CONNECTIONS_MAX;
	}
	p->lws = lws_create_context(&info);
	return p->lws ? 0 : -EADDRINUSE;
}

static int fail(int code, const char *what, const char *wanted)
{
	fprintf(stderr, "edm-panel: %s; %s\n", what, wanted);
	return code;
}

static int open_parts(struct panel *p)
{
	const struct machine_config *c = &p->config;
	char what[400];
	int err;

	err = assets_read(&p->assets, c->panel.assets);
	if (err) {
		snprintf(what, sizeof(what), "no page in %s: %s",
			 c->panel.assets, strerror(-err));
		return fail(EX_NOINPUT, what, "make panel makes it; [panel] "
			    "assets says where it is");
	}
	p->shares = shares_create();
	p->sessions = sessions_create(p->shares);
	p->children = children_create();
	if (!p->shares || !p->sessions || !p->children ||
	    live_create(&p->live, c) < 0)
		return fail(EX_OSERR, "out of memory",
			    "end another program, then start it again");
	p->service = service_create(c->name, p->shares);
	if (!p->service)
		return fail(EX_OSERR, "out of memory",
			    "end another program, then start it again");
	service_on_event(p->service, on_event, p);
	if (open_server(p) == 0)
		return 0;
	snprintf(what, sizeof(what), "cannot listen on %s port %d",
		 c->panel.address, (int)c->panel.port);
	return fail(EX_UNAVAILABLE, what, "another port, an address of this "
		    "host, and a certificate and key that can be read");
}

static void close_parts(struct panel *p)
{
	if (p->lws)
		lws_context_destroy(p->lws);
	service_destroy(p->service);
	children_destroy(p->children);
	live_destroy(p->live);
	sessions_destroy(p->sessions);
	for (int i = 0; i < PANEL_CHECKED_ROOM; i++)
		share_give(&p->checked[i].share);
	shares_destroy(p->shares);
	assets_free(p->assets);
	json_decref(p->told);
	free(p->delta);
}

/* Beyond this host nothing is sent in clear, and everybody needs a password. */
static int check_reach(struct panel *p)
{
	const struct config_panel *c = &p->config.panel;

	p->local = is_loopback(c->address);
	p->tls = is_given(c->certificate) && is_given(c->key);
	p->local_role = (enum role)(c->local_role + ROLE_VIEWER);
	if (p->local || p->tls)
		return 0;
	return fail(EX_CONFIG, "[panel] address is not of this host alone",
		    "[panel] certificate and key, for TLS; or 127.0.0.1");
}

static int serve(struct panel *p)
{
	int err = check_reach(p);

	if (err)
		return err;
	lws_set_log_level(LLL_ERR, NULL);
	err = open_parts(p);
	if (err == 0) {
		fprintf(stderr,
			SD_INFO "edm-panel: machine %s at %s://%s:%d/\n",
			p->config.name, p->tls ? "https" : "http",
			p->config.panel.address, (int)p->config.panel.port);
		sd_notify(0, "READY=1");
		on_tick(&p->timer);
	}
	while (err == 0 && !over)
		if (lws_service(p->lws, 0) < 0)
			err = EX_SOFTWARE;
	close_parts(p);
	return err;
}

/* -- Users ---------------------------------------------------------------- */

static void read_password(char to[260])
{
	struct termios was, quiet;
	const bool tty = tcgetattr(STDIN_FILENO, &was) == 0;

	if (tty) {
		fprintf(stderr, "Password (12 characters or more): ");
		quiet = was;
		quiet.c_lflag &= ~(tcflag_t)ECHO;
		tcsetattr(STDIN_FILENO, TCSANOW, &quiet);
	}
	if (!fgets(to, 260, stdin))
		to[0] = '\0';
	to[strcspn(to, "\n")] = '\0';
	if (tty) {
		tcsetattr(STDIN_FILENO, TCSANOW, &was);
		fputc('\n', stderr);
	}
}

static int add_user(const struct panel *p, const char *name, const char *role)
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyz"
		"ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-@";
	struct session_user u = { .role = role_parse(role) };
	char password[260];
	int err;

	if (u.role == ROLE_NONE)
		return fail(EX_USAGE, "no such role", "viewer, operator or "
			    "service");
	if (strlen(name) >= sizeof(u.name) || !*name ||
	    strspn(name, plain) != strlen(name))
		return fail(EX_USAGE, "no such name", "1 to 31 letters, "
			    "digits, . _ - @");
	snprintf(u.name, sizeof(u.name), "%s", name);
	read_password(password);
	if (strlen(password) < 12 || strlen(password) > 256)
		return fail(EX_DATAERR, "this password is too short or too "
			    "long", "12 to 256 characters");
	if (crypto_pwhash_str(u.hash, password, strlen(password),
			      crypto_pwhash_OPSLIMIT_INTERACTIVE,
			      crypto_pwhash_MEMLIMIT_INTERACTIVE))
		return fail(EX_OSERR, "out of memory", "64 MiB");
	sodium_memzero(password, sizeof(password));
	err = session_user_put(p->config.panel.users, &u);
	if (err) {
		fprintf(stderr, "edm-panel: %s: %s; a file that can be "
			"written, [panel] users\n", p->config.panel.users,
			strerror(-err));
		return EX_CANTCREAT;
	}
	printf("%s is %s in %s\n", name, role, p->config.panel.users);
	return 0;
}

static int read_config(struct panel *p, const struct panel_options *o)
{
	struct interp_diag d = { .line = 0 };
	const int err = config_read(&p->config, o->config, &d);

	if (err == -EINVAL) {
		interp_diag_tell(&d, o->config);
		return EX_CONFIG;
	}
	if (err < 0) {
		fprintf(stderr, "edm-panel: %s: %s; a machine file\n",
			o->config, strerror(-err));
		return EX_NOINPUT;
	}
	if (o->machine)
		snprintf(p->config.name, sizeof(p->config.name), "%s",
			 o->machine);
	if (o->port > 0)
		p->config.panel.port = o->port;
	if (o->assets)
		snprintf(p->config.panel.assets,
			 sizeof(p->config.panel.assets), "%s", o->assets);
	return 0;
}

static void find_self(char to[512])
{
	const ssize_t n = readlink("/proc/self/exe", to, 511);

	to[n > 0 ? n : 0] = '\0';
}

/* The page that was installed with the program, or built beside it. */
static void find_page(char to[256], const char *self)
{
	static const char *const from[] = { "../share/edmd/panel", "panel" };
	const char *slash = strrchr(self, '/');
	const int n = slash ? (int)(slash - self) : 0;

	for (size_t i = 0; i < sizeof(from) / sizeof(from[0]); i++) {
		snprintf(to, 256, "%.*s/%s", n, self, from[i]);
		if (access(to, R_OK) == 0)
			return;
	}
}

int main(int argc, char **argv)
{
	static struct panel p;
	static char self[512];
	struct panel_options o;
	const struct sigaction sa = { .sa_handler = on_signal };
	int rc = panel_options_take(&o, argc, argv);

	if (rc >= 0)
		return rc;
	if (o.work.what)
		return work_run(&o.work);
	if (o.print_words)
		return page_words_print();
	rc = read_config(&p, &o);
	if (rc)
		return rc;
	if (sodium_init() < 0)
		return EX_SOFTWARE;
	if (o.add_user)
		return add_user(&p, o.add_user, o.role);
	find_self(self);
	p.self = self;
	if (strcmp(p.config.panel.assets, "none") == 0)
		find_page(p.config.panel.assets, self);
	p.config_path = o.config;
	sigaction(SIGINT, &sa, NULL);
	sigaction(SIGTERM, &sa, NULL);
	signal(SIGPIPE, SIG_IGN);
	/* This memory holds passwords and keys. */
	prctl(PR_SET_DUMPABLE, 0);
	return serve(&p);
}
