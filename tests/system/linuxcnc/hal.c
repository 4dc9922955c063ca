/* SPDX-License-Identifier: MIT */
/*
 * A HAL for the tests of docs/examples/linuxcnc/owsd_hal.c. It refuses what the genuine one
 * refuses, and in place of halcmd there is a person at the standard input:
 *
 *     show            all pins, "NAME TYPE DIR VALUE", then "end"
 *     setp NAME VALUE
 *     net NAME        the pin's pointer moves to another cell, as when it is linked with a signal
 */
#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal.h"

#define PINS 64

union cell {
	hal_bit_t bit;
	hal_s32_t s32;
	hal_u32_t u32;
	hal_float_t real;
};

struct pin {
	char name[HAL_NAME_LEN + 1];
	hal_type_t type;
	hal_pin_dir_t dir;
	void **data;
	union cell own, linked;
};

static struct pin pins[PINS];
static int pin_count;
static bool ready;
static _Alignas(16) char memory[1 << 16];
static long used;

static union cell *cell_of(const struct pin *pin)
{
	return *pin->data;
}

static double number(const struct pin *pin)
{
	switch (pin->type) {
	case HAL_BIT:
		return cell_of(pin)->bit;
	case HAL_S32:
		return cell_of(pin)->s32;
	case HAL_U32:
		return cell_of(pin)->u32;
	case HAL_FLOAT:
		return cell_of(pin)->real;
	}
	return 0;
}

static void show(void)
{
	static const char *const types[] = {"", "bit", "float", "s32", "u32"};

	for (int i = 0; i < pin_count; i++)
		printf("%s %s %s %.17g\n", pins[i].name, types[pins[i].type],
		       pins[i].dir == HAL_IN ? "in" : "out", number(&pins[i]));
	printf("end\n");
	fflush(stdout);
}

static void set(struct pin *pin, double value)
{
	switch (pin->type) {
	case HAL_BIT:
		cell_of(pin)->bit = value != 0;
		break;
	case HAL_S32:
		cell_of(pin)->s32 = (int32_t)value;
		break;
	case HAL_U32:
		cell_of(pin)->u32 = (uint32_t)value;
		break;
	case HAL_FLOAT:
		cell_of(pin)->real = value;
		break;
	}
}

static void *obey(void *unused)
{
	char line[256], verb[16], name[128];
	double value;

	while (fgets(line, sizeof(line), stdin)) {
		int n = sscanf(line, "%15s %127s %lf", verb, name, &value);

		if (n == 1 && !strcmp(verb, "show"))
			show();
		for (int i = 0; n > 1 && i < pin_count; i++) {
			if (strcmp(pins[i].name, name))
				continue;
			if (!strcmp(verb, "setp") && n == 3)
				set(&pins[i], value);
			if (!strcmp(verb, "net")) {
				pins[i].linked = *cell_of(&pins[i]);
				*pins[i].data = &pins[i].linked;
			}
		}
	}
	return unused;
}

int hal_init(const char *name)
{
	return *name && strlen(name) <= HAL_NAME_LEN ? 1 : -EINVAL;
}

void *hal_malloc(long size)
{
	char *room = memory + used;

	if (size < 0 || used + size + 15 > (long)sizeof(memory))
		return NULL;
	used += (size + 15) / 16 * 16;
	return room;
}

int hal_ready(int comp_id)
{
	pthread_t thread;

	(void)comp_id;
	ready = true;
	printf("ready\n");
	fflush(stdout);
	return -pthread_create(&thread, NULL, obey, NULL);
}

int hal_exit(int comp_id)
{
	(void)comp_id;
	return 0;
}

/* The pointer has to be in HAL's own memory, the name new and short enough */
static int pin_new(hal_type_t type, hal_pin_dir_t dir, void **data, const char *format,
                   va_list args)
{
	struct pin *pin = &pins[pin_count];
	int n = vsnprintf(pin->name, sizeof(pin->name), format, args);

	if (n < 1 || n > HAL_NAME_LEN || pin_count == PINS - 1 || ready)
		return -EINVAL;
	if ((char *)data < memory || (char *)data >= memory + used)
		return -EINVAL;
	for (int i = 0; i < pin_count; i++) {
		if (!strcmp(pins[i].name, pin->name))
			return -EINVAL;
	}
	pin->type = type;
	pin->dir = dir;
	pin->data = data;
	*data = &pin->own;
	pin_count++;
	return 0;
}

#define NEWF(kind, ctype, htype) \
	int hal_pin_##kind##_newf(hal_pin_dir_t dir, ctype **data, int comp_id, const char *format, ...) \
	{ \
		va_list args; \
		int err; \
\
		(void)comp_id; \
		va_start(args, format); \
		err = pin_new(htype, dir, (void **)data, format, args); \
		va_end(args); \
		return err; \
	}
NEWF(bit, hal_bit_t, HAL_BIT)
NEWF(s32, hal_s32_t, HAL_S32)
NEWF(u32, hal_u32_t, HAL_U32)
NEWF(float, hal_float_t, HAL_FLOAT)
