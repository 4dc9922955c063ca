/* SPDX-License-Identifier: MIT */
/*
 * DS1991 (data sheet 012207) and DS1425: three subkeys, each with an identifier that everybody may
 * read, and 48 bytes behind a password. Passwords are neither used nor set here.
 *
 * A subkey is read until three in a row are the same.
 */
#include "hal/chips/family.h"
#include "hal/chips/steady.h"

#define READ_SUBKEY 0x66
#define SUBKEY_BYTES 64
#define DATA_AT 16
#define IDENTIFIER_BYTES 8

/* To read the data begins with the identifier; no password follows it. */
static int family_02_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                          unsigned n)
{
	uint8_t where = (uint8_t)(at / IDENTIFIER_BYTES * SUBKEY_BYTES + DATA_AT);
	const uint8_t command[] = {READ_SUBKEY, where, (uint8_t)~where};
	int err = txn_ask(txn, command, sizeof(command), bytes, n);

	(void)area;
	return err ? err : steady(txn, bytes, n);
}

static AREA_NAMED(identifiers, "identifiers", .size = 3 * IDENTIFIER_BYTES,
                  .block = IDENTIFIER_BYTES, .load = family_02_load);

enum { IDENTIFIERS = 1 };
static const struct area *const areas[] = {[IDENTIFIERS] = &identifiers};

enum { WAY_IDENTIFIER = 1, WAY_SECRET };
static const struct property_how how[] = {
	[WAY_IDENTIFIER] = {.write = property_refuse},
	[WAY_SECRET] = {.read = property_refuse, .write = property_refuse},
};

#define SUBKEY(name_, n) \
	PROPERTY_DIR(name_), \
		PROPERTY(name_ "/id", BINARY, STABLE, BOTH, SPARSE(LETTERS), \
	                 .size = IDENTIFIER_BYTES, FIELD(IDENTIFIERS, .at = (n)*IDENTIFIER_BYTES), \
	                 .how = WAY_IDENTIFIER), \
		PROPERTY(name_ "/password", BINARY, STABLE, WRITE, SPARSE(LETTERS), .size = 8, \
	                 .how = WAY_SECRET), \
		PROPERTY(name_ "/reset", YESNO, STABLE, WRITE, SPARSE(LETTERS), \
	                 .how = WAY_SECRET), \
		PROPERTY(name_ "/secure_data", BINARY, STABLE, BOTH, SPARSE(LETTERS), .size = 48, \
	                 .how = WAY_SECRET)

static const struct property properties[] = {
	SUBKEY("subkey0", 0),
	SUBKEY("subkey1", 1),
	SUBKEY("subkey2", 2),
};

CHIP_FAMILY(02, "DS1991", PRESENCE, AREAS(areas), HOW(how), PROPERTIES(properties));
CHIP_FAMILY(82, "DS1425", PRESENCE, AREAS(areas), HOW(how), PROPERTIES(properties));
