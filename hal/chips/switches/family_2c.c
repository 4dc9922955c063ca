/* SPDX-License-Identifier: MIT */
/* DS2890 (data sheet, "1-Wire Digital Potentiometer"): a wiper of 256 positions, a charge pump. */
#include <errno.h>

#include "hal/chips/family.h"

#define RELEASE 0x96

/* The chip sends the byte back, and takes it with the release code. */
static int store_register(struct txn *txn, const struct area *area, unsigned at,
                          const uint8_t *bytes, unsigned n)
{
	const uint8_t command[] = {area->write, bytes[1]};
	const uint8_t whole[] = {area->write, bytes[1], 0xff, RELEASE};
	uint8_t echo;
	int err = txn_ask(txn, command, sizeof(command), &echo, 1);

	(void)at, (void)n;
	if (err)
		return err;
	if (echo != bytes[1])
		return -EBADMSG;
	err = txn_write(txn, TXN_BYTES(RELEASE));
	/* A link that takes no write behind a read: to read is to write ones. */
	return err == -EOPNOTSUPP ? txn_command(txn, whole, sizeof(whole)) : err;
}

/* A byte that is not written comes first: the control register, or what the chip can do. */
#define REGISTER .size = 2, .block = 2, .row = 2, .store = store_register

enum { POSITION = 1, CONTROL };
static const struct area *const areas[] = {
	[POSITION] = AREA(.name = "position", REGISTER, .read = 0xf0, .write = 0x0f),
	[CONTROL] = AREA(.name = "control", REGISTER, .read = 0xaa, .write = 0x55),
};

static const struct property properties[] = {
	PROPERTY("chargepump", YESNO, STABLE, BOTH, FIELD(CONTROL, .at = 1, .shift = 6, .bits = 1)),
	PROPERTY("wiper", UNSIGNED, STABLE, BOTH, FIELD(POSITION, .at = 1), .holds = true),
};

CHIP_FAMILY(2c, "DS2890", PRESENCE, .flags = FLAG_RESUME | FLAG_ALARM | FLAG_OVERDRIVE,
            AREAS(areas), PROPERTIES(properties));
