/* SPDX-License-Identifier: Apache-2.0 */
/*
 * users.c - the file of users, and the users of this host
 */
#include "session.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#define GROUPS_MAX	256
#define LINE_MAX_BYTES	320

/* Return: 0; -ENOENT for a line of nobody; -EBADMSG. */
static int read_line(const char *text, struct session_user *ret)
{
	char role[16];

	if (text[strspn(text, " \t\n")] == '\0' || text[0] == '#')
		return -ENOENT;
	if (sscanf(text, "%31s %15s %159s", ret->name, role, ret->hash) != 3)
		return -EBADMSG;
	ret->role = role_parse(role);
	return ret->role == ROLE_NONE ? -EBADMSG : 0;
}

int session_user_find(const char *path, const char *name,
		      struct session_user *ret)
{
	FILE *f = fopen(path, "re");
	char text[LINE_MAX_BYTES];
	int err = -ENOENT;

	if (!f)
		return -errno;
	while (err == -ENOENT && fgets(text, sizeof(text), f)) {
		err = read_line(text, ret);
		if (err == 0 && strcmp(ret->name, name) != 0)
			err = -ENOENT;
	}
	fclose(f);
	return err;
}

static void copy_others(FILE *from, FILE *to, const char *name)
{
	struct session_user u;
	char text[LINE_MAX_BYTES];

	while (fgets(text, sizeof(text), from))
		if (read_line(text, &u) != 0 || strcmp(u.name, name) != 0)
			fputs(text, to);
}

int session_user_put(const char *path, const struct session_user *user)
{
	char made[300];
	FILE *from, *to;
	int fd, err = 0;

	snprintf(made, sizeof(made), "%s.new", path);
	fd = open(made, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	if (fd < 0)
		return -errno;
	to = fdopen(fd, "w");
	if (!to) {
		close(fd);
		return -ENOMEM;
	}
	from = fopen(path, "re");
	if (from) {
		copy_others(from, to, user->name);
		fclose(from);
	}
	fprintf(to, "%s %s %s\n", user->name, role_name(user->role),
		user->hash);
	if (fflush(to) || fsync(fileno(to)))
		err = -errno;
	if (fclose(to) && !err)
		err = -errno;
	if (!err && rename(made, path))
		err = -errno;
	return err;
}

static bool is_in_group(const struct passwd *p, const char *group)
{
	const struct group *g = getgrnam(group);
	gid_t of[GROUPS_MAX];
	int n = GROUPS_MAX;

	if (!g || getgrouplist(p->pw_name, p->pw_gid, of, &n) < 0)
		return false;
	for (int i = 0; i < n; i++)
		if (of[i] == g->gr_gid)
			return true;
	return false;
}

enum role session_local_role(unsigned int uid, enum role most,
			     char ret_name[SESSION_USER_MAX])
{
	const struct passwd *p = getpwuid(uid);

	snprintf(ret_name, SESSION_USER_MAX, "%s", p ? p->pw_name : "?");
	if (uid == 0 || uid == geteuid() || (p && is_in_group(p, "edm")))
		return most;
	return ROLE_VIEWER;
}

/* An address and a port as /proc/net/tcp and tcp6 write them. */
static const char *format_end(char to[48], const struct sockaddr_storage *a)
{
	const struct sockaddr_in *v4 = (const struct sockaddr_in *)a;
	const struct sockaddr_in6 *v6 = (const struct sockaddr_in6 *)a;
	uint32_t word[4];

	if (a->ss_family == AF_INET) {
		snprintf(to, 48, "%08X:%04X", v4->sin_addr.s_addr,
			 ntohs(v4->sin_port));
		return "/proc/net/tcp";
	}
	if (a->ss_family != AF_INET6)
		return NULL;
	memcpy(word, &v6->sin6_addr, sizeof(word));
	if (IN6_IS_ADDR_V4MAPPED(&v6->sin6_addr)) {
		snprintf(to, 48, "%08X:%04X", word[3], ntohs(v6->sin6_port));
		return "/proc/net/tcp";
	}
	snprintf(to, 48, "%08X%08X%08X%08X:%04X", word[0], word[1], word[2],
		 word[3], ntohs(v6->sin6_port));
	return "/proc/net/tcp6";
}

/* Find the file that has the row of the other end of @fd, and how that file
 * writes the two ends. */
static const char *find_ends(int fd, char peer[48], char own[48])
{
	struct sockaddr_storage a, b;
	socklen_t na = sizeof(a), nb = sizeof(b);

	if (getpeername(fd, (struct sockaddr *)&a, &na) < 0 ||
	    getsockname(fd, (struct sockaddr *)&b, &nb) < 0 ||
	    !format_end(own, &b))
		return NULL;
	return format_end(peer, &a);
}

/*
 * Both ends are compared, because another user may have a connection to
 * somewhere else from the same port. A connection that its user has closed
 * belongs to nobody, and the kernel shows it as root's. So only a connection
 * that is still held counts.
 */
int session_peer_uid(int fd, unsigned int *ret)
{
	char peer[48], own[48], local[48], remote[48], text[320];
	const char *path = find_ends(fd, peer, own);
	FILE *f = path ? fopen(path, "re") : NULL;
	unsigned int state;
	bool found = false;

	while (f && !found && fgets(text, sizeof(text), f))
		found = sscanf(text, " %*d: %47s %47s %x %*s %*s %*s %u",
			       local, remote, &state, ret) == 4 &&
			strcmp(local, peer) == 0 && strcmp(remote, own) == 0 &&
			state == TCP_ESTABLISHED;
	if (f)
		fclose(f);
	return found ? 0 : -ENOENT;
}
