/* SPDX-License-Identifier: MIT */
/* The verbs of owsctl: each stands in the file of its name, as a struct verb (ctl.h). */
#pragma once

struct ctl;

int verb_list(struct ctl *ctl, int argc, char **argv);
int verb_get(struct ctl *ctl, int argc, char **argv);
int verb_set(struct ctl *ctl, int argc, char **argv);
int verb_control(struct ctl *ctl, int argc, char **argv);
int verb_who(struct ctl *ctl, int argc, char **argv);
int verb_watch(struct ctl *ctl, int argc, char **argv);
int verb_wait(struct ctl *ctl, int argc, char **argv);
int verb_alarms(struct ctl *ctl, int argc, char **argv);
int verb_trend(struct ctl *ctl, int argc, char **argv);
int verb_journal(struct ctl *ctl, int argc, char **argv);
int verb_stats(struct ctl *ctl, int argc, char **argv);
int verb_metrics(struct ctl *ctl, int argc, char **argv);
int verb_modbus_map(struct ctl *ctl, int argc, char **argv);
int verb_convert(struct ctl *ctl, int argc, char **argv);
int verb_instances(struct ctl *ctl, int argc, char **argv);
int verb_remove(struct ctl *ctl, int argc, char **argv);
int verb_reload(struct ctl *ctl, int argc, char **argv);
int verb_config(struct ctl *ctl, int argc, char **argv);
int verb_dir(struct ctl *ctl, int argc, char **argv);
int verb_read(struct ctl *ctl, int argc, char **argv);
int verb_write(struct ctl *ctl, int argc, char **argv);
int verb_scan(struct ctl *ctl, int argc, char **argv);
int verb_record(struct ctl *ctl, int argc, char **argv);
int verb_doctor(struct ctl *ctl, int argc, char **argv);
int verb_enable(struct ctl *ctl, int argc, char **argv);
int verb_disable(struct ctl *ctl, int argc, char **argv);
