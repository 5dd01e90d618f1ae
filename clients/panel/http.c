/* SPDX-License-Identifier: Apache-2.0 */
/*
 * http.c - pages, sessions, and texts that are too long for the web socket
 *
 *	GET  /, /assets/...	the page
 *	GET  /api/session	who am I; begins a session on loopback
 *	POST /api/login		{"user": ..., "password": ...}
 *	POST /api/logout
 *	POST /api/check?name=	a job's text: is it understood? its path
 *	POST /api/jobs?name=&hold=&line=  a job's text: into the queue, begun
 *					at a line; without, at its beginning
 *	GET  /api/path?program=&tolerance=	of the program that is loaded
 *	GET  /api/path?check=	of a text that was checked
 *
 * A POST bears the session's token in the header X-Edm-Token, and the Origin
 * of this panel.
 */
#include "panel.h"
#include "plain.h"
#include "answer.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BODY_S		60		/* the longest time of an upload */
#define CHECK_S		30
#define SEND_S		180
#define CHECK_BYTES	((size_t)1536 << 20)
#define LOGIN_MAX	1024
#define NAME_ROOM	640

struct route {
	const char *path;
	bool post;
	enum role role;			/* the least */
	size_t body_max;
	int (*run)(struct request *r);
};

/* -- Whose request is it -------------------------------------------------- */

/* Does "HOST:PORT" mean this panel: its address, or a name in [panel] names? */
static bool is_our_name(const struct panel *p, const char *host)
{
	static const char *const local[] = { "127.0.0.1", "localhost",
					     "[::1]" };
	char want[160], names[sizeof(p->config.panel.names)];
	const int port = (int)p->config.panel.port;
	char *rest = names, *name;

	for (size_t i = 0; i < sizeof(local) / sizeof(local[0]); i++) {
		snprintf(want, sizeof(want), "%s:%d", local[i], port);
		if (strcasecmp(want, host) == 0)
			return true;
	}
	snprintf(want, sizeof(want), "%s:%d", p->config.panel.address, port);
	if (strcasecmp(want, host) == 0)
		return true;
	snprintf(names, sizeof(names), "%s", p->config.panel.names);
	while ((name = strsep(&rest, ", "))) {
		snprintf(want, sizeof(want), "%s:%d", name, port);
		if (*name && (strcasecmp(want, host) == 0 ||
			      (port == 443 && strcasecmp(name, host) == 0)))
			return true;
	}
	return false;
}

bool http_is_ours(struct panel *p, struct lws *wsi, bool want_origin)
{
	const char *scheme = p->tls ? "https://" : "http://";
	char host[160] = "", origin[200] = "";

	if (lws_hdr_copy(wsi, host, sizeof(host), WSI_TOKEN_HOST) <= 0 ||
	    !is_our_name(p, host))
		return false;
	if (lws_hdr_copy(wsi, origin, sizeof(origin), WSI_TOKEN_ORIGIN) <= 0)
		return !want_origin;
	return strncmp(origin, scheme, strlen(scheme)) == 0 &&
	       strcasecmp(origin + strlen(scheme), host) == 0;
}

/* A browser sends its cookies to every port of a host, so a program of another
 * user on this host may have seen one. So on loopback a session serves only the
 * user who began it. */
struct session *http_session(struct panel *p, struct lws *wsi)
{
	struct visitor *v = visitor_of(wsi);
	struct share_who who;
	char cookie[1024];
	struct session *s;

	if (lws_hdr_copy(wsi, cookie, sizeof(cookie),
			 WSI_TOKEN_HTTP_COOKIE) <= 0)
		return NULL;
	s = session_find(p->sessions, cookie);
	if (!s || (p->local &&
		   (v->uid == SESSION_NOBODY || v->uid != s->uid)))
		return NULL;
	visitor_who(v, s, &who);
	share_pass(&v->share, &who);
	return s;
}

static bool has_token(struct request *r, const struct session *s)
{
	char token[64];

	return lws_hdr_custom_copy(r->wsi, token, sizeof(token), "x-edm-token:",
				   12) > 0 && session_token_ok(s, token);
}

