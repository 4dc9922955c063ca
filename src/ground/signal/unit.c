/* SPDX-License-Identifier: MIT */
/* The table of the units that owsd knows, and what follows from it. */
#include <stdio.h>
#include <string.h>

#include "src/ground/signal/unit.h"

enum quantity {
	TEMPERATURE,
	TEMPERATURE_DIFFERENCE,
	PRESSURE,
	VOLTAGE,
	CURRENT,
	RESISTANCE,
	CHARGE,
	POWER,
	ENERGY,
	FREQUENCY,
	LIGHT,
	LENGTH,
	SPEED,
	DURATION,
	VOLUME,
	FLOW,
	SHARE,
	OTHERS,
};

/* The first of a quantity is the one that those behind it are made of: it * factor + offset. */
static const struct unit {
	enum quantity quantity;
	const char *symbol;
	const char *others; /* spellings, a blank behind each */
	double factor, offset;
	const char *class; /* of Home Assistant, where it knows the unit; else NULL */
} units[] = {
	{TEMPERATURE, "°C", "C degC ℃ Cel Celsius celsius ", 1, 0, "temperature"},
	{TEMPERATURE, "°F", "F degF ℉ [degF] Fahrenheit fahrenheit ", 1.8, 32, "temperature"},
	/* a chip's table has it for differences: so it has no class */
	{TEMPERATURE, "K", "°K degK Kelvin kelvin ", 1, 273.15, NULL},
	{TEMPERATURE_DIFFERENCE, "K", "°K degK Kelvin kelvin ", 1, 0, NULL},
	{TEMPERATURE_DIFFERENCE, "°C", "C degC ℃ Cel Celsius celsius ", 1, 0, NULL},
	{TEMPERATURE_DIFFERENCE, "°F", "F degF ℉ [degF] Fahrenheit fahrenheit ", 1.8, 0, NULL},
	{PRESSURE, "mbar", "mb ", 1, 0, "pressure"},
	{PRESSURE, "hPa", "hpa ", 1, 0, "pressure"},
	{PRESSURE, "Pa", "pa ", 100, 0, "pressure"},
	{PRESSURE, "kPa", "kpa KPa ", 0.1, 0, "pressure"},
	{PRESSURE, "bar", "Bar ", 0.001, 0, "pressure"},
	{PRESSURE, "psi", "PSI [psi] ", 1 / 68.947572931683, 0, "pressure"},
	{PRESSURE, "inHg", "[in_i'Hg] ", 1 / 33.863886666667, 0, "pressure"},
	{PRESSURE, "mmHg", "Torr torr mm[Hg] ", 1 / 1.3332239, 0, "pressure"},
	{VOLTAGE, "V", "Volt volt volts ", 1, 0, "voltage"},
	{VOLTAGE, "mV", "", 1e3, 0, "voltage"},
	{VOLTAGE, "\u00b5V", "uV \u03bcV ", 1e6, 0, "voltage"},
	{CURRENT, "A", "amp Amp ampere ", 1, 0, "current"},
	{CURRENT, "mA", "", 1e3, 0, "current"},
	{CURRENT, "\u00b5A", "uA \u03bcA ", 1e6, 0, NULL},
	{RESISTANCE, "\u03a9", "Ohm ohm \u2126 ", 1, 0, NULL},
	{RESISTANCE, "k\u03a9", "kOhm kohm k\u2126 ", 1e-3, 0, NULL},
	{CHARGE, "Ah", "A.h ", 1, 0, NULL},
	{CHARGE, "mAh", "mA.h ", 1e3, 0, NULL},
	{POWER, "W", "", 1, 0, "power"},
	{POWER, "kW", "", 1e-3, 0, "power"},
	{ENERGY, "Wh", "W.h ", 1, 0, "energy"},
	{ENERGY, "kWh", "kW.h ", 1e-3, 0, "energy"},
	{FREQUENCY, "Hz", "", 1, 0, "frequency"},
	{FREQUENCY, "rpm", "1/min ", 60, 0, NULL},
	{LIGHT, "lx", "lux Lux ", 1, 0, "illuminance"},
	{LENGTH, "m", "", 1, 0, "distance"},
	{LENGTH, "ft", "[ft_i] ", 1 / 0.3048, 0, "distance"},
	{SPEED, "m/s", "", 1, 0, "speed"},
	{SPEED, "km/h", "kmh kph ", 3.6, 0, "speed"},
	{SPEED, "mph", "[mi_i]/h ", 3600 / 1609.344, 0, "speed"},
	{SPEED, "kn", "[kn_i] ", 3600 / 1852.0, 0, "speed"},
	{DURATION, "s", "sec ", 1, 0, "duration"},
	{DURATION, "min", "", 1 / 60.0, 0, "duration"},
	{DURATION, "h", "hour hours ", 1 / 3600.0, 0, "duration"},
	{DURATION, "d", "day days ", 1 / 86400.0, 0, "duration"},
	{VOLUME, "m³", "m3 m^3 cbm ", 1, 0, NULL},
	{VOLUME, "L", "l liter litre ", 1e3, 0, NULL},
	{FLOW, "m³/h", "m3/h m^3/h ", 1, 0, "volume_flow_rate"},
	{FLOW, "L/min", "l/min ", 1e3 / 60, 0, "volume_flow_rate"},
	{SHARE, "%", "percent ", 1, 0, NULL},
	{OTHERS, "ppm", "[ppm] ", 1, 0, "carbon_dioxide"},
	{OTHERS, "Vh", "V.h ", 1, 0, NULL},
};
#define UNITS (sizeof(units) / sizeof(units[0]))

