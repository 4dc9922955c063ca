/* SPDX-License-Identifier: MIT */
/*
 * Whose program listens at an address of this machine. Any user may take a port above 1023 that is
 * free, as while an owserver starts again, and could answer with values of his own.
 *
 * Source: proc_net_tcp.txt of the kernel: local_address, st 0A, uid.
 */
#pragma once

#include <stdbool.h>
#include <sys/socket.h>
#include <sys/types.h>

/*
 * The user of the listener at this address and port, or of the one that listens at all addresses.
 * folder: "/proc/self/net", of which tcp and tcp6 are read; both answer at once. -ENOENT: nobody
 * known, as without /proc, or where another network namespace answers.
 */
int listener_user(const char *folder, const struct sockaddr *at, uid_t *user);

/*
 * May a program of this user answer for this machine's devices? So may root, system users, those
 * that systemd makes for a service, nobody, and the user of this program.
 */
bool listener_is_trusted(uid_t user);
