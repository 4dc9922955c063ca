/* SPDX-License-Identifier: MIT */
/* What the text of a key may be: the checks of the table of keys. Pure functions. */
#pragma once

#include <stdbool.h>

/* Why the text cannot be the value; NULL: it can. */
typedef const char *text_check(const char *text);

#define TEXT_LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-"

text_check text_is_short, text_is_path, text_is_name, text_is_socket, text_is_url, text_is_hosts;
/* Of owsd-notify. */
text_check text_is_mail, text_is_fields, text_is_hours;
/* "22:00-06:30" as minutes of the day; false: it is none. */
bool text_hours(const char *text, unsigned *from, unsigned *until);
/* A path, or the name of a credential. */
text_check text_is_file;
/* Of a signal: UTF-8 without what disturbs a terminal. */
text_check text_is_unit, text_is_line;
text_check text_is_date, text_is_class, text_is_identity;
/* Of owsd-mqtt. */
text_check text_is_topic, text_is_profile;