static bool is_spelling(const struct unit *unit, const char *text)
{
	size_t len = strlen(text);

	if (!strcmp(unit->symbol, text))
		return true;
	for (const char *p = unit->others; *p; p += strcspn(p, " ") + 1)
		if (strcspn(p, " ") == len && !memcmp(p, text, len))
			return true;
	return false;
}

static bool is_first(const struct unit *unit)
{
	return unit == units || unit[-1].quantity != unit->quantity;
}

/* That of a chip's table: where a spelling is of two quantities, the one that begins with it. */
static const struct unit *find_unit(const char *text)
{
	const struct unit *found = NULL;

	for (size_t i = 0; i < UNITS; i++)
		if (is_spelling(&units[i], text) && (!found || is_first(&units[i])))
			found = &units[i];
	return found;
}

static const struct unit *find_of(const char *text, enum quantity quantity)
{
	for (size_t i = 0; i < UNITS; i++)
		if (units[i].quantity == quantity && is_spelling(&units[i], text))
			return &units[i];
	return NULL;
}

bool unit_convert(const char *from, const char *to, double *factor, double *offset)
{
	const struct unit *a = find_unit(from);
	const struct unit *b = a ? find_of(to, a->quantity) : NULL;

	if (!b || (a != b && a->quantity == OTHERS))
		return false;
	*factor = b->factor / a->factor;
	*offset = b->offset - a->offset * *factor;
	return true;
}

const char *unit_symbol(const char *text)
{
	const struct unit *unit = find_unit(text);

	return unit ? unit->symbol : NULL;
}

const char *unit_class(const char *text)
{
	const struct unit *unit = find_unit(text);

	return unit ? unit->class : NULL;
}

void unit_list(const char *text, char *out, size_t size)
{
	const struct unit *unit = find_unit(text);
	size_t used = 0;

	out[0] = '\0';
	for (size_t i = 0; i < UNITS && unit; i++)
		if (units[i].quantity == unit->quantity && used < size &&
		    (unit->quantity != OTHERS || &units[i] == unit))
			used += (size_t)snprintf(out + used, size - used, "%s%s", used ? ", " : "",
			                         units[i].symbol);
}
