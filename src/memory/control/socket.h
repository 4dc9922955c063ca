/* SPDX-License-Identifier: MIT */
/* The socket NAME.control in owsd's directory. */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

/*
 * Make the socket and listen, in place of one that an owsd before has left: the caller holds the
 * lock of the instance. Returns a descriptor, and in *inode the file's number, or a negative errno.
 */
int socket_listen(int directory, const char *name, bool for_all, ino_t *inode);
/* Remove the socket, but not that of another owsd which has taken the instance over. */
void socket_remove(int directory, const char *name, ino_t inode);
/* May others than owsd's user and root connect? Their rights are looked at afterwards. */
int socket_open_for(int directory, const char *name, bool all);
