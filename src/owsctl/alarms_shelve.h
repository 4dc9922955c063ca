/* SPDX-License-Identifier: MIT */
/* owsctl alarms shelve and unshelve. */
#ifndef OWSCTL_ALARMS_SHELVE_H
#define OWSCTL_ALARMS_SHELVE_H

struct ctl;

int alarms_shelve(struct ctl *ctl, int argc, char **argv);
int alarms_unshelve(struct ctl *ctl, int argc, char **argv);

#endif
