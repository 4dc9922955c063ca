/* SPDX-License-Identifier: MIT */
/*
 * The return codes of the owserver protocol: the code that a client gets for an error of a bus, as
 * from the genuine owserver, and the texts that clients read in /settings/return_codes.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Codes for errors that do not come from a bus. */
#define CODE_NO_SUCH_PATH (-1)
#define CODE_READ_ONLY (-30)
#define CODE_BAD_TYPE (-42)
#define CODE_TOO_OLD (-73) /* "Owserver protocol - timeout" in the texts of owserver */
#define CODE_EMPTY (-74)
#define CODE_BAD_SIZE (-90)

#define CODE_COUNT 211

/* The return code of a negative errno of a bus (hal/bus/bus.h) or of the served namespace. */
int32_t code_of(int err);
/* The text of a code; never NULL, without a comma. */
const char *code_text(unsigned code);
/* Print all texts with commas between. Returns the length, or -EMSGSIZE. */
int code_texts(char *text, size_t room);
