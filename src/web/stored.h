/* SPDX-License-Identifier: MIT */
/* The configuration as it is on disk, and the table of its keys. */
#ifndef WEB_STORED_H
#define WEB_STORED_H

struct request;

int stored_get(struct request *request);
int stored_keys(struct request *request);

#endif
