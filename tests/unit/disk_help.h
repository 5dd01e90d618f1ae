/* SPDX-License-Identifier: Apache-2.0 */
/*
 * disk_help.h - a disk that fails at a chosen write, or is cut off there
 *
 * It is a VFS of SQLite in front of the real one, and the default.  It counts
 * the calls that change the disk (writes, syncs, truncations).  From number
 * `fail_from` on it refuses them with `fail_rc`.  If `snoop` is set, it is
 * called before each of them.
 */
#ifndef DISK_HELP_H
#define DISK_HELP_H

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct disk_help {
	long n;				/* changes so far */
	long fail_from;			/* -1: never */
	int fail_rc;
	bool unread;			/* it cannot be read either */
	int64_t bytes;			/* written */
	/* Before @bytes go to @path at @at; sync, truncate: bytes -1. */
	void (*snoop)(const char *path, const void *data, int bytes,
		      int64_t at);
	sqlite3_vfs *real;
	sqlite3_vfs vfs;
};

static struct disk_help disk = { .fail_from = -1 };

struct disk_file {
	sqlite3_file base;
	const char *path;
	sqlite3_file *real;
};

#define REAL(f)	(((struct disk_file *)(f))->real)

static int disk_change(sqlite3_file *f, const void *data, int n, int64_t at)
{
	const char *path = ((struct disk_file *)f)->path;

	if (disk.fail_from >= 0 && disk.n++ >= disk.fail_from)
		return disk.fail_rc;
	if (disk.fail_from < 0)
		disk.n++;
	if (disk.snoop && path)
		disk.snoop(path, data, n, at);
	if (n > 0)
		disk.bytes += n;
	return SQLITE_OK;
}

static int disk_close(sqlite3_file *f)
{
	return REAL(f)->pMethods ? REAL(f)->pMethods->xClose(REAL(f)) :
				   SQLITE_OK;
}

static int disk_read(sqlite3_file *f, void *to, int n, sqlite3_int64 at)
{
	return disk.unread ? SQLITE_IOERR_READ :
	       REAL(f)->pMethods->xRead(REAL(f), to, n, at);
}

static int disk_write(sqlite3_file *f, const void *from, int n,
		      sqlite3_int64 at)
{
	const int rc = disk_change(f, from, n, at);

	return rc ? rc : REAL(f)->pMethods->xWrite(REAL(f), from, n, at);
}

static int disk_truncate(sqlite3_file *f, sqlite3_int64 size)
{
	const int rc = disk_change(f, NULL, -1, size);

	return rc ? rc : REAL(f)->pMethods->xTruncate(REAL(f), size);
}

/* The tests' file system need not reach its disk. */
static int disk_sync(sqlite3_file *f, int flags)
{
	(void)flags;
	return disk_change(f, NULL, -1, 0);
}

static int disk_size(sqlite3_file *f, sqlite3_int64 *ret)
{
	return REAL(f)->pMethods->xFileSize(REAL(f), ret);
}

static int disk_lock(sqlite3_file *f, int how)
{
	return REAL(f)->pMethods->xLock(REAL(f), how);
}

static int disk_unlock(sqlite3_file *f, int how)
{
	return REAL(f)->pMethods->xUnlock(REAL(f), how);
}

static int disk_reserved(sqlite3_file *f, int *ret)
{
	return REAL(f)->pMethods->xCheckReservedLock(REAL(f), ret);
}

static int disk_control(sqlite3_file *f, int op, void *arg)
{
	return REAL(f)->pMethods->xFileControl(REAL(f), op, arg);
}

static int disk_sector(sqlite3_file *f)
{
	return REAL(f)->pMethods->xSectorSize(REAL(f));
}

static int disk_traits(sqlite3_file *f)
{
	return REAL(f)->pMethods->xDeviceCharacteristics(REAL(f));
}

static int disk_shm_map(sqlite3_file *f, int i, int n, int extend,
			void volatile **ret)
{
	return REAL(f)->pMethods->xShmMap(REAL(f), i, n, extend, ret);
}

static int disk_shm_lock(sqlite3_file *f, int at, int n, int flags)
{
	return REAL(f)->pMethods->xShmLock(REAL(f), at, n, flags);
}

static void disk_shm_barrier(sqlite3_file *f)
{
	REAL(f)->pMethods->xShmBarrier(REAL(f));
}

static int disk_shm_unmap(sqlite3_file *f, int remove)
{
	return REAL(f)->pMethods->xShmUnmap(REAL(f), remove);
}

static const sqlite3_io_methods disk_methods = {
	2, disk_close, disk_read, disk_write, disk_truncate, disk_sync,
	disk_size, disk_lock, disk_unlock, disk_reserved, disk_control,
	disk_sector, disk_traits, disk_shm_map, disk_shm_lock,
	disk_shm_barrier, disk_shm_unmap, NULL, NULL,
};

static int disk_open(sqlite3_vfs *v, const char *path, sqlite3_file *f,
		     int flags, int *ret_flags)
{
	struct disk_file *d = (struct disk_file *)f;
	int rc;

	(void)v;
	d->path = path;
	d->real = (sqlite3_file *)(d + 1);
	rc = disk.real->xOpen(disk.real, path, d->real, flags, ret_flags);
	d->base.pMethods = d->real->pMethods ? &disk_methods : NULL;
	return rc;
}

static void disk_install(void)
{
	disk.real = sqlite3_vfs_find(NULL);
	disk.vfs = *disk.real;
	disk.vfs.zName = "failing";
	disk.vfs.szOsFile = (int)sizeof(struct disk_file) +
			    disk.real->szOsFile;
	disk.vfs.xOpen = disk_open;
	sqlite3_vfs_register(&disk.vfs, 1);
}

#endif /* DISK_HELP_H */
