/* SPDX-License-Identifier: MIT */
/*
 * A stand-in for LinuxCNC's header of this name: what docs/examples/linuxcnc/owsd_hal.c calls,
 * declared as there, so that the example is compiled and run by the tests. LinuxCNC itself is
 * another project; docs/linuxcnc.md says against which one the example was tried.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define HAL_NAME_LEN 47

typedef volatile bool hal_bit_t;
typedef volatile int32_t hal_s32_t;
typedef volatile uint32_t hal_u32_t;
typedef volatile double hal_float_t;

typedef enum { HAL_BIT = 1, HAL_FLOAT = 2, HAL_S32 = 3, HAL_U32 = 4 } hal_type_t;
typedef enum { HAL_IN = 16, HAL_OUT = 32, HAL_IO = 48 } hal_pin_dir_t;

int hal_init(const char *name);
int hal_ready(int comp_id);
int hal_exit(int comp_id);
void *hal_malloc(long size);

#define HAL_PIN(kind, type) \
	int hal_pin_##kind##_newf(hal_pin_dir_t dir, type **data, int comp_id, const char *format, \
	                          ...) __attribute__((format(printf, 4, 5)))
HAL_PIN(bit, hal_bit_t);
HAL_PIN(s32, hal_s32_t);
HAL_PIN(u32, hal_u32_t);
HAL_PIN(float, hal_float_t);
