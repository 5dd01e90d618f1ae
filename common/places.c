/* SPDX-License-Identifier: Apache-2.0 */
/* places.c - where the programs of one host find each other */
#include "places.h"

#include "names.h"

#include <errno.h>
#include <glob.h>
#include <pwd.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#define ANYBODY	"/dev/shm"

/* What begins with the first word is in the folder; the last row is for all
 * else. */
static const struct place {
	const char *what, *folder, *service;
} places[] = {
	{ "jobs",	"/run/edmd-jobs",	PLACES_JOBS },
	{ "stop",	"/run/edmd",		PLACES_EDMD },
	{ "writer",	ANYBODY "/edmd-jobs",	PLACES_JOBS },
	{ "program.",	ANYBODY "/edmd-jobs",	PLACES_JOBS },
	{ "",		ANYBODY "/edmd",	PLACES_EDMD },
};

bool places_is_trusted(uid_t uid, const char *service)
{
	struct passwd entry, *made = NULL;
	char names[4096];

	if (uid == 0 || uid == geteuid())
		return true;
	return getpwnam_r(service, &entry, names, sizeof(names), &made) == 0 &&
	       made && uid == made->pw_uid;
}

static const struct place *place_of(const char *what)
{
	const struct place *p = places;

	while (strncmp(what, p->what, strlen(p->what)) != 0)
		p++;
	return p;
}

static const char *folder_of(const struct place *p)
{
	struct stat st;

	if (lstat(p->folder, &st) == 0 && S_ISDIR(st.st_mode) &&
	    !(st.st_mode & 0022) && places_is_trusted(st.st_uid, p->service))
		return p->folder;
	return ANYBODY;
}

int places_path(char to[PLACES_PATH_MAX], const char *machine,
		const char *what)
{
	if (!names_machine_ok(machine))
		return -EINVAL;
	snprintf(to, PLACES_PATH_MAX, "%s/edmd.%.31s.%s",
		 folder_of(place_of(what)), machine, what);
	return 0;
}

int places_address(struct sockaddr_un *to, const char *machine,
		   const char *what)
{
	char path[PLACES_PATH_MAX];
	const int err = places_path(path, machine, what);

	if (err < 0)
		return err;
	*to = (struct sockaddr_un) { .sun_family = AF_UNIX };
	snprintf(to->sun_path, sizeof(to->sun_path), "%s", path);
	return 0;
}

/* The mode of a new socket comes from the umask, which is the program's. */
static int bind_at(int fd, const struct sockaddr_un *at)
{
	if (unlink(at->sun_path) < 0 && errno != ENOENT)
		return -errno;
	if (bind(fd, (const struct sockaddr *)at, sizeof(*at)) < 0 ||
	    chmod(at->sun_path, 0660) < 0)
		return -errno;
	return 0;
}

int places_listen(const struct sockaddr_un *at, int type)
{
	const int fd = socket(AF_UNIX, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	int err = fd < 0 ? -errno : bind_at(fd, at);

	if (err == 0 && type != SOCK_DGRAM && listen(fd, 64) < 0)
		err = -errno;
	if (err == 0)
		return fd;
	if (fd >= 0)
		close(fd);
	return err;
}

static int peer_check(int fd, const char *service)
{
	struct ucred peer;
	socklen_t size = sizeof(peer);

	if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) < 0)
		return -errno;
	return places_is_trusted(peer.uid, service) ? 0 : -EPERM;
}

int places_connect(const struct sockaddr_un *at, const char *service)
{
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC |
			      SOCK_NONBLOCK, 0);
	int err;

	if (fd < 0)
		return -errno;
	err = connect(fd, (const struct sockaddr *)at, sizeof(*at)) < 0 ?
	      -errno : peer_check(fd, service);
	if (err == 0)
		return fd;
	close(fd);
	return err;
}

/* The machine's name in a path as places_path() makes them; "" if it is not
 * one. */
static void name_take(char to[NAMES_MACHINE_MAX], const char *path,
		      const char *what)
{
	const char *from = strrchr(path, '/') + strlen("/edmd.");
	const size_t n = strlen(from) - strlen(what) - 1;

	to[0] = '\0';
	if (n >= NAMES_MACHINE_MAX)
		return;
	memcpy(to, from, n);
	to[n] = '\0';
	if (!names_machine_ok(to))
		to[0] = '\0';
}

void places_each(const char *what, void (*fn)(void *arg, const char *machine),
		 void *arg)
{
	char pattern[PLACES_PATH_MAX], name[NAMES_MACHINE_MAX];
	glob_t found;

	snprintf(pattern, sizeof(pattern), "%s/edmd.*.%s",
		 folder_of(place_of(what)), what);
	if (glob(pattern, 0, NULL, &found) != 0)
		return;
	for (size_t i = 0; i < found.gl_pathc; i++) {
		name_take(name, found.gl_pathv[i], what);
		if (*name)
			fn(arg, name);
	}
	globfree(&found);
}
