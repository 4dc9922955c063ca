/* SPDX-License-Identifier: MIT */
/* A recording, or a replay, as its owner sees it. */
#pragma once

#include <stdio.h>

#include "hal/bus/tap.h"

#define TRACE_BEGIN "owsd trace 1\n"
#define TRACE_MOST (2u << 20) /* bytes of a recording */
#define TRACE_LINKS 64

struct trace {
	struct tap tap;   /* first: for bus_env.tap */
	FILE *file;       /* of a recording: remarks may be written there too; NULL: a replay */
	unsigned lines;   /* recorded */
	size_t left;      /* bytes that may still be recorded; 0: it is full */
	int64_t since_ns; /* when the first line was begun; 0: there is none */
	void (*progress)(const struct trace *trace); /* after each line; NULL: nobody looks */
};
