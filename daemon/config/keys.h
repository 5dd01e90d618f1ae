/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys.h - the table of machine file keys, and one key's value as text
 *
 * A section with instances, such as [axis.X] ... [axis.V], has its rows once;
 * a row then serves every instance at its own stride.  A key is a row and an
 * instance.  Defaults are text and pass the same parser and range check as
 * the file.
 *
 * Units: a row's unit is that of a linear axis; on a rotary one mm is deg.
 * Threads: startup only.
 */
#ifndef CONFIG_KEYS_H
#define CONFIG_KEYS_H

#include "config.h"

#include <stddef.h>

enum config_section_id {
	SECTION_MACHINE,
	SECTION_AXIS,
	SECTION_WORK,
	SECTION_WIRE,
	SECTION_KINEMATICS,
	SECTION_GAP,
	SECTION_JUMP,
	SECTION_GEOMETRY,
	SECTION_CONTOUR,
	SECTION_PROBE,
	SECTION_SPEED,
	SECTION_CAN402,
	SECTION_GENERATOR,
	SECTION_PLC,
	SECTION_NC,
	SECTION_TECH,
	SECTION_ELECTRODE,
	SECTION_SIM,
	SECTION_GPIO,
	SECTION_LCM,
	SECTION_DDS,
	SECTION_JOBS,
	SECTION_PANEL,
	CONFIG_NSECTIONS
};

enum config_kind {
	KEY_NUMBER,			/* double */
	KEY_WHOLE,			/* double without a fraction */
	KEY_COUNT,			/* uint32_t */
	KEY_ENUM,			/* int, one of word(0), word(1), ... */
	KEY_BIT,			/* yes or no: a bit of a uint32_t */
	KEY_NAME,			/* char[]: letters, digits, - and _ */
	KEY_STRING,			/* char[]: any text without controls */
	KEY_LINE,			/* char[]: as config_line_read() */
};

struct config_section {
	const char *name;
	const char *const *instance;	/* NULL: the section stands alone */
	int ninstances;
	const char *help;
};

struct config_key {
	enum config_section_id section;
	const char *name;
	enum config_kind kind;
	const char *unit;		/* "" if it has none */
	const char *def;		/* as it would stand in the file */
	double min, max;		/* numbers only */
	size_t offset;			/* of instance 0 in machine_config */
	size_t stride;			/* from one instance to the next */
	size_t bytes;			/* text only: room, with its NUL */
	const char *def_rotary;		/* for A B C; NULL: as def */
	const char *def_wire;		/* with process = wire; NULL: as def */
	const char *(*word)(int i);	/* enums only; NULL past the last */
	const char *help;
	bool periods;			/* of a struct cycle_time:
					 * config_cycle() counts its periods */
};

#define CONFIG_NKEYS_MAX	512	/* rows the table may have; asserted */
#define CONFIG_NINSTANCES_MAX	9
#define CONFIG_TEXT_MAX		256	/* of a value, with its NUL */

extern const struct config_section config_section[CONFIG_NSECTIONS];

/** config_key() - row 0, 1, ... of the table; NULL past the last. */
const struct config_key *config_key(int row);

/* Where each key was set: config_lines.at[row][instance]; 0: not at all. */
struct config_lines {
	uint32_t at[CONFIG_NKEYS_MAX][CONFIG_NINSTANCES_MAX];
};

/** config_section_name() - "gap", "axis.X", ... into @buf; returns it. */
const char *config_section_name(enum config_section_id s, int instance,
				char *buf, size_t size);

/**
 * config_section_find() - the section called @name.
 * Return: enum config_section_id, @ret_instance set; or -ENOENT.
 */
int config_section_find(const char *name, int *ret_instance);

/** config_key_find() - its row, for config_key(), or -ENOENT. */
int config_key_find(enum config_section_id s, const char *name);

/** config_key_default() - the text for @instance. */
const char *config_key_default(const struct config_key *k, int instance);

/** config_key_unit() - with a space in front, or "", into @buf. */
const char *config_key_unit(const struct config_key *k, int instance,
			    char *buf, size_t size);

/** config_key_range() - what is accepted, in words, into @buf. */
const char *config_key_range(const struct config_key *k, int instance,
			     char *buf, size_t size);

