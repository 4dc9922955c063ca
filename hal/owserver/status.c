/* SPDX-License-Identifier: MIT */
/* The return codes of an owserver as errors of the bus contract. */
#include <errno.h>

#include "hal/owserver/status.h"

/*
 * Up to 42, 74, 90 and 95 the codes are those of errno(3); 26 to 79 are also owserver's own, listed
 * in /settings/return_codes/text.ALL. Codes that mean either are read as what servers do send.
 */
static const struct {
	int32_t code;
	int err, write_err; /* write_err 0: the same */
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
	{34, -EMSGSIZE, -EINVAL}, /* room too small for .ALL; the number is too large */
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
