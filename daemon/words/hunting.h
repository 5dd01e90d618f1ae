/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hunting.h - words for a gap servo that goes in and out at one place
 *
 * Such a servo cuts nothing, and no fault reports it.  A number of retracts in
 * a row between which the cut gets no deeper is a warning.
 */
#ifndef WORDS_HUNTING_H
#define WORDS_HUNTING_H

/* After this many retracts in a row without progress the gap servo hunts. */
enum { HUNTING_ROW = 20 };

/* %d: retracts in a row. */
#define HUNTING_WHAT	"the gap servo hunts: %d retracts in a row without progress"

#define HUNTING_ADVICE	"raise servo_v, lower feed_gain_mm_s_v, or jump oftener: " \
			"lower [jump] every_s; edmsim --tune finds them"

#endif /* WORDS_HUNTING_H */
