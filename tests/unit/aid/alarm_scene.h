/* SPDX-License-Identifier: MIT */
/* Switches in alarm on a scene, as the tests of the alarm machine have them. */
#ifndef TESTS_UNIT_AID_ALARM_SCENE_H
#define TESTS_UNIT_AID_ALARM_SCENE_H

#include "tests/unit/aid/scene.h"

/* Two switches and a thermometer. */
#define D "/29.066418000000"
#define E "/29.777777000000"
#define T "/28.551DDF030000"
#define T_TEMP T "/temperature12"

/* An input with the keys of an alarm; NULL: not defined. */
struct config_item *alarm_item(struct scene *s, const char *name, const char *path,
                               const char *latch, const char *por, const char *set,
                               const char *reset);
/* Figure 3.3 of the manual, on D. */
struct config_item *figure_3_3(struct scene *s);
/* What D has, and the list of those in alarm. */
void alarm_device(struct scene *s, const char *latch, const char *por);
/* The list made anew: D is in alarm while its latch or its por is not zero, E while its latch is. */
void judge_alarm(struct scene *s);
/* The scene's on_read, which does so before each list. */
void alarm_on_read(struct scene *s, const char *path);
/* Start, and let the first values and the arming pass. */
void alarm_begin(struct scene *s);

#endif