static const struct visitor *visitor(const struct request *r)
{
	return visitor_of(r->wsi);
}

/* What it held is somebody else's now, or it took too long. */
static void on_taken(void *arg, const char *why)
{
	struct request *r = arg;

	child_forget(r->panel->children, r);
	service_forget(r->panel->service, r);
	if (!r->answered)
		answer_refusal(r, 503, why, "try again");
}

static int take_share(struct request *r, struct share *s, enum share_kind kind)
{
	struct share_who who;

	*s = (struct share) { .kind = kind, .end = on_taken, .arg = r };
	visitor_who(visitor(r), http_session(r->panel, r->wsi), &who);
	return share_take(r->panel->shares, s, &who);
}

/* Run a program for the request.  Return: as the callback of lws. */
static int run_child(struct request *r, enum share_kind kind,
		     const struct child_job *j, child_done_fn done)
{
	if (take_share(r, &r->work, kind) ||
	    child_start(r->panel->children, j, done, r))
		return answer_refusal(r, 503, "too much is under way",
				     "try again");
	share_limit(&r->upload, 0);
	return answer_wait(r, (int)j->limit_s + 5);
}

/* The text after "KEY=" in the address, or the text as it is if there is no
 * such key. */
static bool read_arg(struct request *r, const char *key, char *to, size_t size)
{
	char room[NAME_ROOM];
	const char *at = lws_get_urlarg_by_name(r->wsi, key, room,
						sizeof(room));

	if (at)
		snprintf(to, size, "%s", at);
	return at != NULL;
}

/* -- Sessions ------------------------------------------------------------- */

static int give_session(struct request *r, const struct session *s)
{
	json_t *o = json_pack("{s:s,s:s,s:s,s:b,s:s}", "user", s ? s->user : "",
			      "role", role_name(s ? s->role : ROLE_NONE),
			      "token", s ? s->token : "", "login",
			      !r->panel->local, "machine",
			      r->panel->config.name);

	if (s)
		snprintf(r->cookie, sizeof(r->cookie),
			 "edm_session=%s; Path=/; HttpOnly; SameSite=Strict%s",
			 s->id, r->panel->tls ? "; Secure" : "");
	return answer_json(r, 200, o);
}

static int get_session(struct request *r)
{
	struct panel *p = r->panel;
	struct session *s = http_session(p, r->wsi);
	const struct visitor *v = visitor(r);

	if (!s && p->local)
		s = session_begin(p->sessions, v, v->user, v->role);
	return give_session(r, s);
}

static void on_verified(void *arg, int status, int out_fd)
{
	struct request *r = arg;
	struct panel *p = r->panel;
	const struct visitor *v = visitor(r);
	struct session *s;

	close(out_fd);
	if (status != 0) {
		panel_note(p, "%s: login as %s was refused", v->address,
			   r->user.name);
		answer_refusal(r, 403, "name or password is wrong",
			      "edm-panel --add-user makes users");
		return;
	}
	session_try_ok(p->sessions, v->net);
	panel_note(p, "%s: %s logged in as %s", v->address, r->user.name,
		   role_name(r->user.role));
	s = session_begin(p->sessions, v, r->user.name, r->user.role);
	if (s)
		snprintf(s->hash, sizeof(s->hash), "%s", r->user.hash);
	give_session(r, s);
}

/* No password fits this hash. It is used for unknown names, so that they take
 * the same time. */
#define NO_HASH	"$argon2id$v=19$m=65536,t=2,p=1$AAAAAAAAAAAAAAAAAAAAAA$" \
		"AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"

/* The file of users is not as it should be: that is nobody's wrong password. */
static int refuse_users(struct request *r, int err)
{
	const char *what = err == -EBADMSG ? "a line of it is damaged" :
					     strerror(-err);

	panel_note(r->panel, "nobody can log in: %s: %s; edm-panel --add-user, "
		   "as root, writes it so that edm-panel can read it",
		   r->panel->config.panel.users, what);
	return answer_refusal(r, 503, "the panel cannot read its file of users",
			     "its journal says why; edm-panel --add-user, as "
			     "root, mends it");
}

