/* SPDX-License-Identifier: MIT */
/* The numbers that clients see for the buses of all targets: /bus.N. */
#include <string.h>

#include "src/serve/buses.h"

int buses_number(struct buses *buses, unsigned target, unsigned number)
{
	for (unsigned i = 0; i < buses->count; i++)
		if (buses->bus[i].target == target && buses->bus[i].number == number)
			return (int)i;
	for (unsigned i = 0; buses->count == BUSES_MAX && i < BUSES_MAX; i++)
		if (buses->bus[i].target == BUSES_NO_TARGET) {
			buses->bus[i].target = (uint8_t)target;
			buses->bus[i].number = (uint16_t)number;
			return (int)i;
		}
	if (buses->count == BUSES_MAX)
		return -1;
	buses->bus[buses->count].target = (uint8_t)target;
	buses->bus[buses->count].number = (uint16_t)number;
	return (int)buses->count++;
}

void buses_renumber(struct buses *buses, const int *ports, unsigned count)
{
	for (unsigned i = 0; i < buses->count; i++) {
		unsigned before = buses->bus[i].target;

		buses->bus[i].target = BUSES_NO_TARGET;
		for (unsigned k = 0; k < count; k++)
			if (ports[k] == (int)before)
				buses->bus[i].target = (uint8_t)k;
	}
}

int buses_parse(const char *name, unsigned len)
{
	int number = 0;

	if (len < 5 || len > 8 || memcmp(name, "bus.", 4) != 0)
		return -1;
	for (unsigned i = 4; i < len; i++) {
		if (name[i] < '0' || name[i] > '9')
			return -1;
		number = number * 10 + (name[i] - '0');
	}
	return number;
}
