/* SPDX-License-Identifier: MIT */
/* The program of a face: its start, its loop, its end; and what the loop does for the face. */
#pragma once

#include "src/faces/kit/face.h"

/*
 * The program: reads the command line and the file, runs the loop until SIGTERM or SIGINT. Returns
 * the exit status: 0; 1 it cannot run; 2 the command line or the file is wrong.
 */
int face_main(const struct face_ops *ops, int argc, char **argv);

/* Wait for fd too, events as in poll(2). 0 or -ENOSPC. face_ignore() before closing it. */
int face_watch(struct face *face, int fd, short events);
void face_ignore(struct face *face, int fd);
/* Wait for these events in place of those before; 0: no more. As post_open() wants it. */
void face_watch_anew(void *face, int fd, short events);
/*
 * When the loop last saw that nothing was to be read at fd: all that is read there now came later.
 * That is a second ago at most, but where the face did not run, or was busy. 0: not yet.
 */
int64_t face_came(const struct face *face, int fd);
/* What `systemctl status` shows, with a door that is shut. Sent only when it changes. */
void face_status(struct face *face, const char *format, ...) __attribute__((format(printf, 2, 3)));