static int verify(struct request *r, const char *name, const char *password)
{
	const char *const argv[] = { r->panel->self, "--work", "verify", NULL };
	struct child_job j = { .argv = argv, .limit_s = 10 };
	int err = session_user_find(r->panel->config.panel.users, name,
				    &r->user);

	if (err && err != -ESRCH)
		return refuse_users(r, err);
	if (err) {
		r->user = (struct session_user) { .hash = NO_HASH };
		snprintf(r->user.name, sizeof(r->user.name), "%s", name);
	}
	j.in_fd = child_file("panel-login");
	if (j.in_fd < 0)
		return answer_refusal(r, 503, "no room", "try again");
	dprintf(j.in_fd, "%s\n%s", r->user.hash, password);
	err = run_child(r, SHARE_LOGIN, &j, on_verified);
	close(j.in_fd);
	return err;
}

/* The characters that a name may have: names go into the journal. */
static bool is_plain(const char *s, size_t most)
{
	const size_t n = strlen(s);

	return n > 0 && n < most &&
	       strspn(s, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
			 "0123456789._-@") == n;
}

static int post_login(struct request *r)
{
	char wait[64];
	size_t bytes;
	char *text = child_read(r->body_fd, LOGIN_MAX, &bytes);
	json_t *o = text ? json_loadb(text, bytes, 0, NULL) : NULL;
	const char *name = json_string_value(json_object_get(o, "user"));
	const char *password = json_string_value(json_object_get(o,
								 "password"));
	int rc, wait_s;

	wait_s = session_may_try(r->panel->sessions, visitor(r)->net);
	if (wait_s) {
		snprintf(wait, sizeof(wait), "again in %d s", wait_s);
		rc = answer_refusal(r, 429, "too many tries", wait);
	} else if (!name || !password || !is_plain(name, SESSION_USER_MAX) ||
		   strlen(password) > 256) {
		rc = answer_refusal(r, 400, "no user and password", "both");
	} else {
		rc = verify(r, name, password);
	}
	json_decref(o);
	free(text);
	return rc;
}

static int post_logout(struct request *r)
{
	struct session *s = http_session(r->panel, r->wsi);

	if (s)
		session_end(s);
	socket_drop_ended(r->panel);
	return answer_json(r, 200, json_object());
}

/* -- Programs and paths --------------------------------------------------- */

/* The eight places where the machine stands, for --start. */
static void places(const struct panel *p, char *to, size_t size)
{
	const struct shm_snapshot *s = live_snapshot(p->live);
	size_t n = 0;

	for (int i = 0; i < SHM_NAXES && n < size; i++)
		n += (size_t)snprintf(to + n, size - n, "%s%.9g", i ? "," : "",
				      s ? s->pos[i] * s->pulse_mm[i] :
				      p->config.start_mm[i]);
}

static void forget_path(void *arg, const char *why)
{
	struct checked *c = arg;

	(void)why;
	close(c->fd);
	c->id[0] = '\0';
}

/* Keep the last few, so that their paths can be looked at. */
static void keep_check(struct request *r, int fd)
{
	struct checked *c = r->panel->checked;
	struct share_who who;

	while (c->id[0])
		c++;
	c->share = (struct share) { .kind = SHARE_PATH, .end = forget_path,
				    .arg = c, .idle = true };
	visitor_who(visitor(r), http_session(r->panel, r->wsi), &who);
	if (share_take(r->panel->shares, &c->share, &who)) {
		close(fd);
		return;
	}
	c->fd = fd;
	memcpy(c->id, r->id, sizeof(c->id));
}

static int give_check(struct request *r, const char *id)
{
	for (int i = 0; i < PANEL_CHECKED_ROOM; i++) {
		struct checked *c = &r->panel->checked[i];

		if (!c->id[0] || strcmp(c->id, id) != 0)
			continue;
		share_use(&c->share);
		return answer_file(r, dup(c->fd));
	}
	return answer_refusal(r, 404, "that text is forgotten",
			     "check it again");
}

