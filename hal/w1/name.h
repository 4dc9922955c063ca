/* SPDX-License-Identifier: MIT */
/* Names of the kernel's: "28-000003df1d55" is 28.551DDF030000, "w1_bus_master2" a master. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define W1_NAME_MAX 16 /* "28-000003df1d55" with NUL */
#define W1_MASTER_NAME_MAX 24

/* From a ROM id, and back. False: it is none. */
void w1_name(const uint8_t rom[8], char name[W1_NAME_MAX]);
bool w1_name_parse(const char *name, size_t len, uint8_t rom[8]);
/* From a master's number, and back. 0: it is none. */
void w1_master_name(unsigned number, char name[W1_MASTER_NAME_MAX]);
unsigned w1_master_number(const char *name);
