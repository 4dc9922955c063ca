/* SPDX-License-Identifier: MIT */
/*
 * A face's look at owsd: opens its instance, and again when that has to be; gives changes, losses
 * and entries of the journals to the face. Never blocks, but for libows's 20 ms after a restart.
 */
#pragma once

#include "src/faces/kit/face.h"

/* All that has happened up to now, unless the pace of the face has the look wait. */
void look(struct face *face, int64_t now_ns);
/*
 * owsd is there, and ows is of the image that the face was told of last: indexes of signals are
 * those of the last FACE_FOUND or FACE_RELOADED. False also for the moments of a reload in which
 * ows is of the new image already, or still of the old one. A face asks this before it looks at
 * signals by index at another time than in changes().
 */
bool look_is_current(const struct face *face);
/* When to look again if the descriptor stays silent. */
int64_t look_next(const struct face *face, int64_t now_ns);
/* A descriptor that is readable when there is something to look at; -1: none. */
int look_descriptor(const struct face *face, int64_t now_ns);

/*
 * Read the configuration for the first time, as face->config. Errors go to stderr. 0 or a negative
 * errno.
 */
int load_first(struct face *face);
/* Read it again. Errors go to the log, and one that is refused leaves the present one. */
void load_again(struct face *face);
