/* SPDX-License-Identifier: Apache-2.0 */
/* heard.c - which machines send their STATUS now */
#include "heard.h"

#include "local.h"
#include "places.h"
#include "talk.h"
#include "udpm.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define HEAD	"EDM."
#define TAIL	".STATUS"

static void add(void *arg, const char *name)
{
	struct heard *h = arg;

	for (int i = 0; i < h->n; i++)
		if (strcmp(h->name[i], name) == 0)
			return;
	if (h->n < (int)(sizeof(h->name) / sizeof(h->name[0])))
		snprintf(h->name[h->n++], sizeof(h->name[0]), "%s", name);
}

/* One that is left from a service that was killed has nobody behind it. */
static void add_here(void *arg, const char *name)
{
	struct sockaddr_un at;
	const int fd = places_address(&at, name, "jobs") < 0 ? -1 :
		       local_connect(&at);

	if (fd < 0)
		return;
	close(fd);
	add(arg, name);
}

static void take(struct heard *h, const char *channel)
{
	const size_t n = strlen(channel), around = strlen(HEAD TAIL);
	char name[KEYFILE_NAME_MAX];

	if (n <= around || n - around >= sizeof(name) ||
	    strncmp(channel, HEAD, strlen(HEAD)) != 0 ||
	    strcmp(channel + n - strlen(TAIL), TAIL) != 0)
		return;
	memcpy(name, channel + strlen(HEAD), n - around);
	name[n - around] = '\0';
	if (keyfile_name_fits(name))
		add(h, name);
}

int heard_listen(struct heard *ret, const char *url, int ms)
{
	const double until_s = talk_now_s() + ms * 1e-3;
	struct udpm_packet packet;
	struct udpm_url at;
	struct pollfd p = { .events = POLLIN };
	struct udpm *in;
	double left_s;
	int err = udpm_url_read(&at, url ? url : talk_default_url()) ? -EINVAL :
		  udpm_open(&in, &at);

	*ret = (struct heard) { .n = 0 };
	if (!url)
		places_each("jobs", add_here, ret);
	if (err < 0)
		return ret->n ? 0 : err;
	p.fd = udpm_fd(in);
	while ((left_s = until_s - talk_now_s()) > 0 && !talk_interrupted())
		if (poll(&p, 1, (int)(left_s * 1e3) + 1) > 0 &&
		    udpm_take(in, &packet))
			take(ret, packet.channel);
	udpm_close(in);
	return 0;
}
