/* SPDX-License-Identifier: MIT */
/*
 * owsd-mqtt: the stream of an instance's signals, a broker, and the commands that come from it.
 *
 * Room src/faces/mqtt: the program owsd-mqtt: publishes signals to an MQTT broker, and takes
 * commands from it.
 */
#pragma once

#include "src/faces/kit/face.h"
#include "src/faces/kit/wall_clock.h"
#include "src/faces/mqtt/broker.h"
#include "src/faces/mqtt/commands.h"
#include "src/faces/mqtt/credit.h"
#include "src/faces/mqtt/errand.h"
#include "src/faces/mqtt/past.h"
#include "src/faces/mqtt/stream.h"

struct mqtt {
	struct mqtt_options options;
	struct stream stream;
	struct broker broker;
	struct commands commands;
	struct errand errand;
	struct credit lists, renames;
	struct past past;
	struct wall_clock clock;
	int bdseq;               /* of the first session of this process */
	int64_t health_ns;       /* when to look at it again */
	int64_t announced_ns;    /* when somebody asked for the birth last */
	bool asked;              /* again, too soon after that */
	bool sweep;              /* the broker has to be asked what it keeps of us */
	int64_t sweep_ns;        /* it is being asked until then; 0: not */
	int64_t pumped_ns;       /* all that waited was published, or the broker took some of it */
	uint64_t pumped;         /* what the broker had taken then */
	bool stuck;              /* it is logged that nothing goes on */
	enum broker_state shown; /* by the status */
};

int mqtt_open(struct face *face);
void mqtt_changes(struct face *face, const int *signals, int n);
void mqtt_event(struct face *face, const struct face_event *event);
void mqtt_tick(struct face *face, int64_t now_ns);
void mqtt_report(struct face *face, FILE *out);
void mqtt_close(struct face *face);
