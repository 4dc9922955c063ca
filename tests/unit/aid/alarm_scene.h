/* SPDX-License-Identifier: MIT */
/* Switches in alarm on a scene, for the tests of the alarm machine. */
#pragma once

#include "tests/unit/aid/scene.h"

/* Two switches and a thermometer. */
#define D "/29.066418000000"
#define E "/29.777777000000"
#define T "/28.551DDF030000"
#define T_TEMP T "/temperature12"

/* An input with alarm keys; NULL: the key is not set. */
struct config_item *alarm_item(struct scene *s, const char *name, const char *path,
                               const char *latch, const char *por, const char *set,
                               const char *reset);
/* The item of figure 3.3 of the manual, on D. */
struct config_item *figure_3_3(struct scene *s);
/* Set the latch and the por of D, and the list of the devices in alarm. */
void alarm_device(struct scene *s, const char *latch, const char *por);
/*
 * Write the list of the devices in alarm: D while its latch or its por is not zero, E while its
 * latch is not.
 */
void judge_alarm(struct scene *s);
/* The scene's on_read: calls judge_alarm() before each read of the list. */
void alarm_on_read(struct scene *s, const char *path);
/* Start, and run until the first values have come and the alarms are armed. */
void alarm_begin(struct scene *s);
