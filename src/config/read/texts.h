/* SPDX-License-Identifier: MIT */
/* What the text of a key may be: the checks of the table of keys. Pure functions. */
#pragma once

/* Why the text cannot be the value; NULL: it can. */
typedef const char *text_check(const char *text);

#define TEXT_LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-"

text_check text_is_short, text_is_path, text_is_name, text_is_socket, text_is_url, text_is_hosts;
/* A path, or the name of a credential. */
text_check text_is_file;
/* Of a signal: UTF-8 without what disturbs a terminal. */
text_check text_is_unit, text_is_line;
text_check text_is_date, text_is_start, text_is_class, text_is_identity;
/* Of owsd-mqtt. */
text_check text_is_topic, text_is_profile, text_is_protocol;
