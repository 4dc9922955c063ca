/* SPDX-License-Identifier: MIT */
/* The properties that every device has. All but present are known without asking it. */
#include <errno.h>

#include "hal/chips/family.h"

#define LOOKS 3

enum { ADDRESS, REVERSED_ADDRESS, ID, REVERSED_ID, FAMILY, CRC, LOCATOR, TYPE };

static int put_hex(struct txn *txn, unsigned first, unsigned n, bool reversed)
{
	static const char hex[] = "0123456789ABCDEF";
	char text[16 + 1];

	for (unsigned i = 0; i < n; i++) {
		uint8_t byte = txn->device->rom[reversed ? first + n - 1 - i : first + i];

		text[2 * i] = hex[byte >> 4];
		text[2 * i + 1] = hex[byte & 0xf];
	}
	text[2 * n] = '\0';
	return property_text(txn, text);
}

static int read_identity(struct txn *txn)
{
	const char *type;

	switch (txn->property->arg) {
	case ADDRESS:
		return put_hex(txn, 0, 8, false);
	case REVERSED_ADDRESS:
		return put_hex(txn, 0, 8, true);
	case ID:
		return put_hex(txn, 1, 6, false);
	case REVERSED_ID:
		return put_hex(txn, 1, 6, true);
	case FAMILY:
		return put_hex(txn, 0, 1, false);
	case CRC:
		return put_hex(txn, 7, 1, false);
	case LOCATOR:
		/* What OWFS says of a device without a LinkLocator; these are not asked for. */
		return property_text(txn, "FFFFFFFFFFFFFFFF");
	case TYPE:
		/* a driver's chip that cannot be asked is what the driver takes it for */
		type = family_type(txn->device);
		return property_text(txn, type ? type : txn->device->family->type);
	}
	return -EIO;
}

/* Once not found may be noise. */
static int read_present(struct txn *txn)
{
	int there = txn_verify(txn, false);

	txn->number[0] = there > 0;
	return there ? (there < 0 ? there : 0) : ++txn->phase < LOOKS ? TXN_MORE : 0;
}

static int read_alias(struct txn *txn)
{
	return property_text(txn, device_alias(txn->device));
}

static int write_alias(struct txn *txn)
{
	return device_set_alias(txn->device, (const char *)txn->data, txn->len);
}

enum { WAY_IDENTITY = 1, WAY_ALIAS, WAY_PRESENT };
static const struct property_how how[] = {
	[WAY_IDENTITY] = {.read = read_identity},
	[WAY_ALIAS] = {.read = read_alias, .write = write_alias},
	[WAY_PRESENT] = {.read = read_present},
};

/* clang-format off */
#define IDENTITY(text, what, bytes) \
	PROPERTY(text, ASCII, STATIC, READ, .offline = true, .size = (bytes), .arg = (what), \
	         .how = WAY_IDENTITY)

static const struct property properties[] = {
	IDENTITY("address", ADDRESS, 16),
	{.name = "alias", .type = PROPERTY_ALIAS, .life = LIFE_STATIC, .access = ACCESS_BOTH,
	 .offline = true, .how = WAY_ALIAS},
	IDENTITY("crc8", CRC, 2),
	IDENTITY("family", FAMILY, 2),
	IDENTITY("id", ID, 12),
	IDENTITY("locator", LOCATOR, 16),
	{.name = "present", .type = PROPERTY_YESNO, .life = LIFE_VOLATILE, .access = ACCESS_READ,
	 .hidden = true, .alarm = ALARM_LATCH, .how = WAY_PRESENT},
	IDENTITY("r_address", REVERSED_ADDRESS, 16),
	IDENTITY("r_id", REVERSED_ID, 12),
	IDENTITY("r_locator", LOCATOR, 16),
	IDENTITY("type", TYPE, 32),
};
/* clang-format on */

const struct family family_common = {.type = "unknown", HOW(how), PROPERTIES(properties)};
