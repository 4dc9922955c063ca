/* SPDX-License-Identifier: MIT */
/*
 * A HAL for the tests of docs/examples/linuxcnc/owsd_hal.c. It refuses what the genuine one
 * refuses, and in place of halcmd there is a person at the standard input:
 *
 *     show            all pins, "NAME TYPE DIR VALUE", then "end"
 *     setp NAME VALUE
 *     net NAME        the pin's pointer moves to another cell, as when it is linked with a signal
 *
 * Who is spoken to is another process over the same memory, as halcmd and the servo thread are.
 */
#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "tests/system/linuxcnc/hal.h"

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

/* At the same place in both processes */
static struct shared {
	struct pin pins[PINS];
	int count;
	bool ready;
	long used;
	_Alignas(16) char memory[1 << 16];
} * hal;

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

	for (const struct pin *pin = hal->pins; pin < hal->pins + hal->count; pin++)
		printf("%s %s %s %.17g\n", pin->name, types[pin->type],
		       pin->dir == HAL_IN ? "in" : "out", number(pin));
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

static void obey(void)
{
	char line[256], verb[16], name[128];
	double value;

	while (fgets(line, sizeof(line), stdin)) {
		int n = sscanf(line, "%15s %127s %lf", verb, name, &value);

		if (n == 1 && !strcmp(verb, "show"))
			show();
		for (struct pin *pin = hal->pins; n > 1 && pin < hal->pins + hal->count; pin++) {
			if (strcmp(pin->name, name))
				continue;
			if (!strcmp(verb, "setp") && n == 3)
				set(pin, value);
			if (!strcmp(verb, "net")) {
				pin->linked = *cell_of(pin);
				*pin->data = &pin->linked;
			}
		}
	}
}

int hal_init(const char *name)
{
	hal = mmap(NULL, sizeof(*hal), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (hal == MAP_FAILED)
		return -ENOMEM;
	return *name && strlen(name) <= HAL_NAME_LEN ? 1 : -EINVAL;
}

void *hal_malloc(long size)
{
	char *room = hal->memory + hal->used;

	if (size < 0 || hal->used + size + 15 > (long)sizeof(hal->memory))
		return NULL;
	hal->used += (size + 15) / 16 * 16;
	return room;
}

int hal_ready(int comp_id)
{
	pid_t component = getpid(), child;

	(void)comp_id;
	hal->ready = true;
	printf("ready\n");
	fflush(stdout);
	child = fork();
	if (child)
		return child < 0 ? -errno : 0;
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() == component)
		obey();
	_exit(0);
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
	struct pin *pin = &hal->pins[hal->count];
	int n = vsnprintf(pin->name, sizeof(pin->name), format, args);

	if (n < 1 || n > HAL_NAME_LEN || hal->count == PINS - 1 || hal->ready)
		return -EINVAL;
	if ((char *)data < hal->memory || (char *)data >= hal->memory + hal->used)
		return -EINVAL;
	for (int i = 0; i < hal->count; i++) {
		if (!strcmp(hal->pins[i].name, pin->name))
			return -EINVAL;
	}
	pin->type = type;
	pin->dir = dir;
	pin->data = data;
	*data = &pin->own;
	hal->count++;
	return 0;
}

#define NEWF(kind, ctype, htype) \
	int hal_pin_##kind##_newf(hal_pin_dir_t dir, ctype **data, int comp_id, \
	                          const char *format, ...) \
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
