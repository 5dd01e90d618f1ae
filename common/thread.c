/* SPDX-License-Identifier: Apache-2.0 */
/* thread.c - start a thread */
#include "thread.h"

#include <signal.h>

int thread_start(pthread_t *ret, const struct thread *t)
{
	pthread_attr_t attr;
	sigset_t all, before;
	int err = 0;

	pthread_attr_init(&attr);
	if (t->stack_bytes)
		err = pthread_attr_setstacksize(&attr, t->stack_bytes);
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	if (err == 0)
		err = pthread_create(ret, &attr, t->run, t->arg);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	pthread_attr_destroy(&attr);
	if (err == 0)
		pthread_setname_np(*ret, t->name);
	return -err;
}
