/* SPDX-License-Identifier: Apache-2.0 */
/* parallel.h - two things at the same time, and who may do them */
#ifndef COMMON_PARALLEL_H
#define COMMON_PARALLEL_H

#include <stdint.h>

/** parallel_processors() - on how many processors may this thread run?  One
 *  that is kept for a cycle in real time is not among them. */
uint32_t parallel_processors(void);

/** parallel_run() - call @one and @other, which do not disturb each other, at
 *  the same time; one after the other if there can be no thread. */
void parallel_run(void (*one)(void *), void (*other)(void *), void *arg);

#endif /* COMMON_PARALLEL_H */
