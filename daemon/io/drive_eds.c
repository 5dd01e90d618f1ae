/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_eds.c - compare the set-up of a drive with its EDS (CiA 306)
 *
 * A step is refused only if the EDS is clear: the object or sub-index is not
 * there, it is read-only, or the value is outside of its limits.  All else is
 * left to the drive itself.
 */
#include "drive_steps.h"

#include "interp/diag.h"

#include <errno.h>
#include <ini.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define OBJECTS_MAX	128

struct object {
	struct drive_write want;
	bool reads, limited;		/* limits are compared */
	bool found, has_low, has_high;
	long long low, high;
	char access[8];
};

struct eds {
	struct object object[OBJECTS_MAX];
	size_t n;
	uint8_t node;
};

/* "1A00sub3" or "6040". */
static bool is_section(const struct object *o, const char *section)
{
	char name[16];

	snprintf(name, sizeof(name), "%04Xsub%X", o->want.index, o->want.sub);
	if (strcasecmp(section, name) == 0)
		return true;
	snprintf(name, sizeof(name), "%04X", o->want.index);
	return o->want.sub == 0 && strcasecmp(section, name) == 0;
}

/* A number, or "$NODEID+number". */
static bool number(const char *text, uint8_t node, long long *ret)
{
	char *end;

	*ret = 0;
	if (strncasecmp(text, "$NODEID", 7) == 0) {
		*ret = node;
		text += 7 + strspn(text + 7, " +");
	}
	*ret += strtoll(text, &end, 0);
	return end != text;
}

static int on_key(void *user, const char *section, const char *name,
		  const char *value)
{
	struct eds *e = user;

	for (size_t i = 0; i < e->n; i++) {
		struct object *o = &e->object[i];

		if (!is_section(o, section))
			continue;
		o->found = true;
		if (strcasecmp(name, "AccessType") == 0)
			snprintf(o->access, sizeof(o->access), "%s", value);
		else if (strcasecmp(name, "LowLimit") == 0)
			o->has_low = number(value, e->node, &o->low);
		else if (strcasecmp(name, "HighLimit") == 0)
			o->has_high = number(value, e->node, &o->high);
	}
	return 1;
}

/* Values that depend on what is read are not compared with limits. */
static void collect(struct eds *e, const struct drive_config *c)
{
	struct drive_step s;
	struct drive d;

	drive_init(&d, c);
	e->node = c->node;
	for (; drive_step_due(&d, &s) && e->n < OBJECTS_MAX; d.step++) {
		const uint16_t at = s.write.index;
		const bool hangs = (at >= 0x1400 && at < 0x1c00) ||
				   at == 0x60c2 || at == 0x1005;

		if (s.write.may_miss)
			continue;
		e->object[e->n++] = (struct object) {
			.want = s.write, .reads = s.reads, .limited = !hangs
		};
	}
}

static bool is_outside(const struct object *o)
{
	/* Limits below 0 make the value a signed one. */
	const long long x = o->has_low && o->low < 0 && o->want.bytes == 4 ?
			    (int32_t)o->want.value : (long long)o->want.value;

	return o->limited && ((o->has_low && x < o->low) ||
			      (o->has_high && o->high > o->low && x > o->high));
}

static int refuse(struct interp_diag *d, const char *path,
		  const struct object *o, const char *why)
{
	return interp_diag_say(d, "%s: object %04x:%02x, value %x: %s; a "
				  "drive that has it; or another value in the "
				  "machine file; or drive_leave = %x, if "
				  "something else does its work", path,
				  o->want.index, o->want.sub, o->want.value,
				  why, o->want.index);
}

int drive_eds_check(const char *path, const struct drive_config *c,
		    struct interp_diag *diag)
{
	static struct eds e;
	int line;

	memset(&e, 0, sizeof(e));
	collect(&e, c);
	line = ini_parse(path, on_key, &e);
	if (line != 0) {
		interp_diag_say(diag, "%s: %s; the EDS of the drive, as its "
				      "maker has it", path, line < 0 ?
				strerror(errno) : "not the lines of an EDS");
		return line < 0 ? -ENOENT : -EINVAL;
	}
	for (size_t i = 0; i < e.n; i++) {
		const struct object *o = &e.object[i];

		if (!o->found)
			return refuse(diag, path, o, "it is not there");
		if (!o->reads && (strcasecmp(o->access, "ro") == 0 ||
				  strcasecmp(o->access, "const") == 0) &&
		    o->limited)
			return refuse(diag, path, o, "it is read-only");
		if (!o->reads && is_outside(o))
			return refuse(diag, path, o, "its limits are others");
	}
	return 0;
}