/** config_key_at() - where @k keeps its value in @c. */
void *config_key_at(const struct config_key *k, int instance,
		    struct machine_config *c);
const void *config_key_in(const struct config_key *k, int instance,
			  const struct machine_config *c);

/**
 * config_key_parse() - put @text into @c.
 * Return: 0, or -EINVAL with @diag's found and wanted filled.
 */
int config_key_parse(const struct config_key *k, int instance,
		     const char *text, struct machine_config *c,
		     struct interp_diag *diag);

/** config_key_format() - the value in @c, as config_key_parse() takes it. */
const char *config_key_format(const struct config_key *k, int instance,
			      const struct machine_config *c, char *buf,
			      size_t size);

/** config_number() - shortest decimal that reads back as @x, into @buf. */
const char *config_number(double x, char *buf, size_t size);

/**
 * config_check() - what one key alone cannot tell: orders and extents.
 * Return: 0, or -EINVAL with @diag filled, the line from @lines.
 */
int config_check(const struct machine_config *c,
		 const struct config_lines *lines, struct interp_diag *diag);

/**
 * config_maps_read() - the files that `pitch_map` and `[geometry] maps` name.
 * Return: 0, or -EINVAL with @diag filled: the machine file's line, and in its
 * text the map's line and column.
 */
int config_maps_read(struct machine_config *c,
		     const struct config_lines *lines,
		     struct interp_diag *diag);

/** config_check_home() - whether the backend can do each home_method. */
int config_check_home(const struct machine_config *c,
		      const struct config_lines *lines,
		      struct interp_diag *diag);

/** config_check_gpio() - the same for [gpio], if it is the backend. */
int config_check_gpio(const struct machine_config *c,
		      const struct config_lines *lines,
		      struct interp_diag *diag);

/** config_check_brakes() - what [gpio] has beside drives on a bus. */
int config_check_brakes(const struct machine_config *c,
			const struct config_lines *lines,
			struct interp_diag *diag);

/** config_check_sim() - the same for [sim] alone, and for what it senses. */
int config_check_sim(const struct machine_config *c,
		     const struct config_lines *lines,
		     struct interp_diag *diag);

/** config_check_can402() - the same for [can402] and its drives. */
int config_check_can402(const struct machine_config *c,
			const struct config_lines *lines,
			struct interp_diag *diag);

/** config_frame_is_free() - may a frame on the drives' bus that is no drive's
 *  have the identifier @id?  Those of CiA 301 belong to NMT, SYNC and the
 *  drives. */
bool config_frame_is_free(const struct machine_config *c, uint32_t id);

#define CONFIG_FRAME_WANTED	"one from 384 to 1407 whose rest by 128 is " \
				"no drive's node"

/** config_check_generator() - the same for [generator]. */
int config_check_generator(const struct machine_config *c,
			   const struct config_lines *lines,
			   struct interp_diag *diag);

/** config_check_unused() - the same for keys of [generator] that its interface
 *  does not have. */
int config_check_unused(const struct machine_config *c,
			const struct config_lines *lines,
			struct interp_diag *diag);

/**
 * config_way_read() - the text of a way that is not "auto".
 * Return: NULL, or what is wrong with it, as "has no byte".
 */
const char *config_way_read(const char *text, int field,
			    struct config_way *ret);

/** config_way_all() - all that the machine file and a table may say. */
void config_way_all(int field, bool by_hand, struct process_delivers *ret);

#define CONFIG_WAY_WORD	40

/** config_hand_read() - the fields of by_hand, a bit each; @odd gets the first
 *  word that is none, or is there twice, or "". */
uint32_t config_hand_read(const char *text, char odd[CONFIG_WAY_WORD]);

/** config_fault_read() - what is wrong with fault_words, or NULL.  @most: the
 *  highest number that the generator tells. */
const char *config_fault_read(const char *words, double most);

/** config_plc_pulse() - can a PLC set this field, or tell it? */
bool config_plc_pulse(int field);

/** config_generator_gpio() - does [gpio] have a line for this field? */
bool config_generator_gpio(const struct machine_config *c, int field);

/** config_check_plc() - the same for [plc]. */
int config_check_plc(const struct machine_config *c,
		     const struct config_lines *lines,
		     struct interp_diag *diag);

#endif /* CONFIG_KEYS_H */
