/* SPDX-License-Identifier: Apache-2.0 */
/* answer.c - the answers to requests of HTTP */
#include "answer.h"
#include "frames.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEAD_BYTES	2048
#define PART_BYTES	16384

/* Allow scripts, styles and connections of this panel alone, and nothing
 * inline. */
#define CSP	"default-src 'none'; script-src 'self'; style-src 'self'; " \
		"img-src 'self' data:; font-src 'self'; connect-src 'self'; " \
		"manifest-src 'self'; base-uri 'none'; form-action 'self'; " \
		"frame-ancestors 'none'"

static const struct { const char *name, *value; } always[] = {
	{ "content-security-policy:", CSP },
	{ "x-content-type-options:", "nosniff" },
	{ "x-frame-options:", "DENY" },
	{ "referrer-policy:", "no-referrer" },
	{ "cross-origin-opener-policy:", "same-origin" },
	{ "cross-origin-resource-policy:", "same-origin" },
	{ "permissions-policy:", "camera=(), microphone=(), geolocation=()" },
};

struct head {
	struct lws *wsi;
	unsigned char *at, *end;
	bool bad;
};

static void put(struct head *h, const char *name, const char *value)
{
	if (lws_add_http_header_by_name(h->wsi, (const unsigned char *)name,
					(const unsigned char *)value,
					(int)strlen(value), &h->at, h->end))
		h->bad = true;
}

static const char *cache_of(const struct request *r)
{
	return r->asset && r->asset->hashed ?
	       "public, max-age=31536000, immutable" : "no-store";
}

static int write_head(struct request *r)
{
	unsigned char room[LWS_PRE + HEAD_BYTES], *from = room + LWS_PRE;
	struct head h = { .wsi = r->wsi, .at = from,
			  .end = room + sizeof(room) - 1 };

	if (lws_add_http_common_headers(r->wsi, (unsigned int)r->status,
					r->type, r->bytes, &h.at, h.end))
		return -1;
	for (size_t i = 0; i < sizeof(always) / sizeof(always[0]); i++)
		put(&h, always[i].name, always[i].value);
	put(&h, "cache-control:", cache_of(r));
	if (r->panel->tls)
		put(&h, "strict-transport-security:", "max-age=31536000");
	if (r->cookie[0])
		put(&h, "set-cookie:", r->cookie);
	if (r->asset && r->asset->gzip)
		put(&h, "content-encoding:", "gzip");
	if (h.bad || lws_finalize_write_http_header(r->wsi, from, &h.at, h.end))
		return -1;
	r->headed = true;
	return 0;
}

/* A connection that stays open has nothing under way any more. */
static void drop_body(struct request *r)
{
	share_give(&r->upload);
	share_give(&r->work);
	if (!r->has_body)
		return;
	close(r->body_fd);
	r->has_body = false;
}

static int answer(struct request *r, int status, const char *type)
{
	r->answered = true;
	drop_body(r);
	r->status = status;
	r->type = type;
	lws_set_timeout(r->wsi, PENDING_TIMEOUT_HTTP_CONTENT, 60);
	lws_callback_on_writable(r->wsi);
	return 0;
}

int answer_json(struct request *r, int status, json_t *o)
{
	r->text = json_dumps(o, JSON_COMPACT);
	json_decref(o);
	if (!r->text)
		return -1;
	r->bytes = strlen(r->text);
	return answer(r, status, "application/json");
}

int answer_refusal(struct request *r, int status, const char *found,
		  const char *wanted)
{
	return answer_json(r, status, json_pack("{s:s,s:s}", "found", found,
					       "wanted", wanted));
}

int answer_asset(struct request *r, const struct asset *a)
{
	r->asset = a;
	r->bytes = a->size;
	return answer(r, 200, a->type);
}

int answer_file(struct request *r, int fd)
{
	struct stat st;

	if (fd < 0 || fstat(fd, &st) < 0)
		return answer_refusal(r, 503, "no room", "try again");
	r->fd = fd;
	r->bytes = (size_t)st.st_size;
	return answer(r, 200, "application/octet-stream");
}

int answer_wait(struct request *r, int s)
{
	lws_set_timeout(r->wsi, PENDING_TIMEOUT_HTTP_CONTENT, s);
	return 0;
}

static ssize_t fetch(const struct request *r, unsigned char *to, size_t n)
{
	if (r->fd >= 0)
		return pread(r->fd, to, n, (off_t)r->sent);
	memcpy(to, (r->asset ? r->asset->bytes : r->text) + r->sent, n);
	return (ssize_t)n;
}

int answer_write(struct request *r)
{
	unsigned char room[LWS_PRE + PART_BYTES];
	struct lws *wsi;
	size_t left, n;

	if (!r->panel || !r->answered)
		return 0;
	if (!r->headed) {
		if (write_head(r))
			return -1;
		lws_callback_on_writable(r->wsi);
		return 0;
	}
	left = r->bytes - r->sent;
	n = left < PART_BYTES ? left : PART_BYTES;
	if (n > 0 && fetch(r, room + LWS_PRE, n) != (ssize_t)n)
		return -1;
	if (lws_write(r->wsi, room + LWS_PRE, n, n == left ?
		      LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < (int)n)
		return -1;
	r->sent += n;
	lws_set_timeout(r->wsi, PENDING_TIMEOUT_HTTP_CONTENT, 30);
	if (n < left) {
		lws_callback_on_writable(r->wsi);
		return 0;
	}
	/* A refused upload is not read to its end. */
	if (r->status >= 400)
		return -1;
	wsi = r->wsi;
	frames_none(lws_get_socket_fd(wsi));
	answer_forget(r);
	return lws_http_transaction_completed(wsi) ? -1 : 0;
}

void answer_forget(struct request *r)
{
	child_forget(r->panel->children, r);
	service_forget(r->panel->service, r);
	drop_body(r);
	if (r->fd >= 0)
		close(r->fd);
	free(r->text);
	*r = (struct request) { .panel = NULL, .body_fd = -1, .fd = -1 };
}

void answer_draw_id(struct request *r)
{
	uint8_t drawn[16];

	randombytes_buf(drawn, sizeof(drawn));
	sodium_bin2hex(r->id, sizeof(r->id), drawn, sizeof(drawn));
}
