/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hunting.h - words for a gap servo that goes in and out on the spot
 *
 * It cuts nothing, and no fault tells it: a row of retracts between which the cut
 * got no deeper is a warning.
 */
#ifndef WORDS_HUNTING_H
#define WORDS_HUNTING_H

/* So many retracts in a row without progress between: the gap servo hunts. */
enum { HUNTING_ROW = 20 };

/* %d: retracts in a row. */
#define HUNTING_WHAT	"the gap servo hunts: %d retracts in a row without progress"

#define HUNTING_ADVICE	"raise servo_v, lower feed_gain_mm_s_v, or jump oftener: " \
			"lower [jump] every_s; edmsim --tune finds them"

#endif /* WORDS_HUNTING_H */
