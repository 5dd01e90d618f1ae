/* SPDX-License-Identifier: Apache-2.0 */
/* udpm.c - LCM's packets by sockets of our own */
#include "udpm.h"

#include <arpa/inet.h>
#include <errno.h>
#include <ifaddrs.h>
#include <linux/filter.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#define SHORT_MAGIC	0x4c433032u	/* "LC02" */
#define HEAD_BYTES	8		/* magic, sequence number */
#define BUFFER_BYTES	(4 << 20)	/* the kernel gives as much as it
					 * allows */
#define ADDRESSES_MAX	64
#define LOOK_S		1		/* between two checks of the
					 * interfaces */

struct udpm {
	int fd, out;			/* what is sent has a port of its own */
	struct sockaddr_in group;
	bool only_here;			/* accept only packets of this host */
	in_addr_t here[ADDRESSES_MAX];
	int nhere;
	time_t looked_s;
	uint64_t strange;
	char strange_from[UDPM_FROM_MAX];
	uint8_t packet[UDPM_PACKET_MAX + 1];
};

/* -- The URL -------------------------------------------------------------- */

static const char *group_read(struct sockaddr_in *ret, const char *at,
			      size_t bytes)
{
	char host[64], *colon, *end;
	unsigned long port;

	if (bytes >= sizeof(host))
		return "its group is too long";
	memcpy(host, at, bytes);
	host[bytes] = '\0';
	colon = strchr(host, ':');
	if (!colon)
		return "it names no port; udpm://GROUP:PORT?ttl=0";
	*colon = '\0';
	port = strtoul(colon + 1, &end, 10);
	if (*end || end == colon + 1 || port < 1 || port > 65535)
		return "its port is not a number from 1 to 65535";
	*ret = (struct sockaddr_in) {
		.sin_family = AF_INET, .sin_port = htons((uint16_t)port),
	};
	if (inet_pton(AF_INET, host, &ret->sin_addr) != 1 ||
	    !IN_MULTICAST(ntohl(ret->sin_addr.s_addr)))
		return "its group is no multicast address, 224.0.1.0 to "
		       "239.255.255.255";
	if (ntohl(ret->sin_addr.s_addr) >> 8 == 0xe00000)
		return "its group is one of those that belong to routers; "
		       "224.0.1.0 to 239.255.255.255";
	return NULL;
}

/* LCM uses the last of several.  Here only one is accepted; the message says
 * so. */
static const char *ttl_read(unsigned int *ret, const char *at)
{
	unsigned long ttl;
	char *end;

	if (strncmp(at, "ttl=", 4) != 0 || at[4] < '0' || at[4] > '9' ||
	    (at[4] == '0' && at[5] >= '0' && at[5] <= '9'))
		return "one ?ttl=N is wanted behind the port, and nothing "
		       "else; 0 stays on this host";
	ttl = strtoul(at + 4, &end, 10);
	if (*end || ttl > 255)
		return "its ttl is not one number from 0 to 255; 0 stays on "
		       "this host";
	*ret = (unsigned int)ttl;
	return NULL;
}

const char *udpm_url_read(struct udpm_url *ret, const char *url)
{
	const char *at, *query, *wrong;

	if (strncmp(url, "udpm://", 7) != 0)
		return "not a udpm:// URL";
	at = url + 7;
	query = strchr(at, '?');
	if (!query)
		return "it has no ?ttl=N; ttl=0 stays on this host";
	wrong = group_read(&ret->group, at, (size_t)(query - at));
	return wrong ? wrong : ttl_read(&ret->ttl, query + 1);
}

/* -- The socket ----------------------------------------------------------- */

static int set(int fd, int level, int option, int value)
{
	return setsockopt(fd, level, option, &value, sizeof(value));
}

static int join(int fd, const struct udpm_url *url)
{
	struct ip_mreq group = { .imr_multiaddr = url->group.sin_addr };

	if (set(fd, SOL_SOCKET, SO_REUSEADDR, 1) < 0 ||
	    set(fd, IPPROTO_IP, IP_MULTICAST_ALL, 0) < 0)
		return -errno;
	set(fd, SOL_SOCKET, SO_RCVBUF, BUFFER_BYTES);
	/* Bound to the group, the socket does not get packets sent to one
	 * host. */
	if (bind(fd, (const struct sockaddr *)&url->group,
		 sizeof(url->group)) < 0 ||
	    setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group,
		       sizeof(group)) < 0)
		return -errno;
	return 0;
}

