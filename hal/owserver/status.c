/* SPDX-License-Identifier: MIT */
/* Maps the return codes of an owserver to errors of the bus contract. */
#include <errno.h>

#include "hal/owserver/status.h"

/*
 * Codes up to 42, 74, 90 and 95 are those of errno(3); 26 to 79 are owserver's own too, listed in
 * /settings/return_codes/text.ALL. A code with two meanings stands for the one that servers send.
 */
static const struct {
	int err;
	int32_t codes[12]; /* 0 behind the last */
} meanings[] = {
	{1, {1, 2}},
	{-ENODEV, {19, 29, 41, 70}},
	{-ENOTDIR, {20}},
	{-EISDIR, {21}},
	{-ENOENT, {27, 32, 33, 35, 37, 38, 39, 59, 64, 69}},
	{-EPERM, {13, 30, 66}},
	{-EACCES, {60, 65, 95}},
	{-EINVAL, {14, 22, 61, 62, 63}},
	{-EMSGSIZE, {34, 57, 90}},
	{-EBADMSG, {28}},
	{-ECOMM, {44}},
};
#define NUMBER_TOO_LARGE 34 /* of a write; else the room is too small for .ALL */

int status_of(int32_t code, enum bus_op op)
{
	if (op == BUS_WRITE && code == -NUMBER_TOO_LARGE)
		return -EINVAL;
	for (unsigned i = 0; i < sizeof(meanings) / sizeof(meanings[0]); i++)
		for (const int32_t *known = meanings[i].codes; *known; known++)
			if (code == -*known)
				return meanings[i].err;
	return -EIO;
}
