/* SPDX-License-Identifier: MIT */
/*
 * Lists a directory by DIRALL, with each device under its id. owserver shows a device that has an
 * alias under the alias only; the property `address` has its id. The ids of aliases are kept for a
 * while.
 */
#pragma once

#include "hal/owfs/path.h"
#include "hal/owserver/talk.h"

#define LISTING_MAX 262144 /* 10 000 devices are 170 kB */
#define LISTING_NAMES 32

struct listing_name {
	char alias[48];
	char id[ROM_TEXT_MAX];
	int64_t until_ns; /* an alias may move to another device */
};

struct listing {
	struct listing_name name[LISTING_NAMES];
	unsigned next;
	uint8_t reply[LISTING_MAX];
};

/*
 * List req->path into req->data, each full path ended by '\n'. Returns 0 and *used; -EMSGSIZE: no
 * room; 1: the server refused with the code talk->reader.header.type; or the error of
 * talk_exchange().
 */
int listing_read(struct listing *listing, struct talk *talk, struct bus_req *req, uint32_t *used);