int udpm_open(struct udpm **ret, const struct udpm_url *url)
{
	struct udpm *u = calloc(1, sizeof(*u));
	int err;

	if (!u)
		return -ENOMEM;
	u->only_here = url->ttl == 0;
	u->group = url->group;
	u->fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	u->out = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	err = u->fd < 0 || u->out < 0 ? -errno : join(u->fd, url);
	if (err == 0 &&
	    set(u->out, IPPROTO_IP, IP_MULTICAST_TTL, (int)url->ttl) < 0)
		err = -errno;
	if (err < 0) {
		udpm_close(u);
		return err;
	}
	*ret = u;
	return 0;
}

/* -- What is left in the kernel ------------------------------------------- */

/* The kernel's filter sees a packet with its UDP header in front. */
#define UDP_BYTES	8
#define FILTER_MAX	512

struct filter {
	struct sock_filter step[FILTER_MAX];
	int n;
};

static void step(struct filter *f, unsigned int code, uint32_t k, int unlike)
{
	if (f->n < FILTER_MAX)
		f->step[f->n] = (struct sock_filter) {
			.code = (uint16_t)code, .k = k, .jf = (uint8_t)unlike,
		};
	f->n++;
}

/* Take the packet if its channel is this one, with its NUL; else go on behind
 * these steps. */
static void step_channel(struct filter *f, const char *channel)
{
	const int size = (int)strlen(channel) + 1;

	for (int i = 0; i < size; i++) {
		step(f, BPF_LD | BPF_B | BPF_ABS,
		     (uint32_t)(UDP_BYTES + HEAD_BYTES + i), 0);
		step(f, BPF_JMP | BPF_JEQ | BPF_K, (uint8_t)channel[i],
		     2 * (size - i) - 1);
	}
	step(f, BPF_RET | BPF_K, UINT32_MAX, 0);
}

/* What is none of LCM's short packets is taken, and counted as strange. */
void udpm_choose(struct udpm *u, const char *const channel[], int n)
{
	struct filter f = { .n = 0 };
	struct sock_fprog program;

	step(&f, BPF_LD | BPF_W | BPF_LEN, 0, 0);
	step(&f, BPF_JMP | BPF_JGT | BPF_K, UDP_BYTES + HEAD_BYTES, 2);
	step(&f, BPF_LD | BPF_W | BPF_ABS, UDP_BYTES, 0);
	step(&f, BPF_JMP | BPF_JEQ | BPF_K, SHORT_MAGIC, 0);
	f.step[3].jt = 1;
	step(&f, BPF_RET | BPF_K, UINT32_MAX, 0);
	for (int i = 0; i < n; i++)
		step_channel(&f, channel[i]);
	step(&f, BPF_RET | BPF_K, 0, 0);
	if (f.n > FILTER_MAX)
		return;
	program = (struct sock_fprog) {
		.len = (unsigned short)f.n, .filter = f.step,
	};
	setsockopt(u->fd, SOL_SOCKET, SO_ATTACH_FILTER, &program,
		   sizeof(program));
}

void udpm_why(const struct udpm_url *url, int err, char *to, size_t size)
{
	const unsigned int port = ntohs(url->group.sin_port);

	if (err == -EADDRINUSE)
		snprintf(to, size, "another program holds port %u and does not "
			 "share it; ss -ulpn 'sport = :%u' names it; end "
			 "it, or choose another port, in [lcm] url and "
			 "--url",
			 port, port);
	else if (err == -ENODEV || err == -ENETUNREACH ||
		 err == -EADDRNOTAVAIL)
		snprintf(to, size, "this host has no way for multicast; ip "
			 "link set lo multicast on; ip route add 224.0.0.0/4 "
			 "dev lo");
	else
		snprintf(to, size, "%s", strerror(-err));
}

void udpm_close(struct udpm *u)
{
	if (!u)
		return;
	if (u->fd >= 0)
		close(u->fd);
	if (u->out >= 0)
		close(u->out);
	free(u);
}

int udpm_fd(const struct udpm *u)
{
	return u->fd;
}

/* -- Whose packet it is --------------------------------------------------- */

