/* SPDX-License-Identifier: MIT */
/* Puts switches in alarm on a scene. */
#include <string.h>

#include "tests/unit/aid/alarm_scene.h"

struct config_item *alarm_item(struct scene *s, const char *name, const char *path,
                               const char *latch, const char *por, const char *set,
                               const char *reset)
{
	struct config_item *item = scene_input(s, name, path, OWS_BYTE);

	item->alarm = true;
	item->latch_alarm = latch;
	item->por_alarm = por;
	item->set_alarm = set;
	item->reset_latch = reset;
	return item;
}

struct config_item *figure_3_3(struct scene *s)
{
	return alarm_item(s, "inputs", D "/sensed.BYTE", "latch.BYTE", "por", "set_alarm=133333333",
	                  "latch.BYTE=0");
}

void judge_alarm(struct scene *s)
{
	static char list[256];

	list[0] = '\0';
	if (strcmp(scene_at(s, D "/latch.BYTE"), "0") || strcmp(scene_at(s, D "/por"), "0"))
		strcat(list, "/alarm" D "\n");
	if (scene_at(s, E "/latch.BYTE") && strcmp(scene_at(s, E "/latch.BYTE"), "0"))
		strcat(list, "/alarm" E "\n");
	scene_put(s, "/alarm", list, 0);
}

void alarm_device(struct scene *s, const char *latch, const char *por)
{
	scene_put(s, D "/sensed.BYTE", "255", 0);
	scene_put(s, D "/latch.BYTE", latch, 0);
	scene_put(s, D "/por", por, 0);
	scene_put(s, D "/set_alarm", "133333333", 0);
	scene_put(s, D "/PIO.BYTE", "0", 0);
	judge_alarm(s);
}

void alarm_on_read(struct scene *s, const char *path)
{
	if (strcmp(path, "/alarm") == 0)
		judge_alarm(s);
}

void alarm_begin(struct scene *s)
{
	s->on_read = alarm_on_read;
	scene_start(s);
	scene_up(s);
	scene_run(s, 500 * SCENE_MS);
	scene_clear_trace(s);
}
