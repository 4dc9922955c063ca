/* SPDX-License-Identifier: MIT */
/* What the files of the scene share. */
#pragma once

#include "tests/unit/aid/scene.h"

/* NULL: there is no such property. */
struct scene_property *scene_find(struct scene *scene, unsigned wire, const char *path);
bool scene_has_device(struct scene *scene, unsigned wire, const char *path);

/* The disk of Start "last". */
const struct engine_last *scene_disk(struct scene *scene);
/* The controller of the seat joins the scene's engine with a new memory; the old one stays as it
 * is. */
void scene_join_again(struct scene *scene, unsigned seat);

/* The submit of an engine's port; ctx is the bus. */
int scene_submit(void *ctx, struct bus_req *req);
void scene_suspend(void *ctx, bool yes);
