/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_lines.c - a generator's values on lines of GPIO chips
 *
 * All lines of a chip are one request, and one write when any of them changes.
 *
 * This is a file of its own because edmsim has no lines.
 */
#include "chips.h"
#include "generator_own.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define NCHIPS	4

struct line_chip {
	char name[96];
	struct lines_chip *chip;
	struct lines *lines;
	unsigned int offset[LINES_MAX];
	uint8_t level[LINES_MAX];
	size_t n;
};

struct generator_lines {
	struct line_chip chip[NCHIPS];
	int nchips;
	bool due;			/* a chip did not take its levels */
	struct {
		uint8_t chip, slot;
	} at[PROCESS_NFIELDS][CONFIG_WAY_LINES];
};

static bool is_on(const struct generator *g, int field, int line)
{
	const struct config_way *w = &g->way[field];
	const double v = g->value[field];

	if (w->ncodes)
		return generator_code(w, v) >> line & 1;
	return field == INTERP_TECH_POLARITY ? v < 0 : v > 0;
}

static bool levels(struct generator *g, bool off)
{
	struct generator_lines *l = g->lines;
	bool changed = false;

	for (int i = 0; i < PROCESS_NFIELDS; i++) {
		const struct config_way *w = &g->way[i];

		for (int k = 0; w->kind == WAY_LINES && k < w->nlines; k++) {
			uint8_t *was = &l->chip[l->at[i][k].chip].level
						[l->at[i][k].slot];
			const bool on = !off && is_on(g, i, k);
			const uint8_t level = on != w->line[k].inverted;

			changed = changed || *was != level;
			*was = level;
		}
	}
	return changed;
}

static bool lines_write(struct generator *g)
{
	struct generator_lines *l = g->lines;

	if (!levels(g, false) && !l->due)
		return true;
	l->due = false;
	for (int i = 0; i < l->nchips; i++) {
		const struct line_chip *c = &l->chip[i];

		l->due = lines_set(c->lines, c->level) < 0 || l->due;
	}
	return !l->due;
}

static void lines_close(struct generator_lines *l)
{
	for (int i = 0; i < l->nchips; i++) {
		lines_release(l->chip[i].lines);
		if (l->chip[i].chip)
			lines_chip_close(l->chip[i].chip);
	}
	free(l);
}

static int chip_find(struct generator_lines *l, const char *name,
		     const char *key, struct interp_diag *diag)
{
	struct line_chip *c = &l->chip[l->nchips];
	int err;

	for (int i = 0; i < l->nchips; i++)
		if (strcmp(l->chip[i].name, name) == 0)
			return i;
	if (l->nchips == NCHIPS) {
		interp_diag_say(diag, "%s: a fifth chip; lines on at most four "
				"chips", key);
		return -E2BIG;
	}
	err = lines_chip_named(&c->chip, name);
	if (err < 0)
		return lines_chip_refuse(diag, err, key, name);
	snprintf(c->name, sizeof(c->name), "%s", name);
	return l->nchips++;
}

static int line_place(struct generator *g, const struct machine_config *c,
		      int field, int k, struct interp_diag *diag)
{
	struct generator_lines *l = g->lines;
	const struct config_line_at *at = &g->way[field].line[k];
	struct line_chip *chip;
	char key[48];
	int i, err;

	snprintf(key, sizeof(key), "generator.%s", process_name(field));
	i = chip_find(l, *at->chip ? at->chip : c->gpio.chip, key, diag);
	if (i < 0)
		return i;
	chip = &l->chip[i];
	err = lines_chip_offers(chip->chip, chip->name, &(struct lines_use) {
		.offset = at->offset, .key = key,
	}, diag);
	if (err < 0)
		return err;
	l->at[field][k].chip = (uint8_t)i;
	l->at[field][k].slot = (uint8_t)chip->n;
	chip->offset[chip->n++] = at->offset;
	return 0;
}

_Static_assert(PROCESS_NFIELDS * CONFIG_WAY_LINES <= LINES_MAX,
	       "all of them may be on one chip");

static int request(struct line_chip *c, struct interp_diag *diag)
{
	const struct lines_wanted w = {
		.offset = c->offset, .value = c->level, .n = c->n,
		.output = true,
	};
	const int err = lines_request(&c->lines, c->chip, &w);

	return err < 0 ? lines_chip_refuse(diag, err, "generator", c->name) : 0;
}

int generator_lines_open(struct generator *g, const struct machine_config *c,
			 struct interp_diag *diag)
{
	int err = 0;

	g->lines = calloc(1, sizeof(*g->lines));
	if (!g->lines)
		return -ENOMEM;
	g->lines_write = lines_write;
	g->lines_close = lines_close;
	for (int i = 0; i < PROCESS_NFIELDS && err == 0; i++) {
		const struct config_way *w = &g->way[i];

		for (int k = 0; w->kind == WAY_LINES && k < w->nlines &&
				err == 0; k++)
			err = line_place(g, c, i, k, diag);
	}
	levels(g, true);
	for (int i = 0; i < g->lines->nchips && err == 0; i++)
		err = request(&g->lines->chip[i], diag);
	return err;
}
