/* SPDX-License-Identifier: Apache-2.0 */
/*
 * press.h - a key of the page that moves an axis while it is pressed
 *
 * The page sends a sign of the press every 40 ms. Each sign is passed on to
 * edmd, which lets the axis go on for a fifth of a second and no longer. A sign
 * names the last answer that the page has heard. It is passed on only if that
 * answer was given a moment ago. So a sign that was held up by a slow network
 * or a stopped program moves nothing when it arrives.
 *
 * Units: in every name. Threads: one, that of the event loop.
 */
#ifndef PANEL_PRESS_H
#define PANEL_PRESS_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#define PRESS_SAID	16

struct browser;

struct press {
	uint32_t number;		/* the number that edmd knows; 0:
					 * none */
	int64_t page_number;		/* the number that the page knows */
	char axis[8];
	bool begun;			/* edmd has taken a sign of this
					 * press */
	int code;			/* code of the refusal that ended it */
	char reason[200];
	struct {			/* the last answers */
		int64_t n;
		double at_s;
	} said[PRESS_SAID];
	unsigned int nsaid;
};

/** press_take() - take request @n: a sign, or the end of a press. */
void press_take(struct browser *b, int64_t n, const json_t *o);

/** press_end() - say that the browser is gone, or that the key was released. */
void press_end(struct browser *b);

#endif /* PANEL_PRESS_H */
