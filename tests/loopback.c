/* SPDX-License-Identifier: Apache-2.0 */
/*
 * loopback.c - LD_PRELOAD: multicast goes by loopback, without a route
 *
 * LCM's library leaves the interface to the routes.  Where tests have no
 * network of their own, there may be no route for multicast and no right to
 * make one.  Any socket may name loopback as its interface, and this does so
 * for all of them.  Nothing then leaves the host either, whatever the ttl.
 */
#include <dlfcn.h>
#include <netinet/in.h>
#include <string.h>
#include <stdint.h>
#include <sys/socket.h>

#define REAL(name)	((typeof(&name))(uintptr_t)dlsym(RTLD_NEXT, #name))

int socket(int domain, int type, int protocol)
{
	const struct in_addr lo = { htonl(INADDR_LOOPBACK) };
	const int fd = REAL(socket)(domain, type, protocol);

	if (fd >= 0 && domain == AF_INET && (type & 0xf) == SOCK_DGRAM)
		REAL(setsockopt)(fd, IPPROTO_IP, IP_MULTICAST_IF, &lo,
				 sizeof(lo));
	return fd;
}

int setsockopt(int fd, int level, int name, const void *value, socklen_t size)
{
	struct ip_mreqn join = { 0 };

	if (level != IPPROTO_IP || name != IP_ADD_MEMBERSHIP ||
	    size > sizeof(join) || size < sizeof(struct ip_mreq))
		return REAL(setsockopt)(fd, level, name, value, size);
	memcpy(&join, value, size);
	if (!join.imr_ifindex && join.imr_address.s_addr == INADDR_ANY)
		join.imr_address.s_addr = htonl(INADDR_LOOPBACK);
	return REAL(setsockopt)(fd, level, name, &join, size);
}
