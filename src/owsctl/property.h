/* SPDX-License-Identifier: MIT */
/* Does the family of a path's device have the path's property? */
#ifndef OWSCTL_PROPERTY_H
#define OWSCTL_PROPERTY_H

#include <stdbool.h>

#define PROPERTY_NAME 64

/*
 * True too where the answer is not known: a path without an id or a property, a family that owsd
 * does not know. False: nearest gets the name that the user probably meant, with the given
 * extension; "" when no name is near.
 */
bool property_known(const char *path, char nearest[PROPERTY_NAME]);

#endif
