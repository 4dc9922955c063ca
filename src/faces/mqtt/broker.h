/* SPDX-License-Identifier: MIT */
/*
 * The connection to a broker, by libmosquitto in the loop of the face: the ways in turn, with a
 * pause that grows and is different on each machine; each attempt is a new client, so nothing of a
 * lost connection is sent again. Nothing here blocks but the look-up of a host's name, for a few
 * seconds at most, and broker_end().
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/faces/mqtt/client.h"

/* options and what ops needs stay until broker_end(). Begins to connect. */
void broker_begin(struct broker *b, int64_t now_ns);
/*
 * Put the profile's word for the end, after what was put has gone, and disconnect: two seconds at
 * most. If the broker does not acknowledge that until then, it publishes the will.
 */
void broker_end(struct broker *b);
/*
 * The same, and then connect to the next way: what a session is for is not here. vain: it never was
 * in this connection, and the next ones to this way are not worth a line of the log.
 */
void broker_leave(struct broker *b, bool vain, int64_t now_ns);
/* fd is ready, as poll(2) has it. True: it was the broker's. */
bool broker_ready(struct broker *b, int fd, short ready, int64_t now_ns);
void broker_tick(struct broker *b, int64_t now_ns);
/* When to tick at the latest. */
int64_t broker_next(const struct broker *b);
/*
 * Has the connection lasted so long that no other client of the same node takes it again and again?
 * What the broker keeps of the node is not ours alone before.
 */
bool broker_is_settled(const struct broker *b, int64_t now_ns);
/*
 * The will of another process came that had our id meanwhile: two of one node throw each other out.
 */
void broker_taken(struct broker *b);
/*
 * What came was too old, so what the broker holds behind it is, too: connect again, to a session
 * that has nothing.
 */
void broker_forget(struct broker *b);
/* Try again at once, if it is not connected. */
void broker_hurry(struct broker *b, int64_t now_ns);

/* struct outlet. */
bool broker_put(void *ctx, const char *topic, const char *text, size_t len, bool retain);
/*
 * When the broker answers, which sets b->marked, it has all that was put before: QoS 0 has no other
 * proof. False: not now.
 */
bool broker_mark(struct broker *b);
