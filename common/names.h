/* SPDX-License-Identifier: Apache-2.0 */
/*
 * names.h - the rule for the name of a machine, and lists of words
 *
 * Threads: any.
 */
#ifndef COMMON_NAMES_H
#define COMMON_NAMES_H

#include <stdbool.h>
#include <stddef.h>

/* A machine's name is part of file and channel names. */
#define NAMES_MACHINE_MAX	32	/* with its NUL */
#define NAMES_MACHINE_WANTED	"1 to 31 of A-Z a-z 0-9 _ -"

/** names_machine_ok() - may a machine have this name? */
bool names_machine_ok(const char *name);

/**
 * names_join() - "a, b or c": @word(0), @word(1), ... up to NULL, into @buf.
 * Return: @buf.
 */
const char *names_join(const char *(*word)(int i), char *buf, size_t size);

#endif /* COMMON_NAMES_H */
