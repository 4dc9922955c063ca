/* SPDX-License-Identifier: MIT */
/* Why a broker is lost, in words, and what a person can do about it. Pure functions. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* The broker does not speak this version of MQTT. */
#define ADVICE_PROTOCOL 0x84
/* Another client took our place */
#define ADVICE_TAKEN_OVER 0x8e
/* Of a message that the broker does not take, and that was not sent */
#define ADVICE_LARGE "it is too large; raise there max_packet_size"
/* Of one that it has not taken when it closed the connection */
#define ADVICE_MAY_BE_LARGE "is that too large? Raise there max_packet_size"
#define ADVICE_WORDS 384

/* The code of a CONNACK; old: of MQTT 3.1.1; as one of MQTT 5. */
int advice_connack(int code, bool old);
/*
 * code: a reason of MQTT 5 from 128 on, else an error of libmosquitto; err: errno beside it; tls:
 * what the TLS library reported.
 */
const char *advice_words(int code, int err, const char *tls);
/* "" if nothing helps but waiting. */
const char *advice_remedy(int code, int err, const char *tls);
/*
 * The remedy for a broker that took the connection and closed it without an answer. tls: we spoke
 * TLS.
 */
const char *advice_hung_up(bool tls);
/* What the broker has not taken when it closed the connection without a word. Returns words. */
const char *advice_closed(size_t len, const char *topic, const char **remedy,
                          char words[ADVICE_WORDS]);
/* Is it an answer, of TLS or of MQTT, to who wants to connect? No network or name is none. */
bool advice_refuses(int code);
/* The part of a line of libmosquitto's log that a person can read. */
const char *advice_tls(const char *line);
