/* SPDX-License-Identifier: MIT */
/*
 * The return codes of the owserver protocol: what an error of a bus is for a client, as the genuine
 * owserver says it, and the texts that clients ask for in /settings/return_codes.
 */
#ifndef SERVE_CODE_H
#define SERVE_CODE_H

#include <stddef.h>
#include <stdint.h>

/* What is not an error of a bus. */
#define CODE_NO_SUCH_PATH (-1)
#define CODE_READ_ONLY (-30)
#define CODE_BAD_TYPE (-42)
#define CODE_EMPTY (-74)
#define CODE_BAD_SIZE (-90)

#define CODE_COUNT 211

/* The return code of a negative errno of a bus (hal/bus/bus.h) or of the served namespace. */
int32_t code_of(int err);
/* What a code means; never NULL, without a comma. */
const char *code_text(unsigned code);
/* All texts with commas between. Returns the length, -EMSGSIZE. */
int code_texts(char *text, size_t room);

#endif
