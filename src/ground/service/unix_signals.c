/* SPDX-License-Identifier: MIT */
/* Signals as readable descriptors, so that one wait is for them and for the log. */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/ground/service/unix_signals.h"

int unix_signals_open(struct unix_signals *signals)
{
	sigset_t taken;

	*signals = (struct unix_signals){.fd = -1};
	signal(SIGPIPE, SIG_IGN);
	sigemptyset(&taken);
	sigaddset(&taken, SIGTERM);
	sigaddset(&taken, SIGINT);
	sigaddset(&taken, SIGHUP);
	if (sigprocmask(SIG_BLOCK, &taken, NULL) < 0)
		return -errno;
	signals->fd = signalfd(-1, &taken, SFD_CLOEXEC | SFD_NONBLOCK);
	return signals->fd < 0 ? -errno : 0;
}

void unix_signals_take(struct unix_signals *signals)
{
	struct signalfd_siginfo info;

	while (read(signals->fd, &info, sizeof(info)) == (ssize_t)sizeof(info)) {
		if (info.ssi_signo == SIGHUP)
			signals->reload = true;
		else if (!signals->end)
			signals->end = (int)info.ssi_signo;
	}
}

void unix_signals_wait(struct unix_signals *signals, const int fds[2], int64_t at_most_ns)
{
	struct pollfd polled[] = {{.fd = signals->fd, .events = POLLIN},
	                          {.fd = fds[0], .events = POLLIN},
	                          {.fd = fds[1], .events = POLLIN}};
	struct timespec t = timespec_of(at_most_ns);

	ppoll(polled, 3, &t, NULL);
	unix_signals_take(signals);
}
