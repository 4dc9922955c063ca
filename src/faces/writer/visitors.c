/* SPDX-License-Identifier: MIT */
/* Counts and ends the processes of visits. */
#include <signal.h>
#include <sys/wait.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/faces/writer/visitors.h"

#define LAST_NS (45 * NS_PER_S) /* to lock the file, and to reload */
#define PAUSE_NS (5 * NS_PER_MS)

bool visitors_may(const struct visitors *v, uid_t uid)
{
	unsigned count = 0;

	for (unsigned i = 0; i < VISITORS; i++)
		count += v->places[i].pid && v->places[i].uid == uid;
	return !uid || count < VISITORS_PER_USER;
}

void visitors_add(struct visitors *v, pid_t pid, uid_t uid, int64_t now_ns)
{
	unsigned i = 0;

	while (v->places[i].pid)
		i++;
	v->places[i].pid = pid;
	v->places[i].uid = uid;
	v->places[i].until_ns = now_ns + VISITORS_NS;
}

unsigned visitors_look(struct visitors *v, int64_t now_ns)
{
	unsigned count = 0;

	for (unsigned i = 0; i < VISITORS; i++) {
		if (v->places[i].pid && waitpid(v->places[i].pid, NULL, WNOHANG) != 0)
			v->places[i].pid = 0;
		else if (v->places[i].pid && now_ns > v->places[i].until_ns)
			kill(v->places[i].pid, SIGKILL);
		count += v->places[i].pid != 0;
	}
	return count;
}

void visitors_end(struct visitors *v)
{
	const struct timespec pause = {.tv_nsec = PAUSE_NS};
	int64_t left_ns = LAST_NS;

	for (unsigned i = 0; i < VISITORS; i++)
		if (v->places[i].pid)
			kill(v->places[i].pid, SIGTERM);
	while (visitors_look(v, 0) && left_ns > 0) {
		nanosleep(&pause, NULL);
		left_ns -= PAUSE_NS;
	}
}
