/* SPDX-License-Identifier: MIT */
/* How many bytes of the I2C bus pass until an operation of a chip has ended. */
#include "hal/ds2482/ends.h"
#include "hal/ds2482/codes.h"

/*
 * After the last byte of such a pause come an address and a command, and the chip looks at the
 * end of the latter. So with two bytes less than were read until the status said idle the command
 * is as late as that status was, by the START condition between later.
 */
#define AFTER 2
#define DOUBTS_MAX 2

/* -1: its time is not learnt. */
static int which(long max_ns)
{
	if (max_ns == ds2482_reset_max_ns)
		return DS2482_OF_RESET;
	return max_ns == ds2482_byte_max_ns ? DS2482_OF_BYTE : -1;
}

void ds2482_saw_end(struct ds2482_ends *ends, long max_ns, const uint8_t *status, unsigned n)
{
	int operation = which(max_ns);
	unsigned idle = 0;

	while (idle < n && (status[idle] & DS2482_1WB))
		idle++;
	if (operation < 0 || idle == n || idle > UINT8_MAX)
		return;
	ends->of[operation].idle[ends->of[operation].next] = (uint8_t)idle;
	ends->of[operation].next = (uint8_t)((ends->of[operation].next + 1) % DS2482_LOOKS);
	if (ends->of[operation].looks < DS2482_LOOKS)
		ends->of[operation].looks++;
}

unsigned ds2482_pause(const struct ds2482_ends *ends, enum ds2482_operation operation,
                      unsigned least, unsigned longest)
{
	unsigned pause = 0;

	if (ends->of[operation].looks < DS2482_LOOKS)
		return longest;
	for (unsigned i = 0; i < DS2482_LOOKS; i++)
		pause = ends->of[operation].idle[i] > pause ? ends->of[operation].idle[i] : pause;
	pause = pause > AFTER ? pause - AFTER : 0;
	pause = (pause > least ? pause : least) + ends->doubts;
	return pause < longest ? pause : longest;
}

void ds2482_forget_ends(struct ds2482_ends *ends)
{
	ends->of[DS2482_OF_RESET].looks = ends->of[DS2482_OF_BYTE].looks = 0;
	if (ends->doubts < DOUBTS_MAX)
		ends->doubts++;
}
