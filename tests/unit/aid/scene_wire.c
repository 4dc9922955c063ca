/* SPDX-License-Identifier: MIT */
/* The properties on the wires of a scene. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/scene_private.h"

/* A path under /alarm means the same property; the list /alarm is a property of its own. */
struct scene_property *scene_find(struct scene *s, unsigned wire, const char *path)
{
	if (strncmp(path, "/alarm/", 7) == 0)
		path += 6;
	for (unsigned i = 0; i < s->property_count; i++)
		if (s->properties[i].wire == wire && strcmp(s->properties[i].path, path) == 0)
			return &s->properties[i];
	return NULL;
}

static bool below(const char *path, const char *device, size_t len)
{
	return strncmp(path, device, len) == 0 && (path[len] == '/' || !path[len]);
}

bool scene_has_device(struct scene *s, unsigned wire, const char *path)
{
	size_t len = strcspn(path + 1, "/") + 1;

	for (unsigned i = 0; i < s->property_count; i++)
		if (s->properties[i].wire == wire && s->properties[i].err != -ENODEV &&
		    below(s->properties[i].path, path, len))
			return true;
	return false;
}

void scene_put_on(struct scene *s, unsigned wire, const char *path, const char *text, int err)
{
	struct scene_property *p = scene_find(s, wire, path);

	if (!p) {
		TEST_ASSERT_LESS_THAN(SCENE_ITEMS * 2, s->property_count);
		p = &s->properties[s->property_count++];
		p->path = path;
		p->wire = wire;
	}
	p->err = err;
	snprintf(p->text, sizeof(p->text), "%s", text ? text : "");
}

void scene_put(struct scene *s, const char *path, const char *text, int err)
{
	scene_put_on(s, 0, path, text, err);
}

void scene_plug(struct scene *s, const char *path, unsigned wire)
{
	for (unsigned i = 0; i < s->property_count; i++)
		if (below(s->properties[i].path, path, strlen(path)))
			s->properties[i].wire = wire;
}

void scene_unplug(struct scene *s, const char *path, bool unplug)
{
	for (unsigned i = 0; i < s->property_count; i++)
		if (below(s->properties[i].path, path, strlen(path)))
			s->properties[i].err = unplug ? -ENODEV : 0;
}

void scene_refuse_writes(struct scene *s, const char *path, int err)
{
	scene_find(s, 0, path)->write_err = err;
}

const char *scene_at(struct scene *s, const char *path)
{
	for (unsigned i = 0; i < s->property_count; i++)
		if (strcmp(s->properties[i].path, path) == 0)
			return s->properties[i].text;
	return NULL;
}
