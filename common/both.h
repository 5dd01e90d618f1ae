/* SPDX-License-Identifier: Apache-2.0 */
/* both.h - two things at the same time, and who may do them */
#ifndef COMMON_BOTH_H
#define COMMON_BOTH_H

#include <stdint.h>

/** both_processors() - on how many processors may this thread run?  One that is
 *  kept for a cycle in real time is not among them. */
uint32_t both_processors(void);

/** both() - call @one and @other, which do not disturb each other, at the same
 *  time; one after the other if there can be no thread. */
void both(void (*one)(void *), void (*other)(void *), void *arg);

#endif /* COMMON_BOTH_H */
