/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_eds.c - compare the set-up of a drive with its EDS (CiA 306)
 *
 * A step is refused only if the EDS is clear: the object or sub-index is not
 * there, it is read-only, or the value is outside of its limits.  All else is
 * left to the drive itself.
 *
 * An EDS may be compact: with CompactSubObj, the section of an object describes
 * all its sub-indices; with CompactPDO, the objects of PDOs are left out.
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

/* What one section says. */
struct entry {
	bool found, has_low, has_high;
	long long low, high;
	char access[8];
};

struct object {
	struct drive_write want;
	bool reads, limited;		/* limits are compared */
	struct entry own, whole;	/* of its section, of all sub-indices */
	long long compact;		/* sub-indices that whole describes */
};

struct eds {
	struct object object[OBJECTS_MAX];
	size_t n;
	uint8_t node;
	bool compact_pdo;
};

/* "1A00sub3" or "6040". */
static struct entry *entry_of(struct object *o, const char *section)
{
	char name[16];

	snprintf(name, sizeof(name), "%04Xsub%X", o->want.index, o->want.sub);
	if (strcasecmp(section, name) == 0)
		return &o->own;
	snprintf(name, sizeof(name), "%04X", o->want.index);
	if (strcasecmp(section, name) != 0)
		return NULL;
	return o->want.sub == 0 ? &o->own : &o->whole;
}

static const struct entry *said_of(const struct object *o)
{
	return !o->own.found && o->compact >= o->want.sub ? &o->whole : &o->own;
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

static void take(struct entry *to, uint8_t node, const char *name,
		 const char *value)
{
	to->found = true;
	if (strcasecmp(name, "AccessType") == 0)
		snprintf(to->access, sizeof(to->access), "%s", value);
	else if (strcasecmp(name, "LowLimit") == 0)
		to->has_low = number(value, node, &to->low);
	else if (strcasecmp(name, "HighLimit") == 0)
		to->has_high = number(value, node, &to->high);
}

static int on_key(void *user, const char *section, const char *name,
		  const char *value)
{
	struct eds *e = user;
	long long x;

	/* A line without a = is one without a value, or none at all: it depends
	 * on how the library was built. */
	if (!value)
		return 1;
	if (strcasecmp(name, "CompactPDO") == 0 && number(value, 0, &x))
		e->compact_pdo = x != 0;
	for (size_t i = 0; i < e->n; i++) {
		struct object *o = &e->object[i];
		struct entry *to = entry_of(o, section);

		if (!to)
			continue;
		take(to, e->node, name, value);
		if (strcasecmp(name, "CompactSubObj") == 0 &&
		    number(value, 0, &x))
			o->compact = x;
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

/*
 * The limits of a signed object may be written as -128 and 127, or as 0x80 and
 * 0x7f.
 */
static bool is_outside(const struct object *o, const struct entry *e)
{
	const int bits = 8 * o->want.bytes;
	const bool turned = e->has_low && e->has_high && e->low > e->high;
	const long long low = turned ? e->low - (1LL << bits) : e->low;
	/* Limits below 0 make the value a signed one. */
	const long long x = e->has_low && low < 0 && o->want.bytes == 4 ?
			    (int32_t)o->want.value : (long long)o->want.value;

	if (!o->limited || (turned && low > e->high))
		return false;
	return (e->has_low && x < low) ||
	       (e->has_high && (!e->has_low || e->high > low) && x > e->high);
}

static bool is_pdo(const struct object *o)
{
	return o->want.index >= 0x1400 && o->want.index < 0x1c00;
}

/* Return: NULL: the EDS has nothing against it. */
static const char *against(const struct eds *eds, const struct object *o)
{
	const struct entry *e = said_of(o);

	if (!e->found)
		return eds->compact_pdo && is_pdo(o) ? NULL : "it is not there";
	if (o->reads)
		return NULL;
	if (o->limited && (strcasecmp(e->access, "ro") == 0 ||
			   strcasecmp(e->access, "const") == 0))
		return "it is read-only";
	return is_outside(o, e) ? "its limits are others" : NULL;
}

/* A line that cannot be read does no harm, but a file without any object is
 * none. */
static bool has_objects(const struct eds *e)
{
	size_t i = 0;

	while (i < e->n && !e->object[i].own.found && !e->object[i].whole.found)
		i++;
	return i < e->n;
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
	if (line < 0 || !has_objects(&e)) {
		interp_diag_say(diag, "%s: %s; the EDS of the drive, as its "
				      "maker has it", path, line < 0 ?
				strerror(errno) : "not the lines of an EDS");
		return line < 0 ? -ENOENT : -EINVAL;
	}
	for (size_t i = 0; i < e.n; i++) {
		const char *why = against(&e, &e.object[i]);

		if (why)
			return refuse(diag, path, &e.object[i], why);
	}
	return 0;
}