static json_t *head_of(int fd)
{
	char head[4096], *end;
	const ssize_t n = pread(fd, head, sizeof(head) - 1, 0);

	if (n <= 0)
		return NULL;
	head[n] = '\0';
	end = strchr(head, '\n');
	if (end)
		*end = '\0';
	return json_loads(head, 0, NULL);
}

static json_t *check_failed(int status)
{
	return json_pack("{s:b,s:s,s:i,s:i,s:s,s:s}", "ok", 0, "where", "panel",
			 "line", 0, "column", 0, "found", status >= 128 ?
			 "reading it took more time or memory than the panel "
			 "allows" : "it could not be read", "wanted",
			 "a smaller program; edmsim --check reads any");
}

static void on_checked(void *arg, int status, int out_fd)
{
	struct request *r = arg;
	json_t *o = head_of(out_fd);

	if (!o || status > 1) {
		json_decref(o);
		o = check_failed(status);
	}
	if (json_is_true(json_object_get(o, "ok"))) {
		json_object_set_new(o, "check", json_string(r->id));
		keep_check(r, out_fd);
	} else {
		close(out_fd);
	}
	answer_json(r, 200, o);
}

static int post_check(struct request *r)
{
	char start[256];
	const char *const argv[] = {
		r->panel->self, "--work", "check", "--config",
		r->panel->config_path, "--file-name", r->name, "--start",
		start, "--setting", r->setting, NULL
	};
	const struct child_job j = {
		.argv = argv, .in_fd = r->body_fd, .memory_bytes = CHECK_BYTES,
		.limit_s = CHECK_S,
	};

	places(r->panel, start, sizeof(start));
	answer_draw_id(r);
	return run_child(r, SHARE_CHECK, &j, on_checked);
}

static void on_sent(void *arg, const struct service_answer *a)
{
	struct request *r = arg;
	json_t *body = json_loads(a->body, 0, NULL);

	panel_note(r->panel, "%s (%s): sent job %s, %s: %.80s", r->who,
		   role_name(r->role), r->id, r->name, a->reason);
	answer_json(r, 200, json_pack("{s:i,s:s,s:s,s:o}", "code", a->code,
				     "reason", a->reason, "job", r->id, "body",
				     body ? body : json_null()));
}

static int post_job(struct request *r)
{
	struct stat st;
	struct service_job j = {
		.fd = r->body_fd, .id = r->id, .name = r->name,
		.hold = r->hold, .from_line = r->from_line,
		.setting = r->setting,
	};
	int err;

	if (fstat(r->body_fd, &st) < 0)
		return answer_refusal(r, 500, "no text", "a text");
	j.bytes = (size_t)st.st_size;
	answer_draw_id(r);
	/* Twelve letters are enough, and a person can read them out. */
	r->id[12] = '\0';
	err = service_send(r->panel->service, &j, on_sent, r);
	if (err == -ENOTCONN)
		return answer_refusal(r, 503, service_why(r->panel->service),
				     "then try again");
	if (err)
		return answer_refusal(r, 503, "two jobs are being sent already",
				     "try again when one of them is there");
	share_limit(&r->upload, SEND_S);
	return answer_wait(r, SEND_S);
}

static void on_path(void *arg, int status, int out_fd)
{
	json_t *o;

	if (status == 0) {
		answer_file(arg, out_fd);
		return;
	}
	o = status == 1 ? head_of(out_fd) : NULL;
	close(out_fd);
	answer_json(arg, 404, o ? o : check_failed(status));
}

static int get_path(struct request *r)
{
	char check[64] = "", number[16] = "", tolerance[24] = "0";
	const char *const argv[] = {
		r->panel->self, "--work", "path", "--config",
		r->panel->config_path, "--machine", r->panel->config.name,
		"--program", number, "--tolerance", tolerance, NULL
	};
	const struct child_job j = { .argv = argv, .in_fd = -1,
				     .memory_bytes = (size_t)2 << 30,
				     .limit_s = CHECK_S };

	if (read_arg(r, "check=", check, sizeof(check)))
		return give_check(r, check);
	read_arg(r, "program=", number, sizeof(number));
	read_arg(r, "tolerance=", tolerance, sizeof(tolerance));
	if (!*number || strspn(number, "0123456789") != strlen(number))
		return answer_refusal(r, 400, "no program", "its number");
	if (strspn(tolerance, "0123456789.e-") != strlen(tolerance))
		return answer_refusal(r, 400, "no tolerance", "mm");
	return run_child(r, SHARE_CHECK, &j, on_path);
}

