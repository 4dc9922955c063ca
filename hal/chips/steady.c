/* SPDX-License-Identifier: MIT */
/* Bytes without a checksum that change by themselves: they are read until they stay the same. */
#include <errno.h>
#include <string.h>

#include "hal/chips/area.h"
#include "hal/chips/steady.h"

#define LOOKS_MOST 12
#define CLOCK_BYTES 5
#define LATE_S 2

struct looks {
	uint8_t bytes[STEADY_MOST], same, all;
};

int steady(struct txn *txn, const uint8_t *bytes, unsigned n)
{
	struct looks *looks = txn_own(txn, struct looks);

	if (looks->all++ == 0 || memcmp(looks->bytes, bytes, n) != 0)
		looks->same = 0;
	memcpy(looks->bytes, bytes, n);
	if (++looks->same < (txn->silent && txn->asked ? 2 * AREA_LOOKS : AREA_LOOKS))
		return looks->all < LOOKS_MOST ? TXN_MORE : -EBADMSG;
	memset(looks, 0, sizeof(*looks));
	return 0;
}

int steady_clock_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                      unsigned n)
{
	int err = area_fetch(txn, area, at, bytes, n);

	if (area->address_bytes)
		bytes[0] = 0;
	return err ? err : steady(txn, bytes, n);
}

bool steady_clock_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n)
{
	(void)txn;
	return n == CLOCK_BYTES && have[0] == want[0] &&
	       area_le32(have + 1) - area_le32(want + 1) <= LATE_S;
}
