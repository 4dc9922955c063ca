/* SPDX-License-Identifier: MIT */
/*
 * A control room with three signals and a thread that takes joining and leaving controllers as the
 * engine's does; and the programs that connect to it.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "src/config/read/config.h"
#include "src/memory/control/control.h"

/* Nothing here waits longer than that for something that has to come. */
#define CONTROL_SCENE_MS 20000

extern struct control *control_room;
extern struct config control_config; /* pump_1, pump_2, valve; a test adds ControlAllow */

/* Make the room, in a folder of the test's own; the configuration is as the test has set it. */
void control_open(void);
void control_close(void);
/* The whole of a reload, with the same configuration but for what the test has changed. */
void control_reload(void);

/* The engine's thread rings the news of the controllers that wait for it. */
void control_ring_news(void);

/* How many controllers the engine's thread has now, and how often one joined or left. */
unsigned control_joined(void), control_left(void), control_inside(void);
/* The message by which the controller with that serial joined, or its memory of a reload. */
const struct control_message *control_message_of(uint32_t serial);
uint64_t control_count(const char *name);
void control_wait_count(const char *name, uint64_t count);

/* What a program that connected has. */
struct control_client {
	int fd; /* -1: it could not connect */
	struct ows_welcome welcome;
	int fds[3]; /* memory, bell, news; -1: did not come */
	char *memory;
};
int control_connect(void); /* a descriptor, or a negative errno */
struct ows_hello control_hello(uint32_t flags, const char *name);
/* Receive a welcome and what comes along. 0; -EPIPE: owsd hung up; else a negative errno. */
int control_receive(int fd, struct ows_welcome *welcome, int fds[3]);
/* Connect, say hello, and map the memory. Returns welcome.err, or why there was no welcome. */
int control_join(struct control_client *client, uint32_t flags, const char *name);
void control_leave(struct control_client *client);
/*
 * The same in a process of its own, as another user (0: as this one) and with those other groups:
 * returns what control_join() returned there.
 */
int control_join_as(uid_t uid, const gid_t *groups, size_t group_count, uint32_t flags);
