/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_rows.h - how the rows of keys_*.c are written
 *
 * A row names its section without SECTION_, its key, unit, default and range,
 * where the value is kept, and its line of help.  The place is AT() a field,
 * or of a section with instances EACH() of them.  Private to the files of
 * daemon/config.
 */
#ifndef CONFIG_KEYS_ROWS_H
#define CONFIG_KEYS_ROWS_H

#include "keys.h"

#define ROWS_IN(a)	(sizeof(a) / sizeof((a)[0]))

/* For the word() of an enum whose words are a table. */
#define WORD_OF(words, i) \
	((i) >= 0 && (size_t)(i) < ROWS_IN(words) ? (words)[i] : NULL)

#define AT(field)	offsetof(struct machine_config, field)
#define EACH(first, type)	AT(first), sizeof(type)
#define ROOM(field)	.bytes = sizeof(((struct machine_config *)0)->field)

#define NUMBER(section, key, unit_, def_, low, high, place, what) \
	{ SECTION_##section, key, KEY_NUMBER, unit_, def_, low, high, place, \
	  .help = what }
/* A time that the cycle counts: @field is a struct cycle_time. */
#define PERIODS(section, key, unit_, def_, low, high, field, what) \
	{ SECTION_##section, key, KEY_NUMBER, unit_, def_, low, high, \
	  AT(field.s), .help = what, .periods = true }
#define ROTARY(section, key, unit_, def_, def_abc, low, high, place, what) \
	{ SECTION_##section, key, KEY_NUMBER, unit_, def_, low, high, place, \
	  .def_rotary = def_abc, .help = what }
#define OF_WIRE(section, key, unit_, def_, def_cut, low, high, place, what) \
	{ SECTION_##section, key, KEY_NUMBER, unit_, def_, low, high, place, \
	  .def_wire = def_cut, .help = what }
#define WHOLE(section, key, unit_, def_, low, high, place, what) \
	{ SECTION_##section, key, KEY_WHOLE, unit_, def_, low, high, place, \
	  .help = what }
#define COUNT(section, key, unit_, def_, low, high, place, what) \
	{ SECTION_##section, key, KEY_COUNT, unit_, def_, low, high, place, \
	  .help = what }
#define WORDS(section, key, def_, place, word_, what) \
	{ SECTION_##section, key, KEY_ENUM, "", def_, 0, 0, place, \
	  .word = word_, .help = what }
#define BIT(section, key, def_, place, what) \
	{ SECTION_##section, key, KEY_BIT, "", def_, 0, 0, place, \
	  .help = what }
#define NAME(section, key, def_, field, what) \
	{ SECTION_##section, key, KEY_NAME, "", def_, 0, 0, AT(field), \
	  ROOM(field), .help = what }
#define STRING(section, key, def_, field, what) \
	{ SECTION_##section, key, KEY_STRING, "", def_, 0, 0, AT(field), \
	  ROOM(field), .help = what }

/* config_process_word() - sink, wire; for [gap] and [sim]. */
const char *config_process_word(int i);

/* The rows of one file. */
struct config_keys {
	const struct config_key *row;
	size_t n;
};

extern const struct config_keys config_keys_machine;
extern const struct config_keys config_keys_axis;
extern const struct config_keys config_keys_geometry;
extern const struct config_keys config_keys_gap;
extern const struct config_keys config_keys_bus;
extern const struct config_keys config_keys_generator;
extern const struct config_keys config_keys_sim;
extern const struct config_keys config_keys_gpio;
extern const struct config_keys config_keys_panel;

#endif /* CONFIG_KEYS_ROWS_H */
