/* SPDX-License-Identifier: MIT */
/*
 * A link that is no wire: somebody else, the kernel, speaks 1-Wire and gives files. Its reset,
 * write and read take the commands that the files can stand for; what else it can do is here.
 */
#ifndef HAL_NATIVE_FILES_H
#define HAL_NATIVE_FILES_H

#include "hal/chips/family.h"

struct link_files {
	/*
	 * How this element (enum extension) of the device's property is read and written: the
	 * functions come as the family has them and are left or changed. 0; -ENOENT no file for it.
	 */
	int (*property)(struct link *link, const struct device *device,
	                const struct property *property, int extension, property_function **read,
	                property_function **write);
	/*
	 * All devices, those in alarm, of one family or (0) of all. 0, what found returned, or an
	 * error: -EOPNOTSUPP whether they are in alarm cannot be told, -ENODEV the master is gone.
	 */
	int (*search)(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx);
};

#endif
