/* SPDX-License-Identifier: Apache-2.0 */
/* talk_way.c - how packets go between a client and edmd-jobs */
#include "talk_way.h"

#include "local.h"
#include "places.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#define AGAIN_S		0.1		/* between two tries to connect */

struct talk_way {
	const struct talk_carrier *by;	/* NULL: socket or multicast */
	int epoll;
	struct sockaddr_un at;		/* "": only by multicast */
	int local;			/* -1: not connected */
	double tried_s;
	struct udpm *net;		/* NULL: not wanted, or not possible */
	uint8_t packet[UDPM_PACKET_MAX];
};

static int watch(struct talk_way *w, int fd)
{
	struct epoll_event e = { .events = EPOLLIN };

	return epoll_ctl(w->epoll, EPOLL_CTL_ADD, fd, &e) < 0 ? -errno : 0;
}

static int connect_local(struct talk_way *w)
{
	int err;

	w->tried_s = talk_now_s();
	w->local = local_connect(&w->at);
	if (w->local < 0)
		return w->local;
	err = watch(w, w->local);
	if (err < 0) {
		close(w->local);
		w->local = -1;
	}
	return err;
}

const char *talk_default_url(void)
{
	const char *url = getenv("LCM_DEFAULT_URL");

	return url && *url ? url : TALK_URL;
}

/* @named: the user chose the URL. */
static int join(struct talk_way *w, const char *url, bool named, char *said)
{
	const char *wrong;
	char why[UDPM_WHY_MAX];
	struct udpm_url at;
	int err;

	wrong = udpm_url_read(&at, url);
	if (wrong) {
		snprintf(said, TALK_SAID_MAX, "%s %s; %s; such as "
			 TALK_URL, named ? "--url" : "LCM_DEFAULT_URL",
			 url, wrong);
		return -EDESTADDRREQ;
	}
	err = udpm_open(&w->net, &at);
	if (err == 0)
		return watch(w, udpm_fd(w->net));
	udpm_why(&at, err, why, sizeof(why));
	if (named)
		snprintf(said, TALK_SAID_MAX, "cannot open %s: %s", url, why);
	else
		snprintf(said, TALK_SAID_MAX, "no edmd-jobs listens at %s: "
			 "systemctl start edmd-jobs; nor can one be asked by "
			 "multicast: %s", w->at.sun_path, why);
	return -ENETUNREACH;
}

static int find(struct talk_way *w, const struct talk_options *o, char *said)
{
	const char *url = o->url;
	int err = url ? -ENOENT :
			places_address(&w->at, talk_machine(o), "jobs");

	if (err == 0)
		err = connect_local(w);
	return err < 0 ? join(w, url ? url : talk_default_url(), url, said) : 0;
}

int talk_way_open(struct talk_way **ret, const struct talk_options *o,
		  char said[TALK_SAID_MAX])
{
	struct talk_way *w = calloc(1, sizeof(*w));
	int err;

	if (!w)
		return -ENOMEM;
	w->local = -1;
	w->epoll = epoll_create1(EPOLL_CLOEXEC);
	w->by = o->carrier;
	err = w->epoll < 0 ? -errno :
	      w->by ? watch(w, w->by->fd) : find(w, o, said);
	if (err < 0) {
		talk_way_close(w);
		return err;
	}
	*ret = w;
	return 0;
}

void talk_way_close(struct talk_way *w)
{
	if (!w)
		return;
	if (w->local >= 0)
		close(w->local);
	udpm_close(w->net);
	if (w->epoll >= 0)
		close(w->epoll);
	free(w);
}

int talk_way_fd(const struct talk_way *w)
{
	return w->epoll;
}

void talk_way_send(struct talk_way *w, const char *channel, const void *data,
	      size_t size)
{
	if (w->by)
		w->by->send(w->by->arg, channel, data, size);
	else if (w->local >= 0)
		local_put(w->local, channel, data, size);
	else if (w->net)
		udpm_send(w->net, channel, data, size);
}

bool talk_way_take(struct talk_way *w, struct udpm_packet *ret)
{
	int got;

	if (w->by)
		return w->by->take(w->by->arg, ret);
	if (w->local < 0)
		return w->net && udpm_take(w->net, ret);
	got = local_get(w->local, w->packet, ret);
	if (got >= 0)
		return got;
	close(w->local);
	w->local = -1;
	return false;
}

void talk_way_look(struct talk_way *w)
{
	if (w->local >= 0 || !w->at.sun_path[0] ||
	    talk_now_s() - w->tried_s < AGAIN_S || connect_local(w) < 0)
		return;
	udpm_close(w->net);
	w->net = NULL;
}
