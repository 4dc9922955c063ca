/* SPDX-License-Identifier: MIT */
#ifndef FACE_LOAD_H
#define FACE_LOAD_H

struct face;

/*
 * Read the configuration for the first time, as face->config. Errors go to stderr. 0 or a negative
 * errno.
 */
int load_first(struct face *face);
/* Read it again. Errors go to the log, and one that is refused leaves the present one. */
void load_again(struct face *face);
void load_free(struct face *face);

#endif
