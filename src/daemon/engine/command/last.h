/* SPDX-License-Identifier: MIT */
/*
 * Where the last commands of outputs with Start "last" are kept over a reboot: a seam. The host
 * stores them on a thread of its own; no function here blocks.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct engine_last {
	void *ctx;
	/*
	 * The command of this row, which has Start "last", is to be stored. Returns a ticket: the
	 * command is on the disk once stored() has come to that. 0: it is there already. text: of
	 * strings, else NULL.
	 */
	uint32_t (*put)(void *ctx, uint32_t row, int64_t value, const char *text, uint32_t len);
	uint32_t (*stored)(void *ctx); /* counts on, past 0 */
	int (*error)(void *ctx);       /* 0, or the negative errno of the last try */
	/* What was stored of this row before the start; false: nothing. text has room bytes. */
	bool (*find)(void *ctx, uint32_t row, int64_t *value, char *text, size_t room,
	             uint32_t *len);
};
