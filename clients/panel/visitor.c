/* SPDX-License-Identifier: Apache-2.0 */
/* visitor.c - one connection: where it comes from, and for whom it counts */
#include "visitor.h"
#include "frames.h"
#include "panel.h"

#include <arpa/inet.h>
#include <errno.h>
#include <linux/inet_diag.h>
#include <linux/netlink.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* -- Who holds the other end ---------------------------------------------- */

struct question {
	struct nlmsghdr head;
	struct inet_diag_req_v2 ask;
};

/* An address and a port as the kernel's tables have them: what came by IPv4 is
 * there as such. */
static int put_end(const struct sockaddr_storage *a, __be32 to[4], __be16 *port)
{
	const struct sockaddr_in *v4 = (const struct sockaddr_in *)a;
	const struct sockaddr_in6 *v6 = (const struct sockaddr_in6 *)a;

	if (a->ss_family == AF_INET) {
		to[0] = v4->sin_addr.s_addr;
		*port = v4->sin_port;
		return AF_INET;
	}
	*port = v6->sin6_port;
	if (IN6_IS_ADDR_V4MAPPED(&v6->sin6_addr)) {
		memcpy(to, &v6->sin6_addr.s6_addr[12], 4);
		return AF_INET;
	}
	memcpy(to, &v6->sin6_addr, 16);
	return AF_INET6;
}

static int put_question(struct question *q, int fd)
{
	struct sockaddr_storage peer, own;
	socklen_t npeer = sizeof(peer), nown = sizeof(own);
	struct inet_diag_sockid *id = &q->ask.id;
	int family;

	if (getpeername(fd, (struct sockaddr *)&peer, &npeer) < 0 ||
	    getsockname(fd, (struct sockaddr *)&own, &nown) < 0)
		return -errno;
	*q = (struct question) {
		.head = { .nlmsg_len = sizeof(*q), .nlmsg_flags = NLM_F_REQUEST,
			  .nlmsg_type = SOCK_DIAG_BY_FAMILY },
		.ask = { .sdiag_protocol = IPPROTO_TCP,
			 .idiag_states = ~0u },
	};
	/* Its own end is the source of the socket that is looked for. */
	family = put_end(&peer, id->idiag_src, &id->idiag_sport);
	if (put_end(&own, id->idiag_dst, &id->idiag_dport) != family)
		return -EAFNOSUPPORT;
	q->ask.sdiag_family = (__u8)family;
	id->idiag_cookie[0] = id->idiag_cookie[1] = INET_DIAG_NOCOOKIE;
	return 0;
}

/*
 * The kernel looks for one socket, however many there are.  Both its ends have
 * to fit, because it may find one that only listens there.  A socket that its
 * user has closed belongs to nobody, and the kernel shows it as root's: only
 * one that is still held counts.
 */
static int read_answer(const struct question *q, const char *text, ssize_t n,
		       unsigned int *ret)
{
	const struct nlmsghdr *head = (const struct nlmsghdr *)text;
	const struct inet_diag_msg *m = (const struct inet_diag_msg *)
					(text + NLMSG_HDRLEN);
	const struct inet_diag_sockid *id = &m->id;

	if (n < (ssize_t)(NLMSG_HDRLEN + sizeof(*m)) ||
	    head->nlmsg_type != SOCK_DIAG_BY_FAMILY ||
	    m->idiag_state != TCP_ESTABLISHED ||
	    id->idiag_sport != q->ask.id.idiag_sport ||
	    id->idiag_dport != q->ask.id.idiag_dport)
		return -ENOENT;
	*ret = m->idiag_uid;
	return 0;
}

static int peer_uid(int fd, unsigned int *ret)
{
	_Alignas(struct nlmsghdr) char text[1024];
	struct question q;
	int err = put_question(&q, fd), kernel;
	ssize_t n;

	if (err < 0)
		return err;
	kernel = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC,
			NETLINK_SOCK_DIAG);
	if (kernel < 0)
		return -errno;
	err = -ENOENT;
	if (send(kernel, &q, sizeof(q), 0) == (ssize_t)sizeof(q)) {
		n = recv(kernel, text, sizeof(text), 0);
		err = read_answer(&q, text, n, ret);
	}
	close(kernel);
	return err;
}

/* -- The connection ------------------------------------------------------- */

static void drop(void *arg, const char *why)
{
	struct visitor *v = arg;

	(void)why;
	lws_set_timeout(v->wsi, PENDING_TIMEOUT_KILLED_BY_PARENT,
			LWS_TO_KILL_ASYNC);
}

static void find_address(struct visitor *v)
{
	static const char mapped[] = "::ffff:";
	char *to = v->address;
	struct in6_addr a;

	lws_get_peer_simple(v->wsi, to, sizeof(v->address));
	if (strncmp(to, mapped, sizeof(mapped) - 1) == 0)
		memmove(to, to + sizeof(mapped) - 1,
			strlen(to) - sizeof(mapped) + 2);
	snprintf(v->net, sizeof(v->net), "%s", to);
	if (inet_pton(AF_INET6, to, &a) != 1)
		return;
	memset(&a.s6_addr[8], 0, 8);
	inet_ntop(AF_INET6, &a, v->net, sizeof(v->net));
}

int visitor_begin(struct panel *p, struct lws *wsi)
{
	struct visitor *v = calloc(1, sizeof(*v));
	struct share_who who;
	int err;

	if (!v)
		return -ENOMEM;
	v->wsi = wsi;
	v->fd = lws_get_socket_fd(wsi);
	frames_none(v->fd);
	v->uid = SESSION_NOBODY;
	find_address(v);
	if (p->local) {
		v->role = ROLE_VIEWER;
		snprintf(v->user, sizeof(v->user), "?");
		if (peer_uid(v->fd, &v->uid) == 0)
			v->role = session_local_role(v->uid, p->local_role,
						     v->user);
	}
	v->share = (struct share) { .kind = SHARE_CONNECTION, .end = drop,
				    .arg = v, .idle = true };
	visitor_who(v, NULL, &who);
	err = share_take(p->shares, &v->share, &who);
	if (err)
		free(v);
	else
		lws_set_opaque_user_data(wsi, v);
	return err;
}

void visitor_end(struct lws *wsi)
{
	struct visitor *v = visitor_of(wsi);

	if (!v)
		return;
	lws_set_opaque_user_data(wsi, NULL);
	/* The next file of this number is none of a browser, perhaps. */
	frames_none(v->fd);
	share_give(&v->share);
	free(v);
}

struct visitor *visitor_of(struct lws *wsi)
{
	return lws_get_opaque_user_data(wsi);
}

void visitor_who(const struct visitor *v, const struct session *s,
		 struct share_who *ret)
{
	*ret = (struct share_who) { .rank = (int)(s ? s->role : v->role) };
	if (v->user[0])
		snprintf(ret->peer, sizeof(ret->peer), "uid %u", v->uid);
	else if (s)
		snprintf(ret->peer, sizeof(ret->peer), "user %s", s->user);
	else
		snprintf(ret->peer, sizeof(ret->peer), "%s", v->net);
}