static void addresses_look(struct udpm *u)
{
	struct ifaddrs *all, *one;

	if (getifaddrs(&all) < 0)
		return;
	u->nhere = 0;
	for (one = all; one && u->nhere < ADDRESSES_MAX; one = one->ifa_next)
		if (one->ifa_addr && one->ifa_addr->sa_family == AF_INET)
			u->here[u->nhere++] = ((const struct sockaddr_in *)
				(const void *)one->ifa_addr)->sin_addr.s_addr;
	freeifaddrs(all);
}

static bool address_is_known(const struct udpm *u, in_addr_t address)
{
	for (int i = 0; i < u->nhere; i++)
		if (u->here[i] == address)
			return true;
	return false;
}

/*
 * A packet that leaves by an interface without an address, such as a loopback,
 * has no source address.  From outside, the kernel accepts such a packet only
 * for the groups 224.0.0.x, which udpm_url_read() refuses.  Interfaces come and
 * go, but they are checked at most once in LOOK_S, so a flood from outside
 * causes no work.
 */
static bool is_here(struct udpm *u, in_addr_t address)
{
	struct timespec now;

	if (address == INADDR_ANY || ntohl(address) >> 24 == IN_LOOPBACKNET ||
	    address_is_known(u, address))
		return true;
	clock_gettime(CLOCK_MONOTONIC, &now);
	if (u->looked_s && now.tv_sec - u->looked_s <= LOOK_S)
		return false;
	u->looked_s = now.tv_sec;
	addresses_look(u);
	return address_is_known(u, address);
}

static void name_sender(char to[UDPM_FROM_MAX], const struct sockaddr_in *from)
{
	char text[INET_ADDRSTRLEN];

	inet_ntop(AF_INET, &from->sin_addr, text, sizeof(text));
	snprintf(to, UDPM_FROM_MAX, "%s:%u", text, ntohs(from->sin_port));
}

bool udpm_split(struct udpm_packet *ret, const uint8_t *packet, size_t bytes)
{
	const uint8_t *end;
	uint32_t magic;

	if (bytes <= HEAD_BYTES)
		return false;
	memcpy(&magic, packet, sizeof(magic));
	end = memchr(packet + HEAD_BYTES, '\0', bytes - HEAD_BYTES);
	if (ntohl(magic) != SHORT_MAGIC || !end)
		return false;
	ret->channel = (const char *)packet + HEAD_BYTES;
	ret->data = end + 1;
	ret->size = (size_t)(packet + bytes - ret->data);
	return true;
}

bool udpm_take(struct udpm *u, struct udpm_packet *ret)
{
	struct sockaddr_in from = { .sin_family = AF_INET };
	socklen_t size = sizeof(from);
	ssize_t n = recvfrom(u->fd, u->packet, UDPM_PACKET_MAX, 0,
			     (struct sockaddr *)&from, &size);

	if (n < 0)
		return false;
	if ((!u->only_here || is_here(u, from.sin_addr.s_addr)) &&
	    udpm_split(ret, u->packet, (size_t)n)) {
		name_sender(ret->from, &from);
		return true;
	}
	u->strange++;
	name_sender(u->strange_from, &from);
	return false;
}

/* The number behind the magic counts packets for LCM's own reader, which does
 * not look at it. */
void udpm_parts(struct iovec to[UDPM_PARTS], const char *channel,
		const void *data, size_t size)
{
	static const uint8_t head[HEAD_BYTES] = "LC02";

	to[0] = (struct iovec) { (void *)(uintptr_t)head, sizeof(head) };
	to[1] = (struct iovec) { (void *)(uintptr_t)channel,
				 strlen(channel) + 1 };
	to[2] = (struct iovec) { (void *)(uintptr_t)data, size };
}

void udpm_send(const struct udpm *u, const char *channel, const void *data,
	       size_t size)
{
	struct iovec parts[UDPM_PARTS];
	struct sockaddr_in to = u->group;
	const struct msghdr m = {
		.msg_name = &to, .msg_namelen = sizeof(to),
		.msg_iov = parts, .msg_iovlen = UDPM_PARTS,
	};

	udpm_parts(parts, channel, data, size);
	sendmsg(u->out, &m, MSG_NOSIGNAL);
}

uint64_t udpm_strange(const struct udpm *u, const char **ret_from)
{
	*ret_from = u->strange_from;
	return u->strange;
}
