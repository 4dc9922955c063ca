/* SPDX-License-Identifier: MIT */
/* Makes corpses, and lets them end. */
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/shm/corpse.h"
#include "src/public/ows.h"
#include "tests/unit/aid/corpse.h"

#define PATIENCE_NS INT64_C(60000000000)

static void *outlive(void *arg)
{
	char c;

	while (read(*(int *)arg, &c, 1) < 0)
		;
	_exit(0);
}

void corpse_make(struct corpse *corpse, void (*first)(void))
{
	static int hold[2];
	int ready[2];
	char c;

	TEST_ASSERT_EQUAL(0, pipe(hold));
	TEST_ASSERT_EQUAL(0, pipe(ready));
	corpse->pid = fork();
	if (corpse->pid == 0) {
		pthread_t thread;

		close(hold[1]);
		if (first)
			first();
		if (pthread_create(&thread, NULL, outlive, &hold[0]) != 0 ||
		    write(ready[1], "x", 1) != 1)
			_exit(1);
		pthread_exit(NULL);
	}
	TEST_ASSERT_GREATER_THAN(0, corpse->pid);
	close(hold[0]);
	close(ready[1]);
	corpse->hold = hold[1];
	TEST_ASSERT_EQUAL(1, read(ready[0], &c, 1));
	close(ready[0]);
	for (int64_t until = ows_now() + PATIENCE_NS; !corpse_is(corpse->pid) && ows_now() < until;)
		usleep(1000); /* pace */
	TEST_ASSERT_TRUE(corpse_is(corpse->pid));
}

void corpse_end(struct corpse *corpse)
{
	int status;

	close(corpse->hold);
	TEST_ASSERT_EQUAL(corpse->pid, waitpid(corpse->pid, &status, 0));
}

void corpse_own_name(void)
{
	char name[24]; /* the kernel takes 15 of them */

	snprintf(name, sizeof(name), "test.%d", (int)getpid());
	TEST_ASSERT_EQUAL(0, prctl(PR_SET_NAME, name));
}
