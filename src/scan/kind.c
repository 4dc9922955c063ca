/* SPDX-License-Identifier: MIT */
/* The properties that most people want of a device, by its family. */
#include <stdio.h>
#include <string.h>

#include "src/scan/device.h"
#include "src/scan/kind.h"

/* In periods of 0.1 s: measurements once a second, contacts in each period. */
#define MEASURED 10

static const struct scan_kind kinds[] = {
	{"10 54", {{"temperature", "temperature", OWS_DOUBLE, .per_factor = MEASURED}}},
	{"22 28 42", {{"temperature12", "temperature", OWS_DOUBLE, .per_factor = MEASURED}}},
	{"3B",
         {{"temperature12", "temperature", OWS_DOUBLE, .per_factor = MEASURED},
          {"thermocouple", "thermocouple", OWS_DOUBLE, .per_factor = MEASURED}}},
	{"01 09 14 23 2D 31 43", {{"present", "present", OWS_BOOL}}},
	{"05", {{"sensed", "contact", OWS_BOOL}, {"PIO", "switch", OWS_BOOL, .output = true}}},
	{"12 29 3A",
         {{"sensed.BYTE", "inputs", OWS_BYTE}, {"PIO.BYTE", "outputs", OWS_BYTE, .output = true}}},
	{"26",
         {{"temperature", "temperature", OWS_DOUBLE, .per_factor = MEASURED},
          {"humidity", "humidity", OWS_DOUBLE, .per_factor = MEASURED},
          {"VDD", "vdd", OWS_DOUBLE, .per_factor = MEASURED},
          {"VAD", "vad", OWS_DOUBLE, .per_factor = MEASURED}}},
	{"20",
         {{"volt.A", "volt_a", OWS_DOUBLE, .per_factor = MEASURED},
          {"volt.B", "volt_b", OWS_DOUBLE, .per_factor = MEASURED},
          {"volt.C", "volt_c", OWS_DOUBLE, .per_factor = MEASURED},
          {"volt.D", "volt_d", OWS_DOUBLE, .per_factor = MEASURED}}},
	{"1D", {{"counter.A", "counter_a", OWS_DWORD}, {"counter.B", "counter_b", OWS_DWORD}}},
};

const struct scan_kind *scan_kind_of(uint8_t family)
{
	char text[4];

	snprintf(text, sizeof(text), "%02X", family);
	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++)
		if (strstr(kinds[i].families, text))
			return &kinds[i];
	return NULL;
}

bool scan_has_identity(uint8_t family)
{
	return family == 0x26 || family == 0x28 || family == 0x3B || family == 0xA6;
}
