/* SPDX-License-Identifier: MIT */
/* The table of the ranges that properties of the chip families can have, by data sheet. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/signal/quantity.h"

#define CELSIUS "\u00b0C"
/* DS18S20 (and DS1920), DS1822, DS18B20, DS1825 and MAX31826 and MAX31850, DS28EA00 */
#define THERMOMETERS "\x10\x22\x28\x3b\x42"

/*
 * The range that the chip measures by its data sheet, widened by the error that the data sheet
 * allows at its ends: a chip at 125 degrees may rightly report 127. Where a result is computed from
 * a register, the range that the register holds.
 */
static const struct {
	const char *families, *property;
	struct quantity is;
} table[] = {
	/*
	 * -55 to +125, at the ends within 2 degrees, a DS1822 within 3; 9 to 12 bits, 0.5 to 0.0625
	 */
	{THERMOMETERS, "temperature", {-58, 128, 4, true, CELSIUS}},
	{THERMOMETERS, "temperature9", {-58, 128, 1, true, CELSIUS}},
	{THERMOMETERS, "temperature10", {-58, 128, 2, true, CELSIUS}},
	{THERMOMETERS, "temperature11", {-58, 128, 3, true, CELSIUS}},
	{THERMOMETERS, "temperature12", {-58, 128, 4, true, CELSIUS}},
	{THERMOMETERS, "fasttemp", {-58, 128, 1, true, CELSIUS}},
	{THERMOMETERS, "latesttemp", {-58, 128, 4, true, CELSIUS}},
	/* MAX31850: 14 bits of 0.25, of which none below absolute zero */
	{"\x3b", "thermocouple", {-273.15, 2047.75, 2, false, CELSIUS}},
	/* DS1921: G -40 to +85 within 1.3, 0.5; H and Z 0.125 */
	{"\x21", "temperature", {-42, 87, 3, false, CELSIUS}},
	/*
	 * DS2438: -55 to +125 within 2, 0.03125; 10 bits of 10 mV; 10 bits and sign of 0.2441 mV. A
	 * TMP1826, which has the same code: up to 150.
	 */
	{"\x26", "temperature", {-58, 151, 5, false, CELSIUS}},
	/* the chip runs on its VDD of 2.4 V at least: a 0 is what a restart left */
	{"\x26", "VDD", {2, 10.23, 2, false, "V"}},
	{"\x26", "VAD", {0, 10.23, 2, false, "V"}},
	{"\x26", "vis", {-0.25, 0.25, 5, false, "V"}},
	/* Sensors of 0 to 100 %RH within 5, and as much again for their ageing in wet air */
	{"\x26", "humidity", {-10, 110, 2, false, "%"}},
	{"\x26", "HIH3600/humidity", {-10, 110, 2, false, "%"}},
	{"\x26", "HIH4000/humidity", {-10, 110, 2, false, "%"}},
	{"\x26", "HIH5030/humidity", {-10, 110, 2, false, "%"}},
	{"\x26", "HTM1735/humidity", {-10, 110, 2, false, "%"}},
	{"\x26", "DATANAB/humidity", {-10, 110, 2, false, "%"}},
	/* absolute, of any sensor: gain and offset are settings */
	{"\x26", "B1-R1-A/pressure", {0, HUGE_VAL, 2, false, "mbar"}},
	{"\x26", "S3-R1-A/illuminance", {0, HUGE_VAL, 1, false, "lx"}},
	/* DS2450: 16 bits of 5.12 or 2.56 V */
	{"\x20", "volt", {0, 5.12, 5, false, "V"}},
	{"\x20", "volt2", {0, 2.56, 5, false, "V"}},
	{"\x20", "latestvolt", {0, 5.12, 5, false, "V"}},
	{"\x20", "latestvolt2", {0, 2.56, 5, false, "V"}},
	/* DS2760: 10 bits and sign of 0.125 */
	{"\x30", "temperature", {-128, 127.875, 3, false, CELSIUS}},
	/* DS1922, DS1923: L -40 to +85, T to +125, E to +140, within 2, 0.0625; sensor as above */
	{"\x41", "temperature", {-42, 142, 4, false, CELSIUS}},
	{"\x41", "humidity", {-10, 110, 2, false, "%"}},
	/* MS5534 on a TAI8570: -40 to +125, 10 to 1100 mbar, within 15 */
	{"\x12", "TAI8570/temperature", {-42, 127, 2, false, CELSIUS}},
	{"\x12", "TAI8570/pressure", {-5, 1115, 2, false, "mbar"}},
	/* DS2423: 32 bits */
	{"\x1d", "counter", {0, UINT32_MAX, 0, false, ""}},
	{"\x1d", "counters", {0, UINT32_MAX, 0, false, ""}},
};
#define ROWS (sizeof(table) / sizeof(table[0]))

/* Is this property the name, or an element of it, as "volt.A" is of "volt"? */
static bool is_named(const struct path_slice *property, const char *name)
{
	const char *dot = memchr(property->text, '.', property->len);
	size_t len = dot ? (size_t)(dot - property->text) : property->len;

	return strlen(name) == len && memcmp(name, property->text, len) == 0;
}

bool quantity_of(const char *text, struct quantity *quantity)
{
	struct path path;

	if (path_split(text, strlen(text), &path) || !path.device.len || !path.property.len)
		return false;
	for (size_t i = 0; i < ROWS; i++) {
		if (!is_named(&path.property, table[i].property) ||
		    (path.has_rom && !strchr(table[i].families, path.rom[0])))
			continue;
		*quantity = table[i].is;
		if (!path.has_rom) {
			/* a temperature is not below absolute zero, whatever measures it */
			quantity->least = quantity->starves ? -273.15 : -HUGE_VAL;
			quantity->most = HUGE_VAL;
		}
		return true;
	}
	return false;
}

bool quantity_excludes(const struct quantity *quantity, double number)
{
	return number < quantity->least || number > quantity->most;
}
