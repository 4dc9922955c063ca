/* SPDX-License-Identifier: MIT */
/*
 * The kernel's directories of slaves and masters, and the attributes in them: files, each of which
 * is one value. A call lasts as long as the kernel takes. All return a number of bytes or 0, or
 *   -ENODEV the directory is gone, -ENOENT it has no such attribute, -EACCES it can only be read,
 *   -EPERM no right (the log says so once), -EINVAL the kernel refuses the value, -EIO any other
 *   error
 */
#pragma once

#include "hal/bus/bus.h"

#define W1_ROOT "/sys/bus/w1/devices"
#define W1_ROOT_MAX 160
#define W1_TEXT_MAX 4096

struct w1_tree {
	const struct bus_env *env;
	char root[W1_ROOT_MAX];
	bool told_rights;
	_Alignas(8) char text[W1_TEXT_MAX]; /* an attribute that is being looked at */
	char lists[8 * W1_TEXT_MAX];        /* a list of slaves */
};

int w1_read(struct w1_tree *tree, const char *directory, const char *name, unsigned at, void *data,
            size_t room);
int w1_write(struct w1_tree *tree, const char *directory, const char *name, unsigned at,
             const void *data, size_t n);
/* name "": the directory itself. */
bool w1_exists(const struct w1_tree *tree, const char *directory, const char *name);
/*
 * The slaves of a master, a line each, sorted, in tree->lists; bytes or an error. From its
 * directory: w1_master_slaves takes a mutex that a master being removed holds while it waits for
 * the readers of its attributes, and both hang for good.
 */
int w1_slaves(struct w1_tree *tree, const char *directory);
