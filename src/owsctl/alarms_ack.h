/* SPDX-License-Identifier: MIT */
/* owsctl alarms ack: acknowledges limit alarms. */
#ifndef OWSCTL_ALARMS_ACK_H
#define OWSCTL_ALARMS_ACK_H

struct ctl;

int alarms_ack(struct ctl *ctl, int argc, char **argv);

#endif
