/* SPDX-License-Identifier: Apache-2.0 */
/*
 * places.h - where the programs of one host find each other
 *
 * Each service makes what others shall find in a folder of its own, which the
 * host makes when it boots (systemd/edmd.tmpfiles):
 *
 *	jobs			/run/edmd-jobs	a socket of edmd-jobs, for
 *						clients
 *	stop			/run/edmd	a socket of edmd, for acts that
 *						end motion
 *	writer, program.<n>	/dev/shm/edmd-jobs
 *	all others		/dev/shm/edmd
 *
 * Where there is no such folder, as in a container or in a tree that is not
 * installed, the place is /dev/shm, where anybody may make a file.  So whoever
 * opens one looks at who made it: places_is_trusted().
 *
 * Threads: any.
 */
#ifndef COMMON_PLACES_H
#define COMMON_PLACES_H

#include <stdbool.h>
#include <sys/types.h>
#include <sys/un.h>

#define PLACES_PATH_MAX	96		/* with its NUL; fits a socket's
					 * address */
#define PLACES_EDMD	"edmd"		/* users of the services */
#define PLACES_JOBS	"edm-jobs"

/**
 * places_path() - "FOLDER/edmd.<machine>.<what>"; -EINVAL for a bad name.
 *
 * A folder counts if it belongs to its service, root or this user, and nobody
 * else may write in it.
 */
int places_path(char to[PLACES_PATH_MAX], const char *machine,
		const char *what);

/** places_address() - the same, as the address of a socket. */
int places_address(struct sockaddr_un *to, const char *machine,
		   const char *what);

/**
 * places_listen() - a socket of @type there, for its owner and its group; one
 * that is left from before is replaced.  Return: a descriptor that does not
 * block, or -errno.
 */
int places_listen(const struct sockaddr_un *at, int type);

/**
 * places_connect() - to the SOCK_SEQPACKET at @at, if the user @service, root
 * or this user listens.  Return: a descriptor that does not block; -EPERM:
 * somebody else does; else -errno.
 */
int places_connect(const struct sockaddr_un *at, const char *service);

/**
 * places_each() - call @fn with the name of each machine of which @what is on
 * this host.  Who made it is not looked at: the names are a hint.
 */
void places_each(const char *what, void (*fn)(void *arg, const char *machine),
		 void *arg);

/** places_is_trusted() - is @uid root, the user @service, or this user? */
bool places_is_trusted(uid_t uid, const char *service);

#endif /* COMMON_PLACES_H */
