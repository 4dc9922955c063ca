/* SPDX-License-Identifier: MIT */
/* POST api/config/save and api/config/restore: what the writer does with the file. */
#ifndef WEB_SAVE_H
#define WEB_SAVE_H

struct request;

int save_post(struct request *request);
int save_restore(struct request *request);

#endif
