/* SPDX-License-Identifier: MIT */
/* Who may own a segment that owsd uses. Blocking: reads /etc/passwd and /etc/group. */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

/* Is uid root, owsd, or the caller? */
bool owner_trusted(uid_t uid);
/* Is the caller the service's user, owsd? */
bool owner_is_service(void);
/* A user's name, cut to 16 bytes, and number; the number alone where /etc/passwd has no name. */
#define OWNER_NAME 40
const char *owner_name(uid_t uid, char name[OWNER_NAME]);
/* The ids of a user and a group, false if there is none of that name. */
bool owner_user(const char *name, uid_t *uid);
bool owner_group(const char *name, gid_t *gid);
/* Is the user in that group, by its own entry or by that of the group? */
bool owner_in_group(uid_t uid, gid_t gid);
