/* SPDX-License-Identifier: MIT */
/* The Mqtt block, of which owsd-mqtt takes its options. owsd checks it, and does not use it. */
#pragma once

struct build;
struct config_item;
struct option_value;
struct rio_node;

/* The block, or the defaults if it is NULL. */
void mqtt_build(struct build *build, const struct rio_node *block);
/* The key Class of an item. */
void class_build(struct build *build, const struct option_value *value, struct config_item *item);
