/* SPDX-License-Identifier: MIT */
/*
 * GET api/devices: the devices on the buses of owsd, whether they have signals or not. With ids=
 * those devices alone, read past the cache. One scan at a time.
 */
#ifndef WEB_DEVICES_H
#define WEB_DEVICES_H

struct request;

int devices_get(struct request *request);

#endif
