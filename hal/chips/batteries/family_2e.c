/* SPDX-License-Identifier: MIT */
/*
 * DS2770: battery gauge and charge controller (data sheet, "Battery Monitor and Charge
 * Controller").
 */
#include <errno.h>

#include "hal/chips/batteries/gauge.h"

enum { DEFAULTS_AT = 0x31, STATUS_AT = 0x01, CHARGING = 0x40, CHARGE_STATUS = 0xc0 };
#define REFRESHED 0x33 /* bits of the status that Refresh takes from the EEPROM */

static AREA_NAMED(status, "status", .at = STATUS_AT, .size = 1, GAUGE_WRITE(1));
static AREA_NAMED(timer, "timer", .at = 0x02, .size = 2, GAUGE_WRITE(2),
                  .is_written = gauge_is_counted);

static int family_2e_command(struct txn *txn, uint8_t code)
{
	txn_void(txn);
	return txn_command(txn, &code, 1);
}

/* Start Charge, Stop Charge; then the status says what it is. */
static int write_charge(struct txn *txn)
{
	bool on = txn->number[0] != 0;
	uint8_t byte;
	int err;

	if (txn->phase == 0) {
		err = family_2e_command(txn, on ? 0xb5 : 0xbe);
		if (err)
			return err;
		txn->phase = 1;
	}
	err = area_read(txn, &gauge_bytes, STATUS_AT, &byte, 1);
	if (err)
		return err;
	return ((byte & CHARGE_STATUS) == CHARGING) == on ? 0 : -EIO;
}

/* The phases from first on: what the EEPROM holds, Refresh, the status. */
static int refresh(struct txn *txn, unsigned first)
{
	uint8_t *stored = txn_own(txn, uint8_t), byte;
	int err;

	if (txn->phase == first) {
		err = area_read(txn, &gauge_eeprom, DEFAULTS_AT, stored, 1);
		if (err)
			return err;
		txn->phase++;
		return TXN_MORE;
	}
	if (txn->phase == first + 1) {
		err = family_2e_command(txn, 0x63);
		if (err)
			return err;
		txn->phase++;
	}
	err = area_read(txn, &gauge_bytes, STATUS_AT, &byte, 1);
	if (err)
		return err;
	return ((byte ^ *stored) & REFRESHED) == 0 ? 0 : -EIO;
}

static int write_refresh(struct txn *txn)
{
	return txn->number[0] != 0 ? refresh(txn, 0) : 0;
}

/* The status has it from the EEPROM, when it is refreshed. */
static int write_setting(struct txn *txn)
{
	const uint8_t mask = (uint8_t)(1 << txn->property->field.shift);
	const uint8_t byte = txn->number[0] != 0 ? mask : 0;
	int err;

	if (txn->phase > 0)
		return refresh(txn, 1);
	err = area_write(txn, &gauge_eeprom, DEFAULTS_AT, &byte, &mask, 1);
	if (err)
		return err;
	txn->phase = 1;
	return TXN_MORE;
}

enum { STATUS = AFTER_GAUGE_AREAS, TIMER };
static const struct area *const areas[] = {
	GAUGE_AREAS,
	[STATUS] = &status,
	[TIMER] = &timer,
};

enum { WAY_CHARGE = AFTER_GAUGE_WAYS, WAY_REFRESH, WAY_SETTING };
static const struct property_how how[] = {
	GAUGE_WAYS,
	[WAY_CHARGE] = {.write = write_charge},
	[WAY_REFRESH] = {.write = write_refresh},
	[WAY_SETTING] = {.write = write_setting},
};

#define SETTING(text, bit) \
	PROPERTY(text, YESNO, STABLE, BOTH, \
	         FIELD(BYTES, .at = STATUS_AT, .shift = (bit), .bits = 1), .how = WAY_SETTING)
#define BIAS(text, life_, resistor, unit_) \
	PROPERTY(text, FLOAT, life_, BOTH, \
	         FIELD(EEPROM, .at = 0x32, .bytes = 2, .big_endian = true, .is_signed = true, \
	               .unit = GAUGE_FINE / (resistor)), \
	         IN_UNIT(unit_))

static const struct property properties[] = {
	GAUGE_AMPHOURS,
	PROPERTY("charge", YESNO, STABLE, WRITE, .how = WAY_CHARGE),
	SETTING("cini", 1),
	GAUGE_BIT("cstat0", STABLE, BOTH, STATUS, 0, 6),
	GAUGE_BIT("cstat1", STABLE, BOTH, STATUS, 0, 7),
	SETTING("ctype", 0),
	GAUGE_WORD("current", 0x0e, GAUGE_FINE / GAUGE_RESISTOR, GAUGE_CURRENT_FINE),
	BIAS("currentbias", VOLATILE, GAUGE_RESISTOR, "A"),
	GAUGE_BIT("defaultpmod", STABLE, BOTH, EEPROM, DEFAULTS_AT, 5),
	GAUGE_LOCK(3, 0x07, 0x403020),
	AREA_MEMORY(MEMORY, 256),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(3, NUMBERS), .size = 16,
                 FIELD(EEPROM, .at = 0x20)),
	SETTING("pmod", 5),
	PROPERTY("refresh", YESNO, STABLE, WRITE, .how = WAY_REFRESH),
	GAUGE_TEMPERATURE(0x18),
	PROPERTY("timer", FLOAT, VOLATILE, BOTH,
                 FIELD(TIMER, .bytes = 2, .big_endian = true, .unit = .015625),
                 MEASURES(0, 1024, 6, "h")),
	GAUGE_COUPLES(0x18, 1),
	BIAS("vbias", STABLE, 1, "V"),
	GAUGE_WORD("vis", 0x0e, GAUGE_FINE, GAUGE_VIS_FINE),
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};

CHIP_FAMILY(2e, "DS2770", PRESENCE,
            SCAN({"temperature", "temperature"}, {"volt", "volt"}, {"current", "current"},
                 {"amphours", "amphours"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
