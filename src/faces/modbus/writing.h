/* SPDX-License-Identifier: MIT */
/*
 * Commands of clients. Each address that commands is a controller of its own towards owsd, as
 * modbus:ADDRESS, and beats as long as it asks for something: when it falls silent, owsd has its
 * outputs go to SafeValue. An address that has written the register of the beat beats by that
 * alone: its program may have stopped while something else goes on to ask.
 */
#pragma once

#include "src/faces/kit/command.h"
#include "src/faces/modbus/answer.h"

#define WRITERS 16 /* addresses that command at a time */

struct writer {
	struct listen_address from; /* without a port */
	struct face_way way;
	int64_t again_ns;    /* when to open the way again; 0: it is open */
	int64_t heard_ns;    /* CLOCK_MONOTONIC: time asleep is no silence */
	int64_t promised_ns; /* to owsd, by its last beat */
	bool used, by_register;
};

struct writing {
	struct face *face;
	struct writer writers[WRITERS];
	/* what one request sets */
	const char *names[FRAME_WRITES_MOST];
	double numbers[FRAME_WRITES_MOST];
	int ids[FRAME_WRITES_MOST], count;
	uint64_t taken;
	int64_t said_ns; /* when the log had the last refusal */
};

/* May a client at that address command the signal, or beat (NULL)? */
enum exception writing_may(const struct writing *w, const char *name,
                           const struct listen_address *from);
/*
 * One more to be set, if the signal takes the number, as far as its type, Min and Max say; if not,
 * the log has it.
 */
enum exception writing_add(struct writing *w, const struct ows_info *info, double number,
                           const struct listen_address *from);
/* Set all of them (one at least), or none; came_ns as in struct face_command. */
enum exception writing_set(struct writing *w, const struct listen_address *from, int64_t came_ns);
/*
 * A client at that address, which may have commanded, has asked; by_register: written its beat.
 * EXCEPTION_BUSY: what may have waited says nothing of the client now.
 */
enum exception writing_heard(struct writing *w, const struct listen_address *from, int64_t came_ns,
                             bool by_register);
/*
 * End the way of each that owsd has lost: owsctl who shows it no longer as late. Returns when the
 * next may be lost.
 */
int64_t writing_tick(struct writing *w, int64_t now_ns);
/* At the end: who has promised a beat is lost to owsd, so that its outputs become safe. */
void writing_close(struct writing *w);

#define WRITING_PERSON 32
/* "modbus:10.0.0.5"; of a long address the end. Returns person. Pure. */
const char *writing_person(const struct listen_address *from, char person[WRITING_PERSON]);
/* What a client is told of an error of face_way_try(). Pure. */
enum exception writing_refusal(int err);
