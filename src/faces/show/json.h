/* SPDX-License-Identifier: MIT */
/* A JSON writer: one document on one line, valid by RFC 8259 whatever the strings contain. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct json {
	FILE *out;
	bool inner; /* the next value needs a comma */
	bool list;  /* json_list() has begun one */
};

void json_open(struct json *json, FILE *out);
void json_end(struct json *json); /* Write the newline; the writer is as after json_open(). */
/* A document that is an array, opened and ended. Not wanted: these two write nothing. */
void json_list(struct json *json, FILE *out, bool wanted);
void json_list_end(struct json *json);

/*
 * A document in memory that is one object: open both, and end both. text is allocated, and valid
 * with len after the end. False: no memory, and text is NULL.
 */
bool json_start(struct json *json, char **text, size_t *len);
void json_finish(struct json *json);

/* Of a member whose value is written as an element. */
void json_key(struct json *json, const char *key);
/* key NULL: an element of an array, or the document itself. */
void json_object(struct json *json, const char *key);
void json_object_end(struct json *json);
void json_array(struct json *json, const char *key);
void json_array_end(struct json *json);
/* text NULL: null. Bytes that are not UTF-8 become U+FFFD. */
void json_string(struct json *json, const char *key, const char *text);
void json_bytes(struct json *json, const char *key, const char *text, size_t len);
/* The member "value"; also "hex", all bytes, if they are not UTF-8. */
void json_text(struct json *json, const char *text, size_t len);
void json_int(struct json *json, const char *key, int64_t number);
void json_uint(struct json *json, const char *key, uint64_t number);
/* For a browser, which has 53 bits for a number: what it would round is a text of its digits. */
void json_exact(struct json *json, const char *key, int64_t number);
void json_known(struct json *json, const char *key, int number); /* null below 0 */
void json_bool(struct json *json, const char *key, bool value);
void json_null(struct json *json, const char *key);
/* Nanoseconds as seconds with three digits. */
void json_seconds(struct json *json, const char *key, int64_t ns);
/* Has JSON such a number? -?D+(.D+)?([eE][+-]?D+)? without a 0 in front. */
bool json_is_number(const char *text, size_t len);
/* A number that is already text; null without a text, or if JSON has no such number (nan, inf). */
void json_number(struct json *json, const char *key, const char *text);
void json_double(struct json *json, const char *key, double number); /* null for a NaN */
