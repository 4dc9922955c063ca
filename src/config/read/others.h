/* SPDX-License-Identifier: MIT */
/* Others of the block Web: the pages of other machines and instances. Pure functions. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#define OTHERS_MAX 32
#define OTHER_NAME 64

/* One of them: NAME ADDRESS, or NAME ADDRESS PAGE. */
struct other_place {
	char name[OTHER_NAME]; /* for people */
	char host[256];        /* a name, or an address without brackets; the path of a socket */
	char port[6];          /* "": host is the path of a socket */
	char path[256];        /* that the page has there, from "/" to "/" */
	char page[256];        /* where a browser finds it; "": nowhere */
};

/* Read one (len bytes). NULL, or why it is none. */
const char *other_parse(const char *text, size_t len, struct other_place *place);
/* The next one of the list; false: there is none. *why: as other_parse() has it. */
bool other_next(const char **text, struct other_place *place, const char **why);
