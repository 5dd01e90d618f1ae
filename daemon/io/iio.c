/* SPDX-License-Identifier: Apache-2.0 */
/*
 * iio.c - read and write the files of a device of industrial I/O
 */
#include "iio.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool iio_line(const char *path, char *ret, size_t size)
{
	FILE *f = fopen(path, "re");
	bool ok;

	if (!f)
		return false;
	ok = fgets(ret, (int)size, f) != NULL;
	fclose(f);
	if (ok)
		ret[strcspn(ret, "\n")] = '\0';
	return ok;
}

bool iio_put(const char *path, const char *text)
{
	const int fd = open(path, O_WRONLY | O_CLOEXEC);
	bool ok;

	if (fd < 0)
		return false;
	ok = write(fd, text, strlen(text)) == (ssize_t)strlen(text);
	return close(fd) == 0 && ok;
}

static bool has_name(const char *sysfs, const char *folder, const char *device)
{
	char path[160], name[64];

	snprintf(path, sizeof(path), "%s/%.60s/name", sysfs, folder);
	return iio_line(path, name, sizeof(name)) && strcmp(name, device) == 0;
}

int iio_find(const char *sysfs, const char *device, char *ret, size_t size)
{
	struct dirent *e;
	bool itself = false;
	int n = 0;
	DIR *d = opendir(sysfs);

	while (d && !itself && (e = readdir(d))) {
		if (strncmp(e->d_name, "iio:device", 10) != 0)
			continue;
		itself = strcmp(e->d_name, device) == 0;
		if (!itself && !has_name(sysfs, e->d_name, device))
			continue;
		n++;
		snprintf(ret, size, "%.60s", e->d_name);
	}
	if (d)
		closedir(d);
	return n == 1 || itself ? 0 : n ? -ENOTUNIQ : -ENODEV;
}

double iio_number(const char *dir, const char *kind, uint32_t channel,
		  const char *what, double otherwise)
{
	char path[160], text[64], *end;
	double x;

	snprintf(path, sizeof(path), "%s/%s%u_%s", dir, kind, channel, what);
	if (!iio_line(path, text, sizeof(text))) {
		snprintf(path, sizeof(path), "%s/%s_%s", dir, kind, what);
		if (!iio_line(path, text, sizeof(text)))
			return otherwise;
	}
	x = strtod(text, &end);
	return end == text ? NAN : x;
}
