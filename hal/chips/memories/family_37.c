/* SPDX-License-Identifier: MIT */
/*
 * DS1977 (data sheet, "Password-Protected 32KB EEPROM iButton"). Passwords are neither used nor set
 * here: zeros are sent in their place, which the chip takes while none is switched on.
 *
 * Read Memory with Password has a CRC16. The chip sends what it reads behind a strong pull-up of 5
 * ms, in the same transaction: the bus waits for it, and nothing comes in between. Without a strong
 * pull-up its reads may fail.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/steady.h"

#define READ_WITH_PASSWORD 0x69
#define PASSWORD_BYTES 8
#define PAGE 64
#define READ_NS (5 * TXN_MS)
#define ENABLED 0xaa

struct visit {
	uint8_t looks[16]; /* of steady() */
	bool sent;
};

/*
 * The command; after its strong pull-up the bytes come in the same transaction. Nothing else may
 * use the wire in between: another reset ends what the chip sends. Where the pull-up cannot be held
 * so long, as there is none (w1), it is left to luck, and the checksum tells.
 */
static int family_37_begin(struct txn *txn, const struct area *area, unsigned at,
                           uint8_t command[3])
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t bytes[3 + PASSWORD_BYTES] = {READ_WITH_PASSWORD, (uint8_t)(area->at + at),
	                                     (uint8_t)((area->at + at) >> 8)};

	memcpy(command, bytes, 3);
	if (!txn->link->facts->strong) {
		visit->sent = !visit->sent;
		return visit->sent ? txn_command_strong(txn, bytes, sizeof(bytes), READ_NS) : 0;
	}
	int err = txn_command(txn, bytes, 1);
	return err ? err : txn_write_paused(txn, bytes + 1, sizeof(bytes) - 1, READ_NS);
}

/* The checksum is at the end of the page. */
static int family_37_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                          unsigned n)
{
	uint8_t command[3], page[PAGE];
	int err = family_37_begin(txn, area, at, command);

	if (!err)
		err = txn_read_crc16(txn, command, sizeof(command), page, PAGE - at % PAGE);
	if (!err)
		memcpy(bytes, page, n);
	return err;
}

static AREA_NAMED(memory, "memory", .size = 32704, .block = 32, .row = 32, .address_bytes = 2,
                  .write = 0x0f, .verify = 0xaa, .copy = 0x99, .password = PASSWORD_BYTES,
                  .strong = true, .copy_ns = 10 * TXN_MS, .load = family_37_load);

/* The byte that switches the passwords on has no checksum. */
static int load_control(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                        unsigned n)
{
	uint8_t command[3];
	int err = family_37_begin(txn, area, at, command);

	if (!err)
		err = txn_read(txn, bytes, n);
	return err ? err : steady(txn, bytes, n);
}

static AREA_NAMED(control, "control", .at = 0x7fd0, .size = 1, .load = load_control);

/* The chip sends it twice. */
static int saw_version(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	return bytes[0] == bytes[1] ? 0 : -EBADMSG;
}

static AREA_NAMED(version, "version", .size = 2, .block = 2, .address_bytes = 2, .read = 0xcc,
                  .saw = saw_version);

static int read_enabled(struct txn *txn)
{
	uint8_t byte;
	int err = area_read(txn, &control, 0, &byte, 1);

	if (!err)
		txn->number[0] = byte == ENABLED;
	return err;
}

enum { MEMORY = 1, VERSION };
static const struct area *const areas[] = {[MEMORY] = &memory, [VERSION] = &version};

enum { WAY_ENABLED = 1, WAY_PASSWORD };
static const struct property_how how[] = {
	[WAY_ENABLED] = {.read = read_enabled, .write = property_refuse},
	[WAY_PASSWORD] = {.write = property_refuse},
};

#define PASSWORD(text) PROPERTY(text, BINARY, STABLE, WRITE, .size = 8, .how = WAY_PASSWORD)

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 32704),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 511, 64),
	PROPERTY_DIR("set_password"),
	PROPERTY("set_password/enabled", YESNO, STABLE, BOTH, .how = WAY_ENABLED),
	PASSWORD("set_password/full"),
	PASSWORD("set_password/read"),
	PROPERTY_DIR("use_password"),
	PASSWORD("use_password/full"),
	PASSWORD("use_password/read"),
	PROPERTY("version", UNSIGNED, STABLE, READ, FIELD(VERSION)),
};

CHIP_FAMILY(37, "DS1977", PRESENCE, .flags = FLAG_RESUME | FLAG_OVERDRIVE, AREAS(areas), HOW(how),
            PROPERTIES(properties));
