/* SPDX-License-Identifier: MIT */
/* Boards of Hobby Boards: which one is it, its version, fields and texts of its settings. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/makers/hobby_boards.h"
#include "hal/chips/row.h"

const struct area hobby_type = {HOBBY_VALUE("type", 1, 0x12)};
const struct area hobby_version = {HOBBY_VALUE("version", 2, 0x11)};

/* All ones: the board is not ready, or none is there. */
int hobby_identify(struct txn *txn)
{
	uint8_t kind;
	int err = area_read(txn, &hobby_type, 0, &kind, 1);

	if (err)
		return err;
	if (kind == 0xff)
		return -EBADMSG;
	txn->device->kind = kind > 0 && kind < HOBBY_OTHER ? kind : HOBBY_OTHER;
	return 0;
}

int hobby_saw_setting(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	unsigned ones = 0;

	(void)txn, (void)at;
	while (ones < n && bytes[ones] == 0xff)
		ones++;
	return ones == n ? -EIO : 0;
}

int hobby_read_text(struct txn *txn)
{
	char text[AREA_UNIT + 1] = {0};
	int err = area_read(txn, family_area(txn), 0, (uint8_t *)text, family_area(txn)->size);

	return err ? err : property_text(txn, text);
}

/* The last byte is the end of the text. */
int hobby_write_text(struct txn *txn)
{
	const struct area *area = family_area(txn);
	uint8_t text[AREA_UNIT] = {0};

	if (txn->at || txn->len >= area->size)
		return -EINVAL;
	memcpy(text, txn->data, txn->len);
	return area_write(txn, area, 0, text, NULL, area->size);
}

int hobby_read_type(struct txn *txn)
{
	int err = hobby_identify(txn);

	return err ? err : property_text(txn, family_type(txn->device));
}

int hobby_read_version(struct txn *txn)
{
	uint8_t version[2];
	char text[8];
	int err = area_read(txn, &hobby_version, 0, version, 2);

	if (err)
		return err;
	snprintf(text, sizeof(text), "%u.%u", version[1], version[0]);
	return property_text(txn, text);
}