static const struct route routes[] = {
	{ "/api/session", false, ROLE_NONE, 0, get_session },
	{ "/api/path", false, ROLE_VIEWER, 0, get_path },
	{ "/api/login", true, ROLE_NONE, LOGIN_MAX, post_login },
	{ "/api/logout", true, ROLE_NONE, 0, post_logout },
	{ "/api/check", true, ROLE_VIEWER, PANEL_BODY_MAX, post_check },
	{ "/api/jobs", true, ROLE_OPERATOR, PANEL_BODY_MAX, post_job },
};

/* -- Taking one ----------------------------------------------------------- */

static const struct route *route_of(const char *path)
{
	for (size_t i = 0; i < sizeof(routes) / sizeof(routes[0]); i++)
		if (strcmp(routes[i].path, path) == 0)
			return &routes[i];
	return NULL;
}

/* Return: 0, or the HTTP status with which to refuse it. */
static int may_do(struct request *r, bool post)
{
	const struct session *s = http_session(r->panel, r->wsi);

	if (r->route->post != post)
		return 405;
	if (!http_is_ours(r->panel, r->wsi, post))
		return 403;
	if (r->route->role == ROLE_NONE && r->route->run != post_logout)
		return 0;
	if (!s)
		return 401;
	if (s->role < r->route->role || (post && !has_token(r, s)))
		return 403;
	snprintf(r->who, sizeof(r->who), "%s", s->user);
	r->role = s->role;
	return 0;
}

/* Does edmd-jobs take this name? */
static bool read_name(struct request *r)
{
	char hold[8] = "", line[16] = "", set[NAME_ROOM] = "";
	char name[NAME_ROOM] = "job.ngc";
	long from;

	read_arg(r, "name=", name, sizeof(name));
	for (char *at = name; *at; at++)
		if (*at == '/')
			*at = '_';
	read_arg(r, "hold=", hold, sizeof(hold));
	r->hold = hold[0] == '1';
	read_arg(r, "line=", line, sizeof(line));
	from = strtol(line, NULL, 10);
	/* The service refuses what is no line. */
	r->from_line = from < 0 || from > INT32_MAX ? -1 : (int)from;
	read_arg(r, "set=", set, sizeof(set));
	snprintf(r->setting, sizeof(r->setting), "%s", set);
	snprintf(r->name, sizeof(r->name), "%.63s", name);
	/* lws does not tell a text that is too long from no text. */
	if (lws_hdr_total_length(r->wsi, WSI_TOKEN_HTTP_URI_ARGS) >= NAME_ROOM)
		return false;
	return *name && strlen(name) < sizeof(r->name) && plain_is(name) &&
	       strlen(set) < sizeof(r->setting);
}

/* As long as there are bytes behind the body, lws calls this again and serves
 * nobody else. No browser sends such bytes before it has the answer. */
static int end_body(struct request *r)
{
	if (r->whole)
		return -1;
	r->whole = true;
	return r->has_body ? r->route->run(r) : 0;
}

static int open_body(struct request *r)
{
	char length[10] = "";

	/* A browser behind another server must count its bytes as that server
	 * does. */
	if (lws_hdr_total_length(r->wsi, WSI_TOKEN_HTTP_TRANSFER_ENCODING) >
		    0 ||
	    lws_hdr_total_length(r->wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH) <= 0)
		return answer_refusal(r, 411, "a body of unknown length",
				     "Content-Length");
	if (lws_hdr_copy(r->wsi, length, sizeof(length),
			 WSI_TOKEN_HTTP_CONTENT_LENGTH) <= 0 ||
	    strspn(length, "0123456789") != strlen(length) ||
	    strtoul(length, NULL, 10) > r->route->body_max)
		return answer_refusal(r, 413, "too long", "at most 64 MiB");
	if (take_share(r, &r->upload, SHARE_UPLOAD))
		return answer_refusal(r, 503, "too many uploads at once",
				     "try again");
	r->body_fd = child_file("panel-body");
	if (r->body_fd < 0)
		return answer_refusal(r, 503, "no room", "try again");
	r->has_body = true;
	/* lws begins its own anew with each piece. */
	share_limit(&r->upload, BODY_S);
	return 0;
}

