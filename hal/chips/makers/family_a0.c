/* SPDX-License-Identifier: MIT */
/* Rotation sensor mRS001. */
#include "hal/chips/makers/cmciel.h"

/* Below zero in reverse, though the property is unsigned: owserver says 4294967295 for -1. */
static int read_rpm(struct txn *txn)
{
	uint8_t word[3];
	int err = area_read(txn, &cmciel_reading, 0, word, sizeof(word));

	if (!err)
		txn->number[0] = (int16_t)(word[0] | word[1] << 8);
	return err;
}

static const struct area *const areas[] = {CMCIEL_AREAS};

enum { WAY_RPM = 1 };
static const struct property_how how[] = {[WAY_RPM] = {.read = read_rpm}};

static const struct property properties[] = {
	PROPERTY("RPM", UNSIGNED, VOLATILE, READ, MEASURES(INT16_MIN, INT16_MAX, 0, "rpm"),
                 .how = WAY_RPM),
	CMCIEL_READING,
};

CHIP_FAMILY(a0, "mRS001", PRESENCE, SCAN({"RPM", "rpm"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
