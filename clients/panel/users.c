/* SPDX-License-Identifier: Apache-2.0 */
/*
 * users.c - the file of users, and the users of this host
 */
#include "session.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <libgen.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define GROUPS_MAX	256
#define LINE_MAX_BYTES	320
#define SERVICE_USER	"edm-panel"

/* Return: 0; -ESRCH for a line of nobody; -EBADMSG. */
static int read_line(const char *text, struct session_user *ret)
{
	char role[16];

	if (text[strspn(text, " \t\n")] == '\0' || text[0] == '#')
		return -ESRCH;
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
	int err = -ESRCH;

	if (!f)
		return -errno;
	while (err == -ESRCH && fgets(text, sizeof(text), f)) {
		err = read_line(text, ret);
		if (err == 0 && strcmp(ret->name, name) != 0)
			err = -ESRCH;
	}
	if (ferror(f))
		err = -errno;
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

/* The service reads the file and does not write it. */
static int give_to_service(int fd, const char *path)
{
	const struct passwd *service = getpwnam(SERVICE_USER);
	char folder[300];
	struct stat st;

	if (geteuid() != 0)
		return 0;
	snprintf(folder, sizeof(folder), "%s", path);
	if (stat(path, &st) < 0 && stat(dirname(folder), &st) < 0)
		return -errno;
	if (fchown(fd, st.st_uid, service ? service->pw_gid : st.st_gid) < 0 ||
	    fchmod(fd, service ? 0640 : 0600) < 0)
		return -errno;
	return 0;
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
	err = give_to_service(fd, path);
	to = err ? NULL : fdopen(fd, "w");
	if (!to) {
		close(fd);
		return err ? err : -ENOMEM;
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