static const char *reason_of(int status)
{
	return status == 401 ? "log in first" :
	       status == 405 ? "GET for what is read, POST for what is done" :
	       "the role, the token and the site of this panel";
}

static int take(struct request *r, const char *path)
{
	const bool post = lws_hdr_total_length(r->wsi, WSI_TOKEN_POST_URI) > 0;
	const bool get = lws_hdr_total_length(r->wsi, WSI_TOKEN_GET_URI) > 0;
	const struct asset *asset;
	int status;

	if (!get && !post)
		return answer_refusal(r, 405, "another method", reason_of(405));
	r->route = route_of(path);
	if (!r->route) {
		asset = assets_find(r->panel->assets, path);
		if (!get || !asset)
			return answer_refusal(r, get ? 404 : 405,
					      "nothing here", "/");
		if (!http_is_ours(r->panel, r->wsi, false))
			return answer_refusal(r, 403, "another name",
					     "an address of [panel] names");
		return answer_asset(r, asset);
	}
	status = may_do(r, post);
	if (status) {
		if (status == 403)
			panel_note(r->panel, "%s was refused: not from this "
				   "panel's page, or not permitted", path);
		return answer_refusal(r, status, "refused", reason_of(status));
	}
	if (!post)
		return r->route->run(r);
	if (!read_name(r))
		return answer_refusal(r, 400, "this name of a job cannot be "
				     "taken", "1 to 63 bytes of UTF-8 "
				     "without characters of control or of "
				     "the direction of writing; settings "
				     "of up to 191 bytes");
	return open_body(r);
}

static int take_body(struct request *r, const char *in, size_t len)
{
	if (!r->has_body || r->whole)
		return 0;
	r->body_bytes += len;
	if (r->body_bytes > r->route->body_max)
		return -1;
	while (len > 0) {
		const ssize_t n = write(r->body_fd, in, len);

		if (n <= 0)
			return -1;
		in += n;
		len -= (size_t)n;
	}
	return 0;
}

static int begin(struct lws *wsi, struct request *r, const char *path)
{
	struct panel *p = lws_context_user(lws_get_context(wsi));

	if (r->panel)
		answer_forget(r);
	*r = (struct request) { .panel = p, .wsi = wsi, .body_fd = -1,
				.fd = -1 };
	return take(r, path);
}

static int refuse_upgrade(struct lws *wsi)
{
	lws_return_http_status(wsi, HTTP_STATUS_BAD_REQUEST,
			       "HTTP/1.1, and Upgrade: websocket");
	return -1;
}

int http_callback(struct lws *wsi, enum lws_callback_reasons reason,
		  void *user, void *in, size_t len)
{
	struct request *r = user;

	switch (reason) {
	case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
		return visitor_begin(lws_context_user(lws_get_context(wsi)),
				     wsi);
	case LWS_CALLBACK_WSI_DESTROY:
		visitor_end(wsi);
		return 0;
	case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
		/* HTTP/2 without TLS goes another way through lws. */
		return strcasecmp(in, "websocket") == 0 ? 0 :
		       refuse_upgrade(wsi);
	case LWS_CALLBACK_HTTP:
		return begin(wsi, r, in);
	case LWS_CALLBACK_HTTP_BODY:
		return take_body(r, in, len);
	case LWS_CALLBACK_HTTP_BODY_COMPLETION:
		return end_body(r);
	case LWS_CALLBACK_HTTP_WRITEABLE:
		return answer_write(r);
	case LWS_CALLBACK_CLOSED_HTTP:
	case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
		if (r && r->panel)
			answer_forget(r);
		return 0;
	default:
		return lws_callback_http_dummy(wsi, reason, user, in, len);
	}
}
