/* SPDX-License-Identifier: MIT */
/* Maps the return codes of an owserver to errors of the bus contract. */
#include <errno.h>

#include "hal/owserver/status.h"

/*
 * Codes up to 42, 74, 90 and 95 are those of errno(3); 26 to 79 are owserver's own too, listed in
 * /settings/return_codes/text.ALL. A code with two meanings stands for the one that servers send.
 */
static const struct {
	int32_t code;
	int err, write_err; /* write_err 0: the same as err */
} meanings[] = {
	{1, 1},
	{2, 1},
	{19, -ENODEV},
	{29, -ENODEV},
	{41, -ENODEV},
	{70, -ENODEV},
	{20, -ENOTDIR},
	{21, -EISDIR},
	{27, -ENOENT},
	{32, -ENOENT},
	{33, -ENOENT},
	{35, -ENOENT},
	{37, -ENOENT},
	{38, -ENOENT},
	{39, -ENOENT},
	{59, -ENOENT},
	{64, -ENOENT},
	{69, -ENOENT},
	{13, -EPERM},
	{30, -EPERM},
	{66, -EPERM},
	{60, -EACCES},
	{65, -EACCES},
	{95, -EACCES},
	{14, -EINVAL},
	{22, -EINVAL},
	{61, -EINVAL},
	{62, -EINVAL},
	{63, -EINVAL},
	{34, -EMSGSIZE, -EINVAL}, /* the room is too small for .ALL, or the number is too large */
	{57, -EMSGSIZE},
	{90, -EMSGSIZE},
	{28, -EBADMSG},
	{44, -ECOMM},
};

int status_of(int32_t code, enum bus_op op)
{
	for (unsigned i = 0; i < sizeof(meanings) / sizeof(meanings[0]); i++) {
		if (code != -meanings[i].code)
			continue;
		if (op == BUS_WRITE && meanings[i].write_err)
			return meanings[i].write_err;
		return meanings[i].err;
	}
	return -EIO;
}
