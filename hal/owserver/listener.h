/* SPDX-License-Identifier: MIT */
/*
 * Whose program listens at an address of this machine. Any user may take a port above 1023 that is
 * free, as while an owserver starts again, and could answer with values of his own.
 *
 * Source: proc_net_tcp.txt of the kernel: local_address, rem_address, st 0A, uid, inode.
 */
#pragma once

#include <stdbool.h>
#include <sys/socket.h>
#include <sys/types.h>

/*
 * The user of the listener at this address and port, or of the one that listens at all addresses;
 * without a listener that of the program that has taken the connection from there.
 * folder: "/proc/self/net", of which tcp and tcp6 are read; both answer at once. -ECONNREFUSED:
 * nobody answers for the connection, or there are too many to see, or it is one of a socket to
 * itself. -ENOENT: it does not end here, as at the address of another machine, or where another
 * network namespace answers; or there is no /proc.
 */
int listener_user(const char *folder, const struct sockaddr *at, const struct sockaddr *from,
                  uid_t *user);

/*
 * May a program of this user answer for this machine's devices? So may root, system users, those
 * that systemd makes for a service, nobody, and the user of this program.
 */
bool listener_is_trusted(uid_t user);
